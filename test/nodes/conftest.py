"""Fixtures of the node tests: a domain that nobody else is on, and the bench."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from domains import own_domain

sys.path.insert(0, str(Path(__file__).parent))

from node_bench import Bench


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    with own_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        made = Bench(domain)
        yield made
        made.close()
