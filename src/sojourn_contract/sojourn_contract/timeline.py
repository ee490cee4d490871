"""Simulation time as the inputs of a node tell it, in real time; and the stamps that do not fit it. No ROS in here.

Simulation time never runs faster than the wall's. A stamp further ahead of the time that is known than wall time has
passed is another clock's. The time that is known is the newest that *two* messages have reached: a single one that is
ahead moves nothing. Where the time is wrong all the same, as after a false first message or a plant that begins again,
the messages that are refused agree with each other: then they set it.
"""

from sojourn_contract.stamps import NANOSECONDS, seconds

LONGEST_AHEAD_NS = NANOSECONDS // 4
"""By how much a stamp may be ahead of what the wall allows at most [ns]."""
LONGEST_AGE_S = 3.0
"""Refused messages may be apart by this much and agree [s], where their rows ask for nothing."""
AGREEING = 3
"""Messages that must agree against the time that is known; against one that a single message has told, one less."""
PERSISTING_S = 0.2
"""Wall time for which they must, while nothing else fits."""


class Timeline:
    """The clock of one node.

    Attributes:
        now: the time that is known [ns]; 0 before the first message. resets: how often it has been set anew.
    """

    def __init__(self) -> None:
        self.now = 0
        self.resets = 0
        self._newest = 0
        self._moved_at = 0.0
        self._voices = 0
        self._strangers: list[tuple[int, float]] = []
        """Stamp [ns] and wall time [s] of messages that have been refused one after the other and agree."""

    def hear(self, stamp: int, period_ns: int, max_age_s: float, wall_s: float) -> str | None:
        """Take the stamp [ns] of a message that has come at wall time `wall_s` [s]. Returns what is allowed, None if it
        fits.

        Args:
            period_ns: of its topic [ns]. max_age_s: how old it may be.
        """
        if not self._voices:
            self._set(stamp, stamp, wall_s)
            return None
        latest = self.now + _elapsed(self._moved_at, wall_s) + ahead_ns(period_ns)
        age = seconds(self.now - stamp)
        if stamp <= latest and age <= max_age_s:
            if age <= LONGEST_AGE_S:  # an older one, where any age is allowed, says nothing of the time
                self._strangers.clear()
                self._voices += 1
                self._advance(stamp, wall_s)
            return None
        if self._outvoted(stamp, min(max_age_s, LONGEST_AGE_S), wall_s):
            before = self._strangers[-2][0]
            self._set(min(stamp, before), max(stamp, before), wall_s)
            self._voices = AGREEING
            self.resets += 1
            return None
        if stamp > latest:
            return f"simulation time, {seconds(latest):.3f} s at most"
        return f"{seconds(self.now) - max_age_s:.3f} s or later"

    def _advance(self, stamp: int, wall_s: float) -> None:
        """The time is the second newest stamp."""
        reached = min(stamp, self._newest)
        self._newest = max(stamp, self._newest)
        if reached > self.now:
            self.now, self._moved_at = reached, wall_s

    def _outvoted(self, stamp: int, max_age_s: float, wall_s: float) -> bool:
        """Whether refused messages have agreed for long enough against the time that is known."""
        if self._strangers:
            last, at = self._strangers[-1]
            if stamp > last + _elapsed(at, wall_s) + LONGEST_AHEAD_NS or seconds(last - stamp) > max_age_s:
                self._strangers.clear()
        self._strangers.append((stamp, wall_s))
        if self._voices == 1:
            return len(self._strangers) >= AGREEING - 1
        lasting = wall_s - self._strangers[0][1] >= PERSISTING_S
        return lasting and len(self._strangers) >= AGREEING

    def _set(self, now: int, newest: int, wall_s: float) -> None:
        self.now, self._newest, self._moved_at, self._voices = now, newest, wall_s, 1
        self._strangers = []


def ahead_ns(period_ns: int) -> int:
    """By how much a message of this period may be ahead of the time that is known [ns]: two messages make the time, so
    that the next of a topic that comes alone is two periods after it.
    """
    return min(2 * period_ns, LONGEST_AHEAD_NS)


def _elapsed(since: float, wall_s: float) -> int:
    return int((wall_s - since) * NANOSECONDS)
