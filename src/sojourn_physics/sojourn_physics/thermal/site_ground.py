"""Ground of a site as a machine on it feels it: warm by day, cold by night, as its own Sun makes it.

The light over the site is looked at over one solar day from the start of the run on, in a thousand steps, and the
ground is taken to have lived through many such days (`regolith_day`): seasons and weather other than those of this day
are left out, and an eclipse late in it is as coarse as its steps are long. One that goes on or comes within `NEAR` of
the start is in no other day, and is gone through minute by minute, from before it on. Of air the ground is given what a
sky of one temperature radiates, and no convection.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.sunlight import Sunlight
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.thermal.regolith import advance, cut_ground
from sojourn_physics.thermal.regolith_day import settled_day
from sojourn_physics.thermal.regolith_params import RegolithParams

STEPS = 1000
"""Of a day."""
NEAR, LOOK, MINUTE = 6.0 * 3600.0, 600.0, 60.0
"""On both sides of the start that are looked at for an eclipse, how often, and steps through it [s]."""
HIGH, SEEN = math.radians(3.0), 0.98
"""Elevation from which on no other day's Sun is low enough to be hidden [rad], and part of its disc that is then seen
[1].
"""


class SiteGround:
    """The surface of the ground over the days.

    Args:
        body: with the table `regolith`.
        light: over the site, by the time after the start of the run, and before it [s].

    Raises:
        InvalidValueError: a body without the table, or days that do not come to repeat.
    """

    def __init__(self, body: BodyParams, light: Callable[[float], Sunlight]) -> None:
        if body.regolith is None:
            raise InvalidValueError("body", body.name, "one whose file has the table regolith, for a machine with heat")
        self._day = body.solar_day
        shone_on = _ShoneOn(body.regolith, STEFAN_BOLTZMANN * body.sky_temperature**4, light)
        ground = cut_ground(body.regolith, self._day)
        day = settled_day(ground, shone_on.rows((np.arange(STEPS) + 0.5) / STEPS * self._day), self._day)
        self._times = np.arange(STEPS + 1) / STEPS * self._day
        self._surface = np.concatenate((day.surface[-1:], day.surface))
        self._near = np.zeros((0, 2))
        """Times and temperatures in place of these, from the start on, where one of `NEAR` is eclipsed."""
        if _is_eclipsed(light, self._day):
            before = day.temperatures[round((1.0 - NEAR / self._day) * STEPS) - 1]
            self._near = _near_start(shone_on, ground.depths, before)

    def temperature(self, time: float) -> float:
        """Of the surface, `time` [s] after the start of the run [K]."""
        if len(self._near) and time <= self._near[-1, 0]:
            return float(np.interp(time, self._near[:, 0], self._near[:, 1]))
        return float(np.interp(time % self._day, self._times, self._surface))


class _ShoneOn(NamedTuple):
    """Ground under what its sky radiates [W/m2] and the light over the site."""

    regolith: RegolithParams
    sky: float
    light: Callable[[float], Sunlight]

    def rows(self, times: FloatArray) -> FloatArray:
        """Of `Irradiation`, at times after the start [s]."""
        given = np.zeros((len(times), 4))
        given[:, 1] = self.sky
        given[:, 0] = [_absorbed(self.regolith, self.light(time)) for time in times.tolist()]
        return given


def _near_start(ground: _ShoneOn, depths: FloatArray, before: FloatArray) -> FloatArray:
    """Times [s] and temperatures [K] of the surface within `NEAR` of the start, minute by minute, shape (N, 2).

    Args:
        before: temperatures at depths [m] when that begins, shape (K,) [K].
    """
    fine = cut_ground(ground.regolith, 2.0 * NEAR)  # in so short a time heat comes less deep, through thinner layers
    ends = np.arange(-NEAR, NEAR, MINUTE) + MINUTE
    there, _ = advance(fine, np.interp(fine.depths, depths, before), ground.rows(ends - 0.5 * MINUTE), MINUTE)
    return np.column_stack((ends, there[:, 0]))


def _absorbed(regolith: RegolithParams, now: Sunlight) -> float:
    """Sunlight that the ground takes in [W/m2]."""
    sine = max(math.sin(now.elevation), 0.0)
    albedo = regolith.albedo(math.acos(sine))
    return now.direct * sine * (1.0 - albedo) + now.diffuse * (1.0 - regolith.albedo_normal)


def _is_eclipsed(light: Callable[[float], Sunlight], day: float) -> bool:
    """Whether a Sun that stands high near the start is hidden which is not a day earlier or later."""
    if day < 2.0 * NEAR:
        return False
    for time in np.arange(-NEAR, NEAR + LOOK, LOOK).tolist():
        now = light(time)
        if now.elevation > HIGH and now.visible < SEEN:
            other = light(time + (day if time < 0.0 else -day))
            if other.elevation > HIGH and other.visible >= SEEN:
                return True
    return False
