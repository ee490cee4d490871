"""Fixtures of the console's tests: the reference run, and a feed that only remembers what is said."""

import sys
from pathlib import Path

import pytest

from sojourn_bags.reading import Bag, read_bag
from sojourn_console.world import World, world_of_bag

sys.path.insert(0, str(Path(__file__).parent))

from deaf_feed import DeafFeed

REFERENCE = Path(__file__).parents[1] / "replay" / "short_goals"


@pytest.fixture(scope="session")
def reference() -> Bag:
    return read_bag(REFERENCE)


@pytest.fixture(scope="session")
def world(reference: Bag) -> World:
    return world_of_bag(reference)


@pytest.fixture
def feed() -> DeafFeed:
    return DeafFeed()
