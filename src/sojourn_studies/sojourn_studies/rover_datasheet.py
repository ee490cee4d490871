"""scripts/rover_datasheet: what a rover can do, computed from its files, as a page or as JSON."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line
from sojourn_config.paths import available


def parser() -> argparse.ArgumentParser:
    """Options of scripts/rover_datasheet."""
    result = command_line.Parser(
        prog="rover_datasheet",
        description="Figures and plots of a rover: loads, tip-over, steps, traction, grade, energy, steering, ride. Of "
        "a machine that stands: its motors.",
    )
    known = ", ".join(available("machines"))
    result.add_argument("machine", help=f"the path of its folder, or one of {known}")
    result.add_argument("--body", help="name in config/bodies (default: moon; of what floats low_earth_orbit)")
    result.add_argument("--soil", default="lunar_nominal", help="name in config/soils (default: %(default)s)")
    result.add_argument(
        "--json", action="store_true", help="print the figures; a page is then written with --out alone"
    )
    result.add_argument("--out", type=Path, metavar="FILE", help="page to write (default: NAME_datasheet.html here)")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Compute the sheet and write or print it."""
    given = parser().parse_args(arguments)
    from sojourn_studies.datasheet_of_rover import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
