"""How far a campaign is, for a person: a bar on a terminal, else a line now and then."""

import time
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from sojourn_studies.campaign.row import LOST, MET

LINE_S = 30.0
"""Wall time from one line to the next where there is no terminal [s]."""


class CampaignProgress:
    """Counts runs as they end. A context manager.

    Args:
        total: runs of the campaign. done: of them, before this start. console: where it is shown.
    """

    def __init__(self, total: int, done: int, console: Console) -> None:
        self._total, self._done, self._before = total, done, done
        self._met = self._lost = 0
        self._began = self._told = time.monotonic()
        self._console = console
        self._bar = Progress(BarColumn(bar_width=24), TextColumn("{task.description}"), console=console, transient=True)
        self._task = self._bar.add_task("starting the workers", total=total, completed=done)

    def count(self, result: str) -> None:
        """A run has ended so."""
        self._done += 1
        self._met += result == MET
        self._lost += result == LOST
        words = self.words(time.monotonic() - self._began)
        self._bar.update(self._task, completed=self._done, description=words)
        if not self._console.is_terminal and time.monotonic() - self._told >= LINE_S:
            self._told = time.monotonic()
            self._console.print(words, markup=False)

    def words(self, elapsed_s: float) -> str:
        """Runs done, goals met of those that are judged, runs lost, speed and time to go, after so much wall time since
        this start [s].
        """
        ended = self._done - self._before
        each = elapsed_s / max(ended, 1)
        met = 100.0 * self._met / max(ended - self._lost, 1)
        lost = f"{self._lost} lost, " if self._lost else ""
        return (
            f"{self._done} of {self._total} runs, {met:.0f} % of the new met, {lost}"
            f"{each:.1f} s a run, {duration(each * (self._total - self._done))} to go"
        )

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()


def duration(seconds: float) -> str:
    """As a person says it."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    if seconds < 5400.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"
