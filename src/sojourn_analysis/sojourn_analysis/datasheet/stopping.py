"""Stopping: how brakes that are alike share the force, and how far it coasts."""

import math

import numpy as np

from sojourn_analysis.datasheet.driving import braking_deceleration
from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.vehicle.braking import (
    BrakeGeometry,
    braking_limit,
    coasting_speed,
    ideal_forces,
    ideal_front_fraction,
)
from sojourn_analysis.vehicle.driveline import equivalent_mass
from sojourn_analysis.vehicle.longitudinal import total_pull

POINTS = 60


def stopping(subject: Subject) -> Section:
    """Of two axles the brakes, of any vehicle the coasting."""
    vehicle, course = subject.vehicle, subject.course()
    resistance = max(-total_pull(course, 0.0, 0.0, 0.0), 0.0) / (vehicle.mass * subject.gravity)
    mass = equivalent_mass(vehicle)
    figures = [Figure("equivalent_mass", "Mass that resists acceleration, rotors included", mass, "kg")]
    curves: tuple[Curve, ...] = ()
    if resistance > 0.0:
        times, speeds = _coasting(subject, resistance, mass / vehicle.mass)
        figures += [
            Figure("coasting_time", "Coasts from cruise speed for", float(times[-1]), "s"),
            Figure("coasting_distance", "Way of that", float(np.trapezoid(speeds, times)), "m"),
        ]
        curves += (Curve("Coasting from cruise speed", "time [s]", "speed [km/h]", {"free": (times, 3.6 * speeds)}),)
    friction = braking_deceleration(course) / subject.gravity
    if len(vehicle.axles) != 2:
        figures.append(Figure("first_to_lock", "Axle that locks first", None, "", "told of two axles alone"))
    elif friction > 0.0:
        found, curve = _distribution(subject, friction)
        figures += found
        curves += (curve,)
    text = "Coasting: motors and gears let go, the ground and the wheels hold it back. "
    text += "Brakes: alike on all wheels that have a motor, on ground with the friction of the braking limit above."
    return Section("Stopping", tuple(figures), curves, text)


def _coasting(subject: Subject, resistance: float, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] until it stands, and speeds [m/s]."""
    vehicle = subject.vehicle
    cruise, quadratic = vehicle.cruise_speed, vehicle.rolling_loss_quadratic
    # without the part that grows with the speed it takes longest
    longest = cruise * ratio / (subject.gravity * resistance)
    if quadratic > 0.0:
        scale = math.sqrt(quadratic / resistance)
        longest = math.atan(cruise * scale) * ratio / (subject.gravity * resistance * scale)
    times = np.linspace(0.0, longest, POINTS)
    speeds = [coasting_speed(cruise, float(t), subject.gravity, resistance, quadratic, ratio) for t in times]
    return times, np.array(speeds)


def _distribution(subject: Subject, friction: float) -> tuple[list[Figure], Curve]:
    vehicle = subject.vehicle
    front, rear = vehicle.axles
    geometry = BrakeGeometry(front.x, -rear.x, vehicle.height, vehicle.mass, subject.gravity)
    share = float(front.driven) / float(front.driven + rear.driven)
    limit = braking_limit(geometry, friction, share)
    best = friction * subject.gravity
    figures = [
        Figure("brake_friction", "Friction of the braking limit", friction, ""),
        Figure("front_brake_share", "Share of the front axle, brakes alike", share, ""),
        Figure("ideal_front_share", "Ideal share of it at that limit", ideal_front_fraction(geometry, best), ""),
        Figure("brake_deceleration", "Deceleration until an axle locks, brakes alike", limit.deceleration, "m/s²"),
        Figure("brake_efficiency", "The same over the ideal", limit.efficiency, ""),
        Figure("first_to_lock", "Axle that locks first", limit.first_to_lock, "", "rear: it turns round"),
    ]
    lifts = subject.gravity * geometry.front / geometry.height
    forces = np.array([ideal_forces(geometry, float(d)) for d in np.linspace(0.0, min(1.5 * best, lifts), 40)])
    total = np.array([0.0, forces.sum(axis=1).max()])
    lines = {"ideal": (forces[:, 0], forces[:, 1]), "brakes alike": (share * total, (1.0 - share) * total)}
    reached = limit.deceleration * vehicle.mass
    points = {"locks": (share * reached, (1.0 - share) * reached)}
    return figures, Curve("Braking forces", "front axle [N]", "rear axle [N]", lines, points)
