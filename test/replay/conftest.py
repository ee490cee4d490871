"""Fixtures of the replays: a domain of their own."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "system"))

from programs import next_domain


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> int:
    """A ROS domain that no other test uses."""
    number = next_domain()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
    return number
