"""What all pages share, and a page changes only as long as no other has the control."""

import math
import time
from collections.abc import Callable
from typing import Any

from sojourn_console.errors import GoalError
from sojourn_console.panels.panel import Workbench

NOTICE_S = 6.0
"""So long a notice stays, and so long the page is not told again [s of wall time]."""


class SharedFields:
    """Of one panel.

    Args:
        bench: that the fields work on.
    """

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        self._told_at: dict[int, float] = {}
        """When which page was told last, of a clock that only goes on [s]."""

    def let(self, client: Any, act: Callable[[], None]) -> bool:
        """Do what a page asks for if it may; else it is told why not. Returns whether it was done.

        Args:
            client: that asks, None for the program itself. act: what it asks for.
        """
        with self._bench.lock:
            try:
                if client is not None:
                    self._bench.control.check(client.client_id)
            except GoalError as error:
                self._tell(client, str(error))
                return False
            act()
        return True

    def connect(self, field: Any, act: Callable[[], None]) -> None:
        """Do something when a field has another value; where the page may not, the field has its old one again."""
        taken = field.value

        def take() -> None:
            nonlocal taken
            taken = field.value
            act()

        def updated(event: Any) -> None:
            with self._bench.lock:
                # as it was: put back from below, or again before a thread came to this
                if field.value != taken and not self.let(event.client, take):
                    field.value = taken

        field.on_update(updated)

    def _tell(self, client: Any, words: str) -> None:
        """Once, not with each letter that is typed and each step of a drag."""
        now = time.monotonic()
        if now - self._told_at.get(client.client_id, -math.inf) > NOTICE_S:
            self._told_at[client.client_id] = now
            client.add_notification("Not done", words, color="red", auto_close_seconds=NOTICE_S)
