"""Cornering at speed: a rigid body on wheels with any law of the side force, in the plane, at constant speed.

Frame of the body: u = V forward, v to the left, yaw rate r. Wheel at (x, y) with steer angle d:

    slip angle  a = atan2(v + r x, u - r y) - d
    m (v' + u r) = sum (F_y cos d),    J r' = sum (x F_y cos d + y F_y sin d)
    loads: N = static -+ m a_y h/t shared by the axles as their roll stiffness    (quasi-static load transfer)

A driver (or motors) holds the speed: the longitudinal balance is not solved. Linearised, it is `handling`
(Genta and Morello 2009, vol. 2, sec. 25.4; Milliken and Milliken 1995, ch. 5).
Assumptions: no roll motion, no pitch, plane ground, upright wheels. Range: speeds of more than 0.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from sojourn_analysis.vehicle.side_force import SideForce
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class CorneringAxle:
    """Two wheels: place x [m], track [m], load of both together [N], share of steer angle and of roll stiffness,
    law.
    """

    x: float
    track: float
    load: float
    steer_ratio: float
    roll_share: float
    law: SideForce


@dataclass(frozen=True, slots=True)
class CorneringVehicle:
    """Mass [kg], yaw inertia [kg m^2], height of the centre of mass [m], axles."""

    mass: float
    yaw_inertia: float
    height: float
    axles: Sequence[CorneringAxle]


def wheel_forces(vehicle: CorneringVehicle, speed: float, side_speed: float, rate: float, steer: float) -> FloatArray:
    """Rows of every wheel, left before right: x, y [m], steer angle [rad], load, side force [N]. Shape (wheels, 5)."""
    transfer = vehicle.mass * speed * rate * vehicle.height
    rows = []
    for axle in vehicle.axles:
        angle = axle.steer_ratio * steer
        for sign in (1.0, -1.0):
            y = 0.5 * sign * axle.track
            load = max(0.5 * axle.load - sign * axle.roll_share * transfer / axle.track, 0.0)
            slip = math.atan2(side_speed + rate * axle.x, speed - rate * y) - angle
            rows.append((axle.x, y, angle, load, axle.law.force(load, slip)))
    return np.array(rows)


def accelerations(
    vehicle: CorneringVehicle, speed: float, side_speed: float, rate: float, steer: float
) -> tuple[float, float]:
    """Rate of change of side speed [m/s^2] and of yaw rate [rad/s^2]."""
    x, y, angle, _, force = wheel_forces(vehicle, speed, side_speed, rate, steer).T
    total = float(np.sum(force * np.cos(angle)))
    moment = float(np.sum(x * force * np.cos(angle) + y * force * np.sin(angle)))
    return total / vehicle.mass - speed * rate, moment / vehicle.yaw_inertia


def simulate(vehicle: CorneringVehicle, speed: float, steer: Callable[[float], float], times: FloatArray) -> FloatArray:
    """Motion from straight driving: rows x, y [m], heading [rad], side speed [m/s], yaw rate [rad/s]; shape (times, 5).

    Args:
        steer: steer angle [rad] at a time [s]. times: from 0, rising [s].
    """
    _check_speed(speed)

    def derivative(time: float, state: FloatArray) -> list[float]:
        _, _, heading, side, rate = state
        change = accelerations(vehicle, speed, side, rate, steer(time))
        cosine, sine = math.cos(heading), math.sin(heading)
        return [speed * cosine - side * sine, speed * sine + side * cosine, rate, *change]

    span = (float(times[0]), float(times[-1]))
    step = max((span[1] - span[0]) / 20.0, 1e-3)
    found = solve_ivp(derivative, span, np.zeros(5), t_eval=times, rtol=1e-7, atol=1e-9, max_step=step)
    return np.asarray(found.y.T)


def steady_cornering(vehicle: CorneringVehicle, speed: float, steer: float) -> tuple[float, float]:
    """Side speed [m/s] and yaw rate [rad/s] of the steady turn.

    Raises:
        InvalidValueError: no steady turn was found: the vehicle slides or spins.
    """
    _check_speed(speed)
    wheelbase = vehicle.axles[0].x - vehicle.axles[-1].x
    ratio = vehicle.axles[0].steer_ratio - vehicle.axles[-1].steer_ratio
    start = [0.0, speed * steer * ratio / wheelbase]
    scale = max(speed, 1e-3)
    for factor in (1.0, 0.3, 0.1, 0.0):
        found = root(
            lambda s: accelerations(vehicle, speed, s[0] * scale, s[1], steer), [start[0], factor * start[1]], tol=1e-12
        )
        if found.success:
            return float(found.x[0]) * scale, float(found.x[1])
    raise InvalidValueError("steer", steer, f"one with a steady turn at {speed:g} m/s")


def _check_speed(speed: float) -> None:
    if not (math.isfinite(speed) and speed > 0.0):
        raise InvalidValueError("speed", speed, "a finite number more than 0 m/s")
