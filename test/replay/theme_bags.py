"""The theme bags as tests play them: each read once, each of its roles replayed directly."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.run_configuration import run_configuration
from sojourn_bringup.references import references_folder
from sojourn_contract.app import App
from sojourn_stack.replay import app_of


@cache
def bag_of(name: str) -> Bag:
    return read_bag(references_folder() / name)


@contextmanager
def app_and_bag(name: str, role: str) -> Iterator[tuple[Bag, App[Any]]]:
    """The app of a role as in the run of a bag."""
    bag = bag_of(name)
    with run_configuration(bag) as configuration:
        yield bag, app_of(role, configuration)
