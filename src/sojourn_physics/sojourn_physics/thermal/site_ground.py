"""Ground of a site as a machine on it feels it: warm by day, cold by night, as its own Sun makes it.

The light over the site is looked at over one solar day from the start of the run on, in a thousand steps, and the
ground is taken to have lived through many such days (`regolith_day`): seasons, eclipses and weather other than those
of this day are left out. Of air the ground is given what a sky of one temperature radiates, and no convection.
"""

import math
from collections.abc import Callable

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.sunlight import Sunlight
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.thermal.regolith import cut_ground
from sojourn_physics.thermal.regolith_day import settled_day

STEPS = 1000
"""Of a day."""


class SiteGround:
    """The surface of the ground over the days.

    Args:
        body: with the table `regolith`.
        light: over the site, by the time after the start of the run [s].

    Raises:
        InvalidValueError: a body without the table, or days that do not come to repeat.
    """

    def __init__(self, body: BodyParams, light: Callable[[float], Sunlight]) -> None:
        if body.regolith is None:
            raise InvalidValueError("body", body.name, "one whose file has the table regolith, for a machine with heat")
        self._day = body.solar_day
        rows = np.zeros((STEPS, 4))
        rows[:, 1] = STEFAN_BOLTZMANN * body.sky_temperature**4
        for place in range(STEPS):
            now = light((place + 0.5) / STEPS * self._day)
            sine = max(math.sin(now.elevation), 0.0)
            albedo = body.regolith.albedo(math.acos(sine))
            rows[place, 0] = now.direct * sine * (1.0 - albedo) + now.diffuse * (1.0 - body.regolith.albedo_normal)
        surface = settled_day(cut_ground(body.regolith, self._day), rows, self._day).surface
        self._times = np.arange(STEPS + 1) / STEPS * self._day
        self._surface = np.concatenate((surface[-1:], surface))

    def temperature(self, time: float) -> float:
        """Of the surface, `time` [s] after the start of the run [K]."""
        return float(np.interp(time % self._day, self._times, self._surface))
