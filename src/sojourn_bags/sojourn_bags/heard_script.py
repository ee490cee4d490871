"""What a role of a run in real time acted on, period by period, as its heartbeats tell it: the script of its replay.

In real time a node acts on whatever has come, and no stamp says what that was; so each tells in its heartbeat what it
went by. The script ends with the last heartbeat of the role that is in the bag, or with its process.
"""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from sojourn_bags.comparison import stamps_of
from sojourn_bags.contract_version import check_contract, table_of_bag
from sojourn_bags.cut_off import check_recorded
from sojourn_bags.errors import ReplayError
from sojourn_bags.messages import Messages
from sojourn_bags.provenance import run_of
from sojourn_bags.reading import Bag
from sojourn_bags.replay_script import HEARTBEATS, ReplayPeriod, ReplayScript, own_heartbeats
from sojourn_bags.role_beats import beats_of
from sojourn_contract.arrival import check_input
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heard import Acted, Took, acted_in, took_in
from sojourn_contract.heartbeat import Heartbeat
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic

PLANT = "plant"


@dataclass(frozen=True)
class HeardPeriod:
    """A period on which a role acted.

    Args:
        at: its stamp [ns]. inputs: CDR by topic, None where there was none to act on. goals: (topic, CDR) in order.
        last_refusal: the role's own word of what it refused last, as far as it is known.
    """

    at: int
    inputs: Mapping[str, bytes | None]
    goals: Sequence[tuple[str, bytes]]
    last_refusal: str


@dataclass(frozen=True)
class HeardScript:
    """All of a replay.

    Args:
        script: what was said and by whom, with steps that hold no message. periods: in order.
    """

    script: ReplayScript
    periods: tuple[HeardPeriod, ...]


def heard_script_of(bag: Bag, role: str) -> HeardScript:
    """The script of a role in a bag that was recorded in real time.

    Raises:
        ReplayError: the role did not take part, or nothing tells what it acted on.
        OtherContractError, IncompleteConfigError: of the bag.
    """
    check_contract(bag)
    check_recorded(bag)
    participants, table = tuple(run_of(bag)["participants"].split(",")), table_of_bag(bag)
    if role not in participants:
        raise ReplayError(f"{bag.path} is of a run without {role}: there were {', '.join(participants)}")
    beats = _first_life(_heartbeats(bag, role))
    try:
        acted = [(each, beat.values.get("last refusal", "")) for beat in beats for each in acted_in(beat.values)]
        took = [goal for beat in beats for goal in took_in(beat.values)]
    except RefusedMessageError as error:
        raise ReplayError(f"{bag.path}: {error}") from error
    if not acted:
        raise ReplayError(f"{bag.path}: nothing in it tells what {role} acted on, so that it cannot be replayed")
    _check_names(bag, role, table.inputs_of(role, {*participants, role}), acted, took)
    periods = _periods(bag, table, acted, took)
    recorded = _said(bag, table, role, {period.at for period in periods})
    if not recorded:
        raise ReplayError(f"{bag.path} lacks the answers of {role}: there is nothing to compare with")
    steps = tuple(ReplayPeriod(period.at // CONTROL_PERIOD_NS) for period in periods)
    script = ReplayScript(
        role, participants, table, steps, table.inputs_of(role, participants), recorded, not bag.whole
    )
    return HeardScript(script, periods)


def _heartbeats(bag: Bag, role: str) -> list[Heartbeat]:
    if HEARTBEATS not in bag:
        return []
    beats = own_heartbeats(bag[HEARTBEATS], role)
    row = table_of_bag(bag).topic(HEARTBEATS)
    try:
        return [beat for data in beats.data for beat in beats_of(role, row, data)]
    except RefusedMessageError as error:
        raise ReplayError(f"{bag.path}: {error}") from error


def _first_life(beats: Sequence[Heartbeat]) -> list[Heartbeat]:
    """Until its process was started again, which begins to count anew."""
    found: list[Heartbeat] = []
    for beat in beats:
        if found and sum(beat.published.values()) < sum(found[-1].published.values()):
            break
        found.append(beat)
    return found


def _check_names(
    bag: Bag, role: str, heard: Sequence[Topic], acted: Sequence[tuple[Acted, str]], took: Sequence[Took]
) -> None:
    """Raise ReplayError unless the role tells of what it hears: of all its inputs, and of no goals but its own."""
    inputs = {row.name for row in heard if not row.is_event and row.publisher != "all"}
    wrong = {goal.topic for goal in took} - {row.name for row in heard if row.is_event}
    for each, _ in acted:
        wrong |= each.inputs.keys() ^ inputs
    if wrong:
        told = ", ".join(map(repr, sorted(wrong)))
        raise ReplayError(
            f"{bag.path}: what {role} tells of {told} is not what it hears, so that it cannot be replayed"
        )


def _periods(
    bag: Bag, table: TopicTable, acted: Sequence[tuple[Acted, str]], took: Sequence[Took]
) -> tuple[HeardPeriod, ...]:
    stamped = {name: _by_stamp(bag.topics.get(name)) for each, _ in acted for name in each.inputs}
    waiting = {name: _by_stamp(bag.topics.get(name)) for name in {goal.topic for goal in took}}
    goals: dict[int, list[tuple[str, bytes]]] = defaultdict(list)
    for goal in sorted(took, key=lambda one: one.at):
        row, left = table.topic(goal.topic), waiting[goal.topic].get(goal.stamp, [])
        while left and not _is_readable(row, left[0]):
            left.pop(0)
        if not left:
            raise ReplayError(f"{bag.path} lacks the goal on {goal.topic} that took effect at {goal.at / 1e9:.2f} s")
        goals[goal.at].append((goal.topic, left.pop(0)))
    found = []
    for each, refusal in acted:
        inputs: dict[str, bytes | None] = {}
        for name, stamp in each.inputs.items():
            data = None if stamp is None else next(iter(stamped[name].get(stamp, ())), None)
            if data is None and stamp is not None:
                raise ReplayError(
                    f"{bag.path} lacks the message on {name} stamped {stamp / 1e9:.2f} s, on which was acted"
                )
            inputs[name] = data
        found.append(HeardPeriod(each.at, inputs, goals.pop(each.at, []), refusal))
    return tuple(found)


def _by_stamp(messages: Messages | None) -> dict[int, list[bytes]]:
    found: dict[int, list[bytes]] = defaultdict(list)
    if messages is not None:
        for index, stamp in enumerate(stamps_of(messages)):
            found[stamp].append(messages.data[index])
    return found


def _is_readable(row: Topic, data: bytes) -> bool:
    """Whether a goal is one: of those that are none, nobody has taken any."""
    try:
        check_input(row, decode(row, data))
    except RefusedMessageError:
        return False
    return True


def _said(bag: Bag, table: TopicTable, role: str, acted: Collection[int]) -> dict[str, Messages]:
    """What the role said in these periods, its heartbeats aside: they count what its node has sent, too. The plant
    tells the truth of the next period, and before all others that of the first.
    """
    if role == PLANT:
        acted = {CONTROL_PERIOD_NS, *acted, *(stamp + CONTROL_PERIOD_NS for stamp in acted)}
    found = {}
    for row in table.outputs_of(role, run_of(bag)["participants"].split(",")):
        if row.name == HEARTBEATS or row.name not in bag:
            continue
        messages = bag[row.name]
        kept = [index for index, stamp in enumerate(stamps_of(messages)) if stamp in acted]
        times = [messages.log_times[index] for index in kept]
        found[row.name] = Messages(row.name, messages.type, times, [messages.data[index] for index in kept])
    return {name: messages for name, messages in found.items() if len(messages)}
