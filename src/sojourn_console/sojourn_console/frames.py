"""How often a page is shown: thirty times a second, seldomer where that would take too much from the run beside it.

A run takes all the processors that it can have, in lock-step at least, so what a page takes is taken from it. Where
there are two, scenes of three milliseconds are so shown thirty times a second, and of eight thirteen times.
"""

FRAMES, FEWEST = 30.0, 10.0
"""Scenes a second, and that a page has whatever they cost."""
PART = 0.05
"""Of all processors, which scenes may take where a run goes on beside them."""
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
