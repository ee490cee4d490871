"""The work of scripts/alarms: limits, a bag or a running stack, what is printed."""

import argparse
import getpass
import json
from collections.abc import Sequence
from pathlib import Path

import yaml

from sojourn_bags.cut_off import unless_cut_off
from sojourn_bags.errors import BagsError
from sojourn_bags.reading import Bag, read_bag
from sojourn_bringup.alarm_lines import alarm_lines
from sojourn_bringup.alarms import SCENARIO
from sojourn_bringup.alarms_bag import watched_bag
from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.run_table import table_of
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.params import Severity
from sojourn_operator.alarms.watch import Watch, WatchState, limits_of
from sojourn_operator.scenario_steps import named_scenario


def run(given: argparse.Namespace) -> int:
    """Watch, and say how it stands. Status as `main` says."""
    try:
        if given.show_limits:
            limits = limits_of(named_scenario(given.scenario, given.machine, SCENARIO), given.limits)
            print(yaml.safe_dump({name: params.model_dump(mode="json", exclude_defaults=True)
                                  for name, params in limits.items()}, sort_keys=False), end="")  # fmt: skip
            return 0
        bags = [] if given.bag is None else [read_bag(given.bag)]
        watch, state, log, is_heard = (*_of_bag(bags[0], given.limits), True) if bags else _of_stack(given)
    except (BagsError, UnknownFieldNameError) as error:
        raise UsageError(str(error)) from error
    command_line.say("\n".join(alarm_lines(watch, state)))
    if given.json is not None:
        _write(given.json, watch, state, log)
    return unless_cut_off(1 if state.alarms.worst is Severity.CRITICAL or not is_heard else 0, bags)


def _of_bag(bag: Bag, limits: Path | None) -> tuple[Watch, WatchState, list[Event]]:
    watch, state, log = watched_bag(bag, limits)
    for event in log:
        command_line.say(event.line())
    return watch, state, log


def _of_stack(given: argparse.Namespace) -> tuple[Watch, WatchState, list[Event], bool]:
    """Last, whether the run was not silent at the end."""
    from sojourn_bringup.alarms_live import AlarmDesk  # not above: a bag needs no ROS

    scenario = named_scenario(given.scenario, given.machine, SCENARIO)
    watch = Watch(limits_of(scenario, given.limits), table_of(scenario))
    with AlarmDesk(given.domain, given.namespace, watch, given.who or getpass.getuser()) as desk:
        is_heard = desk.run(given.seconds, given.publish)
    return watch, desk.state, desk.log, is_heard


def _write(file: Path, watch: Watch, state: WatchState, log: Sequence[Event]) -> None:
    alarms = [{"alarm": status.name, **dict(status.values)} for status in watch.message(state).status]
    data = {"log": [event.as_data() for event in log], "alarms": alarms}
    try:
        file.write_text(json.dumps(data, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise UsageError(f"--json: {file} cannot be written: {error.strerror}") from error
