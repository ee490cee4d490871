"""Replays a bag through one node or candidate and compares its answers with the recorded ones: scripts/replay."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_bags.replay_choices import PREFIX, ROLES_TO_REPLAY
from sojourn_bringup.bench_options import add_bench
from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/replay."""
    result = command_line.Parser(
        prog="replay",
        description="Feed the recorded inputs of a role to a node, in lock-step over real topics, and compare its "
        "answers with the recorded ones. The status is 0 if they are identical or within the contract's tolerance, "
        "1 if not, or if the bag is cut off.",
    )
    roles = ", ".join(ROLES_TO_REPLAY)
    result.add_argument(
        "bag", type=Path, metavar="BAG", nargs="*", help="a run's folder or a bag, recorded in lock-step"
    )
    result.add_argument("--node", metavar="ROLE", help=f"replay our own node: {roles}")
    result.add_argument("--exec", metavar="COMMAND", help="replay this program; it gets the ROS arguments of our node")
    result.add_argument("--role", metavar="ROLE", help="with --exec: whom it stands in for")
    result.add_argument(
        "--direct", action="store_true", help="without middleware: our own node's app alone; the values are the same"
    )
    result.add_argument(
        "--coverage",
        action="store_true",
        help="tell which part of the flight laws a set of bags goes through (default: the reference bags), "
        "replayed directly; with --node of one role alone",
    )
    result.add_argument("--missed", action="store_true", help="with --coverage: name the lines that none goes through")
    result.add_argument("--exact", action="store_true", help="status 1 also for what is within tolerance")
    command_line.add_result(result, f"the replayed topics under {PREFIX}/...")
    add_bench(result)
    command_line.add_place(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Replay, compare and tell. Returns the exit status."""
    given = parser().parse_args(arguments)
    if given.coverage:
        from sojourn_bringup.replay_coverage import run_coverage  # not above: --help needs none of it

        return run_coverage(given)
    from sojourn_bringup.replay_run import run

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
