"""What a machine is to do over the next days, as far as its power goes: what loads draw, and what is switched off."""

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from math import floor, inf
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_flight.power_manager.modes import SLEEP
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.names import names_text
from sojourn_machine.params import FloatArray, Params

SECONDS_PER_HOUR = 3600.0


class ActivityParams(Params):
    """One span of time, once or again and again."""

    load: str = Field(min_length=1, description="name of a load; `sleep`: the machine sleeps meanwhile")
    power_w: float | None = Field(
        default=None,
        gt=0.0,
        le=1e6,
        description="that a load draws meanwhile whose motors say how much; left out: it is off meanwhile [W]",
    )
    start_h: float = Field(ge=0.0, le=1e6, description="beginning after the start of the run [h]")
    hours: float = Field(gt=0.0, le=1e6, description="length [h]")
    every_h: float | None = Field(default=None, gt=0.0, le=1e6, description="again after so long; left out: once [h]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.every_h is not None and self.every_h <= self.hours:
            raise ValueError(f"every_h = {self.every_h}: allowed is above hours, {self.hours} h")
        return self

    def is_on(self, time: float) -> bool:
        """Whether it is going on `time` [s] after the start of the run."""
        since = time / SECONDS_PER_HOUR - self.start_h
        period = inf if self.every_h is None else self.every_h
        return since >= 0.0 and (since if period == inf else since - period * floor(since / period)) < self.hours


class Activities:
    """All that is planned for a machine. Raises InvalidValueError for what `activity_problems` finds."""

    def __init__(self, params: PowerManagerParams, activities: Sequence[ActivityParams]) -> None:
        self._names = [load.name for load in params.loads]
        for place, key, value, allowed in activity_problems(params, activities):
            raise InvalidValueError(f"activities[{place}].{key}", value, allowed)
        self._drawing = [(self._names.index(one.load), one) for one in activities if one.power_w is not None]
        self._off = [one for one in activities if one.power_w is None]
        self._factor = 1.0
        self._standing = np.zeros(len(self._names))
        self._begins = {
            place: min(one.start_h for load, one in self._drawing if load == place) for place, _ in self._drawing
        }
        """When what is planned of a load begins [h]."""

    def times(self, factor: float) -> "Activities":
        """The same with so many times the power."""
        new = copy(self)
        new._factor = factor * self._factor
        return new

    def standing(self, drawn: FloatArray) -> "Activities":
        """The same, where motors that stand and hold draw so much, (loads,) [W]: those of a load that is planned for
        from its first activity on, all others always.
        """
        new = copy(self)
        new._standing = drawn
        return new

    def demand(self, time: float) -> FloatArray:
        """Asked by the loads whose motors say how much, zero for all others, (loads,) [W]."""
        found = np.zeros(len(self._names))
        for place, activity in self._drawing:
            if activity.power_w is not None and activity.is_on(time):
                found[place] += self._factor * activity.power_w
        holds = found == 0.0
        for place, begin in self._begins.items():
            holds[place] &= time >= begin * SECONDS_PER_HOUR
        found[holds] = self._standing[holds]
        return found

    def asked(self, time: float) -> Mapping[str, bool]:
        """What an operator wants at a time: load name to on (True) or off (False), and whether it sleeps. Of what the
        plan does not name, nothing.
        """
        found: dict[str, bool] = {}
        for activity in self._off:
            going = activity.is_on(time)
            if activity.load == SLEEP:
                found[SLEEP] = found.get(SLEEP, False) or going
            else:
                found[activity.load] = found.get(activity.load, True) and not going
        return found


def activity_problems(
    params: PowerManagerParams, activities: Sequence[ActivityParams]
) -> Iterator[tuple[int, str, object, str]]:
    """What a machine cannot carry out: place, key, value, and what is allowed."""
    names = [load.name for load in params.loads]
    for place, activity in enumerate(activities):
        if activity.load == SLEEP:
            if params.law.sleep is None:
                yield place, "load", SLEEP, "is for a machine whose power manager has a table sleep"
            elif activity.power_w is not None:
                yield place, "power_w", activity.power_w, "allowed is none while the machine sleeps"
            continue
        if activity.load not in names:
            yield place, "load", activity.load, "allowed is a load, or sleep: " + names_text(activity.load, names)
            continue
        load = params.loads[names.index(activity.load)]
        if activity.power_w is None:
            if load.essential:
                switchable = ", ".join(load.name for load in params.loads if not load.essential)
                yield place, "load", load.name, f"is essential and never off: allowed are {switchable}"
        elif load.kind != "commanded":
            yield place, "power_w", activity.power_w, f"allowed is none: {load.name} draws {load.power_w:g} W while on"
        elif activity.power_w > load.power_w:
            yield place, "power_w", activity.power_w, f"allowed is at most the {load.power_w:g} W of {load.name}"
