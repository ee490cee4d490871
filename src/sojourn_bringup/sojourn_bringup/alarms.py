"""The alarms and the log of a run, beside it or from its bag: scripts/alarms."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

SCENARIO = "lunar_sample"
"""Whose machine runs where nothing else says."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/alarms."""
    result = command_line.Parser(
        prog="alarms",
        description="Watch a running stack: one line for each thing that happens, alarms by their limits. Type a and "
        "Enter to acknowledge all, a NAME for one, l to list them, q to end. With --bag: the same of a finished run.",
    )
    result.add_argument("--bag", type=Path, metavar="RUN", help="a bag, its folder, or the folder of a run")
    result.add_argument("--limits", type=Path, metavar="FILE", help="alarms over those of the machine (YAML)")
    result.add_argument("--show-limits", action="store_true", help="print the limits, and end")
    result.add_argument("--scenario", metavar="NAME", help=f"whose machine runs (default: the bag's; else {SCENARIO})")
    command_line.add_machine(result)
    result.add_argument("--who", metavar="NAME", help="who acknowledges (default: the login name)")
    result.add_argument("--publish", action="store_true", help="say them on /alarms")
    result.add_argument("--seconds", type=command_line.positive, metavar="S", help="how long, wall time (default: on)")
    result.add_argument("--json", type=Path, metavar="FILE", help="write log and alarms there at the end")
    command_line.add_place(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Watch. 0 without a critical alarm that nobody has acknowledged, 1 with one, if the bag is cut off, or the stack
    silent and not at its end, 2 if there was nothing to watch.
    """
    given = parser().parse_args(arguments)
    from sojourn_bringup.alarms_run import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
