"""Sends a goal to a running stack from another terminal and shows its progress to the end: scripts/goal."""

import argparse
import sys
from collections.abc import Sequence
from itertools import islice

from sojourn_config import command_line
from sojourn_flight.arm.tasks.names import TASKS
from sojourn_machine.fault_names import FAULTS

VERBS = ("drive", "route", "arm", "task", "power", "here", "fault", "cancel", "stop")
WITH_VALUE = (
    "--domain", "--namespace", "--timeout", "--frame", "--yaw", "--z", "--within", "--name", "--over", "--set",
)  # fmt: skip
"""Options behind which their value stands."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/goal."""
    result = command_line.Parser(prog="goal", description="Send a goal to a running stack and follow it to its end.")
    commands = result.add_subparsers(dest="command", required=True)
    drive = commands.add_parser("drive", help="drive to a place")
    drive.add_argument("x", type=command_line.number, help="[m]")
    drive.add_argument("y", type=command_line.number, help="[m]")
    drive.add_argument("yaw", type=command_line.number, nargs="?", help="heading there [rad]; any if left out")
    drive.add_argument(
        "--z",
        type=command_line.number,
        default=0.0,
        help="height of the ground there [m], for the energy forecast; 0: not known",
    )
    drive.add_argument("--frame", default="map", help="map, odom or base_link (default: %(default)s)")
    drive.add_argument(
        "--over",
        metavar="SCENARIO",
        help="plan a route over this scenario's orbital map, and again where the drive finds it closed",
    )
    command_line.add_changes(drive, "of the scenario of --over: as the run was started with")
    route = commands.add_parser("route", help="drive along points")
    route.add_argument(
        "points", type=command_line.number, nargs="+", metavar="X Y", help="[m], one pair for each point"
    )
    route.add_argument("--yaw", type=command_line.number, help="heading at the last point [rad]; any if left out")
    route.add_argument("--frame", default="map", help="map, odom or base_link (default: %(default)s)")
    for command in (drive, route):
        command.add_argument(
            "--dry-run", action="store_true", help="do not drive: say what it would take, and whether it is allowed"
        )
    arm = commands.add_parser("arm", help="place the tip of the arm")
    for axis in ("x", "y", "z"):
        arm.add_argument(axis, type=command_line.number, help="[m]")
    arm.add_argument("--frame", default="base_link", help="base_link (default)")
    task = commands.add_parser("task", help="a task of the arm: guarded_move force=10 speed=0.01")
    task.add_argument("name", help=f"one of {', '.join(TASKS.names())}")
    task.add_argument("values", nargs="*", default=[], metavar="KEY=VALUE", help="its numbers; a vector as 0,0,-1")
    power = commands.add_parser("power", help="switch a load on or off")
    power.add_argument("load", help="its name in the machine's power.yaml; sleep: the machine")
    power.add_argument("switch", choices=("on", "off"))
    here = commands.add_parser("here", help="tell a drive that is lost where it is")
    for axis in ("x", "y"):
        here.add_argument(axis, type=command_line.number, help="on the map [m]")
    here.add_argument("yaw", type=command_line.number, help="heading [rad]")
    here.add_argument(
        "--within",
        type=command_line.positive,
        default=0.1,
        metavar="M",
        help="standard deviation of the place [m] and of the heading [rad] (default: %(default)s)",
    )
    fault = commands.add_parser("fault", help="let something fail: fault motor_dead joint=wheel_front_left_joint")
    fault.add_argument("kind", help=f"one of {', '.join(FAULTS.names())}")
    fault.add_argument(
        "values", nargs="*", default=[], metavar="KEY=VALUE", help="words of its kind; a vector as 0,0,1"
    )
    fault.add_argument("--name", default="", help="of the fault (default: its kind and what it is of)")
    fault.add_argument("--gone", action="store_true", help="it goes again")
    cancel = commands.add_parser("cancel", help="take back commands that wait for a link to Earth")
    cancel.add_argument(
        "number", type=command_line.whole_number, nargs="?", help="of the command, as it is shown; all if left out"
    )
    stop = commands.add_parser("stop", help="stop drive and arm")
    for command in (drive, route, arm, task, power, here, fault, cancel, stop):
        command_line.add_place(command)
        command.add_argument(
            "--timeout",
            type=command_line.positive,
            default=3600.0,
            metavar="S",
            help="longest wait (wall time)",
        )
    return result


def in_order(arguments: Sequence[str]) -> list[str]:
    """The same as verb, options, words: so options are told in any order, also between words, where argparse takes no
    further word of a list. Where none is a verb, the first word is taken for it, and refused by its name.
    """
    words, options = list[str](), list[str]()
    rest = iter(arguments)
    for one in rest:
        if one == "--":
            words += rest
        elif not _is_option(one):
            words.append(one)
        else:
            options.append(one)
            if _takes_value(one):
                options += islice(rest, 1)
    if not words:
        return options
    verb = words.pop(next((place for place, word in enumerate(words) if word in VERBS), 0))
    return [verb, *options, *(["--", *words] if words else [])]


def _is_option(word: str) -> bool:
    """Whether a word is one; a number below zero is none."""
    try:
        float(word)
    except ValueError:
        return word.startswith("-")
    return False


def _takes_value(option: str) -> bool:
    """Whether the next word is its value. It may be told by its first letters."""
    return "=" not in option and any(name.startswith(option) for name in WITH_VALUE)


def main(arguments: Sequence[str] | None = None) -> int:
    """Send a goal; 0 only if it was reached (a stop: if drive and arm stand; a dry run: if it is allowed; a switch: if
    it is done).
    """
    words, options = in_order(sys.argv[1:] if arguments is None else arguments), parser()
    if words and words[0].startswith("-") and not {"-h", "--help"} & set(words):
        options.error(f"what to do is missing: allowed is one of {', '.join(VERBS)}")
    given = options.parse_args(words)
    from sojourn_operator.goal_command import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
