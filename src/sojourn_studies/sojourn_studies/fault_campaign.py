"""Faults against their detection, over seeds: scripts/fault_campaign."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/fault_campaign."""
    result = command_line.Parser(
        prog="fault_campaign",
        description="Run scenarios once for each of their faults and each seed, with that fault alone and without any, "
        "and say how each showed: detected in so many seconds, missed, or a false alarm.",
    )
    result.add_argument(
        "scenarios",
        nargs="*",
        default=["fault_course"],
        metavar="SCENARIO",
        help="with faults that say how they should show (default: fault_course)",
    )
    result.add_argument("--faults", metavar="SCENARIO", help="take the faults from this one")
    result.add_argument("--only", default="", metavar="NAMES", help="these faults, with commas between them")
    result.add_argument("--seeds", type=command_line.count, default=5, metavar="N", help="how many (%(default)s)")
    result.add_argument("--first-seed", type=command_line.whole_number, default=1, metavar="N", help="(%(default)s)")
    command_line.add_changes(result)
    result.add_argument("--csv", type=Path, metavar="FILE", help="write every run")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 0 only if every fault was detected in every run, and none that had not come."""
    given = parser().parse_args(arguments)
    from sojourn_studies.fault_table import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
