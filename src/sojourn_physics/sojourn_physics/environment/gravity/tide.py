"""What draws on things beside a spacecraft in a circular orbit, in a map that turns with it.

    x along the flight, y along the orbit's pole, z outward; map turns at n about y, its origin falls freely

    tide        n^2 [-x, -y, 2 z]                                          against the stars
    in map      x'' = -2 n z',   y'' = -n^2 y,   z'' = 2 n x' + 3 n^2 z    (Clohessy & Wiltshire 1960)

(`orbit/relative_motion` has the closed form, in another order of axes.) E = n^2 (y^2 - 3 z^2) / 2 is the energy that
goes with it in map. Range: distances small against the orbit's radius.
"""

from dataclasses import dataclass

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.gravity.field import AT_REST


@dataclass(frozen=True, slots=True)
class TidalField:
    """Gravity in the map of a circular orbit."""

    rate: float
    """Mean motion n [rad/s]."""
    uniform = False

    @property
    def gravity(self) -> float:
        """At the origin of map, which falls freely: none [m/s^2]."""
        return 0.0

    @property
    def turning(self) -> FloatArray:
        """Of map against the stars, in map, (3,) [rad/s]."""
        return np.array((0.0, self.rate, 0.0))

    def tide(self, place: FloatArray) -> FloatArray:
        """Shape (3,) [m/s^2] against the stars, at a place in map, (3,) [m]."""
        return self.rate**2 * np.array((-1.0, -1.0, 2.0)) * place

    def acceleration(self, place: FloatArray, velocity: FloatArray = AT_REST) -> FloatArray:
        """Shape (3,) [m/s^2] in map, of what moves there at a velocity in map, (3,) [m/s]."""
        (_, y, z), (vx, _, vz), n = place, velocity, self.rate
        return np.array((-2.0 * n * vz, -n * n * y, 2.0 * n * vx + 3.0 * n * n * z))

    def potential(self, place: FloatArray) -> float:
        """Energy of a kilogram at rest there over one at the origin of map [J/kg]."""
        _, y, z = place
        return float(0.5 * self.rate**2 * (y * y - 3.0 * z * z))

    def escapes(self, place: FloatArray, velocity: FloatArray) -> bool:
        """Never: it is in orbit."""
        return False
