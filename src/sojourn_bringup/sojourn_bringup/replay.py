"""Replays a bag through one node or candidate and compares its answers with the recorded ones: scripts/replay."""

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from sojourn_bags.compare_command import exit_status, read_runs, write_result
from sojourn_bags.comparison_result import at
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.cut_off import unless_cut_off
from sojourn_bags.reading import Bag
from sojourn_bags.replay import PREFIX, Replay, replay
from sojourn_bags.replay_script import ROLES_TO_REPLAY
from sojourn_bringup.candidate_bench import add_bench, bench, candidate_of, check_role, replay_settings
from sojourn_config import command_line
from sojourn_config.command_errors import UsageError


def parser() -> argparse.ArgumentParser:
    """Options of scripts/replay."""
    result = command_line.Parser(
        prog="replay",
        description="Feed the recorded inputs of a role to a node, in lock-step over real topics, and compare its "
        "answers with the recorded ones. The status is 0 if they are identical or within the contract's tolerance, "
        "1 if not, or if the bag is cut off.",
    )
    roles = ", ".join(ROLES_TO_REPLAY)
    result.add_argument("bag", type=Path, metavar="BAG", help="a run's folder or a bag, recorded in lock-step")
    result.add_argument("--node", metavar="ROLE", help=f"replay our own node: {roles}")
    result.add_argument("--exec", metavar="COMMAND", help="replay this program; it gets the ROS arguments of our node")
    result.add_argument("--role", metavar="ROLE", help="with --exec: whom it stands in for")
    result.add_argument("--exact", action="store_true", help="status 1 also for what is within tolerance")
    command_line.add_result(result, f"the replayed topics under {PREFIX}/...")
    add_bench(result)
    command_line.add_place(result)
    return result


def wanted(given: argparse.Namespace) -> tuple[str, str]:
    """Role and command ("" for our own node). Raises UsageError."""
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
    with bench(given, role, command, bag) as (candidate, configuration):
        return replay(bag, role, candidate, configuration, replay_settings(given))


def main(arguments: Sequence[str] | None = None) -> int:
    """Replay, compare and tell. Returns the exit status."""
    given = parser().parse_args(arguments)
    role, command = wanted(given)
    (bag,) = read_runs([given.bag])
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


if __name__ == "__main__":
    command_line.run_script(main)
