"""The magnetic field that a body makes itself, as that of one dipole.

    B = (a / r)^3 (3 (m . n) n - m),      m = [g11, h11, g10],   n = r / |r|

with the Gauss coefficients of degree one m [T] at the reference radius a, in axes fixed to the body (z along its axis
of rotation, x through the meridian of longitude 0), and r from the dipole's place, which may be off the centre along
the axis. It is minus the gradient of a (a / r)^2 (m . n), the terms of degree one of the spherical harmonics (Chapman &
Bartels 1940, Geomagnetism, ch. 17; Langel 1987, in Jacobs, Geomagnetism 1:249).

Left out are all higher degrees (of the Earth up to a third of the field at some places), what the body's crust and what
currents above it add, and change with time.
"""

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.environment.site import SiteFrame


class MagneticDipoleParams(Params):
    """The dipole of a body."""

    gauss_coefficients: tuple[float, float, float] = Field(description="g10, g11, h11 at the reference radius [T]")
    reference_radius: float = Field(gt=0.0, le=1e9, description="at which they are told [m]")
    offset_north: float = Field(
        default=0.0, ge=-1e9, le=1e9, description="place of the dipole on the axis, from the centre [m]"
    )

    def field_at(self, place: FloatArray) -> FloatArray:
        """Flux density at a place, shape (3,) [m], in the axes of the body, (3,) [T].

        Raises:
            InvalidValueError: a place within a hundredth of the reference radius from the dipole.
        """
        axial, first, second = self.gauss_coefficients
        moment = np.array((first, second, axial))
        away = place - np.array((0.0, 0.0, self.offset_north))
        distance = float(np.linalg.norm(away))
        if not distance > 0.01 * self.reference_radius:
            allowed = f"more than {0.01 * self.reference_radius:.4g} m, as in its dipole a field has no end"
            raise InvalidValueError("distance from the dipole", distance, allowed)
        along = away / distance
        found: FloatArray = (self.reference_radius / distance) ** 3 * (3.0 * (moment @ along) * along - moment)
        return found

    def field_over(self, frame: SiteFrame) -> FloatArray:
        """Flux density at the origin of map, in its axes east, north, up, shape (3,) [T]. Raises as `field_at`."""
        return np.asarray(frame.rotation.T @ self.field_at(frame.origin))
