"""Attraction of a body that is nearly a sphere: its mass and its flattening.

    U = -GM/r [1 - J2 (R/r)^2 P2(s) - J4 (R/r)^4 P4(s)],    s = z/r,
    P2 = (3 s^2 - 1)/2,    P4 = (35 s^4 - 30 s^2 + 3)/8,

and its fall, a zonal harmonic of degree n giving, with r^ and z^ for the unit vectors,

    a_n = GM J_n R^n / r^(n+2) [((n + 1) P_n + s P_n') r^ - P_n' z^]

(Vallado 2013, Fundamentals of Astrodynamics, 4th ed., sec. 8.6; Montenbruck & Gill 2000, Satellite Orbits,
sec. 3.2). Without harmonics it is the sphere. Range: outside the body; left out are all other harmonics, on Earth, Mars
and Moon a few 1e-4 of g at most, most of it from mass concentrations.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.gravity.attraction import AttractionParams

if TYPE_CHECKING:
    from sojourn_physics.environment.body import BodyParams


@dataclass(frozen=True, slots=True)
class OblateAttraction:
    """See the head of this module. Built by `OblateParams`."""

    gravitational_parameter: float
    """GM [m^3/s^2]."""
    reference_radius: float
    """R [m]."""
    j2: float = 0.0
    j4: float = 0.0

    def acceleration(self, position: FloatArray) -> FloatArray:
        """Shape (3,) [m/s^2]."""
        x, y, z = position.tolist()
        square = x * x + y * y + z * z
        radius = square**0.5
        s = z / radius
        second, fourth = self._harmonics(square)
        along = 3.0 * _p2(s) * second + 5.0 * _p4(s) * fourth - 1.0
        polar = 3.0 * s * second + 0.5 * (35.0 * s**3 - 15.0 * s) * fourth
        pull = self.gravitational_parameter / square
        outward = pull * (along + s * polar) / radius
        return np.array((outward * x, outward * y, outward * z - pull * polar))

    def potential(self, position: FloatArray) -> float:
        """[J/kg]."""
        x, y, z = position.tolist()
        square = x * x + y * y + z * z
        radius = square**0.5
        s = z / radius
        second, fourth = self._harmonics(square)
        return float(-self.gravitational_parameter / radius * (1.0 - _p2(s) * second - _p4(s) * fourth))

    def _harmonics(self, square: float) -> tuple[float, float]:
        """J2 (R/r)^2 and J4 (R/r)^4 at a distance, squared [m^2]."""
        ratio = self.reference_radius**2 / square
        return self.j2 * ratio, self.j4 * ratio**2


def _p2(s: float) -> float:
    return 1.5 * s * s - 0.5


def _p4(s: float) -> float:
    return (35.0 * s**4 - 30.0 * s * s + 3.0) / 8.0


class OblateParams(AttractionParams):
    """A sphere, or one that is flattened a little."""

    kind: Literal["oblate"] = Field(default="oblate", description="this kind")
    j2: float = Field(default=0.0, ge=0.0, le=0.2, description="second zonal harmonic, not normalised [1]")
    j4: float = Field(default=0.0, ge=-0.1, le=0.1, description="fourth zonal harmonic, not normalised [1]")
    reference_radius: float | None = Field(
        default=None, gt=0.0, le=1e9, description="radius that they are given for; by default the longest semi-axis [m]"
    )

    def build(self, body: "BodyParams") -> OblateAttraction:
        """Of a body with this flattening."""
        radius = body.semi_axes[0] if self.reference_radius is None else self.reference_radius
        return OblateAttraction(body.gravitational_parameter, radius, self.j2, self.j4)
