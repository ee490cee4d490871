"""A drive motor dies during a run: the drive says so, the goal is reached in truth, and the contract is kept."""

from collections.abc import Callable
from pathlib import Path

from programs import HERE, PATIENT, Program

from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import read_bag

DEAD_AT = 15.0
FIRM = ("--set", "drive.odometry.mean_slip=0.0", "--set", "drive.odometry.slip_per_grade=0.0")
"""Options: the drive knows that rock does not slip."""


def test_ten_metres_with_a_dead_wheel(start: Callable[..., Program], tmp_path: Path) -> None:
    folder = tmp_path / "run"
    program = start("start", HERE / "dead_wheel.yaml", *PATIENT, *FIRM, "--direct", "--run-dir", folder)
    assert program.wait() == 0, program.text  # the goal is met by the truth of the plant
    bag = read_bag(folder)
    statuses = bag["/drive/status"].statuses()
    said = [(time, status["failed_motors"]) for time, status in zip(bag["/drive/status"].times, statuses, strict=True)]
    first = next(time for time, text in said if text)
    assert DEAD_AT + 2.0 <= first <= DEAD_AT + 2.0 + 1.5  # drive_time, and the period of the status
    assert {text for _, text in said} == {"", "drive of front_left does not follow"}
    assert statuses[-1]["state"] == "reached"
    contacts = bag["/truth/contacts"].points()["slip_ratio"]
    assert contacts[-500:-200, 0].mean() < -0.05  # the ground turns it
    assert contacts[-500:-200, 1:6].mean() > 0.0
    assert not list(judge_bag(bag)[0].lines())
