"""Leaps of the clock: while nothing moves and nobody wants anything, the plant passes over control periods.

A run whose scenario asks for it has only the control periods that its clock tells. A leap begins at a whole second and
lands at a multiple of all periods of the table, so that every role acts in the period before it and in the one at its
end, and every row is due there. Nothing is said between.

Who waits for a message that lags waits for the newest that the run has, `Leaps.newest`. Where the clock leaps nobody
has to be told: messages of a topic come in their order, so that a stamp beyond the next one of a row that comes at the
pace of its listener tells him that all between are not in the run (`LeapWatch`). A gap that does not go from a whole
second to a whole second is none: what is lost there is waited for, and said again. In a run that does not ask for leaps
any gap is a fault, as ever.
"""

from bisect import bisect_left
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import lcm

from sojourn_contract.errors import LeapError
from sojourn_contract.stamps import CONTROL_PERIOD_NS, seconds
from sojourn_contract.topic_types import Topic

BEGIN = 50
"""A leap begins at a multiple of so many control periods, and lands at one."""
REMEMBERED = 200
"""Periods heard that are remembered: many times those that may be said again."""


@dataclass(frozen=True, slots=True)
class Leaps:
    """Those of a run so far. A value: each change is a new one."""

    gaps: tuple[tuple[int, int], ...] = ()
    """Control period before each of them and the one in which it lands, in their order."""

    def with_leap(self, begin: int, end: int) -> "Leaps":
        """With another."""
        return replace(self, gaps=tuple(sorted((*self.gaps, (begin, end)))))

    def newest(self, period: int, every: int = 1) -> int:
        """The newest control period, no later than this one, that the run has and that is a multiple of `every`; 0
        where there is none.
        """
        found = period - period % every
        while True:
            number = bisect_left(self.gaps, (found, 0))
            if not number:
                return max(found, 0)
            begin, end = self.gaps[number - 1]
            if found >= end:
                return found
            found = begin - begin % every

    def after(self, period: int) -> int:
        """The control period after one that the run has."""
        number = bisect_left(self.gaps, (period, 0))
        if number < len(self.gaps) and self.gaps[number][0] == period:
            return self.gaps[number][1]
        return period + 1

    def before(self, period: int) -> int:
        """The control period before one that the run has."""
        return self.newest(period - 1)

    def lagging(self, stamp: int, lag: int) -> int:
        """The stamp that is so many control periods before another [ns], or the newest before it that the run has."""
        return self.newest(stamp // CONTROL_PERIOD_NS - lag) * CONTROL_PERIOD_NS

    def stamps(self, every: int, begin: int, end: int) -> Iterator[int]:
        """Those of the run with begin < stamp <= end [ns] that are multiples of so many control periods."""
        grid = every * CONTROL_PERIOD_NS
        wanted = (begin // grid + 1) * grid
        for before, after in self.gaps:
            if after * CONTROL_PERIOD_NS > wanted:
                yield from range(wanted, min(before * CONTROL_PERIOD_NS, end) + 1, grid)
                wanted = -(-after * CONTROL_PERIOD_NS // grid) * grid
        yield from range(wanted, end + 1, grid)

    def count(self, last: int, every: int = 1) -> int:
        """How many control periods, 1 to `last`, the run has that are multiples of `every`."""
        last = self.newest(last)
        missed = sum((end - 1) // every - begin // every for begin, end in self.gaps if end <= last)
        return last // every - missed


NO_LEAPS = Leaps()
"""Of a run whose clock tells every period."""


class LeapWatch:
    """Tells a leap by the periods that are heard of one row, also where some are lost and said again. Where that in
    which one leap lands and the next begins is lost, both are one.

    Args:
        stride: periods from one to the next where there is no leap. heard: the last one that was heard; 0: none.
    """

    def __init__(self, stride: int = 1, heard: int = 0) -> None:
        self._stride = stride
        self._heard = [heard] if heard else []
        """In their order, which is that of the run."""

    def hear(self, period: int) -> tuple[int, int] | None:
        """The period before a leap and the one in which it lands, if it is this one that tells of it."""
        heard = self._heard
        place, is_late = bisect_left(heard, period), bool(heard) and period <= heard[-1]
        before = heard[place - 1] if place else period
        after = heard[place] if is_late else period
        if is_late and (after == period or not place or self._is_leap(before, after)):  # older than all, or told
            return None
        heard.insert(place, period)
        del heard[:-REMEMBERED]
        return next((gap for gap in ((before, period), (period, after)) if self._is_leap(*gap)), None)

    def _is_leap(self, begin: int, end: int) -> bool:
        return end > begin + self._stride and may_be_leap(begin, end)


def may_be_leap(begin: int, end: int) -> bool:
    """Whether a gap from one control period to another may be a leap."""
    return begin % BEGIN == 0 and end % BEGIN == 0


def leaps_of(clock: Iterable[int]) -> Leaps:
    """Of a run, by the stamps of its clock [ns] in their order; what the clock lacks besides is no leap."""
    periods = [stamp // CONTROL_PERIOD_NS for stamp in clock]
    return Leaps(tuple(gap for gap in pairwise(periods) if gap[1] > gap[0] + 1 and may_be_leap(*gap)))


def landing_grid(rows: Iterable[Topic]) -> int:
    """Control periods of which a landing is a multiple, in a run with these rows.

    Raises:
        LeapError: a row that does not let the clock leap.
    """
    periodic = [row for row in rows if not row.is_event]
    for row in periodic:
        period = f"{seconds(row.every * CONTROL_PERIOD_NS):g} s"
        if row.delivery is not None:
            raise LeapError(f"{row.name} is heard later than it is measured", "a sensor without timing and dropouts")
        if BEGIN % row.every and row.every % BEGIN:
            raise LeapError(f"{row.name} comes each {period}", "a divisor or a multiple of 1 s")
    return lcm(BEGIN, *(row.every for row in periodic))
