"""Days of a machine's power: its network as it truly is under the law of its power manager, in the light of its site.

The machine stands, level, where it starts; what it does is what the scenario has in `activities`, and its
motors hold meanwhile (`standing_draw`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil
from typing import NamedTuple

import numpy as np

from sojourn_config.expected_heat import heat_at_start
from sojourn_config.expected_light import expected_light, goes_by_light, is_dark, light_at_start, light_on_machine
from sojourn_config.scenario import LoadedScenario
from sojourn_flight.power_manager import law
from sojourn_flight.power_manager.activities import SECONDS_PER_HOUR, Activities
from sojourn_flight.power_manager.forecast import Forecaster, Known, first_limit, limit_text
from sojourn_flight.power_manager.preview import Around, Preview, PreviewState, PreviewStep
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network import PowerNetwork
from sojourn_studies.standing_draw import standing_draw

FORECAST_EVERY = 600.0
"""The power manager looks ahead so often here; in a run it is each minute [s]."""
ROUNDING = 1e-9
"""Of a number of steps, that it makes no more of them [1]."""
LONGEST_STEP = 60.0
"""Longer ones are taken in parts: a thermostat or a mode of the manager would last for all of one [s]."""


class DayOfPower(NamedTuple):
    """One solar day of the machine."""

    number: int
    """From 1 on."""
    hours: float
    """Of it that were looked at [h]."""
    offered: float
    """The most that all sources could have given [Wh]."""
    given: float
    """By all sources [Wh]."""
    used: float
    """By all loads [Wh]."""
    least: float
    """Charge of all stores [1]."""
    most: float
    modes: tuple[str, ...]
    """In the order in which they came."""


class Limit(NamedTuple):
    """What limits the machine."""

    hours: float
    """When, after the start of the run [h]."""
    what: str


@dataclass(frozen=True)
class PowerDays:
    """What has come of it."""

    scenario: LoadedScenario
    step: float
    """Of time [s]."""
    parts: int
    """Of these steps in each that was asked for [1]."""
    steps: Sequence[PreviewStep]
    end: PreviewState
    around: Around
    """Light and warmth at the machine."""

    @cached_property
    def hours(self) -> FloatArray:
        """Ends of the steps after the start of the run, (steps,) [h]."""
        return np.array([step.time for step in self.steps]) / SECONDS_PER_HOUR

    @cached_property
    def charge(self) -> FloatArray:
        """Of all stores, (steps,) [1]."""
        shares = np.array(self.scenario.power_manager.shares)
        found: FloatArray = np.clip(np.array([step.charges for step in self.steps]) @ shares, 0.0, 1.0)
        return found

    @cached_property
    def offered(self) -> FloatArray:
        """The most that all sources could have given, (steps,) [W]."""
        return np.array([step.network.offered for step in self.steps])

    @cached_property
    def given(self) -> FloatArray:
        """By all sources, (steps,) [W]."""
        return np.array([sum(step.network.source_powers) for step in self.steps])

    @cached_property
    def used(self) -> FloatArray:
        """By each load, (steps, loads) [W]."""
        return np.array([step.network.load_power for step in self.steps])

    @cached_property
    def temperatures(self) -> FloatArray:
        """Of each store, (steps, stores) [K]."""
        return np.array([step.temperatures for step in self.steps])

    @cached_property
    def nodes(self) -> dict[str, FloatArray]:
        """Temperatures of the nodes of the machine's heat by their names, (steps,) [K]; none where it has none."""
        if self.scenario.thermal is None:
            return {}
        table = np.array([step.nodes for step in self.steps])
        return dict(zip(self.scenario.thermal.nodes, table.T, strict=True))

    @cached_property
    def beyond_limits(self) -> dict[str, tuple[float, str]]:
        """Stores that are too cold or too hot at some time: when first [h], and how, in words."""
        found = {}
        for place, (name, store) in enumerate(self.scenario.power.all_stores.items()):
            for hour, step in zip(self.hours, self.steps, strict=True):
                broken = store.limits_exceeded(step.temperatures[place], 0.0)
                if broken:
                    found[name] = float(hour), " and ".join(broken)
                    break
        return found

    @cached_property
    def first_limit(self) -> Limit | None:
        """Something shed (see `forecast.first_limit`; at the first step, if it is so from the start on), a bus that
        falls short, a store too cold or too hot.
        """
        first = self.steps[0]
        shed = first if first.manager.shed_level > 0 and not first.sleeps_by_plan else first_limit(self.steps)
        found = [Limit(hour, f"{name} {broken}") for name, (hour, broken) in self.beyond_limits.items()]
        if shed is not None:
            found.append(Limit(shed.time / SECONDS_PER_HOUR, limit_text(shed)))
        return min(found, default=None)

    @property
    def lies_in_the_dark(self) -> bool:
        """Whether all sources go by light, and none falls on the machine in all this time."""
        lights = (self.around(step.time - 0.5 * self.step) for step in self.steps)  # as the steps had it
        return goes_by_light(self.scenario) and is_dark(lights)

    @property
    def dead_at(self) -> float | None:
        """When all stores were first empty [h]; None where they never were."""
        empty = self.hours[self.charge <= 0.0]
        return float(empty[0]) if len(empty) else None

    @property
    def imbalance(self) -> float:
        """Energy that the account of the network does not explain, of all that went through it [1]."""
        account = self.end.network.energy
        through = max(account.loads, account.sources, 1.0)
        return (account.sources + account.stores - account.loads - account.converters - account.shunts) / through

    def days(self) -> list[DayOfPower]:
        """Day by day from the start of the run on."""
        day = self.scenario.body.solar_day / SECONDS_PER_HOUR
        numbers = np.floor((self.hours - 0.5 * self.step / SECONDS_PER_HOUR) / day).astype(int)
        hours = self.step / SECONDS_PER_HOUR
        found = []
        for number in np.unique(numbers):
            here = numbers == number
            modes = [str(step.manager.mode) for step, inside in zip(self.steps, here, strict=True) if inside]
            found.append(
                DayOfPower(
                    number=int(number) + 1,
                    hours=float(here.sum()) * hours,
                    offered=float(self.offered[here].sum()) * hours,
                    given=float(self.given[here].sum()) * hours,
                    used=float(self.used[here].sum()) * hours,
                    least=float(self.charge[here].min()),
                    most=float(self.charge[here].max()),
                    modes=tuple(dict.fromkeys(modes)),
                )
            )
        return found


def power_days(scenario: LoadedScenario, days: float, step: float) -> PowerDays:
    """So many solar days, in steps of at most so many seconds [s]: whole ones make a solar day.

    Raises:
        ConfigError: the ground cannot be made that hides the Sun.
    """
    known = scenario.as_believed()
    params = known.power_manager
    planned = Activities(params, scenario.config.activities).standing(standing_draw(scenario))
    light = light_at_start(scenario, scenario.height_field)
    around = light_on_machine(scenario, light)
    preview = Preview(params, PowerNetwork(scenario.power), planned, around, heat_at_start(scenario, light))
    expected = light_at_start(known)
    ahead = expected_light(known, expected), heat_at_start(known, expected)
    forecaster = Forecaster(params, scenario.config.activities, *ahead)
    state, steps = preview.initial_state(scenario.config.battery_soc), []
    asked, parts = steps_of_a_day(scenario, step)
    step = scenario.body.solar_day / (asked * parts)
    looked = -FORECAST_EVERY
    for _ in range(max(round(days * asked), 1) * parts):
        if state.time - looked > FORECAST_EVERY - 0.5 * step:
            looked = state.time
            least = forecaster.least_asleep(Known(state.time, state.manager, preview.readings(state), state.heat))
            if least is not None:
                state = state._replace(manager=law.foreseen(params, state.manager, least))
        state, shown = preview.step(state, step)
        steps.append(shown)
    return PowerDays(scenario, step, parts, steps, state, around)


def steps_of_a_day(scenario: LoadedScenario, step: float) -> tuple[int, int]:
    """Whole steps of at most so many seconds that make a solar day, and the parts in which each is taken."""
    asked = ceil(scenario.body.solar_day / step * (1.0 - ROUNDING))
    return asked, ceil(scenario.body.solar_day / asked / LONGEST_STEP * (1.0 - ROUNDING))
