"""Fixtures of the node tests: a domain that nobody else is on, the bench, and a plant that is made quickly."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from domains import own_domain

sys.path.insert(0, str(Path(__file__).parent))

from node_bench import SCENARIO, Bench

from sojourn_config.scenario import load_scenario
from sojourn_plant import app
from sojourn_plant.start import build_plant


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    with own_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        made = Bench(domain)
        yield made
        made.close()


@pytest.fixture(scope="module")
def built() -> Any:
    """Model and first state, made once: to settle the machine takes most of a test's time."""
    return build_plant(load_scenario(SCENARIO))


@pytest.fixture
def quick_start(built: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """All that changes is in the state, so each plant gets a copy of that and the model itself."""
    model, state = built
    monkeypatch.setattr(app, "build_plant", lambda scenario: (model, state.copy()))
