"""Cornering: stability derivatives, and the steady turn with the whole law of the side force beside the linear one."""

import contextlib
import math

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.datasheet.turning import first_on_a_curve, single_track
from sojourn_analysis.vehicle.cornering import CorneringAxle, CorneringVehicle, simulate, steady_cornering
from sojourn_analysis.vehicle.handling import (
    SingleTrack,
    derivatives,
    frequency_response,
    neutral_steer_point,
    steady_gains,
    step_response,
)
from sojourn_analysis.vehicle.longitudinal import loads
from sojourn_analysis.vehicle.rollover import curve_speed
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

RADIUS = 10.0
"""Of the curve whose fastest speed is told [m]."""
LARGEST_STEER = 0.3
ANGLES = 9
STEP = math.radians(4.0)
TIMES = np.linspace(0.0, 3.0, 31)
FREQUENCIES = np.geomspace(0.05, 10.0, 120)


def cornering(subject: Subject) -> Section | None:
    """Of a vehicle whose wheels steer; None of one that turns by slip, by a joint in its middle or on rollers."""
    if subject.articulation is not None or subject.rolls_sideways:
        return None
    try:
        car = single_track(subject)
        limit = first_on_a_curve(subject).least
    except InvalidValueError as error:
        return Section("Cornering", (Figure("static_margin", "Static margin", None, "", f"not told: {error}"),))
    speed = subject.vehicle.cruise_speed
    found = derivatives(car, speed)
    neutral = neutral_steer_point(car)
    figures = [
        Figure("y_beta", "Side force by side slip", found.y_beta, "N/rad"),
        Figure("y_rate", "Side force by yaw rate", found.y_rate, "N s/rad"),
        Figure("n_beta", "Yawing moment by side slip", found.n_beta, "N m/rad"),
        Figure("n_rate", "Yawing moment by yaw rate", found.n_rate, "N m s/rad"),
        Figure("y_steer", "Side force by steering", found.y_steer, "N/rad"),
        Figure("n_steer", "Yawing moment by steering", found.n_steer, "N m/rad"),
        Figure("neutral_steer_point", "Neutral steer point, ahead of the centre of mass", 1000.0 * neutral, "mm"),
        Figure("static_margin", "Static margin, over the wheelbase", -neutral / subject.vehicle.wheelbase, ""),
        Figure(
            "curve_speed",
            f"Fastest on a curve of {RADIUS:g} m radius",
            3.6 * curve_speed(limit, RADIUS, subject.gravity),
            "km/h",
            "it slides or rolls over beyond",
        ),
    ]
    curves: tuple[Curve, ...] = ()
    if any(car.steer_ratio):
        whole = _whole(subject, car)
        quick = max(speed, 1.0)
        steady, last = _steady_curve(whole, car, quick)
        figures.append(
            Figure("greatest_steady_turn", f"Largest steady lateral acceleration found, {quick:g} m/s", last, "m/s²")
        )
        curves = (steady, _step_curve(whole, car, quick), _frequency_curve(car, quick))
    text = f"Derivatives at {speed:g} m/s. The whole law takes each wheel's load and the shift of load to the outside."
    return Section("Cornering", tuple(figures), curves, text)


def _whole(subject: Subject, car: SingleTrack) -> CorneringVehicle:
    """With each wheel's own law; axles share the roll as the rates of their springs, or evenly without any."""
    vehicle = subject.vehicle
    rates = np.array([(axle.spring_rate or 0.0) * axle.track**2 for axle in vehicle.axles])
    shares = rates / rates.sum() if rates.sum() > 0.0 else np.full(len(rates), 1.0 / len(rates))
    axles = [
        CorneringAxle(axle.x, axle.track, 2.0 * float(load), ratio, float(share), subject.side_force(axle))
        for axle, load, ratio, share in zip(
            vehicle.axles, loads(subject.course(), 0.0), car.steer_ratio, shares, strict=True
        )
    ]
    return CorneringVehicle(vehicle.mass, vehicle.yaw_inertia, vehicle.height, axles)


def _steady_curve(whole: CorneringVehicle, car: SingleTrack, speed: float) -> tuple[Curve, float]:
    """Lateral acceleration over the steer angle as far as a steady turn is found, and the largest of them [m/s^2]."""
    angles = np.linspace(0.0, LARGEST_STEER, ANGLES)
    found = [0.0]
    for angle in angles[1:]:
        try:
            found.append(speed * steady_cornering(whole, speed, float(angle))[1])
        except InvalidValueError:  # it slides off, or the inner wheels lift
            break
    accelerations = np.array(found + [math.nan] * (ANGLES - len(found)))
    lines = {"whole law": (np.degrees(angles), accelerations)}
    with contextlib.suppress(InvalidValueError):  # at the critical speed there is no steady turn
        gain = steady_gains(car, speed).lateral_acceleration
        lines["linear"] = (np.degrees(angles), gain * angles)
    title = f"Steady turn at {speed:g} m/s"
    return Curve(title, "steer angle [°]", "lateral acceleration [m/s²]", lines), float(np.nanmax(accelerations))


def _step_curve(whole: CorneringVehicle, car: SingleTrack, speed: float) -> Curve:
    lines: dict[str, tuple[FloatArray, FloatArray]] = {
        "linear": (TIMES, np.degrees(step_response(car, speed, STEP, TIMES))[:, 1])
    }
    with contextlib.suppress(InvalidValueError):  # a wheel is pressed harder than the soil carries
        lines["whole law"] = (TIMES, np.degrees(simulate(whole, speed, lambda time: STEP, TIMES))[:, 4])
    title = f"Yaw rate after a step of {math.degrees(STEP):.0f}° of steering at {speed:g} m/s"
    return Curve(title, "time [s]", "yaw rate [°/s]", lines)


def _frequency_curve(car: SingleTrack, speed: float) -> Curve:
    gain = np.abs(frequency_response(car, speed, FREQUENCIES)[:, 1])
    lines = {"linear": (FREQUENCIES, gain)}
    return Curve(f"Yaw rate over steering at {speed:g} m/s", "frequency [Hz]", "1/s", lines, logarithmic=True)
