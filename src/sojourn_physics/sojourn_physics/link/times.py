"""Windows by a table: from one simulated time to another, once or again and again."""

from typing import Literal, NamedTuple, Self

from pydantic import Field, model_validator

from sojourn_machine.timing import NANOSECONDS
from sojourn_physics.link.window import NEVER, Sky, Window, WindowChoice

LATEST = 1e8


class TimesParams(WindowChoice):
    """`{kind: times, from_s: 60, to_s: 600, every_s: 7200}`."""

    kind: Literal["times"] = "times"
    from_s: float = Field(ge=0.0, le=LATEST, description="simulated time at which it opens [s]")
    to_s: float = Field(ge=0.0, le=LATEST, description="simulated time at which it closes [s]")
    every_s: float | None = Field(default=None, ge=1e-3, le=LATEST, description="from one to the next [s]; none: once")

    @model_validator(mode="after")
    def _closes_after_it_opens(self) -> Self:
        _, length, every = self._nanoseconds
        if length <= 0:
            raise ValueError(f"to_s = {self.to_s:g}: allowed is later than from_s = {self.from_s:g} s")
        if every is not None and every < length:
            allowed = f"{length / NANOSECONDS:g} s, the length of a window, or more"
            raise ValueError(f"every_s = {self.every_s:g}: allowed is {allowed}")
        return self

    @property
    def _nanoseconds(self) -> "Times":
        begin, end = (round(time * NANOSECONDS) for time in (self.from_s, self.to_s))
        return Times(begin, end - begin, None if self.every_s is None else round(self.every_s * NANOSECONDS))

    def build(self, sky: Sky) -> Window:
        """See WindowChoice."""
        return self._nanoseconds


class Times(NamedTuple):
    """See `TimesParams`."""

    begin: int
    length: int
    every: int | None
    """[ns]"""

    def at(self, time: int, x: float, y: float) -> tuple[bool, int]:
        """See Window."""
        since = time - self.begin
        if since < 0:
            return False, self.begin
        number = 0 if self.every is None else since // self.every
        opened = self.begin + number * (self.every or 0)
        if time < opened + self.length:
            return True, opened + self.length
        return False, NEVER if self.every is None else opened + self.every
