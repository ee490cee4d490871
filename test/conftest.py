"""Settings of every test, made before anything of ROS or numpy is imported."""

import sojourn_machine  # isort: skip  # noqa: F401 - first of all, so that numpy finds the arithmetic pinned

import os
import sys
from pathlib import Path

import pytest
from hypothesis import settings

sys.path.insert(0, str(Path(__file__).parent))  # `domains`, for the fixtures of several folders

# rclpy looks at it once, when the first message class is imported: without it wrong types corrupt in silence.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(Path(__file__).parents[1] / "config" / "nodes" / "fastdds.xml")
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SYSTEM_DEFAULT"

# How long an example takes says something of what else the machine does, and nothing of the code. A commit is judged by
# the same examples wherever its tests are run; new ones are looked for with scripts/test --random.
settings.register_profile("sojourn", deadline=None, derandomize="SOJOURN_RANDOM_EXAMPLES" not in os.environ)
settings.load_profile("sojourn")

FIRST = [Path(__file__).parent / folder for folder in ("system", "replay", "studies", "bringup", "nodes")]
"""Folders of the tests that take longest."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whole stacks first: a file of them takes minutes, and begun last it would keep one process busy alone."""
    items.sort(key=lambda item: next((place for place, folder in enumerate(FIRST) if folder in item.path.parents), 9))
