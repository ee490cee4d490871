"""Proves that a bag is complete: messages published, as the nodes count them, against messages written.

Each heartbeat carries its node's counters, and the last one says `ended`. In lock-step the topic table also
says how many messages of each row are due by the last period of the run.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from sojourn_contract.heartbeat import ENDED, HEARTBEAT_PERIODS, STALLED, Heartbeat
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Reliability, Topic

RECORD = "sojourn_completeness"
"""Name of the metadata record in the bag."""
FOREIGN = "foreign"
"""In it: topics that hold messages which their publisher has not sent, and how many."""
SHOWN = 3
"""Topics that a sentence names."""
NOT_COUNTED = 2 * HEARTBEAT_PERIODS
"""Control periods of which a publisher that was killed may not have counted its messages."""


@dataclass(frozen=True)
class Count:
    """One topic's account.

    Args:
        published: messages sent, as the sender counts them; None where no sender counts.
        recorded: messages in the bag. due: messages that lock-step asks for, None elsewhere.
        may_be_lost: the topic's quality of service allows loss, so that a gap is no failure.
        foreign: messages that others than its publisher have sent, where there are more than a publisher that has been
            killed may not have counted; else 0.
    """

    published: int | None
    recorded: int
    due: int | None = None
    may_be_lost: bool = False
    foreign: int = 0

    @property
    def lost(self) -> int:
        """Messages that should be in the bag and are not."""
        return max(0, self.recorded, self.published or 0, self.due or 0) - self.recorded


HEARTBEATS = "/diagnostics"
OUTSIDE_THE_RECORD = (STALLED, ENDED)
"""States of heartbeats that come when the wall clock has them come. In a record they would make two of the same run
differ.
"""


class PublishedCounts:
    """Adds up the counters of all nodes' heartbeats. A node that starts again counts from zero again."""

    def __init__(self) -> None:
        self._latest: dict[str, dict[str, int]] = {}
        self._before_restart: dict[str, int] = {}
        self._ended: dict[str, int] = {}

    def hear(self, heartbeat: Heartbeat) -> None:
        """Take a heartbeat of the run."""
        latest = self._latest.get(heartbeat.role, {})
        if heartbeat.state in OUTSIDE_THE_RECORD:  # whether its sender counts it or not
            counts = {**heartbeat.published, HEARTBEATS: latest.get(HEARTBEATS, 0)}
            heartbeat = replace(heartbeat, published=counts)
        if sum(heartbeat.published.values()) < sum(latest.values()):
            for topic, count in latest.items():
                self._before_restart[topic] = self._before_restart.get(topic, 0) + count
            self._ended.pop(heartbeat.role, None)
        self._latest[heartbeat.role] = heartbeat.published
        if heartbeat.state == ENDED:
            self._ended[heartbeat.role] = heartbeat.stamp

    def totals(self) -> dict[str, int]:
        """Messages published so far, by topic."""
        totals = dict(self._before_restart)
        for counts in self._latest.values():
            for topic, count in counts.items():
                totals[topic] = totals.get(topic, 0) + count
        return totals

    def has_ended(self, roles: Iterable[str]) -> bool:
        """Whether all of these nodes have said farewell."""
        return all(role in self._ended for role in roles)


@dataclass(frozen=True)
class Completeness:
    """Account of a whole bag, by topic."""

    counts: Mapping[str, Count]

    @property
    def gaps(self) -> dict[str, Count]:
        """Topics that lack messages which their quality of service does not allow to lose."""
        return {name: count for name, count in self.counts.items() if count.lost and not count.may_be_lost}

    def explain(self) -> str:
        """The gaps in words, "" where there are none."""
        lines = []
        for name, count in self.gaps.items():
            published = "an unknown number" if count.published is None else str(count.published)
            due = "" if count.due is None else f", {count.due} due"
            lines.append(f"{name}: {count.recorded} recorded of {published} published{due}")
        return "; ".join(lines)

    @property
    def foreign(self) -> str:
        """Topics on which others have spoken than those whose they are, in words; "" where nobody has."""
        found = [
            f"{name} ({count.foreign} of {count.recorded})" for name, count in self.counts.items() if count.foreign
        ]
        return ", ".join(found)

    def as_record(self) -> dict[str, str]:
        """Metadata record for the bag."""
        topics = {
            name: {"published": count.published, "recorded": count.recorded, "due": count.due}
            for name, count in self.counts.items()
        }
        return {
            "complete": "false" if self.gaps else "true",
            "gaps": self.explain(),
            "topics": json.dumps(topics),
            **({FOREIGN: self.foreign} if self.foreign else {}),
        }


def published_by(record: Mapping[str, str]) -> dict[str, int | None] | None:
    """Messages published, by topic, as the record of a bag has them (None where nobody counted); None where it cannot
    be read: nothing in a file guards a metadata record.
    """
    return _counted(record, "published")


def miscounted(record: Mapping[str, str], found: Mapping[str, int], thinned: bool = False) -> str:
    """In words, of which topics more or fewer messages have been read than the recorder has written; "" where it is as
    many, or nothing can be read of how many it has written.

    Args:
        record: of the bag. found: messages read, by topic. thinned: whether the bag lacks topics on purpose.
    """
    recorded = _counted(record, "recorded") or {}
    wrong = {name: count for name, count in recorded.items() if count is not None and count != found.get(name, 0)}
    lines = [
        f"{name} ({found.get(name, 0)} of {count})" for name, count in wrong.items() if not thinned or found.get(name)
    ]
    if not lines:
        return ""
    more = f" and {len(lines) - SHOWN} more topics" if len(lines) > SHOWN else ""
    return f"it does not hold as many messages as the recorder wrote of {', '.join(lines[:SHOWN])}{more}"


def why_incomplete(record: Mapping[str, str] | None) -> str:
    """What an account says against a bag, in words; "" where it says that all is there.

    Args:
        record: of the bag, None where it has none.
    """
    if record is None:
        return "the recorder has left no account in it"
    if published_by(record) is None:
        return "the recorder's account in it cannot be read"
    if record.get("complete") == "true":
        return ""
    gaps = [line for line in record.get("gaps", "").split("; ") if line]
    more = f" and {len(gaps) - SHOWN} more topics" if len(gaps) > SHOWN else ""
    return f"{'; '.join(gaps[:SHOWN])}{more}" or "the recorder says so, and not why"


def _counted(record: Mapping[str, str], which: str) -> dict[str, int | None] | None:
    try:
        counts = {str(name): count[which] for name, count in json.loads(record.get("topics", "{}")).items()}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None
    return counts if all(count is None or type(count) is int for count in counts.values()) else None


def account(
    rows: Iterable[Topic],
    recorded: Mapping[str, int],
    published: Mapping[str, int],
    last_stamp: int | None,
    lockstep_rows: Iterable[Topic] = (),
    before: Mapping[str, int] | None = None,
    leaps: Leaps = NO_LEAPS,
) -> Completeness:
    """Account of a run.

    Args:
        rows: topics that the recorder listens to.
        recorded, published: messages by topic.
        last_stamp: stamp [ns] of the last period of the run in lock-step, None in real time.
        lockstep_rows: rows of the table whose messages lock-step demands.
        before: messages by topic that belong to the time before the record; none where it is of the whole run.
        leaps: of the clock, in the record.
    """
    due = {row.name: due_by(row, last_stamp, leaps) for row in lockstep_rows} if last_stamp is not None else {}
    counts = {}
    for row in rows:
        earlier = (before or {}).get(row.name, 0)
        sent, kept = _later(published.get(row.name), earlier), recorded.get(row.name, 0)
        count = Count(
            sent,
            kept,
            _later(due.get(row.name), earlier),
            row.reliability is Reliability.BEST_EFFORT or (row.name == "/clock" and last_stamp is None),
            _foreign(row, sent, kept),
        )
        if count.published or count.recorded or count.due:
            counts[row.name] = count
    return Completeness(counts)


def _foreign(row: Topic, sent: int | None, kept: int) -> int:
    """Messages of a row that its publisher has not sent. Goals and heartbeats are anybody's."""
    if row.is_event or row.publisher == "all" or sent is None:
        return 0
    more = kept - sent
    return more if more > NOT_COUNTED // row.every + 1 else 0


def _later(count: int | None, earlier: int) -> int | None:
    """Of a count since the start of the run what is later than the first so many."""
    return None if count is None else max(count - earlier, 0)


def due_by(row: Topic, last_stamp: int, leaps: Leaps = NO_LEAPS) -> int:
    """Messages of a periodic row that somebody has waited for by this stamp [ns]."""
    if row.delivery is not None:
        return sum(1 for _ in row.delivery.departures(last_stamp // CONTROL_PERIOD_NS))
    return leaps.count(last_stamp // CONTROL_PERIOD_NS - row.lag, row.every)
