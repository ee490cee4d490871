"""A bag played as if it were a run: time goes on, stands still, goes on faster, or jumps."""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.definitions import full_type
from sojourn_bags.reading import Bag
from sojourn_console.errors import GoalError
from sojourn_console.feed import FeedMessage
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message

STEP_NS = 20_000_000
"""Of one step: a control period."""


class BagFeed:
    """Plays a bag. Time goes on by `advance`, which whoever shows it calls with the wall time that has passed.

    Args:
        bag: read. table: topics of its run; what the bag holds besides is not played.
    """

    def __init__(self, bag: Bag, table: TopicTable) -> None:
        self._rows: dict[str, Topic] = {}
        self._times: dict[str, NDArray[np.int64]] = {}
        self._data: dict[str, list[bytes]] = {}
        for row in table:
            messages = bag.topics.get(row.name)
            if messages is not None and len(messages) and messages.type == full_type(row.type):
                times = np.array(messages.log_times, dtype=np.int64)
                order = np.argsort(times, kind="stable")
                self._rows[row.name], self._times[row.name] = row, times[order]
                self._data[row.name] = [messages.data[place] for place in order]
        self.begin = min((int(times[0]) for times in self._times.values()), default=0)
        self.end = max((int(times[-1]) for times in self._times.values()), default=0)
        self.now = self.begin
        self.speed = 1.0
        self.is_playing = True
        self._looked_at: frozenset[str] = frozenset()
        self._in_full: frozenset[str] = frozenset()
        self._said: dict[str, int] = {}
        """Of each topic how many messages have been given."""
        self._jumped = False

    def advance(self, wall_s: float) -> None:
        """So much wall time is over [s]."""
        if self.is_playing:
            self.now = min(self.now + round(wall_s * self.speed * 1e9), self.end)
            self.is_playing = self.now < self.end

    def step(self, periods: int = 1) -> None:
        """Go on by some control periods, or back, and stand still there."""
        self.is_playing = False
        target = min(max(self.now + periods * STEP_NS, self.begin), self.end)
        if periods < 0:
            self.jump(target)
        self.now = target

    def jump(self, time: int) -> None:
        """Go to a time [ns]."""
        self.now = min(max(time, self.begin), self.end)
        self._said.clear()
        self._jumped = True

    def poll(self) -> list[FeedMessage]:
        found: list[FeedMessage] = []
        for name in self._looked_at & self._rows.keys():
            times = self._times[name]
            upto, before = int(np.searchsorted(times, self.now, side="right")), self._said.get(name, 0)
            if upto == before:
                continue
            self._said[name] = upto
            first = before if name in self._in_full else upto - 1
            row, data = self._rows[name], self._data[name]
            found += [FeedMessage(row, data[place], int(times[place])) for place in range(first, upto)]
        return sorted(found, key=lambda heard: heard.time)

    def want(self, looked_at: Collection[str], in_full: Collection[str]) -> None:
        for name in set(in_full) - self._in_full:
            self._said.pop(name, None)  # from the beginning, as a bag can
        self._looked_at, self._in_full = frozenset((*looked_at, *in_full)), frozenset(in_full)

    def has_jumped(self) -> bool:
        jumped, self._jumped = self._jumped, False
        return jumped

    def silence(self) -> str:
        return ""

    def refusal(self) -> str:
        return "a bag is played: it has happened"

    def send(self, name: str, message: Message) -> None:
        raise GoalError(name, self.refusal())

    def close(self) -> None:
        return
