"""What a candidate has answered so far, and whether the next period may begin. No ROS in here.

A message on a topic comes in order: once a later one has come, an earlier one that is missing never will. So a
due answer is settled when a message with its stamp or a later one is here. A candidate that answers late, stamps
too old or leaves messages out is not waited for again and again: after a moment its topic may lag by a period
more, up to MOST_LAG, and where others of its topics go on even longer. Only one that says nothing any more is
silent.
"""

from collections.abc import Mapping, Sequence

from sojourn_bags.definitions import full_type
from sojourn_bags.messages import Messages
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import STANDARD

MOST_LAG = 5
"""Periods that the inputs may be ahead of a topic's answers. Under the depth of the topics' queues, so that a slow
candidate loses nothing."""


class Answers:
    """Messages of the candidate by topic.

    Args:
        due: stamps [ns] at which the run has an answer, by topic, rising; a range where nobody knows how long the run
            will be. lead: periods by which answers are stamped later than what they answer.
        table: the topics of the run.
    """

    def __init__(self, due: Mapping[str, Sequence[int]], lead: int, table: TopicTable = STANDARD) -> None:
        self._table = table
        self.newest = 0
        """Latest stamp of all [ns]."""
        self.count = 0
        """Messages so far."""
        self._lead = lead
        self._due = dict(due)
        self._place = dict.fromkeys(self._due, 0)
        self._latest = dict.fromkeys(self._due, 0)
        self._lag = dict.fromkeys(self._due, 0)
        self._given_up: set[str] = set()
        self._data: dict[str, list[bytes]] = {}
        self._stamps: dict[str, list[int]] = {}

    def take(self, name: str, stamp: int, data: bytes) -> None:
        """Take a message stamped `stamp` [ns]."""
        self.count += 1
        self._data.setdefault(name, []).append(data)
        self._stamps.setdefault(name, []).append(stamp)
        self.newest = max(self.newest, stamp)
        if stamp > self._latest.get(name, stamp):
            self._latest[name] = stamp
            self._given_up.discard(name)

    def missing(self, period: int) -> list[tuple[str, int]]:
        """Topics that must be waited for in this period, each with the stamp [ns] that is missing."""
        found = []
        for name, stamps in self._due.items():
            if name in self._given_up:
                continue
            until = (period + self._lead - self._lag[name]) * CONTROL_PERIOD_NS
            place, latest = self._place[name], self._latest[name]
            row = self._table.get(name)
            while place < len(stamps) and stamps[place] <= latest:
                place += 1
            self._place[name] = place
            if place < len(stamps) and (stamps[place] if row is None else row.heard_at(stamps[place])) <= until:
                found.append((name, stamps[place]))
        return found

    def unsettled(self) -> bool:
        """Whether anything that is due at all is still to come."""
        return any(
            stamps and stamps[-1] > self._latest[name]
            for name, stamps in self._due.items()
            if name not in self._given_up
        )

    def be_patient(self, period: int) -> bool:
        """A moment has passed: let the topics that are missing lag more. Whether that helps.

        It does not where all of them lag by the most already, and the candidate says nothing newer elsewhere.
        """
        helped = False
        for name, stamp in self.missing(period):
            if self._lag[name] < MOST_LAG:
                self._lag[name] += 1
                helped = True
            elif self.newest > stamp:
                self._given_up.add(name)
                helped = True
        return helped

    def messages(self) -> dict[str, Messages]:
        """Everything that has come, by topic, in order of arrival."""
        return {
            name: Messages(name, full_type(self._table.topic(name).type), list(self._stamps[name]), list(data))
            for name, data in self._data.items()
        }
