"""How far a run is, by its plant's heartbeats: the plant owns the clock, and its heart beats once a second.

Anybody can say a heartbeat in its name. One that is further ahead than the next one can be is believed only where
another follows it as the plant's do, so that a single false one moves nothing.
"""

from sojourn_contract.heartbeat import HEARTBEAT_PERIODS
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS

BEAT_NS = HEARTBEAT_PERIODS * CONTROL_PERIOD_NS
LATE_NS = NANOSECONDS
"""By how much the first heartbeat may have been late where later ones are not."""


class PlantTime:
    """Of one run.

    Args:
        begun: stamp of the state from which it goes on [ns], 0 for its start.
        longest_leap: simulation time by which its clock may leap [ns]. realtime: whether the wall paces it.

    Attributes:
        now: the newest stamp that is believed [ns].
    """

    def __init__(self, begun: int = 0, longest_leap: int = 0, realtime: bool = False) -> None:
        self.now = begun
        self._farthest = BEAT_NS + longest_leap
        self._realtime = realtime
        self._stranger: tuple[int, float] | None = None
        """Stamp [ns] and wall time [s] of the last one that was not believed."""
        self._anchor: tuple[int, float] | None = None
        """The same of the first one that was, in real time."""

    def hear(self, stamp: int, wall_s: float) -> None:
        """A heartbeat stamped so [ns] has come at a wall time [s]."""
        if stamp <= self.now:
            return
        if stamp <= self.now + self._farthest and self._paced(self._anchor, stamp, wall_s, LATE_NS):
            self.now, self._anchor = stamp, self._anchor or (stamp, wall_s)
        elif self._follows(stamp, wall_s):
            self.now, self._anchor, self._stranger = stamp, (stamp, wall_s), None
        else:
            self._stranger = (stamp, wall_s)

    def _follows(self, stamp: int, wall_s: float) -> bool:
        """Whether it comes after the last one that was not believed as one of the plant's after another."""
        if self._stranger is None or not 0 < stamp - self._stranger[0] <= self._farthest:
            return False
        return self._paced(self._stranger, stamp, wall_s, LATE_NS // 2)

    def _paced(self, since: tuple[int, float] | None, stamp: int, wall_s: float, slack: int) -> bool:
        """Whether the wall allows a stamp, so much after another."""
        if not self._realtime or since is None:
            return True
        return stamp - since[0] <= int((wall_s - since[1]) * NANOSECONDS) + slack
