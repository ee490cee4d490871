"""The limits of fields, as a file has them: `alarms.yaml` beside a machine's files, or any other.

battery:
  field: /battery_state.percentage
  watch: {below: 0.4}
  warning: {below: 0.3}
  critical: {below: 0.25}
  hysteresis: 0.02
  persistence_s: 3.0
  help: The charge is low
"""

from collections.abc import Iterator, Mapping
from enum import IntEnum
from typing import Self

from pydantic import Field, model_validator

from sojourn_contract.named_fields import FieldValue
from sojourn_machine.params import Params


class Severity(IntEnum):
    """How bad it is."""

    NONE = 0
    WATCH = 1
    WARNING = 2
    CRITICAL = 3

    @property
    def word(self) -> str:
        """In words."""
        return self.name.lower()


class LimitParams(Params):
    """When a level holds: any one of the comparisons is enough. A number is compared with `above` and `below`, a text
    or a number with the others."""

    above: float | None = Field(default=None, description="it is larger")
    below: float | None = Field(default=None, description="it is smaller")
    equals: tuple[str | float, ...] | str | float | None = Field(
        default=None, description="it is this, or one of these"
    )
    differs: str | float | None = Field(default=None, description="it is anything else")
    contains: str | None = Field(default=None, min_length=1, description="its text has this in it")

    @model_validator(mode="after")
    def _has_one(self) -> Self:
        if not self.model_dump(exclude_none=True):
            raise ValueError("a limit without a comparison: allowed is one of " + ", ".join(type(self).model_fields))
        if self.above is not None and self.below is not None and self.below > self.above:
            raise ValueError(
                f"below = {self.below:g}: allowed is at most above, {self.above:g}, or every value is meant"
            )
        return self

    def holds(self, value: FieldValue, slack: float = 0.0) -> bool:
        """Whether a value is beyond the limit, which is so much wider [unit of the field]."""
        if isinstance(value, float):
            if self.above is not None and value > self.above - slack:
                return True
            if self.below is not None and value < self.below + slack:
                return True
        if self.equals is not None and any(_same(value, one) for one in _several(self.equals)):
            return True
        if self.differs is not None and not _same(value, self.differs):
            return True
        return self.contains is not None and self.contains in str(value)

    def __str__(self) -> str:
        return " or ".join(f"{name} {value!r}" for name, value in self.model_dump(exclude_none=True).items())


class AlarmParams(Params):
    """One alarm: a field and its limits."""

    field: str = Field(min_length=1, description="TOPIC.FIELD or TOPIC.FIELD[WHICH], as scripts/plot names it")
    watch: LimitParams | None = Field(default=None, description="to be looked at")
    warning: LimitParams | None = Field(default=None, description="something has to be done soon")
    critical: LimitParams | None = Field(default=None, description="something has to be done now")
    persistence_s: float = Field(default=0.0, ge=0.0, le=1e6, description="it holds so long before it counts [s]")
    hysteresis: float = Field(
        default=0.0, ge=0.0, description="a number has to be so far within the limit to be over [unit of the field]"
    )
    latched: bool = Field(default=True, description="it stays until it has been acknowledged, over or not")
    help: str = Field(default="", description="what it means, and what to do")

    @model_validator(mode="after")
    def _has_a_level(self) -> Self:
        if not self.levels:
            raise ValueError("an alarm without a limit: allowed is watch, warning or critical")
        return self

    @property
    def levels(self) -> Mapping[Severity, LimitParams]:
        """Its limits, the worst first."""
        found = {Severity.CRITICAL: self.critical, Severity.WARNING: self.warning, Severity.WATCH: self.watch}
        return {severity: limit for severity, limit in found.items() if limit is not None}


class AlarmSet(Params):
    """A file of alarms."""

    alarms: dict[str, AlarmParams | None] = Field(
        description="alarms by their names; null takes one away that the machine has"
    )

    def over(self, others: Mapping[str, AlarmParams]) -> dict[str, AlarmParams]:
        """These over others of the same names."""
        both = {**others, **self.alarms}
        return {name: params for name, params in both.items() if params is not None}


def _several(value: tuple[str | float, ...] | str | float) -> Iterator[str | float]:
    if isinstance(value, tuple):
        yield from value
    else:
        yield value


def _same(value: FieldValue, wanted: str | float) -> bool:
    return value == (float(wanted) if isinstance(wanted, int | float) else wanted)
