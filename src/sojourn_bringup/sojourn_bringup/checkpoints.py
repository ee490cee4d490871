"""Checkpoints of a run without middleware: kept at even times, and a run that goes on from one of them.

A run goes on only with the files that it began with, and then it is the run that it would have been, bit for bit. With
other values over the files (--set) it branches off; they may change what the world is like, not what the state
consists of.
"""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sojourn_bags.errors import UnreadableBagError
from sojourn_bags.reading import bag_file
from sojourn_bringup.plan import RunPlan
from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import LoadedScenario, ScenarioConfig
from sojourn_config.steps import StepConfig
from sojourn_contract.checkpoint_times import EvenTimes
from sojourn_contract.role_state import ForeignState, RoleState
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS, seconds
from sojourn_contract.state_tree import CheckpointError
from sojourn_operator.app import OperatorApp, OperatorState
from sojourn_operator.scenario_steps import PreparedScenario, prepare_scenario
from sojourn_stack.apps import make_apps
from sojourn_stack.checkpoint import Origin, read, save
from sojourn_stack.stack import Stack, StackState
from sojourn_stack.structure import difference, misfit

FOLDER, SUFFIX = "checkpoints", ".checkpoint"
HALF_PERIOD_S = seconds(CONTROL_PERIOD_NS) / 2
ONLY_AT_START = ("start", "battery_soc", "seed", "terrain")
"""Values of a scenario that the state of a run has taken the place of: noise goes on from where it is, and the machine
stands on the ground that there was.
"""
OF_OPERATOR = ("steps", "faults", "link")
"""Values of a scenario that the role operator carries out."""


class CheckpointKeeper:
    """Writes the state of a run into its folder, each time that so much simulation time has passed.

    Args:
        run_dir: folder of the run. every_s: simulation time from one to the next [s]. origin: of which run they are.
        begun_s: simulation time at which it looks for the first time [s].
    """

    def __init__(self, run_dir: Path, every_s: float, origin: Origin, begun_s: float = 0.0) -> None:
        self._folder, self._origin = run_dir / FOLDER, origin
        self._times = EvenTimes(every_s, begun_s)

    def look(self, state: StackState) -> None:
        """After each control period.

        Raises:
            OSError: a checkpoint cannot be written. CheckpointError: the state holds what cannot be kept.
        """
        if self.is_due(seconds(state.now)):
            self.keep(state)

    def is_due(self, now: float) -> bool:
        """Whether a checkpoint is wanted of a simulation time [s]."""
        return self._times.is_due(now)

    def keep(self, state: StackState) -> None:
        """Write a checkpoint. Raises as `look`."""
        now = seconds(state.now)
        self._times.passed(now)
        self._folder.mkdir(exist_ok=True)
        save(state, self._folder / f"{now:08.2f}{SUFFIX}", self._origin)


@dataclass(frozen=True)
class Resumption:
    """A run that goes on.

    Args:
        scenario: with what goes over it now. participants: all roles. state: where it goes on from.
    """

    scenario: PreparedScenario
    participants: tuple[str, ...]
    state: StackState


def keeper_of(plan: RunPlan, loaded: LoadedScenario) -> CheckpointKeeper | None:
    """Of a run and its scenario; None where no checkpoints are asked for."""
    if plan.checkpoint_every_s is None:
        return None
    origin = Origin(plan.scenario, tuple(plan.overrides), tuple(plan.participants), _digests(loaded))
    begun = 0.0 if plan.begin is None else seconds(plan.begin.now)
    return CheckpointKeeper(plan.run_dir, plan.checkpoint_every_s, origin, begun)


def last_before(bag: Path, at_s: float) -> Path:
    """The last checkpoint at or before a simulation time [s] of those that the run of a bag has kept beside it.

    Args:
        bag: of the run: its folder, that of the run, or its MCAP file. at_s: infinity for the last of all.

    Raises:
        UsageError: there is none.
    """
    try:
        folder = bag_file(bag).absolute().parent.parent / FOLDER
    except UnreadableBagError as error:
        raise UsageError(f"--from {error}") from error
    kept = sorted((time, file) for file in folder.glob(f"*{SUFFIX}") if (time := _time_of(file)) is not None)
    if not kept:
        raise UsageError(f"--from {bag}: its run has kept no checkpoint: allowed is one with --checkpoint-every")
    found = [file for time, file in kept if time <= at_s + HALF_PERIOD_S]
    if not found:
        first = f"the first checkpoint of {bag} is of {kept[0][0]:g} s"
        raise UsageError(f"--at {at_s:g}: {first}: allowed is from there on")
    return found[-1]


def _time_of(file: Path) -> float | None:
    """The simulation time that a file's name says [s], None where it says none."""
    try:
        return float(file.name.removesuffix(SUFFIX))
    except ValueError:
        return None


def resume(file: Path, overrides: Sequence[str] = ()) -> Resumption:
    """The run of a checkpoint, with further values over its files.

    Raises:
        UsageError: the file is no checkpoint, the files of its run have changed, or the state does not fit the values.
        ConfigError: the values are wrong.
    """
    try:
        state, origin = read(file)
    except CheckpointError as error:
        raise UsageError(str(error) if error.place == str(file) else f"{file}: {error}") from error
    except OSError as error:
        raise UsageError(f"{file}: it cannot be read: {error.strerror or error}") from error
    if origin is None:
        raise UsageError(f"{file}: it does not say of which run it is")
    if state.finished:
        raise UsageError(f"{file}: the run had ended, there is nothing to go on with")
    as_it_was = prepare_scenario(origin.scenario, origin.overrides)
    now = _digests(as_it_was.loaded)
    changed = sorted(name for name in {*now, *origin.digests} if now.get(name) != origin.digests.get(name))
    if changed:
        allowed = "a run goes on with the files that it began with, and --set KEY=VALUE puts other values over them"
        raise UsageError(f"{file}: {', '.join(changed)} changed since: {allowed}")
    begun = _begun(as_it_was.loaded, origin.participants)
    altered = _first(
        _altered(one.app, state.roles[role].app, role) for role, one in begun.items() if role in state.roles
    )
    if altered:
        raise UsageError(f"{file}: it is no state of its run ({altered})")
    if not overrides:
        return Resumption(as_it_was, origin.participants, state)
    branched = prepare_scenario(origin.scenario, (*origin.overrides, *overrides))
    late = _too_late(as_it_was.loaded.config, branched.loaded.config, state)
    if late:
        raise UsageError(f"{file}: {late}")
    idle = _idle(as_it_was.loaded.config, branched.loaded.config)
    if idle and OperatorApp.role not in origin.participants:
        reason = "carried out by the role operator, which takes no part in the run of this checkpoint"
        raise UsageError(f"{file}: {' and '.join(idle)}: {reason}: allowed is none of them")
    unlike = _unlike(begun, _begun(branched.loaded, origin.participants))
    if unlike:
        raise UsageError(f"{file}: with these values the run would have another state ({unlike})")
    return Resumption(branched, origin.participants, state)


def what_keeps_from_resuming(state: StackState, replaced: Mapping[str, str]) -> str:
    """Why a state cannot be gone on from with these roles replaced, in words: each has to go back to a node of the kind
    that it is of; "" where it can.
    """
    for role, one in state.roles.items():
        is_foreign = isinstance(one.app, ForeignState)
        if is_foreign and role not in replaced:
            return f"it has the state of a {role} of others: allowed is --processes --replace {role}=COMMAND with it"
        if role in replaced and not is_foreign:
            return f"it has the state of our own {role}, which no node of others can read: allowed is none in its place"
    return ""


def _digests(loaded: LoadedScenario) -> dict[str, str]:
    texts = {name: hashlib.sha256(text.encode()).hexdigest() for name, text in loaded.files.items()}
    return {**texts, **loaded.digests}


def _too_late(one: ScenarioConfig, other: ScenarioConfig, state: StackState) -> str:
    """What another run changes that is over in a state, in words; "" where that is nothing. It would have no effect,
    and yet stand in its record.
    """
    for name in ONLY_AT_START:
        if getattr(one, name) != getattr(other, name):
            return f"{name} is of the start, which is over: allowed is what acts from {seconds(state.now):g} s on"
    begun = _steps_begun(state)
    for place in range(begun):
        pair = [config.steps[place] if place < len(config.steps) else None for config in (one, other)]
        if pair[0] != pair[1] and not (place == begun - 1 and _do_the_same(*pair)):
            allowed = f"its steps from steps[{begun}] on, and the time-out of the step that goes on"
            return f"steps[{place}] has begun: allowed is a change of {allowed}"
    return ""


def _idle(one: ScenarioConfig, other: ScenarioConfig) -> list[str]:
    """What another run would have its operator carry out that the one has not."""
    return [name for name in OF_OPERATOR if getattr(other, name) and getattr(other, name) != getattr(one, name)]


def _steps_begun(state: StackState) -> int:
    """Steps of the operator that have begun, those among them that have ended."""
    operator = state.roles.get(OperatorApp.role)
    if operator is None or not isinstance(operator.app, OperatorState):
        return 0
    script = operator.app.script
    return len(script.results) + (script.since is not None)


def _do_the_same(one: StepConfig | None, other: StepConfig | None) -> bool:
    """Whether steps differ by their time-outs alone."""
    return one is not None and other is not None and (one.kind, one.action) == (other.kind, other.action)


def _altered(first: Any, later: Any, role: str) -> str:
    """Why the state of a role is none to which its run can have come; that of a node of others only it knows."""
    if isinstance(later, ForeignState):
        return ""
    if type(first) is not type(later):
        return f"{role}: a {type(later).__name__}, and the run begins with a {type(first).__name__}"
    return misfit(first, later, role)


def _unlike(states: Mapping[str, RoleState], others: Mapping[str, RoleState]) -> str:
    """The first difference in structure of what two runs begin with."""
    if set(states) != set(others):
        return f"roles: {', '.join(set(states) ^ set(others))}"
    return _first(difference(states[role].app, others[role].app, role) for role in states)


def _first(found: Iterable[str]) -> str:
    """The first words of several; "" where there are none."""
    return next(filter(None, found), "")


def _begun(loaded: LoadedScenario, participants: Sequence[str]) -> Mapping[str, RoleState]:
    """The roles of a run after its first period: sensors have no state before."""
    stack = Stack(make_apps(loaded, participants), participants, table_of(loaded))
    state, _ = stack.begin()
    return stack.step(state)[0].roles
