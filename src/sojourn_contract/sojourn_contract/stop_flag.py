"""A wish to stop, as a signal brings it."""

import signal
from types import FrameType


class StopFlag:
    """Set by SIGINT or SIGTERM."""

    def __init__(self) -> None:
        self.is_set = False

    def install(self) -> "StopFlag":
        """Catch SIGINT and SIGTERM from here on."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._set)
        return self

    def _set(self, _number: int, _frame: FrameType | None) -> None:
        self.is_set = True
