"""Power and charge of a machine over days, as a table and a picture: scripts/power_plan."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/power_plan."""
    result = command_line.Parser(
        prog="power_plan",
        description="Sources, loads, charge and temperatures of a scenario's machine over days, without its "
        "motion: what it is given and takes each day, its modes, the first limit that it meets.",
    )
    result.add_argument("scenario", metavar="SCENARIO", help="of config/scenarios, or a file")
    result.add_argument("--days", type=command_line.number, default=1.0, metavar="D", help="solar days (%(default)s)")
    result.add_argument(
        "--step",
        type=command_line.number,
        default=60.0,
        metavar="S",
        help="of time, at most: whole ones make a solar day; more than a minute is for the rows of --csv (%(default)s)",
    )
    command_line.add_changes(result)
    result.add_argument("--plot", type=Path, metavar="FILE", help="draw it")
    result.add_argument("--csv", type=Path, metavar="FILE", help="write every step")
    result.add_argument("--json", action="store_true", help="print JSON")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the days."""
    given = parser().parse_args(arguments)
    from sojourn_studies.power_days_told import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
