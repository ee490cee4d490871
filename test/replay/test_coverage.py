"""What the reference bags go through of apps and flight laws: a defect in any other line passes all of them.

Kernels are compiled here, so that their files are left out: scripts/replay --coverage counts them, too.
"""

from collections import defaultdict
from pathlib import Path

import pytest

from sojourn_bringup.references import REFERENCES, THEMES, references_folder
from sojourn_bringup.replay_coverage import measure
from sojourn_stack.exercise import FLIGHT_ROLES, Exercise, folders_of, share

LEAST = 0.70
"""Of all lines that an app can come to. A tenth of the rest refuses parameters, which no recorded run has; most else
are searches of the arm among obstacles, redundant arms, and ways round several obstacles."""
LEAST_OF = {
    "sojourn_drive": 0.70,
    "mobility": 0.84,
    "odometry": 0.90,
    "planning": 0.80,
    "hazards": 0.40,
    "supervision": 0.66,
    "sojourn_arm": 0.84,
    "arm": 0.60,
    "sojourn_power": 0.86,
    "power_manager": 0.73,
}
"""Of those of one folder."""


@pytest.fixture(scope="module")
def found() -> list[Exercise]:
    bags = [references_folder() / reference.name for reference in (*REFERENCES, *THEMES)]
    found, differs = measure(bags, FLIGHT_ROLES)
    assert not differs
    return found


def test_the_bags_go_through_most_of_the_flight_laws(found: list[Exercise]) -> None:
    assert share(found) > LEAST


def test_no_folder_is_passed_over(found: list[Exercise]) -> None:
    by_folder: dict[Path, list[Exercise]] = defaultdict(list)
    folders = [folder for role in FLIGHT_ROLES for folder in folders_of(role)]
    for each in found:
        by_folder[next(folder for folder in folders if folder in each.path.parents)].append(each)
    shares = {folder.name: share(files) for folder, files in by_folder.items()}
    assert not {name: shares[name] for name, least in LEAST_OF.items() if shares[name] < least}
