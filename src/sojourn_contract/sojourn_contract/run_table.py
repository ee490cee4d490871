"""The topics of one run: those of every machine, and those that its own machine brings.

What a bag or a tool finds on a topic it can look up by the topic's name alone: `row_named`.
"""

from collections.abc import Mapping

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.topic_table import TopicTable, of_thing
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import STANDARD

STORE = "store"
"""Rows with `each` of it stand once for each energy store."""


def table_of(scenario: LoadedScenario) -> TopicTable:
    """The topics of a run of a scenario, whoever takes part. Raises TopicNameError."""
    return STANDARD.for_things(things_of(scenario))


def things_of(scenario: LoadedScenario) -> Mapping[str, tuple[str, ...]]:
    """What a machine may have several of: names by kind, in the order of its files."""
    return {STORE: ("battery",)}


def row_named(name: str) -> Topic | None:
    """The row of a topic in whatever run has it; None for a topic that no run has."""
    row = STANDARD.get(name)
    if row is not None:
        return row
    first, _, thing = name.rpartition("/")
    row = STANDARD.get(first)
    return of_thing(row, thing) if row is not None and row.each and thing else None
