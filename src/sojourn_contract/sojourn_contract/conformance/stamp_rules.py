"""Stamps: on the grid of their rate, growing, not too old and not ahead of the plant's clock."""

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.events import MAX_AHEAD_S
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS, seconds
from sojourn_contract.topic_types import Topic

STAMP = "header.stamp"
AHEAD_PERIODS = 5
"""A stamp so many periods ahead of /clock may be a message that overtook it; more is another clock than ours."""


class StampRule:
    """Stamps of one topic.

    Args:
        row: the topic. lockstep: mode of time. longest_leap: control periods by which the clock may leap.
    """

    name = "stamp"

    def __init__(self, row: Topic, lockstep: bool, longest_leap: int = 0) -> None:
        self._ahead = max(AHEAD_PERIODS, longest_leap) * CONTROL_PERIOD_NS
        self._row = row
        self._lockstep = lockstep
        # in real time a node that lost a message may skip to its next one, and stays on the control period
        self._grid = (row.every or 1) * CONTROL_PERIOD_NS if lockstep else CONTROL_PERIOD_NS
        self._last: dict[str, int] = {}

    def judge(self, seen: Observation) -> list[Finding]:
        """What is wrong with its stamp."""
        if self._row.is_event:
            return self._event(seen)
        found = []
        stamp = seen.stamp
        delivery = self._row.delivery
        if delivery is not None and (stamp % CONTROL_PERIOD_NS or not delivery.leaves(stamp // CONTROL_PERIOD_NS)):
            found.append(_finding(stamp, "that of a measurement whose message is not lost"))
        elif delivery is None and (stamp <= 0 or stamp % self._grid):
            found.append(_finding(stamp, f"a multiple of {seconds(self._grid):g} s, above zero"))
        sender = seen.message.status[0].name if self._row.publisher == "all" and seen.message.status else ""
        last = self._last.get(sender, 0)
        if last and stamp <= last:
            found.append(_finding(stamp, f"after {seconds(last):.2f} s, the stamp of the last one", last - stamp))
        self._last[sender] = max(stamp, last)
        return found + self._against_time(seen)

    def _against_time(self, seen: Observation) -> list[Finding]:
        """Too old where it was filed, or by the clock; or ahead of it."""
        latest = seen.clock + self._ahead
        if seen.clock and seen.stamp > latest:
            return [_finding(seen.stamp, f"{seconds(latest):.2f} s at most, by /clock", seen.stamp - latest)]
        limit_s = self._late(seen.stamp) if self._lockstep else self._row.max_age_s
        if seen.logged is not None:
            return _too_old(seen.logged - seen.stamp, limit_s)
        return [] if self._lockstep or not seen.clock else _too_old(seen.clock - seen.stamp, limit_s)

    def _late(self, stamp: int) -> float:
        """By how much a message is later than its stamp [ns] in lock-step [s]."""
        if self._row.delivery is None:
            return 0.0
        leaves = self._row.delivery.leaves(stamp // CONTROL_PERIOD_NS)
        return max(0.0, seconds(leaves * CONTROL_PERIOD_NS - stamp))

    def _event(self, seen: Observation) -> list[Finding]:
        """A goal: zero, or not too old, and of the simulation's time."""
        now = seen.logged if seen.logged is not None else seen.clock
        if seen.stamp == 0 or not now:
            return []
        if seen.stamp < 0 or seen.stamp > now + int(MAX_AHEAD_S * NANOSECONDS):
            return [_finding(seen.stamp, f"zero, or at most {MAX_AHEAD_S:.0f} s after {seconds(now):.2f} s")]
        return _too_old(now - seen.stamp, self._row.max_age_s)


def _too_old(age: int, limit_s: float) -> list[Finding]:
    age_s = seconds(age)
    if age_s <= limit_s:
        return []
    return [Finding("age", f"{age_s:.3f} s", f"{limit_s:g} s at most", age_s - limit_s)]


def _finding(stamp: int, allowed: str, excess: float = float("inf")) -> Finding:
    return Finding(STAMP, f"{seconds(stamp):.9g} s", allowed, excess)
