"""Runs of a scenario with one fault each, and how that fault showed.

A run goes on until the fault should have shown, and no longer. One without a fault tells of false alarms: what is
expected of each fault is looked for in it for as long as the longest of the runs.
"""

import json
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sojourn_bags.detection import FALSE_ALARM, FaultResult, judge_faults
from sojourn_bags.reading import read_bag
from sojourn_config.command_errors import UsageError
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import ROLES
from sojourn_machine.fault_choice import FaultChoice
from sojourn_operator.scenario_steps import absent_roles, prepare_scenario
from sojourn_stack.run import RunSpec, run
from sojourn_stack.stack import StackState

AFTER_S = 2.0
"""Simulated time for which a run goes on after the fault should have shown [s]: a status comes once a second."""
NO_FAULT = "no fault"


@dataclass(frozen=True)
class FaultRun:
    """One run.

    Args:
        scenario: its name. seed: of the run. fault: that came, NO_FAULT where none did.
        result: how it showed; of a run without a fault the false alarm of one, or None.
    """

    scenario: str
    seed: int
    fault: str
    result: FaultResult | None


def judged_faults(scenario: str, overrides: Sequence[str], only: Sequence[str] = ()) -> list[FaultChoice]:
    """The faults of a scenario that say how they should show, or those of these names.

    Raises:
        ConfigError: the scenario is wrong. UsageError: there are none, or one has not that name.
    """
    found = prepare_scenario(scenario, overrides).loaded.config.faults
    faults = [fault for fault in found if fault.expect is not None]
    names = [fault.called for fault in faults]
    for name in only:
        if name not in names:
            raise UsageError(f"--only: fault {name!r} of {scenario}: allowed is one of {', '.join(names) or 'none'}")
    if not faults:
        raise UsageError(f"{scenario}: no fault says how it should show: allowed is one with the key expect")
    return [fault for fault in faults if not only or fault.called in only]


def fault_runs(
    scenario: str, faults: Sequence[FaultChoice], seeds: Sequence[int], overrides: Sequence[str] = ()
) -> Iterator[FaultRun]:
    """Every run of a scenario, seed by seed: first without a fault, then with each alone."""
    longest = max(_end_s(fault, seed) for fault in faults for seed in seeds)
    for seed in seeds:
        for result in _judged(scenario, seed, (), faults, longest, overrides):
            if result.outcome == FALSE_ALARM:
                yield FaultRun(scenario, seed, NO_FAULT, result)
        yield FaultRun(scenario, seed, NO_FAULT, None)
        for fault in faults:
            (result,) = _judged(scenario, seed, (fault,), (fault,), _end_s(fault, seed), overrides)
            yield FaultRun(scenario, seed, fault.called, result)


def _judged(
    scenario: str,
    seed: int,
    acting: Sequence[FaultChoice],
    judged: Sequence[FaultChoice],
    end_s: float,
    overrides: Sequence[str],
) -> list[FaultResult]:
    words = [fault.model_dump(mode="json", exclude_none=True, exclude_defaults=False) for fault in acting]
    told = (*overrides, f"seed={seed}", f"faults={json.dumps(words)}")
    prepared = prepare_scenario(scenario, told)
    absent = absent_roles(prepared.loaded)
    participants = tuple(role for role in ROLES if role not in absent)
    end = round(end_s * NANOSECONDS)

    def goes_on(state: StackState) -> bool:
        return state.now < end

    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        run(RunSpec(scenario, participants, told, bag, prepared.loaded), goes_on)
        return judge_faults(read_bag(bag), judged)


def _end_s(fault: FaultChoice, seed: int) -> float:
    """When a fault should have shown [s]; of one that an event brings nobody knows when it comes."""
    time, within = fault.time(seed), 0.0 if fault.expect is None else fault.expect.within
    return float("1e6") if time is None else time + within + AFTER_S
