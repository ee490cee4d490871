"""Braking of a vehicle with two axles, and coasting down.

With deceleration d on level ground, h the height and a, b the distances of the front and rear axle from the centre of
mass, l = a + b (Genta and Morello 2009, vol. 2, sec. 23.10; Wong 2008, sec. 3.7):

    N_1 = m (g b + h d)/l,  N_2 = m (g a - h d)/l
    ideal:   F_i = (d/g) N_i: both axles use the same friction, d = mu g (a parabola in F_1, F_2 with d as parameter)
    given:   F_1 = k F, F_2 = (1 - k) F: the front locks first beyond  d_1 = mu g b/(k l - mu h),
             the rear beyond  d_2 = mu g a/((1 - k) l + mu h); efficiency min(d_1, d_2)/(mu g)
    a vehicle whose rear axle locks first is unstable
    coasting m_e v' = -m g (f_0 + K v^2):  v = sqrt(f_0/K) tan(atan(v_0 sqrt(K/f_0)) - g (m/m_e) sqrt(f_0 K) t)

Assumptions: Coulomb friction mu on both axles, quasi-static loads, no rise time. Range: level ground; d below the one
that lifts the rear axle, g a/h.
"""

import math
from typing import NamedTuple

from sojourn_machine.errors import InvalidValueError


class BrakeGeometry(NamedTuple):
    """Two axles: distances of front and rear from the centre of mass, its height [m]; mass [kg]; gravity [m/s^2]."""

    front: float
    rear: float
    height: float
    mass: float
    gravity: float

    @property
    def wheelbase(self) -> float:
        """[m]"""
        return self.front + self.rear


class BrakeLimit(NamedTuple):
    """Greatest deceleration without a locked axle [m/s^2], over mu g [-], and the axle that locks first beyond it."""

    deceleration: float
    efficiency: float
    first_to_lock: str


def dynamic_loads(geometry: BrakeGeometry, deceleration: float) -> tuple[float, float]:
    """Loads of the front and rear axle [N] at a deceleration [m/s^2].

    Raises:
        InvalidValueError: one that lifts an axle.
    """
    lifts = geometry.gravity * geometry.front / geometry.height
    rears = -geometry.gravity * geometry.rear / geometry.height
    if not rears <= deceleration <= lifts:
        raise InvalidValueError("deceleration", deceleration, f"{rears:.4g} to {lifts:.4g} m/s2: no axle lifts")
    scale = geometry.mass / geometry.wheelbase
    return (
        scale * (geometry.gravity * geometry.rear + geometry.height * deceleration),
        scale * (geometry.gravity * geometry.front - geometry.height * deceleration),
    )


def ideal_forces(geometry: BrakeGeometry, deceleration: float) -> tuple[float, float]:
    """Braking forces of front and rear axle [N] that use the same friction on both."""
    friction = deceleration / geometry.gravity
    front, rear = dynamic_loads(geometry, deceleration)
    return friction * front, friction * rear


def ideal_front_fraction(geometry: BrakeGeometry, deceleration: float) -> float:
    """Share of the front axle in the ideal distribution at a deceleration [m/s^2]."""
    return (geometry.rear + geometry.height * deceleration / geometry.gravity) / geometry.wheelbase


def braking_limit(geometry: BrakeGeometry, friction: float, front_fraction: float) -> BrakeLimit:
    """What a given distribution reaches on ground with a friction coefficient.

    Raises:
        InvalidValueError: a friction that is not positive, or a fraction outside 0 to 1.
    """
    if not (math.isfinite(friction) and friction > 0.0):
        raise InvalidValueError("friction", friction, "a finite number more than 0")
    if not 0.0 <= front_fraction <= 1.0:
        raise InvalidValueError("front_fraction", front_fraction, "0 to 1")
    limit = friction * geometry.gravity
    over = front_fraction * geometry.wheelbase - friction * geometry.height
    front = limit * geometry.rear / over if over > 0.0 else math.inf
    rear = limit * geometry.front / ((1.0 - front_fraction) * geometry.wheelbase + friction * geometry.height)
    lifted = geometry.gravity * geometry.front / geometry.height
    reached = min(front, rear, lifted)
    first = "front" if front < rear else "rear"
    if math.isclose(front, rear, rel_tol=1e-9):
        first = "both"
    return BrakeLimit(reached, reached / limit, first)


def stopping_distance(speed: float, deceleration: float, reaction_time: float = 0.0) -> float:
    """v t_r + v^2/(2 d) [m] from a speed [m/s] with a deceleration of more than 0 [m/s^2]."""
    if not (math.isfinite(deceleration) and deceleration > 0.0):
        raise InvalidValueError("deceleration", deceleration, "a finite number more than 0 m/s2")
    return speed * reaction_time + speed * speed / (2.0 * deceleration)


def coasting_speed(
    speed: float, time: float, gravity: float, constant: float, quadratic: float, mass_ratio: float = 1.0
) -> float:
    """Speed [m/s] after coasting for a time [s] from a speed [m/s] on level ground; 0 after the stop.

    Args:
        constant, quadratic: f_0 [-] and K [s^2/m^2] of the resistance. mass_ratio: m_e/m, at least 1.
    """
    if constant < 0.0 or quadratic < 0.0 or mass_ratio < 1.0:
        raise InvalidValueError("constant, quadratic, mass_ratio", (constant, quadratic, mass_ratio), "0, 0, 1 or more")
    rate = gravity / mass_ratio
    if quadratic == 0.0:
        return max(speed - rate * constant * time, 0.0)
    if constant == 0.0:
        return speed / (1.0 + rate * quadratic * speed * time)
    scale = math.sqrt(constant / quadratic)
    angle = math.atan(speed / scale) - rate * math.sqrt(constant * quadratic) * time
    return scale * math.tan(angle) if angle > 0.0 else 0.0
