"""The last words of a run: verdict, folder, and what to type for more."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from sojourn_bringup import start
from sojourn_bringup.ending import last_words
from sojourn_bringup.outcome import INTERRUPTED, Outcome
from sojourn_operator.script import StepResult


def plan(folder: Path) -> Any:
    return SimpleNamespace(run_dir=folder, bag=lambda: folder / "bag")


def test_a_run_without_a_bag_says_where_it_is(tmp_path: Path) -> None:
    outcome = Outcome(INTERRUPTED, "interrupted", (StepResult("wait", "stopped", "", 0.5, 1.0),), 1.0, 2.0)
    *_, step, where, ended = last_words(plan(tmp_path), outcome)
    assert step.endswith("wait: stopped") and ended == "interrupted after 1.00 s of simulation, 2.0 s of wall time"
    assert where == f"it is in {tmp_path}, without a bag"


def test_a_bag_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    (tmp_path / "bag").mkdir()
    *_, verdict, where, _ = last_words(plan(tmp_path), Outcome(0, "done"))
    assert verdict.startswith("verdict: none: ") and f"scripts/report {tmp_path} --html" in where


def test_a_run_ends_with_its_verdict_and_the_command_for_its_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "a run"
    steps = "steps=[{wait_s: 0.4}]"
    assert start.main(["flat_drive", "--direct", "--set", steps, "--run-dir", str(folder)]) == 0
    *_, verdict, where, ended = capsys.readouterr().out.splitlines()
    assert "s of simulation" in ended and verdict.startswith("verdict: ")
    assert where == f"it is in {folder}; its report: scripts/report '{folder}' --html"
