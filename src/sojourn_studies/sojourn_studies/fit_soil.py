"""Identifies a soil's parameters from measured trials of a wheel and writes them as a soil file: scripts/fit_soil."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_analysis.wheels.soil_bounds import PHYSICAL_BOUNDS
from sojourn_analysis.wheels.test_bed import GRAVITY
from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/fit_soil."""
    result = command_line.Parser(
        prog="fit_soil",
        description="Identify a soil's parameters from trials of a wheel, with their errors, and cross-validate them.",
        epilog="Parameters: " + ", ".join(PHYSICAL_BOUNDS) + ". Columns of the file: see wheel_test --help.",
    )
    result.add_argument("trials", type=Path, metavar="FILE", help="trials, as for wheel_test --csv")
    result.add_argument("--soil", required=True, metavar="NAME|FILE", help="soil to start from; what is not free stays")
    result.add_argument("--wheel", metavar="NAME|FILE", help="wheel of the trials (default: the file's)")
    result.add_argument(
        "--free", metavar="NAME[,NAME...]", help="parameters to identify (default: those the trials can tell)"
    )
    result.add_argument("--where", action="append", default=[], metavar="COLUMN=VALUE", help="take these rows alone")
    command_line.add_changes(result, "change the soil to start from")
    result.add_argument(
        "--gravity", type=command_line.number, default=GRAVITY, metavar="G", help="[m/s2] (%(default)s)"
    )
    result.add_argument("--starts", type=command_line.whole_number, default=4, metavar="N", help="starts (%(default)s)")
    result.add_argument(
        "--seed", type=command_line.whole_number, default=0, metavar="N", help="of the starts (%(default)s)"
    )
    result.add_argument("--no-cross-validation", action="store_true", help="leave the cross-validation out")
    result.add_argument("--write", type=Path, metavar="FILE", help="write the soil there")
    result.add_argument("--json", action="store_true", help="print JSON")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Fit, report and write."""
    given = parser().parse_args(arguments)
    from sojourn_studies.soil_fit import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
