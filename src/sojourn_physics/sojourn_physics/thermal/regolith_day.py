"""Ground that has lived through many like days: its temperatures repeat. And the light of such a day.

The state that repeats is found by steps of a day. After each, the mean heat that goes down through every gap between
nodes is compared with the heat flow of the interior, and the mean gradients are put right at once instead of by
diffusion, which would take hundreds of days for the depth: a node is moved by the sum, from the surface down, of
(mean flux + heat flow)/(mean conductance). Where nothing is left to put right, the days are alike.

Sun over a level place without seasons: cos i = cos(latitude) cos(hour angle), declination 0 unless given.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN
from sojourn_physics.thermal.regolith import Irradiation, LayeredGround, advance
from sojourn_physics.thermal.regolith_params import RegolithParams

_DAYS = 400
_ALIKE = 0.005
"""Between one day and the next [K]."""


class SolarDay(NamedTuple):
    """A day at a level place."""

    length: float
    """[s]"""
    flux: float
    """Of sunlight on a plane that faces it, at the ground [W/m2]."""
    latitude: float
    """[rad]"""
    declination: float = 0.0
    """Of the Sun [rad]."""

    def sine_of_elevation(self, fraction: FloatArray) -> FloatArray:
        """At fractions of the day since midnight, any shape; at least 0 [1]."""
        turned = np.cos(2.0 * np.pi * (fraction - 0.5))
        level, polar = math.cos(self.latitude) * math.cos(self.declination), self.declination
        sine = math.sin(self.latitude) * math.sin(polar) + level * turned
        return np.maximum(sine, 0.0)


class DayOfGround(NamedTuple):
    """A day that repeats, from midnight to midnight."""

    fractions: FloatArray
    """Of the day, at the ends of the M steps, shape (M,) [1]."""
    temperatures: FloatArray
    """Of the nodes then, shape (M, N) [K]."""
    fluxes: FloatArray
    """Heat that went down, shape (M, N + 1), as `regolith.advance` has them [W/m2]."""

    @property
    def surface(self) -> FloatArray:
        """Temperature of the surface, shape (M,) [K]."""
        return self.temperatures[:, 0]


def irradiation_of_day(
    params: RegolithParams, day: SolarDay, steps: int = 1000, sky: Irradiation | None = None
) -> FloatArray:
    """Rows of `Irradiation`, shape (steps, 4), for the middles of the steps from midnight. `sky`: what comes beside
    the sunlight: its `absorbed` is added by day and night.
    """
    beside = sky or Irradiation(0.0)
    sine = day.sine_of_elevation((np.arange(steps) + 0.5) / steps)
    reflected = np.array([params.albedo(math.acos(value)) for value in sine])
    rows = np.tile(np.array(beside, dtype=np.float64), (steps, 1))
    rows[:, 0] += day.flux * sine * (1.0 - reflected)
    return rows


def settled_day(ground: LayeredGround, given: FloatArray, length: float) -> DayOfGround:
    """The day, of a length [s], that repeats under rows of `Irradiation`, shape (M, 4).

    Raises:
        InvalidValueError: `given` is not such rows of finite numbers, at least 0; length not above 0; or days that do
            not come to repeat.
    """
    if given.ndim != 2 or given.shape[1] != 4 or not np.all(np.isfinite(given) & (given >= 0.0)):
        raise InvalidValueError("irradiation", given.shape, "rows of 4 finite numbers, at least 0")
    if not (math.isfinite(length) and length > 0.0):
        raise InvalidValueError("length of the day [s]", length, "a finite number above 0")
    steps = given.shape[0]
    temperatures = np.full(ground.depths.size, _first_guess(ground, given))
    for _ in range(_DAYS):
        over_time, fluxes = advance(ground, temperatures, given, length / steps)
        end = over_time[-1]
        passed = fluxes[:, 1:-1].mean(axis=0)
        conductance = _mean_conductance(ground, over_time)
        moved = np.concatenate(([0.0], np.cumsum((passed + ground.params.heat_flow) / conductance)))
        if max(np.abs(end - temperatures).max(), np.abs(moved).max()) < _ALIKE:
            return DayOfGround(np.arange(1, steps + 1) / steps, over_time, fluxes)
        temperatures = np.maximum(end + moved, 0.5 * end)
    raise InvalidValueError("days of the ground", _DAYS, f"days that come to repeat within {_ALIKE} K")


def _mean_conductance(ground: LayeredGround, over_time: FloatArray) -> FloatArray:
    """Of the gaps between nodes over the day, shape (N - 1,) [W/(m2 K)]."""
    mean = 0.5 * (over_time[:, 1:] + over_time[:, :-1]) / 350.0
    layers = ground.layers
    conductance: FloatArray = layers.contact * (1.0 + layers.radiative * mean**3).mean(axis=0)
    return conductance


def _first_guess(ground: LayeredGround, given: FloatArray) -> float:
    """Temperature that would radiate what is given over the day [K]."""
    emissivity = ground.params.emissivity
    mean = given[:, 0].mean() + emissivity * given[:, 1].mean() + ground.params.heat_flow
    return float(max((mean / (emissivity * STEFAN_BOLTZMANN)) ** 0.25, 20.0))
