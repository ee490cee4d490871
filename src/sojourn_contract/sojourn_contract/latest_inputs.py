"""What a node acts on in real time: the last message of each periodic input, as long as it is young enough."""

from collections.abc import Sequence
from typing import Any

from sojourn_contract import stamps
from sojourn_contract.timeline import LONGEST_AHEAD_NS, Timeline, ahead_ns
from sojourn_contract.topic_table import CLOCK
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES


class LatestInputs:
    """The last message of each input.

    Args:
        rows: the periodic inputs.
    """

    def __init__(self, rows: Sequence[Topic]) -> None:
        self.timeline = Timeline()
        """Simulation time as the inputs tell it."""
        self._rows = tuple(rows)
        self._kept: dict[str, tuple[int, Any]] = {}
        """Stamp [ns] and content by topic; None where it was refused."""

    def hear(self, row: Topic, stamp: int, heard: float) -> tuple[str | None, bool]:
        """Take note of a stamp [ns] that came at a wall time [s]: what is allowed where its message cannot be taken;
        whether the timeline begins anew with it.
        """
        resets = self.timeline.resets
        refusal = self.timeline.hear(stamp, _period(row), row.max_age_s, heard)
        return refusal, self.timeline.resets > resets

    def repeats(self, row: Topic, stamp: int, now: int) -> str | None:
        """What is allowed after the last message of a row; one from ahead of the time `now` [ns] blocks no other."""
        last = self.stamp_of(row.name)
        if stamp == last or (stamp < last <= now + _period(row)):
            return f"after {last / 1e9:.3f} s, that of the last one"
        return None

    def stamp_of(self, name: str) -> int:
        """Of the last message of a topic [ns]; zero where there was none."""
        return self._kept.get(name, (0, None))[0]

    def keep(self, row: Topic, stamp: int, message: Any) -> None:
        """Keep a message as the last one of its row; None for one that was refused."""
        self._kept[row.name] = (stamp, message)

    def begin_anew(self, stamp: int) -> None:
        """The time was wrong, it is `stamp` [ns]: forget what is from ahead of it."""
        self._kept = {name: kept for name, kept in self._kept.items() if kept[0] <= stamp + LONGEST_AHEAD_NS}

    def at(self, stamp: int) -> dict[str, Any]:
        """The last message of every input; None for one that is older than its row allows at `stamp` [ns], and for
        one from ahead of it, which would never age.
        """
        inputs: dict[str, Any] = {}
        for row in self._rows:
            sent, message = self._kept.get(row.name, (0, None))
            ahead = sent > stamp + ahead_ns(_period(row))
            lost = ahead or (stamp - sent) / stamps.NANOSECONDS > row.max_age_s
            inputs[row.name] = None if lost else message
        return inputs


def _period(row: Topic) -> int:
    """Of a row [ns]."""
    return row.every * stamps.CONTROL_PERIOD_NS


def trigger_of(awaited: Sequence[Topic]) -> str:
    """In real time: the input on which a node acts. Of the fastest ones that of the earliest role of a period: a node
    that is down, and started again, does not keep those after it from acting. One that may come late is none where
    another comes in time, were it the clock. Empty where nothing is awaited.
    """
    if not awaited:
        return ""
    awaited = [row for row in awaited if row.delivery is None] or awaited
    fastest = min(row.every for row in awaited)
    rows = [row for row in awaited if row.every == fastest]
    rows = [row for row in rows if row.name != CLOCK] or rows
    first = min((row.publisher for row in rows), key=ROLES.index)
    return [row.name for row in rows if row.publisher == first][-1]
