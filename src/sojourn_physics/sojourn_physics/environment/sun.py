"""Where the Sun stands over a site, and how it moves there while the body turns.

In map (x east, y north, z up) a Sun of azimuth A, from north towards east, and elevation e is in the direction

    u_0 = [sin A cos e, cos A cos e, sin e].

The body turns eastward about its positive pole, which a site of latitude f sees at p = [0, cos f, sin f]. So the
Sun turns westward about p, once in a solar day T (Rodrigues' formula, a = -2 pi t / T):

    u(t) = u_0 cos a + (p x u_0) sin a + p (p . u_0) (1 - cos a).

Source: Meeus (1998), Astronomical Algorithms, ch. 13 (hour angle and horizontal coordinates), with the declination
held, which is asin(u . p) and changes by less than 0.4 deg in a solar day of the Earth or of Mars. Assumptions: no
refraction; a flat horizon: no ground hides the Sun.
"""

import math

import numpy as np
from pydantic import Field

from sojourn_machine.params import FloatArray, Params


class SunParams(Params):
    """The Sun over the site at the start of a run. Angles in degrees."""

    azimuth_deg: float = Field(default=90.0, ge=-360.0, le=360.0, description="from north, east is 90 [deg]")
    elevation_deg: float = Field(default=30.0, ge=-90.0, le=90.0, description="over the horizon [deg]")
    latitude_deg: float = Field(default=0.0, ge=-90.0, le=90.0, description="of the site, north positive [deg]")


def sun_direction(sun: SunParams, solar_day: float, time: float) -> FloatArray:
    """Unit vector to the Sun in map, shape (3,).

    Args:
        solar_day: noon to noon [s]. time: since the start of the run [s].
    """
    azimuth, elevation = math.radians(sun.azimuth_deg), math.radians(sun.elevation_deg)
    level = math.cos(elevation)
    x, y, z = math.sin(azimuth) * level, math.cos(azimuth) * level, math.sin(elevation)
    north, up = math.cos(math.radians(sun.latitude_deg)), math.sin(math.radians(sun.latitude_deg))
    angle = -2.0 * math.pi * time / solar_day
    cosine, sine = math.cos(angle), math.sin(angle)
    along = (north * y + up * z) * (1.0 - cosine)
    return np.array(
        (
            x * cosine + (north * z - up * y) * sine,
            y * cosine + up * x * sine + north * along,
            z * cosine - north * x * sine + up * along,
        )
    )
