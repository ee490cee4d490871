"""What the reference bags go through of apps and flight laws: a defect in any other line passes all of them.

Kernels run as Python here, as scripts/replay --coverage has them, so that their lines count, too.
"""

import os
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from unittest import mock

import pytest

from sojourn_bringup.replay_coverage import UNCOMPILED, measure, reference_bags
from sojourn_stack.exercise import FLIGHT_ROLES, Exercise, folders_of, share

LEAST = 0.90
"""Of all lines that an app can come to. What is left are mostly checks of numbers that others have checked before, ways
of a rover round and back where several things go wrong at once, and errors of cameras' calibration."""
LEAST_OF = {
    "sojourn_drive": 0.88,
    "mobility": 0.91,
    "odometry": 0.95,
    "planning": 0.88,
    "hazards": 0.93,
    "supervision": 0.87,
    "sojourn_arm": 0.90,
    "arm": 0.89,
    "sojourn_power": 0.92,
    "power_manager": 0.91,
}
"""Of those of one folder."""


@pytest.fixture(scope="module")
def found() -> list[Exercise]:
    # in a process of its own: kernels are made when they are imported, and what others have run before here, and is
    # kept, would not be run again
    with mock.patch.dict(os.environ, {UNCOMPILED: "1"}), ProcessPoolExecutor(1, get_context("spawn")) as pool:
        found, differs = pool.submit(measure, reference_bags(), FLIGHT_ROLES, with_starts=True).result()
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
