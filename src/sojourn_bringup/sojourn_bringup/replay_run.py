"""A bag replayed, and the answers compared with the recorded ones: the work of scripts/replay."""

import argparse
import time

from sojourn_bags.compare_runs import exit_status, read_runs, write_result
from sojourn_bags.comparison_result import at
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.cut_off import unless_cut_off
from sojourn_bags.errors import BagsError
from sojourn_bags.reading import Bag
from sojourn_bags.replay import Replay, replay
from sojourn_bags.replay_choices import PREFIX
from sojourn_bags.run_configuration import run_configuration
from sojourn_bringup.bench_options import candidate_of, check_role
from sojourn_bringup.candidate_bench import bench, replay_settings
from sojourn_config.command_errors import UsageError


def wanted(given: argparse.Namespace) -> tuple[str, str]:
    """Role and command ("" for our own node). Raises UsageError."""
    if len(given.bag) != 1:
        raise UsageError(f"replay: give one BAG, not {len(given.bag) or 'none'}")
    if given.missed:
        raise UsageError("replay: --missed goes with --coverage")
    if given.direct and given.exec:
        raise UsageError("replay: --direct is for our own nodes: a program is replayed over topics")
    if bool(given.node) == bool(given.exec):
        raise UsageError("replay: give either --node ROLE or --exec COMMAND --role ROLE")
    if given.exec and not given.role:
        raise UsageError("replay: --exec needs --role: whom it stands in for")
    if given.node and given.role and given.role != given.node:
        raise UsageError(f"replay: --node {given.node} and --role {given.role} are two roles")
    if given.exec:
        return candidate_of(given.exec, given.role)
    return check_role(given.node, "--node"), ""


def run_replay(given: argparse.Namespace, bag: Bag, role: str, command: str) -> Replay:
    """Replay, and leave no process and no file behind. Raises as `bench` does."""
    if given.direct:
        return replay_directly(bag, role)
    with bench(given, role, command, bag) as (candidate, configuration):
        return replay(bag, role, candidate, configuration, replay_settings(given))


def replay_directly(bag: Bag, role: str) -> Replay:
    """Replay through our app of a role, without middleware. Raises UsageError: the bag cannot be played."""
    from sojourn_stack.replay import app_of  # here: it loads every app, which a replay over topics does without
    from sojourn_stack.replay import replay as replay_app

    try:
        with run_configuration(bag) as configuration:
            for warning in configuration.warnings():
                print(f"note: {warning}")
            return replay_app(bag, role, app_of(role, configuration))
    except BagsError as error:
        raise UsageError(str(error)) from error


def run(given: argparse.Namespace) -> int:
    """Replay, compare and tell. Returns the exit status."""
    role, command = wanted(given)
    (bag,) = read_runs(given.bag)
    begun = time.monotonic()
    result = run_replay(given, bag, role, command)
    script = result.script
    cut = ", which is cut off: as far as it goes" if script.cut_off else ""
    print(
        f"{command or role}: {len(script.steps)} periods of {bag.path}{cut}, "
        f"{at(script.end)} replayed in {time.monotonic() - begun:.1f} s"
    )
    print("\n".join(comparison_lines(result.comparison, "recorded", "replayed")))
    data = {"bag": str(bag.path), "role": role, "command": command, "cut_off": script.cut_off}
    sides = (dict(script.recorded), dict(result.answers))
    write_result(given, result.comparison, data | result.comparison.as_data(), sides, PREFIX, bag)
    return unless_cut_off(exit_status(result.comparison.verdict, given.exact), [bag])
