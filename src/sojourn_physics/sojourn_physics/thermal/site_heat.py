"""What is round the nodes of a machine at a site: the ground under it, the sky, the light of the moment, the air."""

import math
from collections.abc import Callable

import numpy as np

from sojourn_machine.sunlight import Sunlight
from sojourn_machine.thermal.network import ThermalSurroundings
from sojourn_machine.thermal.thermal_params import ThermalParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.thermal.site_ground import SiteGround


class SiteHeat:
    """Round a machine.

    Args:
        params: its nodes. body, site: where it is; the air is that of the height of the site.
        light: over the site, by the time after the start of the run [s]: what the ground lives by.

    Raises:
        InvalidValueError: as `SiteGround` does.
    """

    def __init__(
        self, params: ThermalParams, body: BodyParams, site: SiteParams | None, light: Callable[[float], Sunlight]
    ) -> None:
        self.params = params
        self._level = np.array([node.level for node in params.nodes.values()])
        self._ground = SiteGround(body, light)
        self._sky = body.sky_temperature
        airless = body.atmosphere is None
        self._air = 0.0 if airless else body.air_at(site).temperature
        self._convection = 0.0 if airless else params.convection

    def around(self, time: float, light: Sunlight) -> ThermalSurroundings:
        """At a time after the start of the run [s], in a light."""
        sunlight = light.direct * np.where(self._level, max(math.sin(light.elevation), 0.0), 1.0) + light.diffuse
        ground = self._ground.temperature(time)
        return ThermalSurroundings(ground, self._sky, sunlight, self._air, self._convection)
