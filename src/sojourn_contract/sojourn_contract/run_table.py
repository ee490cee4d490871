"""The topics of one run: those of every machine, and those that its own machine brings.

What a bag or a tool finds on a topic it can look up by the topic's name alone: `row_named`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.errors import SensorRowError
from sojourn_contract.topic_table import TopicTable, of_thing
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import STANDARD
from sojourn_machine.sensor_choice import SENSORS, SensorParams

STORE = "store"
"""Rows with `each` of it stand once for each energy store."""
RECORDED_BESIDES = ("/tf",)
"""Topics that the recorder adds; no row is about them."""


def table_of(scenario: LoadedScenario) -> TopicTable:
    """The topics of a run of a scenario, whoever takes part. Raises TopicNameError, SensorRowError."""
    rows = {row.name: row for params in scenario.sensors.sensors.values() for row in rows_of(params)}
    brought = [row for name, row in rows.items() if name not in STANDARD]
    return STANDARD.joined_with(brought).for_things(things_of(scenario))


def things_of(scenario: LoadedScenario) -> Mapping[str, tuple[str, ...]]:
    """What a machine may have several of: names by what rows have as `each`, in the order of its files."""
    found: dict[str, tuple[str, ...]] = {STORE: ("battery",)}
    for name, params in scenario.sensors.sensors.items():
        for each in dict.fromkeys(row.each for row in rows_of(params) if row.each != STORE):
            found[each] = (*found.get(each, ()), name)
    return found


def rows_of(params: SensorParams | type[SensorParams]) -> Iterator[Topic]:
    """Rows on which the first sensor of a kind speaks. Raises SensorRowError for one that no sensor can have."""
    for row in params.speaks_on:
        if row.publisher != "sensors" or row.is_event or not row.logged:
            raise SensorRowError(row.name, "a logged row of the role sensors, with a rate")
        if row.name in STANDARD and row != STANDARD.topic(row.name):
            raise SensorRowError(row.name, "a name that no topic of the contract has, or that topic's own row")
        yield row if row.each else replace(row, each=row.name)


def row_named(name: str) -> Topic | None:
    """The row of a topic in whatever run has it: of every machine, or of a kind of sensor that is installed; None for a
    topic that no run has.
    """
    first, _, thing = name.rpartition("/")
    known = STANDARD.get(name) or _of_further(STANDARD.get(first), thing)
    if known is not None or name in RECORDED_BESIDES:
        return known
    brought = _brought()
    return brought.get(name) or _of_further(brought.get(first), thing)


def _of_further(row: Topic | None, thing: str) -> Topic | None:
    return of_thing(row, thing) if row is not None and row.each and thing else None


@cache
def _brought() -> Mapping[str, Topic]:
    """Rows of all kinds of sensors that are installed."""
    return {row.name: row for kind in SENSORS.names() for row in rows_of(SENSORS.get(kind)) if row.name not in STANDARD}
