"""When a sensor measures and when what it has measured is there: a part of a sensor's table that every kind has."""

from math import ceil, floor
from typing import Any, Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params
from sojourn_machine.timing import CONTROL_PERIOD_S

CONTROL_RATE = 1.0 / CONTROL_PERIOD_S
"""Of all that runs at a rate [Hz]."""
_ROUNDING = 1e-6
"""Of numbers that people type, in control periods."""


class SensorTimingParams(Params):
    """When a sensor measures, and when its message leaves. All of it is simulation time.

    A message leaves in the first control period at or after stamp + latency + jitter, and in the order of the stamps:
    one that would overtake another leaves with it.
    """

    rate: float | None = Field(
        default=None, gt=0.0, le=CONTROL_RATE, description="of its messages [Hz]; left out: that of its topic"
    )
    phase: float = Field(default=0.0, ge=0.0, le=3600.0, description="of the measurement after the full period [s]")
    latency: float = Field(default=0.0, ge=0.0, le=60.0, description="shortest time from measurement to message [s]")
    jitter: float = Field(
        default=0.0, ge=0.0, le=1.0, description="most that is added to the latency, drawn evenly from zero on [s]"
    )
    dropped: float = Field(default=0.0, ge=0.0, le=0.9, description="probability that a message is lost [-]")
    seed: int = Field(default=0, ge=0, lt=2**63, description="of its jitter and its losses [-]")

    @property
    def every(self) -> int | None:
        """Control periods from one measurement to the next; None: those of the topic."""
        return None if self.rate is None else round(CONTROL_RATE / self.rate)

    @property
    def phase_periods(self) -> int:
        """Control periods by which it measures after the full period."""
        return round(self.phase / CONTROL_PERIOD_S)

    def check_row(self, row: Any) -> None:
        """Raise ValueError where the phase is longer than the period of a row of the topic table."""
        every = self.every or row.every
        if self.phase_periods >= every:
            longest = (every - 1) * CONTROL_PERIOD_S
            raise ValueError(f"phase {self.phase:g}: allowed is {longest:g} s at most, {row.name} comes at that rate")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.rate is not None:
            periods = CONTROL_RATE / self.rate
            if abs(periods - round(periods)) > _ROUNDING * periods:
                nearest = f"{CONTROL_RATE / ceil(periods):.6g} and {CONTROL_RATE / floor(periods):.6g}"
                allowed = f"a divisor of the control rate of {CONTROL_RATE:g} Hz, the nearest are {nearest}"
                raise ValueError(f"rate {self.rate:g}: allowed is {allowed}")
        if abs(self.phase / CONTROL_PERIOD_S - self.phase_periods) > _ROUNDING:
            allowed = f"a multiple of {CONTROL_PERIOD_S:g} s, the control period"
            raise ValueError(f"phase {self.phase:g}: allowed is {allowed}")
        return self
