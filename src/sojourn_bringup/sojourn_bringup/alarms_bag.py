"""The log and the alarms of a finished run, from its bag: the same each time."""

from collections.abc import Iterator
from pathlib import Path

from sojourn_bags.reading import Bag
from sojourn_bags.run_configuration import run_configuration
from sojourn_config.scenario import load_scenario
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.run_table import table_of
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.params import Severity
from sojourn_operator.alarms.watch import Watch, WatchState, limits_of

JUDGE = "contract"


def watched_bag(bag: Bag, limits: Path | None = None) -> tuple[Watch, WatchState, list[Event]]:
    """What an operator who never acknowledges would have at the end, and the whole log.

    Raises:
        IncompleteConfigError: the bag does not hold its run's configuration. ConfigError: the limits are wrong.
        UnknownFieldNameError: an alarm of a field that the run does not have.
    """
    with run_configuration(bag) as configuration:
        scenario = load_scenario(configuration.scenario, configuration.overrides)
        watch = Watch(limits_of(scenario, limits), table_of(scenario))
    state, log = watch.initial_state(), []
    for topic, data in _in_order(bag, watch):
        try:
            message = decode(watch.table.topic(topic), data)
        except RefusedMessageError as refusal:
            log.append(Event(state.now, JUDGE, JUDGE, Severity.NONE, str(refusal)))
            continue
        state, events = watch.step(state, topic, message)
        log += events
    return watch, state, log


def _in_order(bag: Bag, watch: Watch) -> Iterator[tuple[str, bytes]]:
    """The messages that it wants to hear, as they were written."""
    found = [
        (place, name, data)
        for name in watch.topics
        if name in bag
        for place, data in zip(bag[name].places, bag[name].data, strict=True)
    ]
    for _, name, data in sorted(found, key=lambda entry: entry[0]):
        yield name, data
