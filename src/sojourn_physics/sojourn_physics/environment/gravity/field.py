"""Gravity over a site: what a machine at a place of map weighs, and what it costs to lift it.

    g = R^T [a(r) + w^2 (x, y, 0) + t (2x, -y, -z)] - 2 W x v,    r = r_0 + R p
    E = U(r) - w^2 (x^2 + y^2) / 2 - t (2 x^2 - y^2 - z^2) / 2

for a body that turns at w about its z axis, W that turning in map, p and v a machine's place and velocity in map, R and
r_0 of `site`. The last term of g, Coriolis's, turns what flies and does no work. t = GM/a^3 is the tide of the planet
that a locked moon has over its x axis, at a distance a: nothing where none is known (Murray & Dermott 1999, "Solar
System Dynamics", sec. 4.2). Left out are the eccentricity of the moon's orbit, other bodies, and what the Earth does
to its Moon, 2e-5 of its gravity.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.gravity.attraction import Attraction
from sojourn_physics.environment.site import SiteFrame

MAP_ORIGIN = np.zeros(3)
AT_REST = np.zeros(3)


class GravityField(Protocol):
    """Gravity in map."""

    uniform: bool
    """The same everywhere, straight down."""

    @property
    def gravity(self) -> float:
        """Its strength at the origin of map, however it points [m/s^2]."""

    def acceleration(self, place: FloatArray, velocity: FloatArray = AT_REST) -> FloatArray:
        """Shape (3,) [m/s^2] at a place in map, (3,) [m], of what moves there at a velocity in map, (3,) [m/s]."""

    def potential(self, place: FloatArray) -> float:
        """Energy of a kilogram at rest there over one at the origin of map [J/kg]."""

    def escapes(self, place: FloatArray, velocity: FloatArray) -> bool:
        """Whether a thing that flies there with a velocity in map, (3,) [m/s], leaves the body for good."""


@dataclass(frozen=True, slots=True)
class UniformField:
    """The same gravity everywhere, straight down."""

    gravity: float
    """[m/s^2]"""
    uniform = True

    def acceleration(self, place: FloatArray, velocity: FloatArray = AT_REST) -> FloatArray:
        """Shape (3,) [m/s^2], wherever the place is."""
        return np.array([0.0, 0.0, -self.gravity])

    def potential(self, place: FloatArray) -> float:
        """Over z = 0 [J/kg]."""
        return float(self.gravity * place[2])

    def escapes(self, place: FloatArray, velocity: FloatArray) -> bool:
        """Never: what goes up comes down."""
        return False


@dataclass(frozen=True, slots=True)
class BodyField:
    """Gravity of a body that turns, over one of its sites."""

    attraction: Attraction
    spin: float
    """[rad/s]"""
    frame: SiteFrame
    tide: float = 0.0
    """[1/s^2]"""
    uniform = False

    @property
    def gravity(self) -> float:
        """At the site, however it points [m/s^2]."""
        return float(np.linalg.norm(self.acceleration(MAP_ORIGIN)))

    def acceleration(self, place: FloatArray, velocity: FloatArray = AT_REST) -> FloatArray:
        """Shape (3,) [m/s^2] at a place in map, of what moves there."""
        position = self.frame.in_body(place)
        total = self.attraction.acceleration(position)
        (x, y, z), (vx, vy, _) = position, self.frame.rotation @ velocity
        total[0] += self.spin * (self.spin * x + 2.0 * vy)
        total[1] += self.spin * (self.spin * y - 2.0 * vx)
        if self.tide:
            total += self.tide * np.array((2.0 * x, -y, -z))
        found: FloatArray = self.frame.rotation.T @ total
        return found

    def potential(self, place: FloatArray) -> float:
        """Of attraction, rotation and tide together, over the origin of map [J/kg]."""
        return self._energy(self.frame.in_body(place)) - self._energy(self.frame.origin)

    def escapes(self, place: FloatArray, velocity: FloatArray) -> bool:
        """Whether its speed against the stars is above that of escape."""
        x, y, _ = position = self.frame.in_body(place)
        against_stars = self.frame.rotation @ velocity + self.spin * np.array((-y, x, 0.0))
        return float(against_stars @ against_stars) > -2.0 * self.attraction.potential(position)

    def escape_speed(self, place: FloatArray) -> float:
        """Speed against the stars with which a thing there leaves the body for good [m/s]."""
        return float((-2.0 * self.attraction.potential(self.frame.in_body(place))) ** 0.5)

    def _energy(self, position: FloatArray) -> float:
        x, y, z = position
        of_the_turn = 0.5 * self.spin**2 * (x * x + y * y)
        of_the_tide = 0.5 * self.tide * (2.0 * x * x - y * y - z * z)
        return float(self.attraction.potential(position) - of_the_turn - of_the_tide)
