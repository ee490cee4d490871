"""The plant ends a run between two looks of the supervisor, or in the midst of one: either way the run has ended."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

from sojourn_bringup.health import Progress
from sojourn_bringup.outcome import FAILED, SUCCEEDED
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.screen import PlainScreen
from sojourn_bringup.supervisor import Supervisor
from sojourn_contract.stop_flag import StopFlag


class Ending:
    """A child that has not ended yet the first times that it is asked, and then has."""

    pid = 1
    is_stopped = False

    def __init__(self, asked: int, status: int) -> None:
        self._answers: Iterator[int | None] = iter([None] * asked + [status] * 100)

    @property
    def status(self) -> int | None:
        return next(self._answers)

    def memory_mb(self) -> float:
        return 1.0

    def how_it_ended(self) -> str:
        return f"ended with status {self.status}"

    def sweep(self) -> None:
        """It has left nothing behind."""


@pytest.mark.parametrize(("status", "outcome"), [(0, SUCCEEDED), (1, FAILED)])
@pytest.mark.parametrize("asked", range(5))
def test_the_end_is_seen_whenever_it_comes(tmp_path: Path, asked: int, status: int, outcome: int) -> None:
    """It was seen as a death where it came after the look for an end and before the one for the dead."""
    plan = RunPlan(scenario="flat_drive", run_dir=tmp_path, participants=("plant",), started=("plant",))
    supervisor: Any = Supervisor(plan, PlainScreen(Console(quiet=True)))
    supervisor._monitor = SimpleNamespace(spin=lambda wait_s: None, progress=Progress(stamp=1))
    supervisor.children["plant"] = Ending(asked, status)
    assert supervisor._watch(StopFlag()).status == outcome
