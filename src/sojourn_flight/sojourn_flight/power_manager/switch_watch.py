"""Stuck switches, from the step of the power out of the stores when a load is switched.

Power is averaged over a window before a load is switched and, `settle` later, over one after. Of what it has changed
by, D, and of what it should have, e, a draw that is believed within a part of itself, it is asked which is likelier:

    the switch is well     D = e,    variance  s^2 + (part e)^2
    it is stuck            D = 0,    variance  s^2

(Wald 1947, Sequential Analysis, ch. 3, of one look.) s^2 is that of both means, by the scatter in the windows. What is
likelier by `certainty`, a logarithm, and fits within three of its deviations, is taken for true; else nothing is said,
and the next switching tells. So a verdict comes settle + window after a switching, which is 5.3 s.

Motors that start or stop just then, and draw just what the load should, deceive it (once in some three thousand
switchings while motors change every few seconds): so both windows are long and the gap between them short, and the
power has to be steady over each. Nothing is asked where the step would prove nothing: while motors are at work, while
other loads are switched at the same time or soon after, for loads that draw what motors or thermostats ask, and, on a
machine with sources, while the stores are not discharging, where a source may make up for the step.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

from pydantic import Field

from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.power.loads import LoadParams
from sojourn_machine.power.power_params import PowerParams

STUCK_ON, STUCK_OFF = "switch stuck on", "switch stuck off"
DEVIATIONS = 3.0
"""By which what is said has to fit."""
LEAST_COUNT = 4
"""Readings in a window."""
BRIDGE = 1.63
"""Reach of a Brownian bridge in 99 of 100 cases."""
LEAST_POWER = 1e-6
"""What is no power at all [W]."""
LEAST_DEVIATION = 0.02
"""Of a mean, as a part of the step that is asked for [1]."""


class SwitchWatchParams(Params):
    """What a step is, and how sure the watch must be."""

    window: float = Field(default=5.0, gt=0.0, le=60.0, description="over which power is averaged [s]")
    settle: float = Field(default=0.3, ge=0.0, le=60.0, description="after a switching until the window begins [s]")
    power_error: float = Field(default=0.15, ge=0.0, lt=0.5, description="part by which a draw may be off belief [1]")
    certainty: float = Field(default=4.5, gt=0.0, le=100.0, description="logarithm of the likelihoods' ratio [1]")


@dataclass(frozen=True, slots=True)
class StuckSwitch:
    """Of one load."""

    load: str
    kind: str
    numbers: str


@dataclass(frozen=True, slots=True)
class SwitchState:
    """What is remembered."""

    on: tuple[bool, ...] = ()
    """Of each load, as it was told last; none before."""
    window: tuple[float, ...] = ()
    """Power out of the stores [W], the last ones."""
    before: float | None = None
    """Mean of the window before a load was switched [W]; None while nothing is asked."""
    scatter: float = 0.0
    """Variance of that mean [W^2]."""
    load: int = 0
    """That was switched."""
    expected: float = 0.0
    """Change by it, as believed [W]."""
    elapsed: float = 0.0
    """Since then [s]."""
    stuck: tuple[StuckSwitch, ...] = ()


class Watched:
    """The loads of a machine, as far as steps of their power tell anything.

    Args:
        on_thermostats: loads that draw only while a thermostat asks.
    """

    def __init__(self, power: PowerParams, on_thermostats: Sequence[str]) -> None:
        self.loads = power.loads
        self.has_sources = bool(power.sources)
        self._known = [load.kind != "commanded" and load.name not in on_thermostats for load in power.loads]

    def draw(self, place: int, voltage: float) -> float | None:
        """Of a load that is on [W]; None where that cannot be known."""
        load = self.loads[place]
        return _draw(load, voltage) if self._known[place] else None


def step(
    params: SwitchWatchParams, watched: Watched, state: SwitchState, readings: Sequence[StoreReading], dt: float
) -> SwitchState:
    """After the telemetry of a period of `dt` [s]."""
    count = round(params.window / dt)
    if count < LEAST_COUNT:  # too seldom for a window
        return state
    power = sum([reading.voltage * reading.current for reading in readings])
    elapsed = state.elapsed + dt
    if state.before is not None and elapsed <= params.settle:
        return replace(state, elapsed=elapsed)
    window = (*state.window, power)[-count:]
    if state.before is None or len(window) < count:
        return replace(state, window=window, elapsed=elapsed)
    stuck = _judged(params, watched, state, window)
    return replace(state, window=window, before=None, stuck=stuck)


def told(
    params: SwitchWatchParams, watched: Watched, state: SwitchState, on: tuple[bool, ...], voltage: float, dt: float
) -> SwitchState:
    """After the loads were told to be on or off. voltage: of the bus [V]."""
    count = round(params.window / dt)
    if on == state.on:
        return state
    fresh = replace(state, on=on, window=(), before=None, elapsed=0.0)
    switched = [place for place, (new, old) in enumerate(zip(on, state.on, strict=False)) if new != old]
    if len(switched) != 1 or state.before is not None or len(state.window) < max(count, LEAST_COUNT):
        return fresh
    draw = watched.draw(switched[0], voltage)
    mean, scatter = steady(state.window)
    if draw is None or scatter is None or (watched.has_sources and mean <= 0.0):
        return fresh
    expected = draw if on[switched[0]] else -draw
    return replace(fresh, before=mean, scatter=scatter, load=switched[0], expected=expected)


def _draw(load: LoadParams, voltage: float) -> float:
    return load.power_w * (voltage / load.voltage_nominal) ** 2 if load.kind == "resistive" else load.power_w


def steady(window: tuple[float, ...]) -> tuple[float, float | None]:
    """Mean of a window, and variance of that mean; None where its power was not steady.

    The variance of one reading is half the mean square of successive differences (von Neumann 1941, Annals of
    Mathematical Statistics 12:367), which a step in the window hardly changes; the sum of what is off the mean then
    wanders no further than a Brownian bridge does in 99 of 100 cases.
    """
    count = len(window)
    mean = sum(window) / count
    variance = 0.5 * sum([(new - old) ** 2 for old, new in pairwise(window)]) / (count - 1)
    farthest = max(abs(total) for total in accumulate([power - mean for power in window]))
    steady = farthest <= BRIDGE * math.sqrt(variance * count) + LEAST_POWER * count
    return mean, variance / count if steady else None


def _judged(
    params: SwitchWatchParams, watched: Watched, state: SwitchState, window: tuple[float, ...]
) -> tuple[StuckSwitch, ...]:
    """What is known of stuck switches once both windows are full."""
    mean, scatter = steady(window)
    if state.before is None or scatter is None or (watched.has_sources and mean <= 0.0):
        return state.stuck
    change, step = mean - state.before, state.expected
    noise = state.scatter + scatter + (LEAST_DEVIATION * step) ** 2
    well, fits_well = _likelihood(change - step, noise + (params.power_error * step) ** 2)
    bad, fits_bad = _likelihood(change, noise)
    if abs(well - bad) < params.certainty or not (fits_well if well > bad else fits_bad):
        return state.stuck
    load = watched.loads[state.load].name
    kept = tuple([one for one in state.stuck if one.load != load])
    if well > bad:
        return kept
    off = step < 0.0
    numbers = (
        f"{abs(step) - abs(change):.1f} of {abs(step):.1f} W {'still drawn while off' if off else 'missing while on'}"
    )
    return (*kept, StuckSwitch(load, STUCK_ON if off else STUCK_OFF, numbers))


def _likelihood(off: float, variance: float) -> tuple[float, bool]:
    """Its logarithm for what is off by so much, and whether that fits at all."""
    return -0.5 * off * off / variance - 0.5 * math.log(variance), off * off <= DEVIATIONS**2 * variance
