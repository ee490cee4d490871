"""Whether a stack that somebody waits for still goes: by its simulation time."""

import time

QUIET_S = 30.0
"""Wall time without a word after which nobody waits for one any more."""


class ClockWatch:
    """Of one wait.

    Args:
        now: simulation time at its beginning [ns].
    """

    def __init__(self, now: int) -> None:
        self._now, self._moved_at = now, time.monotonic()

    def look(self, now: int) -> str:
        """Why nothing will come any more, in words; empty as long as the stack goes on.

        Args:
            now: simulation time [ns].
        """
        if now < self._now:
            return "the simulation time has gone back: the stack was started anew, or its clock was set"
        if now > self._now:
            self._now, self._moved_at = now, time.monotonic()
        still_s = time.monotonic() - self._moved_at
        if still_s > QUIET_S:
            return f"the simulation time has stood still for {still_s:.0f} s: has the stack ended?"
        return ""
