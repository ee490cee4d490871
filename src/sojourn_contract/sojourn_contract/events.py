"""Operator's goals: when they take effect, and when they are refused for their stamp.

A goal takes effect at its stamp or when it arrives, whichever is later; stamp zero means now. A scripted
operator stamps its goals some periods ahead, so that a lock-step run is the same every time.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import is_count
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_types import Topic

MAX_AHEAD_S = 3600.0
"""A goal stamped further ahead than this is refused [s]: its sender's clock is not the simulation's."""


@dataclass(frozen=True, slots=True)
class EventQueue:
    """Goals that wait for their period, in order of effect, and among equals of arrival. A value: each change is a new
    one.
    """

    waiting: tuple[tuple[int, int, str, Any], ...] = ()
    """Stamp from which it takes effect [ns], number of its arrival, topic, message."""
    arrivals: int = 0
    received: Mapping[str, int] = field(default_factory=dict)
    """Goals that have arrived on each topic, good or bad."""

    def counted(self, row: Topic) -> "EventQueue":
        """One more goal has arrived, good or bad."""
        return replace(self, received={**self.received, row.name: self.received.get(row.name, 0) + 1})

    def offered(self, row: Topic, stamp: int, now: int, message: Any) -> "EventQueue":
        """With a goal stamped `stamp` [ns] that arrived at simulation time `now` [ns].

        Raises RefusedMessageError if it is older than the row allows, or stamped by another clock than
        ours. A node that has not acted yet (`now` zero) does not know the time and takes any stamp.
        """
        if stamp and stamp < now - int(row.max_age_s * NANOSECONDS):
            raise RefusedMessageError(
                row.name,
                "header.stamp",
                f"{stamp / NANOSECONDS:.2f} s",
                f"zero, or later than {now / NANOSECONDS - row.max_age_s:.2f} s",
            )
        if now and stamp > now + int(MAX_AHEAD_S * NANOSECONDS):
            raise RefusedMessageError(
                row.name,
                "header.stamp",
                f"{stamp / NANOSECONDS:.2f} s",
                f"simulation time: zero, or at most {MAX_AHEAD_S:.0f} s after {now / NANOSECONDS:.2f} s",
            )
        arrivals = self.arrivals + 1
        entry = (max(stamp, now), arrivals, row.name, message)
        return replace(self, waiting=_in_order((*self.waiting, entry)), arrivals=arrivals)

    def taken(self, now: int) -> tuple["EventQueue", list[tuple[str, Any]]]:
        """What is left, and the goals that take effect at the period stamped `now` [ns], as (topic, message)."""
        ready = 0
        while ready < len(self.waiting) and self.waiting[ready][0] <= now:
            ready += 1
        if not ready:
            return self, []
        goals = [(name, message) for _, _, name, message in self.waiting[:ready]]
        return replace(self, waiting=self.waiting[ready:]), goals

    def begun_anew(self, now: int) -> "EventQueue":
        """The clock was wrong, and it is `now` [ns]: what waits for a time that will not come takes effect now."""
        latest = now + int(MAX_AHEAD_S * NANOSECONDS)
        moved = tuple((stamp if stamp <= latest else now, *rest) for stamp, *rest in self.waiting)
        return replace(self, waiting=_in_order(moved))

    def has_received(self, counts: Mapping[str, int]) -> bool:
        """Whether at least so many goals have come on each topic."""
        return all(self.received.get(name, 0) >= count for name, count in counts.items())


def _in_order(entries: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(sorted(entries, key=lambda entry: entry[:2]))


RESTS = "rests_until"
"""In the text of a tick: until when the operator wants nothing."""


def format_tick(counts: dict[str, int], end: bool, rests_until: int = 0) -> str:
    """Text of /operator/tick: how many goals have been sent on each topic, whether the run ends, and the whole second
    of simulation time until which no goal is on its way and none will be sent; 0 where that cannot be said.
    """
    parts = [f"{name}={count}" for name, count in sorted(counts.items())]
    rests = [f"{RESTS}={rests_until}"] if rests_until else []
    return ";".join((["end"] if end else []) + rests + parts)


def rests_until(text: str) -> int:
    """From a tick's text: the second until which the operator wants nothing, 0 where it does not say so."""
    found = [part.partition("=")[2] for part in text.split(";") if part.startswith(f"{RESTS}=")]
    return int(found[0]) if found and is_count(found[0]) else 0


def parse_tick(text: str) -> tuple[dict[str, int], bool]:
    """Counts and end flag of a tick's text. Raises RefusedMessageError for anything else."""
    counts: dict[str, int] = {}
    end = False
    for part in filter(None, text.split(";")):
        name, equals, count = part.partition("=")
        if part == "end":
            end = True
        elif name == RESTS and is_count(count):
            continue
        elif equals and is_count(count):
            counts[name] = int(count)
        else:
            raise RefusedMessageError("/operator/tick", "frame_id", text, "'end' and TOPIC=COUNT, separated by ';'")
    return counts, end
