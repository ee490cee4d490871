"""The topics of one run: those of every machine, and those that its own machine brings.

What a bag or a tool finds on a topic it can look up by the topic's name alone: `row_named`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from math import gcd

from sojourn_config.bundle import Bundle
from sojourn_config.errors import MISSING, ConfigError, Problem
from sojourn_config.flight import FlightScenario
from sojourn_config.known_machine import KnownMachine
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.checkpoint_topic import CHECKPOINT
from sojourn_contract.delivery import Delivery, Loss
from sojourn_contract.disturbances import check_disturbances
from sojourn_contract.errors import LeapError, SensorRowError
from sojourn_contract.leaps import landing_grid
from sojourn_contract.link_topics import CANCEL, EARTH, LINK_STATUS, on_earth
from sojourn_contract.linked_table import linked
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S, NANOSECONDS
from sojourn_contract.stereo_pair import heard_by_drive
from sojourn_contract.topic_table import TopicTable, of_thing
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.topics import STANDARD
from sojourn_machine.chance import stream_of
from sojourn_machine.sensor_choice import SENSORS, SensorParams
from sojourn_machine.sensor_timing import SensorTimingParams

STORE = "store"
"""Rows with `each` of it stand once for each energy store."""
OWN = "{name}"
"""In a row of a kind of sensor: every sensor of the kind has that row alone, under its own name."""
TICK = "/operator/tick"
"""For which waits whoever acts on what an operator says, so that it takes effect at the same period in every run."""
_AT_TIMES = {row.name: row for row in (LINK_STATUS, CANCEL, CHECKPOINT)}
"""Rows that a run has with a link to Earth, or where it keeps checkpoints."""
RECORDED_BESIDES = {
    "/tf": (FieldRule("transforms.transform.translation", "m"), FieldRule("transforms.transform.rotation", ""))
}
"""Topics that the recorder adds, and the rules of their fields; no row is about them."""


def table_of(scenario: KnownMachine) -> TopicTable:
    """The topics of a run of a scenario, whoever takes part.

    Raises TopicNameError, SensorRowError, LeapError, DisturbanceError, LinkError; ConfigError for a sensor by whose
    name a topic would be there twice.
    """
    sensors = scenario.sensors.sensors.items()
    if isinstance(scenario, Bundle):
        _check_names(scenario)
    rows = {row.name: row for name, params in sensors for row in (*rows_of(params, name), *params.heard_rows)}
    brought = heard_by_drive(scenario, [row for name, row in rows.items() if name not in STANDARD])
    table = STANDARD.joined_with(brought).for_things(things_of(scenario)).heard_by(TICK, scenario.fault_roles)
    table = table.delivered(_delivered(scenario, table))
    asked = [name for name, params in sensors if params.on_demand]
    table = table.on_demand({row.name for name in asked for row in rows_of_sensor(scenario, table, name)})
    check_disturbances(scenario.disturbances, table)
    if not isinstance(scenario, LoadedScenario | FlightScenario):
        return table
    table, leaps = table if scenario.link is None else linked(table, scenario.link), scenario.leaps
    return table if leaps is None else TopicTable(table, _longest_leap(leaps.longest_s, table))


def _check_names(scenario: Bundle) -> None:
    """Raise ConfigError where the topics that a sensor has alone, under its own name, are those of others."""
    taken: dict[str, str] = {}
    problems: list[Problem] = []
    for name, params in scenario.sensors.named.items():
        for row in params.own_rows:
            topic = row.name.replace(OWN, name) if OWN in row.name else f"{row.name}/{name}" if row.all_named else ""
            whose = "every run" if OWN in row.name and topic in STANDARD else taken.get(topic)
            if topic and whose is not None:
                allowed = f"would speak on {topic}, a topic of {whose}: allowed is another name"
                problems.append(scenario.documents["sensors"].problem((name,), MISSING, allowed))
                break
            taken[topic] = f"the sensor {name}"
    if problems:
        raise ConfigError(problems)


def _longest_leap(longest_s: float, table: TopicTable) -> int:
    """Control periods; a multiple of those at which leaps land."""
    grid = landing_grid(table)
    longest = round(longest_s / CONTROL_PERIOD_S) // grid * grid
    if not longest:
        least = grid * CONTROL_PERIOD_NS // NANOSECONDS
        raise LeapError(f"longest_s = {longest_s:g}", f"{least} or more, after which every topic of the run is due")
    return longest


def rows_of_sensor(scenario: KnownMachine, table: TopicTable, name: str) -> Iterator[Topic]:
    """Rows of a run's table on which the sensor of a name speaks: those that it has alone, and of the others the first
    that has a row of its kind has it under the row's own name, unless that names all.
    """
    things = things_of(scenario)
    for row in rows_of(scenario.sensors.sensors[name], name):
        if row.each == STORE:
            yield from table.each(row.name)
        elif not row.each:
            yield table.topic(row.name)
        else:
            is_first = things[row.each][0] == name and not row.all_named
            yield table.topic(row.name if is_first else f"{row.name}/{name}")


def things_of(scenario: KnownMachine) -> Mapping[str, tuple[str, ...]]:
    """What a machine may have several of: names by what rows have as `each`, in the order of its files."""
    found: dict[str, tuple[str, ...]] = {STORE: tuple(scenario.power.all_stores)}
    for name, params in scenario.sensors.sensors.items():
        for each in dict.fromkeys(row.each for row in rows_of(params, name) if row.each not in (STORE, "")):
            found[each] = (*found.get(each, ()), name)
    return found


def rows_of(params: SensorParams | type[SensorParams], name: str = OWN) -> Iterator[Topic]:
    """Rows on which the first sensor of a kind speaks, and those that a sensor of this name has alone, which have no
    `each`. Raises SensorRowError for one that no sensor can have.
    """
    for row in params.speaks_on if isinstance(params, type) else params.own_rows:
        if row.publisher != "sensors" or row.is_event or not row.logged:
            raise SensorRowError(row.name, "a logged row of the role sensors, with a rate")
        if row.name in STANDARD and row != STANDARD.topic(row.name):
            raise SensorRowError(row.name, "a name that no topic of the contract has, or that topic's own row")
        if OWN in row.name:
            own = replace(row, name=row.name.replace(OWN, name))
            if own.name in STANDARD:
                raise SensorRowError(own.name, "a name that no topic of the contract has: name the sensor otherwise")
            yield own
        else:
            yield row if row.each else replace(row, each=row.name)


def row_named(name: str) -> Topic | None:
    """The row of a topic in whatever run has it: of every machine, or of a kind of sensor that is installed; None for a
    topic that no run has.
    """
    first, _, thing = name.rpartition("/")
    known = STANDARD.get(name) or _of_further(STANDARD.get(first), thing)
    if known is not None or name in RECORDED_BESIDES:
        return known
    if name in _AT_TIMES or name.startswith(f"{EARTH}/"):
        on_machine = _AT_TIMES.get(name) or row_named(name.removeprefix(EARTH))
        return on_machine if on_machine is None or name in _AT_TIMES else on_earth(on_machine)
    brought = _brought()
    return brought.get(name) or _of_further(brought.get(first), thing) or _own(name)


def _delivered(scenario: KnownMachine, table: TopicTable) -> Iterator[Topic]:
    """Rows of sensors with a timing of their own, and of those of which faults lose messages."""
    for name, params in scenario.sensors.sensors.items():
        timing, faults = params.heard
        if params.timing is not None or faults:
            lost = [Loss(round(after * NANOSECONDS), part, frozen) for after, part, frozen in faults]
            yield from (delivered(row, name, timing, lost) for row in rows_of_sensor(scenario, table, name))


def delivered(row: Topic, name: str, timing: SensorTimingParams, faults: Sequence[Loss] = ()) -> Topic:
    """A row as the sensor of a name speaks on it: with its own rate, and as much older as it is late. faults: what is
    lost besides.
    """
    every = timing.every or row.every
    latency, jitter = (round(time * NANOSECONDS) for time in (timing.latency, timing.jitter))
    delivery = Delivery(
        every=every,
        phase=timing.phase_periods,
        pace=gcd(row.every, every),
        latency=latency,
        jitter=jitter,
        losses=(Loss(0, timing.dropped), *faults),
        stream=stream_of(timing.seed, name),
    )
    age = row.max_age_s * every / row.every + timing.latency + timing.jitter
    return replace(row, every=every, max_age_s=age, delivery=delivery)


def _of_further(row: Topic | None, thing: str) -> Topic | None:
    return of_thing(row, thing) if row is not None and row.each and thing else None


@cache
def _brought() -> Mapping[str, Topic]:
    """Rows of all kinds of sensors that are installed."""
    kinds = [SENSORS.get(kind) for kind in SENSORS.names()]
    rows = [row for kind in kinds for row in (*rows_of(kind), *kind.hears)]
    return {row.name: row for row in rows if row.name not in STANDARD}


def _own(topic: str) -> Topic | None:
    """The row that one sensor has alone: its name is the first word of the topic."""
    _, _, rest = topic.removeprefix("/").partition("/")
    row = _brought().get(f"/{OWN}/{rest}")
    return None if row is None else replace(row, name=topic)
