"""The mode of the power manager: one word for what is switched off, and the sleep that goes beyond all shedding.

    NOMINAL   nothing is shed
    LOW       something is shed, the machine may still move
    SAFE      every load that moves it is shed: those that draw what their motors ask
    SURVIVAL  everything is shed that is not essential
    SLEEP     besides, the essential loads are off that the law names; the others (heaters, receiver) stay on

The first four follow from the level of shedding and have its hysteresis. The machine falls asleep when in SURVIVAL
the charge is below `below_soc` and falls on for `enter_time`, or on request. It wakes when the charge is above
`wake_soc`, or when the stores take, for `wake_time`, more power than the loads need that it would switch on; asleep
on request it waits besides until that was not so for once (it sleeps until the next light). Between waking and
falling asleep lies `enter_time`, between falling asleep and waking by light `wake_time`: so often can it change and
no more.

With a `reserve` the machine does not wait until the charge is low: it sleeps as soon as that is what it takes, by the
forecast, to have so much left all the time until light comes back; and until sleep would leave `reserve_hysteresis`
more.
"""

from dataclasses import dataclass
from typing import Literal, Self, TypeAlias

from pydantic import Field, model_validator

from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.power.loads import LoadParams

Mode: TypeAlias = Literal["NOMINAL", "LOW", "SAFE", "SURVIVAL", "SLEEP"]

SLEEP = "sleep"
"""Name by which an operator asks for it, beside those of the loads."""


class SleepParams(Params):
    """When the machine sleeps and what is off then."""

    loads: tuple[str, ...] = Field(min_length=1, description="essential loads that are off besides all others")
    below_soc: float = Field(gt=0.0, lt=1.0, description="charge below which it falls asleep in SURVIVAL [1]")
    wake_soc: float = Field(gt=0.0, lt=1.0, description="charge above which it wakes [1]")
    enter_time: float = Field(gt=0.0, le=1e5, description="time below it, not charging, before it sleeps [s]")
    wake_time: float = Field(gt=0.0, le=1e5, description="time of light enough before it wakes [s]")
    reserve: float | None = Field(
        default=None,
        gt=0.0,
        lt=1.0,
        description="charge that sleep is to leave over the hours of the forecast; left out: no sleep is foreseen [1]",
    )
    reserve_hysteresis: float = Field(default=0.05, gt=0.0, lt=1.0, description="more than that to wake again [1]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.wake_soc <= self.below_soc:
            raise ValueError(f"wake_soc = {self.wake_soc}: allowed is above below_soc, {self.below_soc}")
        return self


@dataclass(frozen=True, slots=True)
class SleepState:
    """What is remembered of it."""

    asleep: bool = False
    requested: bool = False
    """An operator asked for this sleep."""
    foreseen: bool = False
    """It sleeps for what is ahead."""
    low_elapsed: float = 0.0
    """Awake: time in which it could have fallen asleep [s]."""
    light_elapsed: float = 0.0
    """Asleep: time in which the stores took enough [s]."""
    been_dark: bool = False
    """Asleep: there was a time in which they did not."""
    reason: str = ""
    """Why it fell asleep or woke, in words."""


AWAKE = SleepState()


@dataclass(frozen=True, slots=True)
class Supply:
    """What the sleep goes by."""

    survival: bool
    """All is shed that is not essential."""
    charge: float
    """Of all stores [1]."""
    intake: float
    """Power into all stores, filtered; negative in discharge [W]."""


def after(
    params: SleepParams | None, loads: tuple[LoadParams, ...], state: SleepState, supply: Supply, dt: float
) -> SleepState:
    """Asleep or awake after a period of `dt` [s]; awake always where the law knows no sleep (None)."""
    if params is None:
        return state
    if not state.asleep:
        low = supply.survival and supply.charge < params.below_soc and supply.intake <= 0.0
        elapsed = state.low_elapsed + dt if low else 0.0
        if elapsed < params.enter_time:
            return replace(state, low_elapsed=elapsed)
        return SleepState(asleep=True, reason=f"charge fell below {params.below_soc:.1%}")
    if state.foreseen:
        return state
    needed = sum(load.power_w for load in loads if load.name in params.loads)
    light = supply.intake > needed
    elapsed = state.light_elapsed + dt if light else 0.0
    been_dark = state.been_dark or not light
    if elapsed >= params.wake_time and (been_dark or not state.requested):
        return SleepState(reason=f"woke: the stores took more than {needed:.0f} W for {params.wake_time:.0f} s")
    if supply.charge > params.wake_soc and not state.requested:
        return SleepState(reason=f"woke: charge is above {params.wake_soc:.1%}")
    return replace(state, light_elapsed=elapsed, been_dark=been_dark)


def foreseen(params: SleepParams, state: SleepState, least: float, hours: float) -> SleepState:
    """Asleep or awake after a forecast: `least` is the charge that sleep would leave within so many hours [1]."""
    if params.reserve is None or (state.asleep and not state.foreseen):
        return state
    if not state.asleep and least < params.reserve:
        reason = f"asleep it will come to {least:.1%} within {hours:g} h, less than {params.reserve:.1%}"
        return SleepState(asleep=True, foreseen=True, reason=reason)
    if state.asleep and least > params.reserve + params.reserve_hysteresis:
        return SleepState(reason=f"woke: asleep it would come to {least:.1%} within {hours:g} h")
    return state


def requested(state: SleepState, asleep: bool) -> SleepState:
    """After an operator asked for sleep, or to wake; as it was where it is so already."""
    if asleep == state.asleep:
        return state
    return SleepState(asleep, requested=asleep, reason="asked by the operator")


def mode_of(loads: tuple[LoadParams, ...], shed: tuple[int, ...], levels: int, asleep: bool) -> Mode:
    """The mode in which these priorities are shed, of so many levels."""
    if asleep:
        return "SLEEP"
    if not shed:
        return "NOMINAL"
    if len(shed) == levels:
        return "SURVIVAL"
    moving = [load for load in loads if load.kind == "commanded"]
    still = moving and all(load.priority in shed and not load.essential for load in moving)
    return "SAFE" if still else "LOW"
