"""How far the arm is, as its status says: of a goal, of a task, and of a task of which nothing can be told."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sojourn_arm.tasks import progress_fields
from sojourn_flight.arm.tasks.task import Doing
from sojourn_flight.arm.tasks.task_control import TaskReport

DONE: Any = SimpleNamespace(progress=1.0, time_to_go=0.0)
"""What the arm says after a motion that has ended."""
UNDER_WAY: Any = SimpleNamespace(progress=0.25, time_to_go=3.0)


def told(progress: str, time_to_go: str) -> dict[str, str]:
    return {"progress": progress, "time_to_go": time_to_go}


@pytest.mark.parametrize(
    ("output", "doing", "fields"),
    [
        (UNDER_WAY, None, told("0.250", "3.00")),
        (DONE, None, told("1.000", "0.00")),
        (DONE, Doing(), {}),  # it was said to be done before it had begun
        (UNDER_WAY, Doing(), told("0.250", "3.00")),
        (DONE, Doing(velocity=np.zeros(3), time_to_go=9.0), told("0.000", "9.00")),
        (DONE, Doing(progress=0.5, time_to_go=1.5), told("0.500", "1.50")),
    ],
)
def test_progress_is_true_or_none(output: Any, doing: Doing | None, fields: dict[str, str]) -> None:
    assert progress_fields(output, None if doing is None else TaskReport("tare", doing)) == fields
