"""A circular orbit about a body: period, shadow, drift by its flattening, the tide over a spacecraft.

    n = sqrt(GM/r^3)
    shadow    share acos(sqrt(r^2 - R^2) / (r cos beta)) / pi of the orbit while |beta| < asin(R/r)
    node      -3/2 n J2 (R_e/p)^2 cos i
    perigee    3/4 n J2 (R_e/p)^2 (5 cos^2 i - 1),     p the semi-latus rectum, of a circle its radius
    torque    3 n^2 u x I u, u the unit vector to the body's centre

(Vallado 2013, Fundamentals of Astrodynamics and Applications, sections 5.3 and 9.6; Wertz 1978, Spacecraft Attitude
Determination and Control, section 17.2.) beta is the angle of the Sun over the plane of the orbit. The shadow is a
cylinder: penumbra and refraction, some seconds at each end in a low orbit, are left out. The drifts are
those of the first order in J2, mean over the orbit. Range of the torque: a spacecraft small against r.
"""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class CircularOrbit:
    """Round a body of a gravitational parameter [m^3/s^2] and a radius [m], at a radius [m] from its centre.

    Raises:
        InvalidValueError: an orbit that does not clear the body.
    """

    gravitational_parameter: float
    body_radius: float
    radius: float

    def __post_init__(self) -> None:
        if not self.gravitational_parameter > 0.0 or not math.isfinite(self.gravitational_parameter):
            raise InvalidValueError("gravitational parameter", self.gravitational_parameter, "more than 0")
        if not 0.0 < self.body_radius < self.radius or not math.isfinite(self.radius):
            raise InvalidValueError("radius of the orbit", self.radius, f"more than {self.body_radius:g} m, the body's")

    @property
    def semi_latus_rectum(self) -> float:
        """[m]"""
        return self.radius

    @property
    def rate(self) -> float:
        """Mean motion [rad/s]."""
        return math.sqrt(self.gravitational_parameter / self.radius**3)

    @property
    def period(self) -> float:
        """[s]"""
        return 2.0 * math.pi / self.rate

    @property
    def speed(self) -> float:
        """[m/s]"""
        return self.rate * self.radius

    @property
    def always_sunlit_above(self) -> float:
        """Angle of the Sun over the plane from which on there is no shadow [rad]."""
        return math.asin(self.body_radius / self.radius)

    def shadow_share(self, beta: float) -> float:
        """Share of the orbit in the body's shadow [-], the Sun at an angle over its plane [rad]."""
        if abs(beta) >= self.always_sunlit_above:
            return 0.0
        clear = math.sqrt(self.radius**2 - self.body_radius**2) / (self.radius * math.cos(beta))
        return math.acos(min(clear, 1.0)) / math.pi

    def gravity_gradient_torque(self, inertia: FloatArray, towards_body: FloatArray) -> FloatArray:
        """Shape (3,) [N m], about the centre of mass.

        Args:
            inertia: about the centre of mass, (3, 3) [kg m^2]. towards_body: to the body's centre, (3,), of any length;
                both in the same axes, which are the torque's too.
        """
        down = towards_body / np.linalg.norm(towards_body)
        torque: FloatArray = 3.0 * self.rate**2 * np.cross(down, inertia @ down)
        return torque


class TurnedOrbit(Protocol):
    """What a flattened body turns."""

    @property
    def rate(self) -> float:
        """Mean motion [rad/s]."""

    @property
    def semi_latus_rectum(self) -> float:
        """[m]"""


@dataclass(frozen=True, slots=True)
class Flattening:
    """What turns an orbit, circular or not: J2 [-] with the radius it goes by [m]."""

    j2: float
    reference_radius: float

    def node_rate(self, orbit: TurnedOrbit, inclination: float) -> float:
        """Of the ascending node, eastward [rad/s]; inclination in radians."""
        return -1.5 * self._strength(orbit) * math.cos(inclination)

    def perigee_rate(self, orbit: TurnedOrbit, inclination: float) -> float:
        """Of the argument of perigee [rad/s]; inclination in radians."""
        return 0.75 * self._strength(orbit) * (5.0 * math.cos(inclination) ** 2 - 1.0)

    def _strength(self, orbit: TurnedOrbit) -> float:
        return orbit.rate * self.j2 * (self.reference_radius / orbit.semi_latus_rectum) ** 2
