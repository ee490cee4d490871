"""The campaign of faults: a subset of the course, on a seed that it was not made with, and bad input."""

import csv
from pathlib import Path

import pytest

from sojourn_bags.detection import FaultResult
from sojourn_config.command_errors import UsageError
from sojourn_studies.fault_campaign import main
from sojourn_studies.fault_runs import NO_FAULT, FaultRun
from sojourn_studies.fault_table import is_good, table

SUBSET = ("dead wheel motor", "steering that ran away", "blind camera")


def test_a_subset_of_the_course_is_detected_and_nothing_else(tmp_path: Path) -> None:
    file = tmp_path / "runs.csv"
    assert main(["--only", ",".join(SUBSET), "--seeds", "1", "--first-seed", "41", "--csv", str(file)]) == 0
    with file.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["fault"] for row in rows] == [NO_FAULT, *SUBSET]
    assert [row["outcome"] for row in rows] == ["", *["detected"] * len(SUBSET)]
    assert all(1.0 <= float(row["after_s"]) <= 6.0 and float(row["came_at_s"]) == 5.0 for row in rows[1:])


def test_a_fault_that_nobody_can_see_is_missed(capsys: pytest.CaptureFixture[str]) -> None:
    expect = "{topic: /drive/status, field: failed_motors, says: drive, within: 1}"
    weak = f"faults=[{{kind: motor_weak, joint: wheel_front_left_joint, part: 0.9, at: 1, expect: {expect}}}]"
    assert main(["flat_drive", "--set", weak, "--seeds", "1"]) == 1
    assert "missed: 'drive' in failed_motors of /drive/status within 1 s" in capsys.readouterr().out


def test_the_table_counts_what_was_detected_missed_and_called_falsely() -> None:
    def result(outcome: str, after: float | None) -> FaultResult:
        return FaultResult("a", "motor_dead", 5.0, None, outcome, after, "")

    runs = [
        FaultRun("course", 1, NO_FAULT, result("false alarm", None)),
        FaultRun("course", 1, NO_FAULT, None),
        FaultRun("course", 1, "a", result("detected", 2.0)),
        FaultRun("course", 2, "a", result("detected", 4.0)),
        FaultRun("course", 3, "a", result("missed", 9.0)),
        FaultRun("course", 4, "a", result("not judged", None)),
        FaultRun("course", 5, "a", result("did not come", None)),
    ]
    assert [is_good(one) for one in runs] == [False, True, True, True, False, False, False]
    cells = [next(iter(column.cells)) for column in table(runs).columns]
    assert cells == ["course", "a", "2 of 5", "2.0", "3.0", "4.0", "1", "2", "1"]


def test_what_there_is_not_is_said(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="allowed is one of dead wheel motor, seized wheel"):
        main(["--only", "dead weel", "--seeds", "1"])
    with pytest.raises(UsageError, match="no fault says how it should show"):
        main(["flat_drive", "--seeds", "1"])
