"""Suspension: what its travel does to the wheels, and the modes of the machine by linearising the plant."""

import math

import numpy as np

from sojourn_mechanics.plant.linear_modes import Mode, ground_response, modes
from sojourn_mechanics.plant.linearise import BASE, LinearPlant
from sojourn_mechanics.vehicle.datasheet.figures import Curve, Figure, Section
from sojourn_mechanics.vehicle.datasheet.subject import Subject
from sojourn_mechanics.vehicle.params import VehicleParams
from sojourn_mechanics.vehicle.travel_steer import roll_steer, steering_error, suspension_joints, travel_rates
from sojourn_mechanics.vehicle.wheel_loads import StandingMachine

SWINGS = {"x": "surge", "y": "sway", "z": "heave"}
TRAVEL = 0.1
"""Of suspension joints, for the error of steered wheels [rad], [m]."""
STEER = math.radians(30.0)
UPRIGHT = 1e-6
"""Rates below it count as none."""
CARRIED = 0.5
"""Part of a mode's kinetic energy in base and passive joints from which on it is one of the suspension."""
HIGHEST = 30.0
"""Of the frequencies that are drawn [Hz]."""


def suspension(subject: Subject) -> Section:
    """Of a machine of the plant."""
    if subject.machine is None:
        note = "parameters alone: no joints to look at"
        return Section("Suspension", (Figure("roll_steer", "Roll steer", None, "°/°", note),))
    figures = _kinematics(subject, subject.machine)
    curves: tuple[Curve, ...] = ()
    text = "Travel of the suspension: rates of the wheels about the middle, from the joints of the URDF. "
    if subject.standing is not None:
        figures += _mode_figures(subject.standing, subject.machine)
        text += "Modes: the plant linearised, standing on this soil with all motors holding; the names say which "
        text += "coordinates of base and joints have the kinetic energy. "
    if subject.driving is not None:
        curves = (_answer(subject.driving, subject.vehicle),)
        text += (
            "Answer to the ground: both tracks alike, with the filter of the wheelbase, for waves longer than a wheel."
        )
    return Section("Suspension", tuple(figures), curves, text.strip())


def _answer(plant: LinearPlant, vehicle: VehicleParams) -> Curve:
    """Motion of the base over that of the ground."""
    shortest = 2.0 * max(axle.wheel_radius for axle in vehicle.axles)
    highest = min(plant.speed / shortest, HIGHEST)
    frequencies = np.geomspace(highest / 100.0, highest, 500)
    moved = {
        "heave": np.abs(ground_response(plant, "z", frequencies)),
        "pitch, at half the wheelbase": 0.5 * vehicle.wheelbase * np.abs(ground_response(plant, "pitch", frequencies)),
    }
    square = (2.0 * math.pi * frequencies) ** 2
    lines = {name: (frequencies, np.maximum(values / square, 1e-4)) for name, values in moved.items()}
    title = f"Motion of base_link over that of the ground, at {3.6 * plant.speed:.3g} km/h"
    return Curve(title, "frequency [Hz]", "ratio", lines, logarithmic=True)


def _kinematics(subject: Subject, machine: StandingMachine) -> list[Figure]:
    stance = machine.stand(lambda x, y: 0.0, angles=subject.angles)
    order = [int(index) for index in np.argsort(-stance.contacts[:, 0], kind="stable")]
    figures = []
    for number, axle in enumerate(subject.vehicle.axles):
        pair = (order[2 * number], order[2 * number + 1])
        left = max(pair, key=lambda wheel: stance.contacts[wheel, 1])
        rates = travel_rates(machine, left)
        if rates is None:
            continue
        name = axle.name
        values = {
            f"toe_{name}": (f"Toe by travel, {name}", math.degrees(rates.toe) / 10.0, "°/dm"),
            f"camber_{name}": (f"Camber by travel, {name}", math.degrees(rates.camber) / 10.0, "°/dm"),
            f"scrub_{name}": (f"Shift of the track by travel, {name}", 100.0 * rates.left, "mm/dm"),
            f"roll_steer_{name}": (f"Roll steer, {name}", roll_steer(machine, pair), "°/°"),
        }
        if max(abs(value) for _, value, _ in values.values()) < UPRIGHT:
            words = f"Toe, camber, shift of the track by travel, {name}"
            figures.append(Figure(f"toe_{name}", words, 0.0, "", "it moves in an upright plane"))
        else:
            figures += [Figure(key, words, value, unit) for key, (words, value, unit) in values.items()]
        if axle.max_steer > 0.0:
            travel = {joint: TRAVEL for joint in suspension_joints(machine, left)}
            error = steering_error(machine, left, min(STEER, axle.max_steer), travel)
            words = f"Steering error at {math.degrees(min(STEER, axle.max_steer)):.0f}°, {name}"
            note = f"suspension joints at {TRAVEL:g} rad or m"
            figures.append(Figure(f"travel_error_{name}", words, math.degrees(error), "°", note))
    if not figures:
        figures.append(Figure("roll_steer", "Roll steer", None, "°/°", "the wheels do not travel"))
    return figures


def suspension_modes(plant: LinearPlant, machine: StandingMachine) -> list[Mode]:
    """Modes of the base and of passive joints."""
    carried = {*BASE, *machine.passive}
    return [mode for mode in modes(plant) if sum(mode.shares.get(name, 0.0) for name in carried) > CARRIED]


def _mode_figures(plant: LinearPlant, machine: StandingMachine) -> list[Figure]:
    return [
        Figure(
            f"plant_mode_{number}",
            f"Mode {number}: {', '.join(_words(name) for name in mode.name.split(', '))}",
            mode.frequency,
            "Hz",
            f"damping ratio {mode.damping:.2f}",
        )
        for number, mode in enumerate(suspension_modes(plant, machine), 1)
    ]


def _words(name: str) -> str:
    return SWINGS.get(name, name.removesuffix("_joint").replace("_", " "))
