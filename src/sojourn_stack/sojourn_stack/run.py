"""One run, from its scenario to its result: no signals, no environment, no globals, so that many may follow one another
in one process.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from sojourn_bags.completeness import Completeness
from sojourn_bags.onset import WHOLE
from sojourn_bags.recorded_run import RecordedRun
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.run_table import table_of
from sojourn_operator.script import StepResult
from sojourn_stack.apps import make_apps
from sojourn_stack.recorder import DirectRecorder, onset_of
from sojourn_stack.stack import Said, Stack, StackState

OPERATOR = "operator"


@dataclass(frozen=True)
class RunSpec:
    """What to run.

    Args:
        scenario: name or file. participants: roles that take part. overrides: KEY=VALUE texts that go over it.
        bag: folder of the bag to write, made by the run; None for none.
        loaded: the scenario with the overrides where it has been read before; else the run reads it.
        begin: where the run goes on from, None for its start.
    """

    scenario: str
    participants: tuple[str, ...]
    overrides: tuple[str, ...] = ()
    bag: Path | None = None
    loaded: LoadedScenario | None = None
    begin: StackState | None = None


@dataclass(frozen=True)
class Result:
    """How it went.

    Args:
        state: at the end. steps: what became of the operator's. completeness: of the bag, None without one.
    """

    state: StackState
    steps: Sequence[StepResult]
    completeness: Completeness | None


class BegunRun(NamedTuple):
    """A run before its first period: what has been said of that is not recorded yet."""

    stack: Stack
    state: StackState
    said: list[Said]
    recorder: DirectRecorder | None


def begun(spec: RunSpec) -> BegunRun:
    """A run that somebody else steps. Raises as `run`, but for WaitingError."""
    scenario = spec.loaded or load_scenario(spec.scenario, spec.overrides)
    apps = make_apps(scenario, spec.participants)
    for app in apps.values():
        app.warm_up()
    table = table_of(scenario)
    stack = Stack(apps, spec.participants, table)
    state, said = stack.begin() if spec.begin is None else (spec.begin, stack.resume(spec.begin))
    if spec.bag is None:
        return BegunRun(stack, state, said, None)
    onset = WHOLE if spec.begin is None else onset_of(state, scenario)
    recorded = RecordedRun(spec.scenario, spec.overrides, spec.participants, loaded=scenario, onset=onset)
    return BegunRun(stack, state, said, DirectRecorder(spec.bag, recorded))


def run(spec: RunSpec, goes_on: Callable[[StackState], bool] = lambda state: True) -> Result:
    """Run until the operator is through, or as long as `goes_on`, asked after each control period, says so.

    Raises:
        ConfigError, MachineError: the scenario is wrong. BagsError: the bag cannot be written.
        WaitingError: a role waits for what nobody sends. MisfitError: it cannot go on from where it is to begin.
    """
    stack, state, said, recorder = begun(spec)
    try:
        while True:
            if recorder is not None:
                recorder.take(said)
            if state.finished or not goes_on(state):
                break
            state, said = stack.step(state)
        if recorder is not None:
            recorder.take(stack.farewells(state))
    finally:
        completeness = None if recorder is None else recorder.finish()
    return Result(state, step_results(state), completeness)


def step_results(state: StackState) -> Sequence[StepResult]:
    """What has become of the operator's steps so far."""
    operator = state.roles.get(OPERATOR)
    return () if operator is None else operator.app.script.results
