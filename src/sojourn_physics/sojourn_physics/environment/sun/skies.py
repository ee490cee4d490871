"""What the air of a body lets through of the Sun: the beam, normal to itself, and diffuse light on level ground.

- no air: all of the beam, and nothing else;
- Mars: dust, see `dusty_sky`;
- Earth, clear: beam S 0.7^(m^0.678), m the air mass of Kasten and Young (1989, Applied Optics 28:4735); as much as a
  tenth of it again comes from the sky (Meinel and Meinel 1976, Applied Solar Energy, sec. 2.8);
- Venus and Titan: no beam; the ground has a share of what falls on the clouds, 0.026 (17 of 650 W/m2, the mean over
  Venus: Tomasko et al. 1980, J. Geophys. Res. 85:8167) and 0.10 (McKay, Pollack and Courtin 1991, Science 253:1118),
  whatever the height of the Sun.

Left out: clouds, haze over Mars, the air inside giant planets, light from the sky when the Sun is below the horizon.
"""

import math
from collections.abc import Callable, Mapping

from sojourn_physics.environment.sun.dusty_sky import light_under_dust

Sky = Callable[[float, float], tuple[float, float]]
"""Flux over the air [W/m2] and cosine of the Sun's zenith angle in; beam and diffuse light [W/m2] out."""
SHARES_UNDER_CLOUDS: Mapping[str, float] = {"venus": 0.026, "titan": 0.10}


def sky_over(body: str, dust: float, albedo: float) -> Sky:
    """The sky of a body by its name; none of a body that is not known here.

    Args:
        dust: optical depth over Mars. albedo: of its ground.
    """
    if body == "mars":
        return lambda flux, cos_zenith: light_under_dust(flux, cos_zenith, dust, albedo)
    if body == "earth":
        return _clear_air
    if body in SHARES_UNDER_CLOUDS:
        share = SHARES_UNDER_CLOUDS[body]
        return lambda flux, cos_zenith: (0.0, share * flux * max(cos_zenith, 0.0))
    return lambda flux, cos_zenith: (flux, 0.0)


def _clear_air(flux: float, cos_zenith: float) -> tuple[float, float]:
    if cos_zenith <= 0.0:
        return 0.0, 0.0
    elevation = math.degrees(math.asin(min(cos_zenith, 1.0)))
    air_mass = 1.0 / (cos_zenith + 0.50572 * (6.07995 + elevation) ** -1.6364)
    beam = flux * 0.7 ** (air_mass**0.678)
    return beam, 0.1 * beam * cos_zenith
