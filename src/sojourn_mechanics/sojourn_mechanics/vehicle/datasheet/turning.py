"""Turning: circles, steering errors, handling, roll-over and sliding."""

import math

import numpy as np

from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.vehicle.datasheet.figures import Curve, Figure, Section
from sojourn_mechanics.vehicle.datasheet.subject import Subject
from sojourn_mechanics.vehicle.datasheet.unusual_steering import articulated_steering
from sojourn_mechanics.vehicle.handling import (
    SingleTrack,
    characteristic_speed,
    critical_speed,
    poles,
    steady_gains,
    step_response,
    understeer_gradient,
)
from sojourn_mechanics.vehicle.longitudinal import loads
from sojourn_mechanics.vehicle.params import AxleParams
from sojourn_mechanics.vehicle.rollover import curve_limit, roll_over_factor
from sojourn_mechanics.vehicle.side_force import cornering_stiffness
from sojourn_mechanics.vehicle.steering_geometry import ideal_angles, path_radii, steering_error, turn_of_outer_wheel

SIDE_ANGLE = 0.6
"""Slip angle at which the side force of the soil is taken as its greatest [rad]."""
STEP_DEG = 1.0


def steering(subject: Subject) -> Section:
    """Turning circle at full lock, steering error, turning on the spot."""
    vehicle, places = subject.vehicle, subject.places
    if subject.machine is not None and subject.articulation is not None:
        return articulated_steering(subject, subject.machine, subject.articulation)
    steered = [axle for axle in vehicle.axles if axle.max_steer > 0.0]
    if not steered:
        note = "turns on the spot, on its rollers" if subject.rolls_sideways else "no wheel steers"
        figure = Figure("outer_wheel_radius", "Turning circle", 0.0 if subject.rolls_sideways else None, "m", note)
        return Section("Steering", (figure,))
    centre = _centre(subject)
    front = vehicle.axles[0]
    figures = []
    if front.full_lock is not None:
        inner, outer = front.full_lock
        turn = turn_of_outer_wheel(places, 1, outer, centre)
        radii = path_radii(places, turn)
        ends = [steered_axle.x > centre for steered_axle in vehicle.axles]
        built = np.array(
            [
                (1.0 if ahead else -1.0) * angle if axle.max_steer else 0.0
                for axle, ahead in zip(vehicle.axles, ends, strict=True)
                for angle in (inner, outer)
            ]
        )
        error = steering_error(places, built)
        figures = [
            Figure("outer_wheel_radius", "Radius of the outer wheel's path, full lock", float(radii[1]), "m"),
            Figure("centre_radius", "Radius of the vehicle's centre line, full lock", turn.y, "m"),
            Figure("ideal_inner_angle", "Ideal angle of the inner wheel", math.degrees(turn.angles[0]), "°"),
            Figure("built_inner_angle", "Built angle of the inner wheel", math.degrees(inner), "°"),
            Figure("steering_error", "Largest side slip that the built angles leave", _worst(error.slip_angles), "°"),
        ]
    else:
        y = _tightest(subject, centre)
        figures = [Figure("turn_on_spot", "Turns on the spot", "yes" if y == 0.0 else "no")]
        radii = np.hypot(places[:, 0] - centre, places[:, 1] - y)
        figures += [
            Figure("outer_wheel_radius", "Radius of the outer wheel's path, full lock", float(radii.max()), "m"),
            Figure("centre_radius", "Radius of the vehicle's centre line, full lock", y, "m"),
            Figure("steering_error", "Largest side slip of the tightest turn", 0.0, "°", "each wheel steers by itself"),
        ]
    return Section(
        "Steering", tuple(figures), (_radius_curve(subject, centre),), "Low speed, no side slip, level ground."
    )


def handling(subject: Subject) -> Section:
    """Linear handling with the side force of the soil, limits on curves."""
    try:
        return _handling(subject)
    except InvalidValueError as error:
        figure = Figure("understeer_gradient", "Understeer gradient K", None, "s²/m²", f"not told: {error}")
        return Section("Handling", (figure,))


def _handling(subject: Subject) -> Section:
    vehicle = subject.vehicle
    level = loads(subject.course(), 0.0)
    stiffness = []
    side, weight = 0.0, 0.0
    for axle, load in zip(vehicle.axles, level, strict=True):
        law = subject.side_force(axle)
        stiffness.append(2.0 * cornering_stiffness(law, float(load)))
        side += -2.0 * law.force(float(load), SIDE_ANGLE)
        weight += 2.0 * float(load)
    centre = _centre(subject)
    ratios = tuple(_ratio(axle, centre) for axle in vehicle.axles)
    car = SingleTrack(vehicle.mass, vehicle.yaw_inertia, tuple(vehicle.x), tuple(stiffness), ratios)
    cruise = vehicle.cruise_speed
    found = poles(car, cruise)
    worst = complex(found[np.argmax(found.real)])
    factor = roll_over_factor(min(axle.track for axle in vehicle.axles), vehicle.height)
    limit = curve_limit(factor, side / weight)
    gradient = understeer_gradient(car)
    figures = [
        Figure(f"cornering_stiffness_{axle.name}", f"Cornering stiffness, {axle.name} axle", value, "N/rad")
        for axle, value in zip(vehicle.axles, stiffness, strict=True)
    ]
    kind = "understeers" if gradient > 0.0 else "oversteers"
    speeds = np.linspace(0.05, 2.0, 40) * max(cruise, 1.0)
    figures += [
        Figure(
            "understeer_gradient",
            "Understeer gradient K",
            gradient,
            "s²/m²",
            kind if abs(gradient) > 1e-9 else "neutral",
        ),
        Figure("characteristic_speed", "Characteristic speed", _finite(characteristic_speed(car)), "m/s"),
        Figure("critical_speed", "Critical speed", _finite(critical_speed(car)), "m/s"),
        Figure("slowest_pole", "Slowest pole at cruise speed, real part", worst.real, "1/s"),
        Figure("roll_over_factor", "Roll-over factor (lateral acceleration over g)", limit.roll_over, ""),
        Figure(
            "sliding_factor",
            "Sliding factor on this soil",
            limit.sliding,
            "",
            f"side slip {math.degrees(SIDE_ANGLE):.0f}°",
        ),
        Figure("first_limit", "What comes first on a curve", limit.first),
    ]
    curves: tuple[Curve, ...] = ()
    if any(ratios):
        gains = np.array([steady_gains(car, float(speed)).curvature for speed in speeds])
        times = np.linspace(0.0, 3.0, 121)
        response = np.degrees(step_response(car, max(cruise, 1.0), math.radians(STEP_DEG), times))
        curves = (
            Curve("Curvature for one radian of steering", "speed [m/s]", "1/(R δ) [1/m]", {"linear": (speeds, gains)}),
            Curve(
                f"Step of {STEP_DEG:g}° of steering at {max(cruise, 1.0):g} m/s",
                "time [s]",
                "",
                {"yaw rate [°/s]": (times, response[:, 1]), "side slip [°]": (times, response[:, 0])},
            ),
        )
    text = "Single-track model, small angles; side force by the contact model of the plant at no longitudinal slip."
    return Section("Handling", tuple(figures), curves, text)


def _centre(subject: Subject) -> float:
    """x of the turning centre: the axles that do not steer, or the middle of all."""
    axles = subject.vehicle.axles
    fixed = [axle.x for axle in axles if axle.max_steer == 0.0]
    return float(np.mean(fixed)) if fixed else 0.5 * (axles[0].x + axles[-1].x)


def _ratio(axle: AxleParams, centre: float) -> float:
    if axle.max_steer == 0.0:
        return 0.0
    return 1.0 if axle.x > centre else -1.0


def _tightest(subject: Subject, centre: float) -> float:
    """Least |y| of a turning centre at x that every wheel's steering reaches [m]; 0 is a turn on the spot."""
    limits = np.array([axle.max_steer for axle in subject.vehicle.axles for _ in range(2)])
    for y in np.linspace(0.0, 20.0 * subject.vehicle.wheelbase, 4001):
        places = subject.places
        if np.min(np.hypot(places[:, 0] - centre, places[:, 1] - y)) < 1e-6:
            continue
        angles = ideal_angles(places, centre, float(y))
        fixed = limits == 0.0
        if np.all(np.abs(angles) <= np.where(fixed, 1e-3, limits) + 1e-9):
            return float(y)
    return math.inf


def _radius_curve(subject: Subject, centre: float) -> Curve:
    front = subject.vehicle.axles[0]
    outer_limit = (
        front.full_lock[1] if front.full_lock is not None else min(front.max_steer, _spot_angle(front, centre))
    )
    angles = np.linspace(0.05 * outer_limit, outer_limit, 40)
    radii = []
    for angle in angles:
        # beyond the turn on the spot the centre would be on the other side
        radii.append(max(turn_of_outer_wheel(subject.places, 1, float(angle), centre).y, 0.0))
    lines = {"centre line": (np.degrees(angles), np.array(radii))}
    return Curve("Turning radius", "angle of the outer front wheel [°]", "radius [m]", lines)


def _spot_angle(front: AxleParams, centre: float) -> float:
    """Angle of a front wheel that turns on the spot [rad]."""
    return math.atan2(front.x - centre, 0.5 * front.track)


def _worst(angles: FloatArray) -> float:
    return float(np.degrees(np.abs(angles).max()))


def _finite(value: float) -> float | str:
    return value if math.isfinite(value) else "none"
