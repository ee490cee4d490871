"""Fixtures of the bag tests: a domain of their own, a stack of stand-in nodes, and a recorded run."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy

from domains import own_domain

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "contract")]


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain of this test's own, on this machine only, with the field checks of rclpy."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT")  # LOCALHOST adds shared memory
    monkeypatch.setenv("ROS_PYTHON_CHECK_FIELDS", "1")
    profiles = Path(__file__).parents[2] / "config" / "nodes" / "fastdds.xml"
    monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(profiles))
    with own_domain() as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        yield number


@pytest.fixture
def ros(domain: int) -> Iterator[None]:
    """rclpy, started on the test's domain."""
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    yield
    rclpy.try_shutdown()
