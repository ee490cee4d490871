"""Turning: circles, steering errors, handling, roll-over and sliding."""

import math

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.datasheet.unusual_steering import articulated_steering
from sojourn_analysis.vehicle.handling import (
    SingleTrack,
    characteristic_speed,
    critical_speed,
    poles,
    steady_gains,
    step_response,
    understeer_gradient,
)
from sojourn_analysis.vehicle.longitudinal import loads
from sojourn_analysis.vehicle.params import AxleParams, TrapezoidParams
from sojourn_analysis.vehicle.rollover import CurveLimit, curve_limit, roll_over_factor
from sojourn_analysis.vehicle.side_force import cornering_stiffness
from sojourn_analysis.vehicle.steering_geometry import (
    Turn,
    ideal_angles,
    off_tracking,
    path_radii,
    steering_error,
    trapezoid_right_angle,
    turn_of_outer_wheel,
)
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

SIDE_ANGLE = 0.6
"""Slip angle at which the side force of the soil is taken as its greatest [rad]."""
STEP_DEG = 1.0
STEERING_TEXT = "Low speed, no side slip, level ground."


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
            _off_tracking(subject, centre, turn.y),
        ]
        if front.linkage is not None:
            found, curve = _linkage(subject, front.linkage, turn)
            return Section("Steering", (*figures, *found), (_radius_curve(subject, centre), curve), STEERING_TEXT)
    else:
        y = _tightest(subject, centre)
        figures = [Figure("turn_on_spot", "Turns on the spot", "yes" if y == 0.0 else "no")]
        radii = np.hypot(places[:, 0] - centre, places[:, 1] - y)
        figures += [
            Figure("outer_wheel_radius", "Radius of the outer wheel's path, full lock", float(radii.max()), "m"),
            Figure("centre_radius", "Radius of the vehicle's centre line, full lock", y, "m"),
            Figure("steering_error", "Largest side slip of the tightest turn", 0.0, "°", "each wheel steers by itself"),
            _off_tracking(subject, centre, max(y, vehicle.wheelbase)),
        ]
    return Section("Steering", tuple(figures), (_radius_curve(subject, centre),), STEERING_TEXT)


def _off_tracking(subject: Subject, centre: float, y: float) -> Figure:
    """How far the middles of the axles run beside one another, turning about (centre, y) [m]."""
    ways = np.abs(subject.vehicle.x - centre)
    farthest, nearest = float(ways.max()), float(ways.min())
    key, label = "off_tracking", f"Off-tracking of the axles on a radius of {math.hypot(farthest, y):.3g} m"
    if farthest - nearest < 1e-9:
        return Figure(key, label, 0.0, "m", "all axles run in the same track")
    outer = math.hypot(farthest, y)
    # both axles against one at the centre of the turn
    inner = off_tracking(nearest, math.hypot(nearest, y)) if nearest > 0.0 else 0.0
    return Figure(key, label, off_tracking(farthest, outer) - inner, "m", "first and last axle outside of the middle")


def _linkage(subject: Subject, linkage: TrapezoidParams, turn: Turn) -> tuple[tuple[Figure, ...], Curve]:
    """What the trapezoid of the front axle makes of the angle of its inner wheel, up to full lock."""
    front = subject.vehicle.axles[0]
    ahead = front.x - turn.x
    inner = np.linspace(0.0, front.full_lock[0] if front.full_lock is not None else front.max_steer, 40)
    slope = math.radians(linkage.inclination_deg)
    built = np.array([trapezoid_right_angle(linkage.track, linkage.arm, slope, float(angle)) for angle in inner])
    with np.errstate(divide="ignore"):
        ideal = np.arctan2(ahead, ahead / np.tan(inner) + front.track)
    figures = (
        Figure("linkage_outer_angle", "Outer wheel by the linkage, full lock", math.degrees(built[-1]), "°"),
        Figure("linkage_ideal_angle", "Ideal angle of it", math.degrees(ideal[-1]), "°"),
        Figure("linkage_error", "Largest error of the linkage", _worst(built - ideal), "°"),
    )
    lines = {
        "trapezoid": (np.degrees(inner), np.degrees(built)),
        "ideal": (np.degrees(inner), np.degrees(ideal)),
    }
    return figures, Curve("Steering linkage", "angle of the inner wheel [°]", "angle of the outer wheel [°]", lines)


def handling(subject: Subject) -> Section:
    """Linear handling with the side force of the soil, limits on curves."""
    try:
        return _handling(subject)
    except InvalidValueError as error:
        figure = Figure("understeer_gradient", "Understeer gradient K", None, "s²/m²", f"not told: {error}")
        return Section("Handling", (figure,))


def steer_ratios(subject: Subject) -> tuple[float, ...]:
    """Share of the steer angle of each axle: 1 ahead of the turning centre, -1 behind it, 0 where no wheel steers."""
    centre = _centre(subject)
    return tuple(_ratio(axle, centre) for axle in subject.vehicle.axles)


def single_track(subject: Subject) -> SingleTrack:
    """The vehicle of linear handling, with the side forces of its wheels on this soil.

    Raises:
        InvalidValueError: a soil that does not carry the wheels, or gives no side force.
    """
    vehicle = subject.vehicle
    stiffness = [
        2.0 * cornering_stiffness(subject.side_force(axle), float(load))
        for axle, load in zip(vehicle.axles, loads(subject.course(), 0.0), strict=True)
    ]
    return SingleTrack(vehicle.mass, vehicle.yaw_inertia, tuple(vehicle.x), tuple(stiffness), steer_ratios(subject))


def first_on_a_curve(subject: Subject) -> CurveLimit:
    """Whether the vehicle slides on this soil or rolls over first, level ground."""
    side, weight = 0.0, 0.0
    for axle, load in zip(subject.vehicle.axles, loads(subject.course(), 0.0), strict=True):
        side += -2.0 * subject.side_force(axle).force(float(load), SIDE_ANGLE)
        weight += 2.0 * float(load)
    narrowest = min(axle.track for axle in subject.vehicle.axles)
    return curve_limit(roll_over_factor(narrowest, subject.vehicle.height), side / weight)


def _handling(subject: Subject) -> Section:
    vehicle = subject.vehicle
    car = single_track(subject)
    stiffness, ratios = car.stiffness, car.steer_ratio
    cruise = vehicle.cruise_speed
    found = poles(car, cruise)
    worst = complex(found[np.argmax(found.real)])
    limit = first_on_a_curve(subject)
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
