"""Starts a run: scripts/start.py SCENARIO [options]. Everything is checked before anything is started."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_bringup.plan import add_console, add_patience
from sojourn_bringup.process_table import role_list
from sojourn_config import command_line


def parser(program: str = "start.py") -> argparse.ArgumentParser:
    """Options of scripts/start.py; `program` is the name in messages."""
    result = command_line.Parser(
        prog=program,
        description="Start a scenario: every node as a process, in lock-step, until its operator is through or Ctrl-C.",
    )
    result.add_argument("scenario", nargs="?", help="name in config/scenarios, or a YAML file")
    layout = result.add_mutually_exclusive_group()
    layout.add_argument("--composed", action="store_true", help="all nodes in one process")
    layout.add_argument(
        "--direct", action="store_true", help="all roles in one process without middleware: the same values, sooner"
    )
    layout.add_argument(
        "--processes",
        action="store_true",
        help="every node a process of its own: as without this option, but for --resume and --from",
    )
    result.add_argument(
        "--checkpoint-every",
        type=command_line.positive,
        metavar="SECONDS",
        help="keep the state of the run in its folder each time that so much simulation time is over; in lock-step",
    )
    result.add_argument(
        "--resume",
        type=Path,
        metavar="FILE",
        help="in place of a scenario: go on from this checkpoint, --direct (the default here), --composed or "
        "--processes; with --set on another branch",
    )
    result.add_argument(
        "--from",
        type=Path,
        dest="from_bag",
        metavar="BAG",
        help="in place of a scenario: go on, as with --resume, from the checkpoints that the run of this bag has kept",
    )
    result.add_argument(
        "--at",
        type=command_line.number,
        metavar="SECONDS",
        help="with --from: the last checkpoint at or before this simulation time (default: the last of all)",
    )
    result.add_argument("--realtime", action="store_true", help="paced by the wall clock, not in lock-step")
    result.add_argument(
        "--without", type=role_list("--without"), default=(), metavar="A,B", help="roles that take no part"
    )
    result.add_argument(
        "--only",
        type=role_list("--only"),
        default=(),
        metavar="A,B",
        help="start these only; the others take part from elsewhere",
    )
    result.add_argument(
        "--replace",
        action="append",
        default=[],
        metavar="NAME=COMMAND",
        help="run this command as the node of a role. It gets the ROS arguments that our node would get (--ros-args -p "
        "... -r __ns:=...) and ROS_DOMAIN_ID; a program that is not of our .venv gets nothing of its environment",
    )
    result.add_argument(
        "--shadow",
        action="append",
        default=[],
        metavar="NAME=COMMAND",
        help="run this command beside the node of a role, on the same inputs. What it says is on /shadow/..., is "
        "compared with what our node says, and is not acted upon",
    )
    add_console(result)
    command_line.add_place(result)
    result.add_argument(
        "--network",
        action="store_true",
        help="find nodes on other machines too: opens UDP ports on every interface, see the manual's part on security",
    )
    result.add_argument(
        "--secure",
        action="store_true",
        help="DDS security: each role has keys of its own and may say and hear its rows of the contract; needs SROS 2",
    )
    result.add_argument("--run-dir", type=Path, metavar="DIR", help="folder of the run (default: a new one in runs/)")
    command_line.add_machine(result)
    result.add_argument("--seed", type=command_line.whole_number, metavar="N", help="seed in place of the scenario's")
    what = "set a value of the scenario or of a file that it names: battery_soc=0.5, soil.k_c=1400"
    command_line.add_changes(result, what)
    result.add_argument(
        "--resolved",
        action="store_true",
        help="start nothing: print every file of the run as it comes out, each value with file and line",
    )
    add_patience(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Start a run and return its status: 0 done, 1 failed, 2 bad usage or configuration, 130 interrupted."""
    options = parser()
    given = options.parse_args(arguments)
    if sum(one is not None for one in (given.scenario, given.resume, given.from_bag)) != 1:
        options.error("allowed is a scenario, or --resume FILE or --from BAG, which know their own")
    if given.at is not None and given.from_bag is None:
        options.error("--at says from when on to go on, and goes with --from BAG")
    from sojourn_bringup.start_run import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
