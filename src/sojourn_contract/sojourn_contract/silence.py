"""How long nothing has been heard, in time in which it could have been.

A process that gets no core for seconds, or is stopped and goes on, has what came meanwhile waiting in its queues: such
a gap between two looks says nothing of the others, and counts no more than LONGEST_LOOK_S.
"""

SILENCE_S = 1.0
"""Without the input on which a node acts in real time, after which it says so in its heartbeat [s]."""
LOST_S = 3.0
"""The same, after which a node that `acts_in_silence` acts: longer than the end of a run takes [s]."""
LONGEST_LOOK_S = 0.25
"""Wall time from one look to the next beyond which the process was held up itself."""


class Silence:
    """Of one input or of all, looked at some times a second."""

    def __init__(self, now: float) -> None:
        self._looked, self._lasted = now, 0.0

    def ends(self) -> None:
        """Something has been heard."""
        self._lasted = 0.0

    def until(self, now: float) -> float:
        """How long it lasts at a wall time [s], that of the last look or later [s]."""
        self._lasted += min(now - self._looked, LONGEST_LOOK_S)
        self._looked = now
        return self._lasted
