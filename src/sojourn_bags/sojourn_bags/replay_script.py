"""What a bag says that a role heard, in which order, and what it answered: the script of a replay. No ROS in here.

A step is a control period. In it stand the messages stamped with it, in the order of the file. A goal of the
scripted operator stands in the step of the tick that announces it, some periods before it takes effect; a goal
sent by hand in the step in which it took effect, as the role's heartbeat tells, or else in that under which the
recorder has filed it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

from sojourn_bags.comparison import stamps_of, until
from sojourn_bags.completeness import due_by
from sojourn_bags.contract_version import check_contract, table_of_bag
from sojourn_bags.cut_off import check_recorded
from sojourn_bags.errors import ReplayError
from sojourn_bags.messages import Messages
from sojourn_bags.onset import RESUMED
from sojourn_bags.provenance import run_of
from sojourn_bags.reading import Bag
from sojourn_bags.replay_choices import ROLES_TO_REPLAY
from sojourn_contract.barrier import awaited_inputs
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import parse_tick
from sojourn_contract.heard import took_in
from sojourn_contract.leaps import NO_LEAPS, Leaps, leaps_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import OPERATOR_LAG, topic

CLOCK, TICK, HEARTBEATS = "/clock", "/operator/tick", "/diagnostics"


@dataclass
class ReplayPeriod:
    """One control period.

    Args:
        period: number. goals: (topic, CDR), to be there before the inputs. inputs: (topic, CDR) in the order of the
            file. unannounced: topics of goals of which no tick tells, so that nobody will wait for them.
        by_hand: of these goals those that took effect in this period; untold: topics of the others.
    """

    period: int
    goals: list[tuple[str, bytes]] = field(default_factory=list)
    inputs: list[tuple[str, bytes]] = field(default_factory=list)
    unannounced: set[str] = field(default_factory=set)
    by_hand: list[tuple[str, bytes]] = field(default_factory=list)
    untold: set[str] = field(default_factory=set)

    def add_by_hand(self, name: str, data: bytes, told: bool) -> None:
        """A goal of which no tick tells; `told`: but the role tells that it took effect now."""
        self.unannounced.add(name)
        if told:
            self.by_hand.append((name, data))
        else:
            self.untold.add(name)


class Script(Protocol):
    """What a harness has to know of what it plays; attributes as in `ReplayScript`."""

    @property
    def role(self) -> str: ...
    @property
    def participants(self) -> tuple[str, ...]: ...
    @property
    def table(self) -> TopicTable: ...
    @property
    def steps(self) -> tuple[ReplayPeriod, ...]: ...
    @property
    def inputs(self) -> tuple[Topic, ...]: ...
    @property
    def recorded(self) -> Mapping[str, Messages]: ...
    @property
    def lead(self) -> int: ...
    @property
    def due(self) -> Mapping[str, Sequence[int]]: ...


@dataclass(frozen=True)
class ReplayScript:
    """All of a replay.

    Args:
        role: who is replayed. participants: roles of the run. table: topics of the run.
        steps: by period, from the first. inputs: rows that the role hears; those after the first `awaited` are
            goals and others that it does not wait for.
        recorded: what the role answered in the run, by topic. cut_off: whether the bag is. leaps: of the run's clock.
    """

    role: str
    participants: tuple[str, ...]
    table: TopicTable
    steps: tuple[ReplayPeriod, ...]
    inputs: tuple[Topic, ...]
    recorded: Mapping[str, Messages]
    cut_off: bool = False
    leaps: Leaps = NO_LEAPS

    @property
    def lead(self) -> int:
        """Periods by which an answer is stamped later than what it answers: the plant's truth is of the next one."""
        return 1 if self.role == "plant" else 0

    @property
    def due(self) -> dict[str, list[int]]:
        """Stamps [ns] at which the run has an answer, by topic. Heartbeats are not waited for."""
        return {name: sorted(set(stamps_of(each))) for name, each in self.recorded.items() if name != HEARTBEATS}

    @property
    def end(self) -> int:
        """Stamp [ns] of the last answer."""
        return max(stamps_of(messages)[-1] for messages in self.recorded.values())


def script_of(bag: Bag, role: str) -> ReplayScript:
    """The script of a role in a bag, as far as the bag goes.

    Raises:
        ReplayError: the role did not take part, the run was in real time, or a topic is missing.
        OtherContractError: the bag is of another contract. IncompleteConfigError: it does not say who took part.
    """
    check_contract(bag)
    run = run_of(bag)
    participants = tuple(run["participants"].split(","))
    if role not in ROLES_TO_REPLAY:
        raise ReplayError(f"role {role!r} cannot be replayed, allowed is one of {', '.join(ROLES_TO_REPLAY)}")
    if role not in participants:
        raise ReplayError(f"{bag.path} is of a run without {role}: there were {', '.join(participants)}")
    if run["lockstep"] != "true":
        reason = "was recorded in real time: it is replayed without middleware, --direct, by what its nodes heard"
        raise ReplayError(f"{bag.path} {reason}")
    if run.get(RESUMED):
        reason = "begins at a checkpoint, and a replay at the start of a run: replay the run that it went on from"
        raise ReplayError(f"{bag.path} {reason}")
    check_recorded(bag)
    topics = dict(bag.topics)
    if not bag.whole:
        topics = until(topics, max((each.log_times[-1] for each in topics.values()), default=0))
    if not topics:
        raise ReplayError(f"{bag.path} holds no whole period")
    table = table_of_bag(bag)
    awaited, outputs = awaited_inputs(role, participants, table), table.outputs_of(role, participants)
    inputs = _inputs(role, awaited, table, topics)
    recorded = {name: messages for name, messages in _answers(role, outputs, topics).items() if len(messages)}
    _check_topics(bag, role, (awaited, outputs), topics, recorded)
    leaps = _leaps(bag, table, topics)
    periods = _periods(role, topics, recorded, leaps)
    steps = _steps(role, inputs, topics, periods)
    return ReplayScript(role, participants, table, steps, inputs, recorded, not bag.whole, leaps)


def own_heartbeats(messages: Messages, role: str) -> Messages:
    """The heartbeats of one role."""
    chosen = [index for index in range(len(messages)) if _sender(messages, index) == role]
    return Messages(
        messages.topic,
        messages.type,
        [messages.log_times[index] for index in chosen],
        [messages.data[index] for index in chosen],
        [messages.places[index] for index in chosen],
    )


def _inputs(
    role: str, awaited: Sequence[Topic], table: TopicTable, topics: Mapping[str, Messages]
) -> tuple[Topic, ...]:
    """Rows that the role may hear: what it waits for, goals, heartbeats, and the clock where the plant is another."""
    names = {row.name for row in awaited}
    rows = [row for row in table.inputs_of(role) if row.name in names or row.is_event or row.publisher == "all"]
    clock = () if role == "plant" or CLOCK not in topics or CLOCK in names else (table.topic(CLOCK),)
    return (*clock, *rows)


def _answers(role: str, outputs: Sequence[Topic], topics: Mapping[str, Messages]) -> dict[str, Messages]:
    found = {row.name: topics[row.name] for row in outputs if row.name in topics}
    if HEARTBEATS in found:
        found[HEARTBEATS] = own_heartbeats(found[HEARTBEATS], role)
    return found


def _check_topics(
    bag: Bag,
    role: str,
    rows: tuple[Sequence[Topic], Sequence[Topic]],
    topics: Mapping[str, Messages],
    recorded: Mapping[str, Messages],
) -> None:
    """Raise ReplayError if a topic of the role is not in the bag, unless the run was too short for it.

    Args:
        rows: what the role waits for, and what it says.
    """
    periods = max(each.log_times[-1] for each in topics.values()) // CONTROL_PERIOD_NS
    awaited, outputs = rows
    for row in awaited:
        if row.logged and row.name not in topics and due_by(replace(row, lag=0), periods * CONTROL_PERIOD_NS):
            raise ReplayError(f"{bag.path} lacks {row.name}, without which {role} cannot be replayed")
    for row in outputs:
        if (
            not row.is_event
            and not row.on_demand
            and row.name not in recorded
            and due_by(replace(row, lag=0), (periods - 1) * CONTROL_PERIOD_NS)
        ):
            raise ReplayError(f"{bag.path} lacks {row.name} of {role}: there is nothing to compare its answers with")


def _leaps(bag: Bag, table: TopicTable, topics: Mapping[str, Messages]) -> Leaps:
    """Of the clock of the run."""
    if not table.longest_leap:
        return NO_LEAPS
    if CLOCK not in topics:
        raise ReplayError(f"{bag.path} lacks {CLOCK}, which tells where the clock of this run leapt")
    return leaps_of(stamps_of(topics[CLOCK]))


def _periods(
    role: str, topics: Mapping[str, Messages], recorded: Mapping[str, Messages], leaps: Leaps
) -> tuple[int, ...]:
    """Control periods of the run in which the role is played to."""
    last = max(stamps_of(messages)[-1] for messages in recorded.values()) // CONTROL_PERIOD_NS
    ends = any(ends and period + OPERATOR_LAG <= last for period, (_, ends) in ticks_of(topics).items())
    if role == "plant" and not ends:
        last = leaps.before(last)  # it would answer what the run did not ask for
    stamps = leaps.stamps(1, 0, last * CONTROL_PERIOD_NS)
    return tuple(stamp // CONTROL_PERIOD_NS for stamp in stamps)


def _steps(
    role: str, inputs: Sequence[Topic], topics: Mapping[str, Messages], periods: Sequence[int]
) -> tuple[ReplayPeriod, ...]:
    ticks, took = ticks_of(topics), _took(role, topics)
    steps = {period: ReplayPeriod(period) for period in periods}
    entries = []
    for row in inputs:
        if row.name == "/recorder/tick" or row.name not in topics:
            continue
        messages = topics[row.name]
        for index, stamp in enumerate(stamps_of(messages)):
            if row.publisher == "all" and _sender(messages, index) == role:
                continue
            entries.append((messages.places[index], row, stamp, messages.log_times[index], messages.data[index]))
    for _, row, stamp, log_time, data in sorted(entries, key=lambda entry: entry[0]):
        if row.is_event:
            announced, told = announced_in(row, stamp, ticks), took.get((row.name, stamp))
            at = told.pop(0) // CONTROL_PERIOD_NS if told and not announced else 0
            period = announced or at or max(1, log_time // CONTROL_PERIOD_NS)
            if period in steps:
                steps[period].goals.append((row.name, data))
                if not announced:
                    steps[period].add_by_hand(row.name, data, bool(at))
        elif (period := row.heard_at(stamp) // CONTROL_PERIOD_NS) in steps:
            steps[period].inputs.append((row.name, data))
    return tuple(steps.values())


def _took(role: str, topics: Mapping[str, Messages]) -> dict[tuple[str, int], list[int]]:
    """When goals took effect of which their stamp does not say it [ns], by topic and stamp, as the role tells."""
    found: dict[tuple[str, int], list[int]] = {}
    if HEARTBEATS not in topics:
        return found
    told = own_heartbeats(topics[HEARTBEATS], role)
    for index in range(len(told)):
        values = {pair.key: pair.value for pair in told.decode(index).status[0].values}
        try:
            goals = took_in(values)
        except RefusedMessageError:  # a word of somebody else's
            continue
        for goal in goals:
            found.setdefault((goal.topic, goal.stamp), []).append(goal.at)
    return found


def ticks_of(topics: Mapping[str, Messages]) -> dict[int, tuple[dict[str, int], bool]]:
    """Of each tick of the operator, by period: the goals sent so far, and whether it ends the run."""
    found: dict[int, tuple[dict[str, int], bool]] = {}
    if TICK not in topics:
        return found
    messages = topics[TICK]
    for index, stamp in enumerate(stamps_of(messages)):
        try:
            found[stamp // CONTROL_PERIOD_NS] = parse_tick(messages.decode(index).frame_id)
        except RefusedMessageError:  # the nodes refuse it, too
            continue
    return found


def announced_in(row: Topic, stamp: int, ticks: Mapping[int, tuple[dict[str, int], bool]]) -> int:
    """The period of the tick that tells of a scripted goal; 0 for a goal that was sent by hand."""
    period = stamp // CONTROL_PERIOD_NS - OPERATOR_LAG
    before = topic(TICK).every
    now, earlier = ticks.get(period, ({}, False))[0], ticks.get(period - before, ({}, False))[0]
    return period if now.get(row.name, 0) > earlier.get(row.name, 0) else 0


def _sender(messages: Messages, index: int) -> str:
    statuses = messages.decode(index).status
    return statuses[0].name if statuses else ""
