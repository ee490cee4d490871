"""Suspension: what its travel does to the wheels, and the modes of the machine by linearising the plant."""

import math

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.modal.linear_modes import Mode, ground_response, modes
from sojourn_analysis.modal.linearise import BASE, LinearPlant
from sojourn_analysis.vehicle.anti_dive import anti_fraction, pitch_under
from sojourn_analysis.vehicle.differential import chassis_error
from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_analysis.vehicle.travel_steer import (
    contact_shift,
    roll_steer,
    steering_error,
    suspension_joints,
    travel_rates,
)
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_machine.errors import InvalidValueError

SWINGS = {"x": "surge", "y": "sway", "z": "heave"}
TRAVEL = 0.1
"""Of suspension joints, for the error of steered wheels [rad], [m]."""
STEER = math.radians(30.0)
UPRIGHT = 1e-6
"""Rates below it count as none."""
BRAKING = 0.3
"""Deceleration for which the dive is told, over gravity."""
ROCKING_DEG = 30.0
"""Angles of a rocker for which its differential is told, either way."""
CARRIED = 0.5
"""Part of a mode's kinetic energy in base and passive joints from which on it is one of the suspension."""
HIGHEST = 30.0
"""Of the frequencies that are drawn [Hz]."""


def suspension(subject: Subject) -> Section:
    """Of a machine of the plant."""
    if subject.machine is None:
        note = "parameters alone: no joints to look at"
        return Section("Suspension", (Figure("roll_steer", "Roll steer", None, "°/°", note),))
    figures = _kinematics(subject, subject.machine) + _anti_dive(subject, subject.machine)
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


def differential(subject: Subject) -> Section | None:
    """How far the bar between two rockers is off halving their angles; None where the machine names no bar."""
    if subject.machine is None:
        return None
    bar = next((coupling.bar for coupling in subject.machine.machine.couplings if coupling.bar is not None), None)
    if bar is None:
        return None
    angles, errors = [], []
    for angle in np.radians(np.linspace(-ROCKING_DEG, ROCKING_DEG, 61)):
        try:
            errors.append(math.degrees(chassis_error(bar, float(angle))))
            angles.append(math.degrees(angle))
        except InvalidValueError:  # the links do not reach so far
            continue
    if not angles:
        return Section(
            "Differential", (Figure("differential_error", "Error of the bar", None, "°", "it does not move"),)
        )
    figures = (
        Figure("differential_reach", "Rocker's angle that the bar reaches", max(angles), "°", f"of {ROCKING_DEG:g}°"),
        Figure("differential_error", "Pitch that it leaves to the chassis, largest", float(np.abs(errors).max()), "°"),
    )
    line = {"away from the mean of the rockers": (np.array(angles), np.array(errors))}
    curve = Curve("Error of the differential bar", "left rocker [°]", "chassis [°]", line)
    return Section("Differential", figures, (curve,), "Rigid links. The plant couples the rockers by the bar's ratio.")


def _anti_dive(subject: Subject, machine: StandingMachine) -> list[Figure]:
    """What the links of a sprung suspension carry of the load transfer, motors and brakes in the hubs."""
    vehicle = subject.vehicle
    if not machine.sprung:
        return []
    stance = machine.stand(lambda x, y: 0.0, angles=subject.angles)
    order = np.argsort(-stance.contacts[:, 0], kind="stable")
    shifts = [contact_shift(machine, int(order[2 * number])) or 0.0 for number in range(len(vehicle.axles))]
    figures = [
        Figure(
            f"contact_shift_{axle.name}",
            f"Shift of the contact by travel, {axle.name}",
            100.0 * shift,
            "mm/dm",
            "ahead is positive",
        )
        for axle, shift in zip(vehicle.axles, shifts, strict=True)
    ]
    front, rear = vehicle.axles[0], vehicle.axles[-1]
    if len(vehicle.axles) != 2 or front.spring_rate is None or rear.spring_rate is None:
        return figures
    anti = (
        anti_fraction(0.5, shifts[0], 1.0, vehicle.wheelbase, vehicle.height),
        anti_fraction(0.5, -shifts[1], 1.0, vehicle.wheelbase, vehicle.height),
    )
    rates = (2.0 * front.spring_rate, 2.0 * rear.spring_rate)
    pitch = pitch_under(-BRAKING * subject.gravity, vehicle.mass, vehicle.wheelbase, vehicle.height, rates, anti)
    return [
        *figures,
        Figure("anti_dive", "Anti-dive, front, brakes alike", anti[0], "", "1: no dive at all"),
        Figure("anti_lift", "Anti-lift, rear, brakes alike", anti[1], "", "also anti-squat, driving"),
        Figure("pitch_braking", f"Pitch at a deceleration of {BRAKING:g} g", math.degrees(pitch), "°", "nose up"),
    ]


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
