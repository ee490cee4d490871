"""Tracks driving straight: pressure under them, sinkage, thrust over slip, resistances, and the grade that they climb.

The flat runs lie at a depth that is greatest, Z, at the end to which the load leans: z = Z g,
g = max(1 - β ξ, 0) with ξ l from that end. With k from `pressure_modulus` and w the share under road wheels (`track`):

    p = k z^n w/(1 + a),    β such that the middle of pressure lies e = x_c - h tan α before the middle of the runs
    2 b l (mean of p) = W cos α                                             (Bekker 1969; level and e = 0: β = 0)
    T = 2 b ∫ (c + p tan φ)(1 - e^(-s x'/K)) dx,  x' from the front         (Janosi & Hanamoto 1961)
    R_c = 2 b k Z^(n + 1)/(n + 1),   R_b = 2 b (c Z K_c + γ Z² K_γ/2)
    drawbar pull P = T - R_c - R_b,  greatest grade: P = W sin α

(Wong 2008, Theory of Ground Vehicles, secs. 2.4, 6.3, 6.4.) x_c: of the centre of mass before the middle of the runs, h
its height over them.

Assumptions: rigid, level belts; both tracks alike; the inclined ends carry nothing. Range: sinkage to a quarter of the
width, e to 0.45 l.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from sojourn_analysis.vehicle.driveline import largest_wheel_torque, motor_point
from sojourn_analysis.vehicle.longitudinal import GREATEST_SLIP, STEEPEST
from sojourn_analysis.vehicle.tracked_vehicle import TrackedVehicle
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.passive_pressure import wall_resistance
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn

POINTS = 384
"""Parts of the runs, of like length."""
SLIGHT = 1e-3
"""Slope below which the mean over a part is its middle's to 1e-12, and a difference of powers has lost as much [-]."""
LARGEST_LEAN = 0.45
"""Of the middle of pressure, over the length of the runs."""


class TrackGround(NamedTuple):
    """A tracked vehicle on a soil."""

    vehicle: TrackedVehicle
    soil: FloatArray
    """Row of `SoilColumn`."""
    gravity: float
    """[m/s^2]"""

    @property
    def weight(self) -> float:
        """[N]"""
        return self.vehicle.mass * self.gravity


class TrackFooting(NamedTuple):
    """The runs on the soil."""

    pressure: FloatArray
    """From front to rear, shape (POINTS,) [Pa]."""
    depth: float
    """Z [m]."""
    compaction: float
    """Resistances of both tracks [N]."""
    bulldozing: float


def footing(ground: TrackGround, grade: float = 0.0) -> TrackFooting:
    """How the machine stands on a grade [rad], uphill positive.

    Raises:
        InvalidValueError: a grade at which the middle of pressure is beyond the range.
    """
    vehicle, soil = ground.vehicle, ground.soil
    track, n = vehicle.track, float(soil[SoilColumn.N])
    lean = (vehicle.ahead - vehicle.height * math.tan(grade)) / track.length
    if abs(lean) > LARGEST_LEAN:
        raise InvalidValueError("grade", grade, "one on which the machine does not tip over")
    part = (np.arange(POINTS) + 0.5) / POINTS
    share = 1.0 - track.peakedness * np.cos(2.0 * np.pi * track.road_wheels * part)

    def pressed(slope: float) -> FloatArray:
        return np.asarray(share * mean_powers(slope, n))

    def excess(slope: float) -> float:
        shape = pressed(slope)
        return float(shape @ (0.5 - part) / shape.sum()) - abs(lean)

    slope = brentq(excess, 0.0, 20.0, xtol=1e-12) if abs(lean) > 1e-9 else 0.0
    shape = pressed(slope)
    modulus = pressure_modulus(soil, min(track.width, track.length))
    mean = ground.weight * math.cos(grade) / vehicle.area
    greatest = mean / float(shape.mean())
    depth = (greatest * (1.0 + track.peakedness) / modulus) ** (1.0 / n)
    compaction = 2.0 * track.width * modulus * depth ** (n + 1.0) / (n + 1.0)
    wall = wall_resistance(
        depth, soil[SoilColumn.COHESION], soil[SoilColumn.TAN_PHI], soil[SoilColumn.DENSITY] * ground.gravity
    )
    pressure = greatest * (shape if lean >= 0.0 else shape[::-1])
    return TrackFooting(pressure, depth, compaction, 2.0 * track.width * wall)


def mean_powers(slope: float, n: float) -> FloatArray:
    """Means of max(1 - slope ξ, 0)^n over each part of the runs, (POINTS,), in closed form: with n well below one the
    part that just leaves the ground would jump by what its middle bears, and no slope had the middle of pressure asked.
    """
    ends = np.maximum(1.0 - slope * np.arange(POINTS + 1) / POINTS, 0.0)
    if slope < SLIGHT:
        return np.asarray((0.5 * (ends[:-1] + ends[1:])) ** n)
    return np.asarray(-np.diff(ends ** (n + 1.0)) * (POINTS / ((n + 1.0) * slope)))


def thrust(ground: TrackGround, found: TrackFooting, slip: float) -> float:
    """Of both tracks [N]; negative for a slip below 0, where they brake."""
    track, soil = ground.vehicle.track, ground.soil
    passed = track.length * (np.arange(POINTS) + 0.5) / POINTS
    built_up = -np.expm1(-abs(slip) * passed / soil[SoilColumn.SHEAR_MODULUS])
    strength = soil[SoilColumn.COHESION] + found.pressure * soil[SoilColumn.TAN_PHI]
    return math.copysign(ground.vehicle.area * float(np.mean(strength * built_up)), slip)


def pull(ground: TrackGround, slip: float, grade: float = 0.0) -> float:
    """Drawbar pull of both tracks [N]. Raises as `footing`."""
    found = footing(ground, grade)
    return thrust(ground, found, slip) - found.compaction - found.bulldozing


def slip_on(ground: TrackGround, grade: float) -> float | None:
    """Slip at which the machine climbs a grade [rad] steadily; None beyond GREATEST_SLIP. Raises as `footing`."""
    found = footing(ground, grade)
    needed = ground.weight * math.sin(grade) + found.compaction + found.bulldozing

    def missing(slip: float) -> float:
        return thrust(ground, found, slip) - needed

    if missing(GREATEST_SLIP) < 0.0:
        return None
    return float(brentq(missing, -GREATEST_SLIP, GREATEST_SLIP, xtol=1e-12))


class SteadyTrack(NamedTuple):
    """Steady motion straight up a grade."""

    slip: float
    torque: float
    """Of each sprocket [N m]."""
    power: float
    """Of both motors, from the bus [W]."""
    feasible: bool
    """Whether voltage and current of the motors suffice."""


def steady_climb(ground: TrackGround, speed: float, grade: float = 0.0) -> SteadyTrack | None:
    """At a speed of more than 0 [m/s]; None where the ground does not bear it. Raises as `footing`."""
    slip = slip_on(ground, grade)
    if slip is None:
        return None
    vehicle = ground.vehicle
    torque = 0.5 * vehicle.track.radius * thrust(ground, footing(ground, grade), slip)
    rate = speed / (1.0 - slip) / vehicle.track.radius
    feasible = torque <= largest_wheel_torque(vehicle, rate)
    return SteadyTrack(slip, torque, 2.0 * motor_point(vehicle, torque, rate).power, feasible)


def greatest_grade(ground: TrackGround, speed: float) -> tuple[float, str]:
    """Steepest grade [rad] that is climbed at a speed [m/s], and what limits it: traction, motor or tipping.

    Raises:
        InvalidValueError: level ground is too much for it.
    """

    def limit(grade: float) -> str:
        try:
            steady = steady_climb(ground, speed, grade)
        except InvalidValueError:
            return "tipping"
        if steady is None:
            return "traction"
        return "" if steady.feasible else "motor"

    if limit(0.0):
        raise InvalidValueError("speed", speed, "one that the machine reaches on level ground")
    low, high = 0.0, STEEPEST
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if limit(middle) else (middle, high)
    return low, limit(high)
