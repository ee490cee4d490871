"""Fixtures of the node tests: a domain that nobody else is on, and the bench."""

import itertools
import os
import socket
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from node_bench import Bench

LAST_DOMAIN = 100  # above it the ports of DDS lie where the system takes its own
_next = itertools.count(os.getpid())


def free_domain() -> int:
    """A domain whose first participant's port nobody holds (DDSI-RTPS 2.3, 9.6.1.1: 7410 + 250 a domain)."""
    for number in itertools.islice(_next, LAST_DOMAIN):
        domain = number % LAST_DOMAIN + 1
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", 7410 + 250 * domain))
            except OSError:
                continue
            return domain
    raise RuntimeError("no ROS domain is free")


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    domain = free_domain()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    made = Bench(domain)
    yield made
    made.close()
