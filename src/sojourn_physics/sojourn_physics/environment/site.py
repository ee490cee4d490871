"""A place on a body, and the frame `map` that stands on it.

A body's surface is, for this purpose, its reference ellipsoid of semi-axes a >= b >= c along its own x, y, z; it turns
about z. Latitude f and longitude l (east) are those of the ellipsoid's outward normal, the vertical of the site
(planetographic, in the words of the International Astronomical Union):

    n = [cos f cos l, cos f sin l, sin f]
    r = [a2 n_x, b2 n_y, c2 n_z] / sqrt(a2 n_x2 + b2 n_y2 + c2 n_z2) + h n        (a2 = a^2 and so on)

(Heiskanen & Moritz 1967, Physical Geodesy, sec. 5-3, for two equal axes; the same argument holds for three.) map has
its origin there, z along n, x east along [-sin l, cos l, 0], y north. Where a = b, l is the longitude of the place too.

Range: altitudes from which the ellipsoid's normal does not meet another one, h > -c^2/a.
"""

import math
from typing import NamedTuple

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params


class SiteParams(Params):
    """Where on its body the origin of map is."""

    latitude_deg: float = Field(ge=-90.0, le=90.0, description="of the vertical, north positive [deg]")
    longitude_deg: float = Field(default=0.0, ge=-360.0, le=360.0, description="of the vertical, east positive [deg]")
    altitude_m: float = Field(default=0.0, ge=-1e6, le=1e9, description="over the body's reference ellipsoid [m]")


class SiteFrame(NamedTuple):
    """The frame map in the frame of the body."""

    origin: FloatArray
    """Of map, (3,) [m]."""
    rotation: FloatArray
    """From map to the body, (3, 3): its columns are east, north and up."""

    def in_body(self, place: FloatArray) -> FloatArray:
        """A point of map, (3,) [m], in the frame of the body."""
        found: FloatArray = self.origin + self.rotation @ place
        return found


def site_frame(site: SiteParams, semi_axes: tuple[float, float, float]) -> SiteFrame:
    """Where map is on an ellipsoid of these semi-axes along x, y, z, the longest first [m].

    Raises:
        InvalidValueError: so far down that the vertical of the site meets another.
    """
    lowest = -(semi_axes[2] ** 2) / semi_axes[0]
    if not site.altitude_m > lowest:
        raise InvalidValueError("altitude_m", site.altitude_m, f"more than {lowest:.4g} m, as the body is no thicker")
    latitude, longitude = math.radians(site.latitude_deg), math.radians(site.longitude_deg)
    level = math.cos(latitude)
    up = np.array((level * math.cos(longitude), level * math.sin(longitude), math.sin(latitude)))
    east = np.array((-math.sin(longitude), math.cos(longitude), 0.0))
    scaled = np.square(semi_axes) * up
    origin = scaled / math.sqrt(float(scaled @ up)) + site.altitude_m * up
    return SiteFrame(origin, np.column_stack((east, np.cross(up, east), up)))
