"""The work of scripts/sequence."""

import argparse
import getpass
import json
from pathlib import Path

from sojourn_config.command_errors import CommandError, UsageError
from sojourn_contract.run_table import table_of
from sojourn_operator.scenario_steps import named_scenario
from sojourn_operator.sequence.file import read_sequence, scenario_text, sequence_text
from sojourn_operator.sequence.runner import SequenceRunner, SequenceState
from sojourn_operator.sequence.stream import dropped_s
from sojourn_operator.sequence_command import SCENARIO
from sojourn_operator.steps.step import RunFacts


def run(given: argparse.Namespace) -> int:
    """Status as `main` says."""
    scenario = named_scenario(given.scenario, given.machine, SCENARIO)
    if given.from_scenario:
        print(sequence_text(scenario), end="")
        return 0
    if given.file is None:
        raise UsageError("sequence: file is missing: allowed is the path of a sequence, or --from-scenario")
    table = table_of(scenario)
    config = read_sequence(given.file, scenario, table)
    if given.as_scenario:
        print(scenario_text(config), end="")
        return 0
    if given.check:
        print(f"{given.file}: {len(config.steps)} steps, nothing wrong")
        return 0
    terrain = scenario.height_field() if any(step.action.looks_at_ground for step in config.steps) else None
    runner = SequenceRunner(config, table, RunFacts(scenario.arm_joints, terrain), dropped_s(scenario))
    from sojourn_operator.sequence.desk import SequenceDesk  # not above: a check needs no ROS

    who = given.who or getpass.getuser()
    with SequenceDesk((given.domain, given.namespace), runner, table, who) as desk:
        if given.dry_run:
            return desk.forecast(given.timeout)
        if given.hold:
            desk.obey("h")
        is_good = desk.run()
    if given.json is not None:
        _write(given.json, desk.state)
    return 0 if is_good else 1


def _write(file: Path, state: SequenceState) -> None:
    data = {"phase": state.phase, "history": [entry.as_data() for entry in state.history]}
    try:
        file.write_text(json.dumps(data, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise CommandError(f"--json: {file} cannot be written: {error.strerror}") from error
