"""Attraction of an ellipsoid of constant density with three axes, a >= b >= c.

    U = -GM [3/2 R_F(A, B, C) - 1/2 (x^2 R_D(B, C, A) + y^2 R_D(C, A, B) + z^2 R_D(A, B, C))]
    g = -GM [x R_D(B, C, A), y R_D(C, A, B), z R_D(A, B, C)]

with A = a^2 + k, B = b^2 + k, C = c^2 + k. Outside, k is the greatest root of x^2/A + y^2/B + z^2/C = 1,
inside it is 0. These are the integrals of Chandrasekhar (1969), Ellipsoidal Figures of Equilibrium, sec. 17 and 20,
in the symmetric forms R_F and R_D of Carlson (1995), Numerical Algorithms 10:13. k is found by Newton from below,
where the left side is convex and falls, so that no step goes past it.

Range: everywhere, inside too. What a body's true shape and density add is left out: of Eros and
Itokawa up to half of g.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field
from scipy.special import elliprd, elliprf

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.gravity.attraction import AttractionParams

if TYPE_CHECKING:
    from sojourn_physics.environment.body import BodyParams

STEPS = 60
"""Of Newton's method; some 8 are enough anywhere near a body."""
NEAR = 1e-15
"""Where the next step would change nothing, of the square of the distance [1]."""


@dataclass(frozen=True, slots=True)
class EllipsoidAttraction:
    """See the head of this module. Built by `EllipsoidParams`."""

    gravitational_parameter: float
    """GM [m^3/s^2]."""
    semi_axes: tuple[float, float, float]
    """[m]"""

    def acceleration(self, position: FloatArray) -> FloatArray:
        """Shape (3,) [m/s^2]."""
        found: FloatArray = -self.gravitational_parameter * position * _integrals(self._confocal(position))
        return found

    def potential(self, position: FloatArray) -> float:
        """[J/kg]."""
        squares = self._confocal(position)
        depth = 1.5 * elliprf(*squares) - 0.5 * np.square(position) @ _integrals(squares)
        return float(-self.gravitational_parameter * depth)

    def _confocal(self, position: FloatArray) -> FloatArray:
        """A, B, C: squares of the semi-axes of the confocal ellipsoid through a place outside, else the body's own."""
        own, place = np.square(self.semi_axes), np.square(position)
        if float((place / own).sum()) <= 1.0:
            return own
        total = float(place.sum())
        root = max(0.0, total - float(own[0]))
        for _ in range(STEPS):
            shares = place / (own + root)
            step = (float(shares.sum()) - 1.0) / float((shares / (own + root)).sum())
            root += step
            if not step > NEAR * total:
                break
        found: FloatArray = own + root
        return found


def _integrals(squares: FloatArray) -> FloatArray:
    """R_D with each of A, B, C in turn at its last place, (3,) [1/m^3]."""
    a, b, c = squares.tolist()
    return np.array((elliprd(b, c, a), elliprd(c, a, b), elliprd(a, b, c)))


class EllipsoidParams(AttractionParams):
    """A body as its reference ellipsoid, filled evenly."""

    kind: Literal["ellipsoid"] = Field(default="ellipsoid", description="this kind")

    def build(self, body: "BodyParams") -> EllipsoidAttraction:
        """Of a body of the shape in its file."""
        return EllipsoidAttraction(body.gravitational_parameter, body.semi_axes)
