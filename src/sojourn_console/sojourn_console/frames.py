"""How often a page is shown: thirty times a second, seldomer where that would take too much from the run beside it.

In lock-step a run takes all the processors that it can have, so what a page takes is taken from it: where there are
two, scenes of one millisecond are shown thirty times a second, and of three thirteen times. A run that is paced by the
wall clock leaves most of them idle, and so does a bag.
"""

FRAMES, FEWEST = 30.0, 10.0
"""Scenes a second, and that a page has whatever they cost."""
PART, REALTIME_PART = 0.02, 0.25
"""Of all processors, which scenes may take beside a run in lock-step, and beside what goes by the wall clock."""
SMOOTHED = 30
"""Scenes over which their cost is smoothed: one in which the ground is drawn anew says little of the next."""


class Frames:
    """Of one page.

    Args:
        processors: that scenes may take, a part of one as a rule.
    """

    def __init__(self, processors: float) -> None:
        self._processors, self._cost_s = processors, 0.0

    def interval_s(self, spent_s: float) -> float:
        """Wall time from one scene to the next [s]. spent_s: time of a processor that the last one took [s]."""
        self._cost_s += (spent_s - self._cost_s) / SMOOTHED
        return min(max(self._cost_s / self._processors, 1.0 / FRAMES), 1.0 / FEWEST)
