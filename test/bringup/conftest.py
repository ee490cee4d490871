"""Fixtures of the start-up tests: a ROS domain of each test's own, on this machine only."""

import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from domains import own_domain
from sojourn_config.ros_environment import ros_variables

sys.path[:0] = [str(Path(__file__).parents[1] / folder) for folder in ("contract", "bags")]


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A domain that no other test uses at the same time, and the field checks of rclpy."""
    monkeypatch.setenv("ROS_PYTHON_CHECK_FIELDS", "1")
    with own_domain() as number:
        for name, value in ros_variables(number).items():
            monkeypatch.setenv(name, value)
        yield number


@pytest.fixture(autouse=True)
def signals() -> Iterator[None]:
    """Programs that a test runs in this process catch signals: give them back."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)
