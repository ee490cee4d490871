"""The recorder that waits: made once an attempt, told to begin, never left behind."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from sojourn_bringup import standby
from sojourn_bringup.child import Child
from sojourn_bringup.standby import Standby

WAITING = "import sys; line = sys.stdin.readline(); print('told', repr(line)); sys.exit(3 if line else 4)"


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Of a run in real time; what waits is a program of one line."""
    (tmp_path / "logs").mkdir()

    def child(role: str, command: list[str], environment: Any, log: Path, hears: bool) -> Child:
        assert command[1:3] == ["-m", "sojourn_bags.standby"] and command[4] == f"attempt {len(made) + 1}"
        made.append(Child.of_command(role, [sys.executable, "-c", WAITING], {}, log, hears))
        return made[-1]

    made: list[Child] = []
    monkeypatch.setattr(standby, "Child", SimpleNamespace(of_command=child))
    monkeypatch.setattr(standby, "environment_of", lambda *_: {})
    yield SimpleNamespace(
        realtime=True, started=("plant", "recorder"), replacements={}, scenario="flat_drive", overrides=(),
        run_dir=tmp_path, ros_arguments=lambda role, attempt: [f"attempt {attempt}"], made=made,
    )  # fmt: skip
    for one in made:
        one.sweep()


def test_it_waits_until_it_is_told_and_another_is_made_for_the_next_death(plan: Any) -> None:
    waiting = Standby(plan, {})
    for _ in range(3):
        waiting.prepare(1)
    (first,) = plan.made
    assert first.status is None
    assert waiting.take() is first
    assert first.wait(60.0) and first.status == 3
    assert "told 'begin\\n'" in (plan.run_dir / "logs" / "recorder.log").read_text()
    assert waiting.take() is None, "none is there until it is prepared"
    waiting.prepare(2)
    assert len(plan.made) == 2
    waiting.end()
    assert plan.made[1].status is not None


def test_one_that_has_died_is_not_taken_and_not_made_again(plan: Any) -> None:
    waiting = Standby(plan, {})
    waiting.prepare(1)
    plan.made[0].sweep()
    assert plan.made[0].wait(60.0)
    waiting.prepare(1)
    assert waiting.take() is None and len(plan.made) == 1


@pytest.mark.parametrize(
    "other", [{"realtime": False}, {"started": ("plant",)}, {"replacements": {"recorder": "theirs"}}]
)
def test_none_waits_where_none_can_take_over(plan: Any, other: dict[str, Any]) -> None:
    for name, value in other.items():
        setattr(plan, name, value)
    waiting = Standby(plan, {})
    waiting.prepare(1)
    assert waiting.take() is None and not plan.made
