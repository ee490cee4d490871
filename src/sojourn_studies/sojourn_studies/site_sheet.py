"""The sheet of a place on a body: gravity, day, Sun, air, temperatures: scripts/site."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

SPACE = "space"


def parser() -> argparse.ArgumentParser:
    """Options of scripts/site."""
    result = command_line.Parser(
        prog="site",
        description="A place on a body in figures: gravity and escape, day, Sun, air, temperatures, dose and hits.",
    )
    result.add_argument("body", metavar="BODY", help="of config/bodies, or a file; `space`: none of them")
    result.add_argument("--lat", type=command_line.number, default=0.0, metavar="DEG", help="latitude (%(default)s)")
    result.add_argument("--lon", type=command_line.number, default=0.0, metavar="DEG", help="east (%(default)s)")
    result.add_argument(
        "--altitude",
        type=command_line.number,
        default=0.0,
        metavar="M",
        help="over the reference ellipsoid, of a giant planet over the level of 1 bar (%(default)s)",
    )
    result.add_argument("--orbit", action="store_true", help="not a place of the ground: an orbit at that altitude")
    result.add_argument(
        "--eccentricity",
        type=command_line.number,
        default=0.0,
        metavar="E",
        help="of the orbit, the altitude being its lowest (%(default)s: a circle)",
    )
    result.add_argument(
        "--inclination", type=command_line.number, default=0.0, metavar="DEG", help="of the orbit (%(default)s)"
    )
    result.add_argument(
        "--beta", type=command_line.number, default=0.0, metavar="DEG", help="Sun over the orbit's plane (%(default)s)"
    )
    result.add_argument(
        "--distance", type=command_line.number, default=1.0, metavar="AU", help="of space, from the Sun (%(default)s)"
    )
    result.add_argument("--time", metavar="DATE", help="with its zone, as 2028-03-01T12:00:00Z: the Sun a day on")
    result.add_argument(
        "--days", type=command_line.number, default=365.0, metavar="D", help="of a stay: dose, hits (%(default)s)"
    )
    result.add_argument("--plot", type=Path, metavar="FILE", help="draw the day, the air and gravity by latitude")
    result.add_argument("--json", action="store_true", help="print JSON")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the sheet."""
    given = parser().parse_args(arguments)
    if given.body == SPACE:
        from sojourn_studies.medium_figures import run
    elif given.orbit:
        from sojourn_studies.orbit_figures import run  # not above: --help needs none of it
    else:
        from sojourn_studies.site_figures import run

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
