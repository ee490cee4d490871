"""Judges a bag by the contract: hands its messages, in the order of the file, to the judge of `sojourn_contract`."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import yaml

from sojourn_bags.contract_version import check_own_contract, table_of_bag
from sojourn_bags.definitions import RUN_RECORD, THINNED_RECORD
from sojourn_bags.description import Run
from sojourn_bags.errors import BagsError, IncompleteConfigError, UnreadableMessageError
from sojourn_bags.messages import Messages
from sojourn_bags.onset import RESUMED
from sojourn_bags.reading import Bag
from sojourn_bags.thinning import roles_of
from sojourn_bags.transforms import TOPIC as TRANSFORMS
from sojourn_config.errors import ConfigError
from sojourn_config.urdf import parse_urdf
from sojourn_contract.conformance.endpoints import BEST_EFFORT, RELIABLE, Endpoint
from sojourn_contract.conformance.findings import Finding, Report
from sojourn_contract.conformance.judge import CLOCK, Judge
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import ROLES, STANDARD, TOPICS
from sojourn_machine.errors import UnknownNameError

_RELIABILITY_CODES = {1: RELIABLE, 2: BEST_EFFORT}
"""Numbers that older recorders write for words."""


class UnjudgeableBagError(BagsError):
    """A bag that cannot be judged: it lacks what the judge needs."""


@dataclass(frozen=True)
class Recorded:
    """How a run was recorded.

    Args:
        lockstep: mode of time. participants: roles of the run. by_us: whether our recorder wrote it, so that log
            times are simulation time. notes: what a reader of the verdict should know. from_start: whether it has the
            run from its first period, not from a checkpoint on.
    """

    lockstep: bool
    participants: tuple[str, ...]
    by_us: bool
    notes: list[str] = field(default_factory=list)
    from_start: bool = True


def judge_bag(
    bag: Bag, roles: Collection[str] | None = None, machine: JudgedMachine | None = None
) -> tuple[Report, Recorded]:
    """Judge the messages of these roles, None for all whose topics the bag has.

    Args:
        machine: the rover, None for the one that the bag describes.

    Raises:
        OtherContractError: another contract.
        UnjudgeableBagError: no message of the contract, a role that took no part.
    """
    run = recorded_as(bag)
    if roles is None and THINNED_RECORD in bag.records:
        roles = roles_of(bag)
        run.notes.append(f"the bag is thinned to the topics of {', '.join(roles)}: the others were not judged")
    for role in roles or ():
        if role not in run.participants:
            took_part = ", ".join(run.participants)
            raise UnjudgeableBagError(f"{bag.path}: role {role!r} took no part in this run, only {took_part}")
    table = table_of_bag(bag)
    unseen = [row.name for row in table if not row.logged and row.name not in bag]
    judge = Judge(
        replace(machine or machine_of(bag), table=table),
        lockstep=run.lockstep,
        participants=run.participants,
        roles=roles,
        unseen=unseen,
        from_start=run.from_start,
    )
    for name, messages in bag.topics.items():
        for endpoint in endpoints_of(messages):
            judge.endpoint(name, endpoint)
    for unusable in bag.unusable:
        judge.report.add("type", unusable.topic, unusable.log_time, [Finding("message", "unusable", unusable.reason)])
    for messages, index in in_order(bag, table):
        logged = messages.log_times[index] if run.by_us else None
        try:
            judge.take(messages.topic, messages.decode(index), logged)
        except UnreadableMessageError as error:
            size = f"{len(messages.data[index])} bytes"
            judge.report.add("type", messages.topic, logged, [Finding("message", size, f"{messages.type}: {error}")])
    known = {name: count for name, count in judge.strangers.items() if name != TRANSFORMS}
    if known:
        run.notes.append(f"topics that are not of the contract were not judged: {', '.join(sorted(known))}")
    return judge.finish(), run


def recorded_as(bag: Bag) -> Recorded:
    """How the bag was recorded, from what it says of itself. Raises OtherContractError, UnjudgeableBagError."""
    notes = []
    named = check_own_contract(bag)
    if not named:
        notes.append("the bag does not say under which contract it was recorded: judged by the present one")
    if not any(row.name in bag for row in TOPICS):
        raise UnjudgeableBagError(f"{bag.path} holds no message of the contract")
    if bag.misfit:
        notes.append(f"the bag is not what was recorded: {bag.misfit}")
    elif not bag.whole:
        until = max(messages.log_times[-1] for messages in bag.topics.values()) / 1e9
        notes.append(f"the bag is cut off: judged as far as it goes, {until:.2f} s")
    record = bag.records.get(RUN_RECORD, {})
    participants = tuple(role for role in record.get("participants", "").split(",") if role in ROLES)
    lockstep = record["lockstep"] == "true" if "lockstep" in record else _clock_is_reliable(bag)
    # a bag of ours that was cut off has no record of the run yet, but its attachments
    by_us = bool(record) or named
    return Recorded(lockstep, participants or _speakers(bag, by_us), by_us, notes, RESUMED not in record)


def machine_of(bag: Bag) -> JudgedMachine:
    """The rover that the bag describes. Raises UnjudgeableBagError if it describes none."""
    try:
        run = Run.of_bag(bag)
        power = run.resolved["power"]
        buses = [power["bus"], *power["buses"].values()]
        return JudgedMachine.of(
            run.scenario.machine,
            run.machine,
            parse_urdf(run.urdf, f"URDF of {run.name}"),
            run.arm_joints,
            [load["name"] for bus in buses for load in bus["loads"]],
            () if run.arm is None else tuple(run.arm["named_poses"]),
            run.tool,
            run.moving_joints,
        )
    except (IncompleteConfigError, ConfigError, UnknownNameError, KeyError) as error:
        text = f"{bag.path} does not describe its rover ({error}): name a scenario with it, --scenario NAME"
        raise UnjudgeableBagError(text) from error


def in_order(bag: Bag, table: TopicTable = STANDARD) -> Iterator[tuple[Messages, int]]:
    """All messages by log time, and at the same time in the order of the topic table: topic and index."""
    ranks = {row.name: rank for rank, row in enumerate(table)}
    order = sorted(
        (log_time, ranks.get(name, len(ranks)), name, index)
        for name, messages in bag.topics.items()
        for index, log_time in enumerate(messages.log_times)
    )
    for _, _, name, index in order:
        yield bag.topics[name], index


def endpoints_of(messages: Messages) -> Iterator[Endpoint]:
    """Publishers of a topic, as its channel tells of them: at least the type."""
    package, _, short = messages.type.partition("/msg/")
    kind = f"{package}/{short}"
    profiles = _profiles(messages.offered_qos)
    for profile in profiles:
        code = profile.get("reliability", "")
        yield Endpoint(kind, reliability=_RELIABILITY_CODES.get(code, str(code)))
    if not profiles:
        yield Endpoint(kind)


def _profiles(text: str) -> Sequence[dict[str, Any]]:
    try:
        found = yaml.safe_load(text) if text else None
    except yaml.YAMLError:
        found = None
    return [entry for entry in found if isinstance(entry, dict)] if isinstance(found, list) else []


def _clock_is_reliable(bag: Bag) -> bool:
    """Only in lock-step /clock is reliable."""
    profiles = _profiles(bag[CLOCK].offered_qos) if CLOCK in bag else []
    return any(
        _RELIABILITY_CODES.get(entry.get("reliability", ""), entry.get("reliability")) == RELIABLE for entry in profiles
    )


def _speakers(bag: Bag, by_us: bool) -> tuple[str, ...]:
    """Roles of which something has been recorded, and our recorder, whose own topic is in no bag."""
    found = {row.publisher for row in TOPICS if row.name in bag} | ({"recorder"} if by_us else set())
    return tuple(role for role in ROLES if role in found)
