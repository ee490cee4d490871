"""A drive motor dies during a run: the drive says so, the goal is reached in truth, and the contract is kept; and all
that the same without middleware and in many processes.
"""

from pathlib import Path

from programs import FOUR_THREADS, HERE, LAYOUTS, PATIENT
from test_same_everywhere import records
from verdicts import require_same

from sojourn_bags.judging import judge_bag

DEAD_AT = 15.0
FIRM = ("--set", "drive.odometry.mean_slip=0.0", "--set", "drive.odometry.slip_per_grade=0.0")
"""Options: the drive knows that rock does not slip."""


def test_ten_metres_with_a_dead_wheel(tmp_path: Path) -> None:
    options = (str(HERE / "dead_wheel.yaml"), *PATIENT, *FIRM)
    runs = {name: ((*options, *layout), FOUR_THREADS) for name, layout in LAYOUTS.items()}
    bags = records(tmp_path, runs, status=0)  # the goal is met by the truth of the plant
    bag = bags["direct"]
    require_same(bag, bags["processes"])
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
