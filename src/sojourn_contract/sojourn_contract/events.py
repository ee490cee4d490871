"""Operator's goals: when they take effect, and when they are refused for their stamp.

A goal takes effect at its stamp or when it arrives, whichever is later; stamp zero means now. A scripted
operator stamps its goals some periods ahead, so that a lock-step run is the same every time.
"""

from typing import Any

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_types import Topic

MAX_AHEAD_S = 3600.0
"""A goal stamped further ahead than this is refused [s]: its sender's clock is not the simulation's."""


class EventQueue:
    """Goals that wait for their period, in order of effect, and among equals of arrival."""

    def __init__(self) -> None:
        self._waiting: list[tuple[int, int, str, Any]] = []
        self._arrivals = 0
        self.received: dict[str, int] = {}

    def count(self, row: Topic) -> None:
        """One more goal has arrived, good or bad."""
        self.received[row.name] = self.received.get(row.name, 0) + 1

    def offer(self, row: Topic, stamp: int, now: int, message: Any) -> None:
        """Queue a goal stamped `stamp` [ns] that arrived at simulation time `now` [ns].

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
        self._arrivals += 1
        self._waiting.append((max(stamp, now), self._arrivals, row.name, message))
        self._waiting.sort(key=lambda entry: entry[:2])

    def take(self, now: int) -> list[tuple[str, Any]]:
        """Goals that take effect at the period stamped `now` [ns], as (topic, message)."""
        ready = 0
        while ready < len(self._waiting) and self._waiting[ready][0] <= now:
            ready += 1
        taken = [(name, message) for _, _, name, message in self._waiting[:ready]]
        del self._waiting[:ready]
        return taken

    def has_received(self, counts: dict[str, int]) -> bool:
        """Whether at least so many goals have come on each topic."""
        return all(self.received.get(name, 0) >= count for name, count in counts.items())


def format_tick(counts: dict[str, int], end: bool) -> str:
    """Text of /operator/tick: how many goals have been sent on each topic, and whether the run ends."""
    parts = [f"{name}={count}" for name, count in sorted(counts.items())]
    return ";".join((["end"] if end else []) + parts)


def parse_tick(text: str) -> tuple[dict[str, int], bool]:
    """Counts and end flag of a tick's text. Raises RefusedMessageError for anything else."""
    counts: dict[str, int] = {}
    end = False
    for part in filter(None, text.split(";")):
        name, equals, count = part.partition("=")
        if part == "end":
            end = True
        elif equals and count.isdecimal():
            counts[name] = int(count)
        else:
            raise RefusedMessageError("/operator/tick", "frame_id", text, "'end' and TOPIC=COUNT, separated by ';'")
    return counts, end
