"""Fixtures of the operator's tests: a ROS domain of each test's own, on this machine only."""

from collections.abc import Iterator

import pytest

from domains import own_domain
from sojourn_config.ros_environment import ros_variables


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A domain that no other test uses at the same time."""
    with own_domain() as number:
        for name, value in ros_variables(number).items():
            monkeypatch.setenv(name, value)
        yield number
