"""How often somebody may have the state of a run kept: a checkpoint costs a file and holds the run up, so that whoever
asks without end would fill the disk and stop the run.
"""

from sojourn_contract.checkpoint_topic import CHECKPOINT
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stamps import NANOSECONDS, seconds

ASKED_EVERY_NS = 10 * NANOSECONDS
"""Least simulation time from one checkpoint that is asked for to the next [ns]. Those at even times do not count."""


class AskingLimit:
    """Remembers when a checkpoint was asked for."""

    def __init__(self) -> None:
        self._taken: int | None = None
        self._answered = 0

    def is_new(self, now: int, answered: int) -> bool:
        """Whether a request at simulation time `now` [ns] asks for one more; False where it is answered by the one that
        is still to be kept.

        Args:
            answered: stamp of the last one that was asked for [ns], 0 where none was.

        Raises:
            RefusedMessageError: too soon after the last one.
        """
        if self._taken is None or now - self._taken >= ASKED_EVERY_NS:
            self._taken, self._answered = now, answered
            return True
        if answered == self._answered:
            return False
        after = f"{seconds(now - self._taken):.2f} s after the last one"
        raise RefusedMessageError(
            CHECKPOINT.name, "request", after, f"one in {seconds(ASKED_EVERY_NS):g} s of simulation"
        )
