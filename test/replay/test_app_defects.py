"""Defects put into our apps one at a time, and the field by which the replay of a bag tells of each."""

import re
from collections.abc import Iterator
from contextlib import ExitStack
from functools import cache
from typing import Any

import fault_defects  # noqa: F401  # its defects come into the list of app_defects
import pytest
from app_defects import APP_DEFECTS, AppDefect
from defects import DEFECTS
from theme_bags import app_and_bag

from sojourn_bags.reading import Bag
from sojourn_stack.replay import replay

INDEX = re.compile(r"\[[^\]]*\]")


@pytest.fixture(scope="module")
def apps() -> Iterator[Any]:
    """Bag and app by bag and role, made once; what a test changes in them it takes back."""
    with ExitStack() as stack:
        yield cache(lambda name, role: stack.enter_context(app_and_bag(name, role)))


def differing(bag: Bag, role: str, app: Any) -> set[str]:
    comparison = replay(bag, role, app).comparison
    found = {INDEX.sub("", field.name) for field in comparison.fields if field.beyond}
    return found | {f"{topic.topic} missing" for topic in comparison.topics if topic.missing}


@pytest.mark.parametrize("found", APP_DEFECTS, ids=lambda found: found.name)
def test_a_defect_is_caught_by_its_field(found: AppDefect, apps: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    bag, app = apps(found.bag, found.role)
    found.put_in(app, monkeypatch)
    assert found.field in differing(bag, found.role, app)


def test_there_are_sixty_and_each_is_another() -> None:
    names = [each.name for each in (*DEFECTS, *APP_DEFECTS)]
    assert len(set(names)) == len(names) >= 60
