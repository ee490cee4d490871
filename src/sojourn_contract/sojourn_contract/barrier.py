"""The lock-step barrier: which inputs of a role are due at which stamp, and whether they are all in.

No ROS in here: messages are opaque. A role acts at every stamp at which at least one of its periodic inputs
is due, and it acts once all that are due have arrived. Events (goals) are queued apart, see `events.py`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import gcd
from typing import Generic, TypeVar

from sojourn_contract.delivery import Delivery
from sojourn_contract.errors import LeapError
from sojourn_contract.leaps import NO_LEAPS, Leaps, LeapWatch
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topic_table import CLOCK, TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import STANDARD

Message = TypeVar("Message")

MAX_PENDING_PERIODS = 512
"""A message further ahead than this is refused: its sender's clock is not ours."""
LONGEST_AGE_S = 1e6
"""For which a message counts that never ages [s]."""


def awaited_inputs(role: str, participants: Iterable[str], table: TopicTable = STANDARD) -> tuple[Topic, ...]:
    """Periodic inputs of `role` in a table that one of the participants publishes: the ones worth waiting for.

    The recorder writes a period when it is complete, so for it no row is pipelined.
    """
    roles = set(participants)
    present = roles - {role}
    rows = tuple(row for row in table.inputs_of(role, roles | {role}) if not row.is_event and row.publisher in present)
    return tuple(replace(row, lag=0) for row in rows) if role == "recorder" else rows


def is_due(row: Topic, period: int) -> bool:
    """Whether the consumer at control period `period` (1, 2, ...) needs a message of this row."""
    if row.delivery is not None:
        return period % row.pace == 0 and stamp_due(row, period) > 0
    return period % row.every == 0 and period > row.lag


def stamp_due(row: Topic, period: int, leaps: Leaps = NO_LEAPS) -> int:
    """Stamp [ns] that the message needed at control period `period` carries: of a row with a delivery the newest that
    has left and is not too old, zero where there is none; of one that lags the newest that a clock which leaps has.
    """
    if row.delivery is not None:
        return row.delivery.newest(period, oldest_age(row)) * CONTROL_PERIOD_NS
    due = period - row.lag
    return (leaps.newest(due, row.every) if leaps.gaps else due) * CONTROL_PERIOD_NS


def oldest_age(row: Topic) -> int:
    """Control periods for which a message of a row counts."""
    return int(min(row.max_age_s, LONGEST_AGE_S) * NANOSECONDS) // CONTROL_PERIOD_NS


@dataclass
class Barrier(Generic[Message]):
    """Collects the stamped inputs of one role.

    Args:
        awaited: rows that the role waits for, as `awaited_inputs` gives them.
        every_period: act at every control period, even where no input is due (the plant).
        longest_leap: control periods by which the clock may leap, 0 where it does not.

    Attributes:
        leaps: of the clock, as far as they are known.

    Raises:
        LeapError: the clock leaps, and nothing that is waited for would tell of it.
    """

    awaited: tuple[Topic, ...]
    every_period: bool = False
    longest_leap: int = 0
    leaps: Leaps = field(default=NO_LEAPS, init=False)
    _messages: dict[str, dict[int, Message]] = field(default_factory=dict, init=False)
    _pacer: str = field(default="", init=False)
    """Row whose stamps tell of a leap."""
    _watch: LeapWatch = field(init=False)
    """Of it."""

    def __post_init__(self) -> None:
        paces = [row.pace for row in self.awaited if row.name != CLOCK]
        self.stride = 1 if self.every_period or not paces else gcd(*paces)
        self.period = self.stride
        self._messages = {row.name: {} for row in self.awaited}
        self._watch = LeapWatch(self.stride)
        if self.longest_leap and self.awaited and not self.every_period:
            self._pacer = next((row.name for row in self.awaited if row.every == self.stride and not row.lag), "")
            if not self._pacer:
                names = ", ".join(row.name for row in self.awaited)
                raise LeapError(f"the clock would not be told by {names}", "a run with a node that publishes more")

    @property
    def stamp(self) -> int:
        """Stamp [ns] of the period that is waited for."""
        return self.period * CONTROL_PERIOD_NS

    def refusal(self, row: Topic, stamp: int) -> str | None:
        """Why a message with this stamp cannot be taken, or None."""
        if row.delivery is not None:
            return self._refusal_of_delivered(row.delivery, self._messages[row.name], stamp)
        grid = row.every * CONTROL_PERIOD_NS
        if stamp % grid:
            return f"a multiple of {grid / 1e9:.2f} s, its period"
        unheard = max(self.stride - row.pace, 0)  # of the clock, at which beats the role does not act
        first = self.period - row.lag - unheard
        if self.leaps.gaps:  # what has been said before a leap may come after it
            first = self.leaps.newest(first) - row.lag
        oldest = max(first, 1) * CONTROL_PERIOD_NS
        if stamp < oldest or self._messages[row.name].get(stamp) is not None:  # one that was refused may be replaced
            return f"newer than {oldest / 1e9 - 1e-9 * CONTROL_PERIOD_NS:.2f} s, once a stamp"
        ahead = MAX_PENDING_PERIODS + 2 * self.longest_leap  # its sender may be one leap ahead, and tell of the next
        if stamp > self.stamp + ahead * CONTROL_PERIOD_NS:
            return f"at most {ahead} periods ahead of {self.stamp / 1e9:.2f} s"
        return None

    def _refusal_of_delivered(
        self, delivery: Delivery, messages: Mapping[int, Message | None], stamp: int
    ) -> str | None:
        if stamp % CONTROL_PERIOD_NS or not delivery.leaves(stamp // CONTROL_PERIOD_NS):
            return "that of a measurement whose message is not lost"
        if stamp < min(messages, default=0) or messages.get(stamp) is not None:
            return "newer than those that have been taken, once a stamp"
        return None

    def lacks(self, row: Topic, stamp: int) -> bool:
        """Whether a message could be taken, and none with its stamp has come, not even one that was refused."""
        return stamp not in self._messages[row.name] and self.refusal(row, stamp) is None

    def repeats(self, row: Topic, stamp: int) -> bool:
        """Whether a message is no news: that of a sender whose clock has stopped, which the run's table knows of."""
        delivery = row.delivery
        stopped = delivery is not None and delivery.stands_at * CONTROL_PERIOD_NS == stamp
        return stopped and stamp in self._messages[row.name]

    def offer(self, row: Topic, stamp: int, message: Message) -> None:
        """Keep a message until its period, None for one that is refused. Ask `refusal` first."""
        self._messages[row.name][stamp] = message
        if row.name == self._pacer:
            leap = self._watch.hear(stamp // CONTROL_PERIOD_NS)
            if leap is not None:
                self._learn(*leap)

    def leap(self, begin: int, end: int) -> None:
        """Of a role that makes the time: after the control period `begin` comes `end`."""
        self._learn(begin, end)

    def go_on(self, period: int, leaps: Leaps) -> None:
        """Wait for what follows the last control period on which the role has acted, in a run whose clock leapt so."""
        self.leaps, self.period = leaps, 0
        self.period = self._next(period)
        landed = leaps.after(period) > period + 1  # of which its messages tell nothing new
        self._watch = LeapWatch(self.stride, 0 if landed else period)

    def _learn(self, begin: int, end: int) -> None:
        self.leaps = self.leaps.with_leap(begin, end)
        if begin < self.period <= end:
            self.period = end

    def peek(self, row: Topic) -> Message | None:
        """Message of `row` that is due now, if it has arrived."""
        if not is_due(row, self.period):
            return None
        return self._messages[row.name].get(stamp_due(row, self.period, self.leaps))

    def is_complete(self) -> bool:
        """Whether everything that is due now has arrived. Called for every message: no list, no call
        inside.
        """
        period = self.period
        if self.leaps.gaps:
            return not self.missing()
        for row in self.awaited:
            if row.delivery is not None:
                if is_due(row, period) and stamp_due(row, period) not in self._messages[row.name]:
                    return False
            elif (
                period % row.every == 0
                and period > row.lag
                and (period - row.lag) * CONTROL_PERIOD_NS not in self._messages[row.name]
            ):
                return False
        return True

    def missing(self) -> list[Topic]:
        """Rows that are due now and have not arrived."""
        return [
            row
            for row in self.awaited
            if is_due(row, self.period) and stamp_due(row, self.period, self.leaps) not in self._messages[row.name]
        ]

    def take(self) -> Mapping[str, Message]:
        """Messages of this period, by topic, and step to the next. Only when `missing` is empty."""
        period = self.period
        taken = {}
        for row in self.awaited:
            if not is_due(row, period):
                continue
            stamp, messages = stamp_due(row, period, self.leaps), self._messages[row.name]
            if row.lag and self.longest_leap:  # it may be the newest for a while
                taken[row.name] = messages[stamp]
                oldest = stamp
            elif row.delivery is None:
                taken[row.name] = messages.pop(stamp)
                oldest = stamp if row.pace < self.stride else 0  # it does not act at every beat of the clock
            else:  # until there is a newer one
                taken[row.name] = messages[stamp]
                oldest = stamp
            if oldest:
                self._messages[row.name] = {at: message for at, message in messages.items() if at >= stamp}
        self.period = self._next(period)
        return taken

    def _next(self, period: int) -> int:
        """First period after `period` at which the role acts: the end of a leap, or the next multiple of its stride."""
        landing = self.leaps.after(period)
        return landing if landing > period + 1 else (period // self.stride + 1) * self.stride
