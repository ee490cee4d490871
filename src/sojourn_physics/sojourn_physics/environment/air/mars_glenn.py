"""Air of Mars, a fit to the descent of Viking and to Mars Global Surveyor.

    T = -31 - 0.000998 h   (h < 7000 m),    T = -23.4 - 0.00222 h   above     [degrees Celsius, h in m]
    p = 0.699 exp(-0.00009 h) kPa,    rho = p / (0.1921 (T + 273.1))

Source: NASA Glenn Research Center, Mars Atmosphere Model, metric units. It is a mean: pressure goes from 400 to 870 Pa
over the year, temperature by 100 K over a day near the ground. Range: from the lowest ground of Hellas to 45 km.
"""

import math
from typing import Literal

from pydantic import Field

from sojourn_physics.environment.air.atmosphere import Air, AtmosphereParams


class MarsGlennParams(AtmosphereParams):
    """The fit has no parameters of its own."""

    kind: Literal["mars_glenn"] = Field(default="mars_glenn", description="this kind")

    @property
    def altitudes(self) -> tuple[float, float]:
        """From Hellas to 45 km [m]."""
        return -8200.0, 45000.0

    def at(self, altitude: float) -> Air:
        """The air at an altitude [m]."""
        height = self._checked(altitude)
        celsius = -31.0 - 0.000998 * height if height < 7000.0 else -23.4 - 0.00222 * height
        return self._of(celsius + 273.1, 699.0 * math.exp(-0.00009 * height))
