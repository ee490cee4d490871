"""A vehicle driving straight: working points, energy, greatest grade and speed, acceleration.

Steady motion at a speed V up a grade a. All driven wheels turn alike, with one slip s; wheels without motors are towed:

    sum_i 2 P_i(N_i, s) = m g sin a + (m + sum 2 J_w/r^2 of the towed wheels) v'        (N_i from `axle_loads`)
    T_motor side of a driven wheel = T_i + (J_w + N^2 J_m) v'/r
    w = V / (r (1 - s)),   T_i from the wheel's law, motor and bus from `driveline`
    power of the bus  P_b = sum of the motors / n_c + house power,    energy per metre E = P_b / V,  range = energy / E

What limits: `traction`, the greatest sum of pulls over the slip (greatest torque that the ground takes); `motor`,
voltage and current. At full throttle every wheel has its own slip: an axle whose motors give all they have leaves the
rest to the others. Time and distance to a speed come from  t = int m_e dv / F(v),  F the pull that is left at full
torque (Genta and Morello 2009, vol. 2, sec. 23.6 to 23.9; Wong 2008, Theory of Ground Vehicles, sec. 3.4).

Assumptions: no air; quasi-static loads; level tracks, both sides alike; the soil as the first wheel finds it (no
multipass).
Range: grades below 60 degrees, forward drive.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from sojourn_analysis.vehicle.axle_loads import axle_loads
from sojourn_analysis.vehicle.driveline import bus_power, largest_wheel_torque, motor_point
from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_analysis.vehicle.wheel_traction import WheelForces, WheelTraction
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.actuators.dc_motor import WorkingPoint

GREATEST_SLIP = 0.8
"""Beyond it a wheel digs itself in and a steady state means nothing."""
STEEPEST = math.radians(60.0)


@dataclass(frozen=True, slots=True)
class Course:
    """A vehicle on one ground.

    Args:
        vehicle: the machine. wheels: law of each axle's wheels, in the order of its axles.
        gravity: [m/s^2].
        sharing: part of the weight that each axle carries on a grade [rad], shape (axles,), for a suspension that
            equalises; None for axles on springs.
    """

    vehicle: VehicleParams
    wheels: Sequence[WheelTraction]
    gravity: float
    sharing: Callable[[float], FloatArray] | None = None


class SteadyState(NamedTuple):
    """Steady motion. `motors` holds one working point a driven axle; powers in W, energy in J/m."""

    speed: float
    grade: float
    slip: float
    wheel_rate: float
    wheels: tuple[WheelForces, ...]
    motors: tuple[WorkingPoint, ...]
    drive_power: float
    bus_power: float
    feasible: bool

    @property
    def energy_per_metre(self) -> float:
        """From the bus [J/m]."""
        return self.bus_power / self.speed


def loads(course: Course, grade: float, acceleration: float = 0.0) -> FloatArray:
    """Load on one wheel of each axle [N], shape (axles,), on a grade [rad] with an acceleration [m/s^2]."""
    vehicle = course.vehicle
    press = vehicle.mass * course.gravity * math.cos(grade)
    back = vehicle.mass * (course.gravity * math.sin(grade) + acceleration)
    if course.sharing is not None:
        # acceleration loads the axles as a steeper grade does
        return 0.5 * press * course.sharing(math.atan2(back, press))
    rates = [1.0 if axle.spring_rate is None else axle.spring_rate for axle in vehicle.axles]
    return 0.5 * axle_loads(vehicle.x, vehicle.height, press, back, rates)


def pulls(course: Course, grade: float, slip: float, speed: float, acceleration: float = 0.0) -> list[WheelForces]:
    """Forces on one wheel of each axle at a slip of the driven ones; one without motor gives its towed resistance."""
    found = []
    for axle, wheel, load in zip(course.vehicle.axles, course.wheels, loads(course, grade, acceleration), strict=True):
        if load <= 0.0:
            found.append(WheelForces(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        elif axle.driven:
            found.append(wheel.forces(float(load), slip, speed))
        else:
            found.append(_towed(wheel, float(load), speed))
    return found


def total_pull(course: Course, grade: float, slip: float, speed: float, acceleration: float = 0.0) -> float:
    """Sum of the pulls of all wheels [N]."""
    return 2.0 * sum(force.pull for force in pulls(course, grade, slip, speed, acceleration))


def greatest_pull(course: Course, grade: float, speed: float = 0.0) -> tuple[float, float]:
    """Greatest sum of pulls [N] that the ground takes on a grade [rad], and its slip, up to GREATEST_SLIP."""
    slips = np.linspace(0.0, GREATEST_SLIP, 33)
    values = [total_pull(course, grade, float(slip), speed) for slip in slips]
    best = int(np.argmax(values))
    return values[best], float(slips[best])


def slip_for(course: Course, grade: float, speed: float, acceleration: float = 0.0) -> float | None:
    """Slip of steady motion, or None where the ground does not give the pull."""
    vehicle = course.vehicle
    towed = sum(2.0 * axle.wheel_inertia / axle.wheel_radius**2 for axle in vehicle.axles if not axle.driven)
    needed = vehicle.mass * course.gravity * math.sin(grade) + (vehicle.mass + towed) * acceleration

    def missing(slip: float) -> float:
        return total_pull(course, grade, slip, speed, acceleration) - needed

    low, at_low = -GREATEST_SLIP, missing(-GREATEST_SLIP)
    if at_low > 0.0:
        return None
    for high in (0.0, 0.1, 0.2, 0.4, 0.6, GREATEST_SLIP):
        at_high = missing(high)
        if at_low <= 0.0 <= at_high:
            return float(brentq(missing, low, high, xtol=1e-12))
        low, at_low = high, at_high
    return None


def steady_state(course: Course, speed: float, grade: float = 0.0) -> SteadyState | None:
    """Steady motion at a speed of more than 0 [m/s] up a grade [rad]; None where the ground does not give the pull.

    `feasible` tells whether voltage and current of the motors suffice.

    Raises:
        InvalidValueError: a speed of 0 or less, or a grade beyond 60 degrees.
    """
    _check(speed, grade)
    slip = slip_for(course, grade, speed)
    if slip is None:
        return None
    return _at_slip(course, speed, grade, slip)


def _at_slip(course: Course, speed: float, grade: float, slip: float) -> SteadyState:
    vehicle = course.vehicle
    forces = pulls(course, grade, slip, speed)
    motors, power, feasible, fastest = [], 0.0, True, 0.0
    for axle, wheel, force in zip(vehicle.axles, course.wheels, forces, strict=True):
        if not axle.driven:
            continue
        rate = speed / (wheel.radius * (1.0 - slip))
        point = motor_point(vehicle, force.torque, rate)
        feasible &= force.torque <= largest_wheel_torque(vehicle, rate) * (1.0 + 1e-9)
        motors.append(point)
        fastest = max(fastest, rate)
        power += 2.0 * bus_power(vehicle, point)
    return SteadyState(
        speed, grade, slip, fastest, tuple(forces), tuple(motors), power, power + vehicle.house_power, feasible
    )


def full_throttle_pull(course: Course, speed: float, grade: float = 0.0, acceleration: float = 0.0) -> float:
    """Sum of the pulls [N] with every driven wheel at the limit of its motor or ground, each with its own slip."""
    vehicle = course.vehicle
    total = 0.0
    for axle, wheel, load in zip(vehicle.axles, course.wheels, loads(course, grade, acceleration), strict=True):
        if load <= 0.0:
            continue
        if axle.driven:
            inertia = axle.wheel_inertia + vehicle.gear.ratio**2 * vehicle.motor.rotor_inertia
            spin_up = inertia * acceleration / axle.wheel_radius
            total += 2.0 * _pull_at_limit(vehicle, wheel, float(load), speed, spin_up)
        else:
            towed = axle.wheel_inertia / axle.wheel_radius**2 * acceleration
            total += 2.0 * (_towed(wheel, float(load), speed).pull - towed)
    return total


def _pull_at_limit(vehicle: VehicleParams, wheel: WheelTraction, load: float, speed: float, spin_up: float) -> float:
    """Greatest pull of a wheel whose motor also has to give `spin_up` [N m] to the rotating parts."""

    def excess(slip: float) -> float:
        rate = speed / (wheel.radius * (1.0 - slip))
        return wheel.forces(load, slip, speed).torque + spin_up - largest_wheel_torque(vehicle, rate)

    most = GREATEST_SLIP
    if excess(most) > 0.0:
        if excess(-GREATEST_SLIP) > 0.0:
            return wheel.forces(load, -GREATEST_SLIP, speed).pull
        most = float(brentq(excess, -GREATEST_SLIP, GREATEST_SLIP, xtol=1e-12))
        return wheel.forces(load, most, speed).pull
    # the ground limits: on some soils the pull falls again before the greatest slip
    return max(wheel.forces(load, float(slip), speed).pull for slip in np.linspace(0.2, most, 13))


def greatest_grade(course: Course, speed: float) -> tuple[float, str]:
    """Steepest grade [rad] that is climbed at a speed [m/s], and what limits it: traction, motor or tipping.

    Raises:
        InvalidValueError: a speed that the vehicle does not reach down any grade.
    """
    _check(speed, 0.0)

    def spare(grade: float) -> float:
        try:
            return full_throttle_pull(course, speed, grade) - course.vehicle.mass * course.gravity * math.sin(grade)
        except InvalidValueError:
            return -math.inf  # it tips over

    low, high = (0.0, STEEPEST) if spare(0.0) >= 0.0 else (-STEEPEST, 0.0)
    if spare(low) < 0.0:
        raise InvalidValueError("speed", speed, "one that the vehicle reaches on some grade")
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if spare(middle) >= 0.0 else (low, middle)
    if math.isinf(spare(high)):
        return low, "tipping"
    pull, _ = greatest_pull(course, low, speed)
    missing = course.vehicle.mass * course.gravity * math.sin(low) * (1.0 + 1e-3)
    return low, "motor" if pull > missing else "traction"


def greatest_speed(course: Course, grade: float = 0.0, highest: float = 20.0) -> float:
    """Fastest steady speed [m/s] up a grade [rad]; 0 where it cannot. `highest`: end of the search [m/s]."""
    needed = course.vehicle.mass * course.gravity * math.sin(grade)

    def drives(speed: float) -> bool:
        return full_throttle_pull(course, speed, grade) >= needed

    low, high = 1e-4, highest
    if not drives(low):
        return 0.0
    if drives(high):
        return high
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if drives(middle) else (low, middle)
    return low


def driving_range(course: Course, speed: float, grade: float = 0.0) -> float:
    """Distance [m] on the battery at a speed [m/s]; 0 where the vehicle cannot."""
    state = steady_state(course, speed, grade)
    if state is None or not state.feasible or state.bus_power <= 0.0:
        return 0.0
    return course.vehicle.battery_energy_wh * 3600.0 / state.energy_per_metre


def full_throttle_acceleration(course: Course, speed: float, grade: float = 0.0) -> float:
    """Acceleration [m/s^2] at full voltage: what every wheel gives at the limit of its motor or of its ground.

    Negative where the vehicle cannot hold the speed; at least -2 g, and 2 g at most.
    """
    vehicle = course.vehicle

    def spare(acceleration: float) -> float:
        try:
            pull = full_throttle_pull(course, speed, grade, acceleration)
        except InvalidValueError:  # it would tip over
            return -acceleration
        return pull - vehicle.mass * (course.gravity * math.sin(grade) + acceleration)

    bound = 2.0 * course.gravity
    return float(brentq(spare, -bound, bound, xtol=1e-9)) if spare(-bound) > 0.0 > spare(bound) else -bound


def time_and_distance_to(course: Course, speed: float, grade: float = 0.0, points: int = 24) -> tuple[float, float]:
    """Time [s] and distance [m] from rest to a speed [m/s] at full throttle: int dv/a and int v dv/a.

    Gauss-Legendre over the speed; infinite where the speed is not reached.
    """
    _check(speed, grade)
    nodes, weights = np.polynomial.legendre.leggauss(points)
    time = distance = 0.0
    for node, weight in zip(0.5 * speed * (nodes + 1.0), 0.5 * speed * weights, strict=True):
        acceleration = full_throttle_acceleration(course, float(node), grade)
        if acceleration <= 0.0:
            return math.inf, math.inf
        time += weight / acceleration
        distance += weight * node / acceleration
    return float(time), float(distance)


def _towed(wheel: WheelTraction, load: float, speed: float) -> WheelForces:
    """A wheel that turns without torque."""

    def torque(slip: float) -> float:
        return wheel.forces(load, slip, speed).torque

    slip = float(brentq(torque, -0.9, 0.9, xtol=1e-12)) if torque(-0.9) * torque(0.9) < 0.0 else 0.0
    return wheel.forces(load, slip, speed)._replace(torque=0.0)


def _check(speed: float, grade: float) -> None:
    if not (math.isfinite(speed) and speed > 0.0):
        raise InvalidValueError("speed", speed, "a finite number more than 0 m/s")
    if not -STEEPEST <= grade <= STEEPEST:
        raise InvalidValueError("grade", grade, f"-{STEEPEST:.3f} to {STEEPEST:.3f} rad")
