"""A soil as a designer asks it: what a pad may press, how deep it stands, what holds and digs: scripts/soil_test."""

import argparse
from collections.abc import Sequence

from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/soil_test."""
    result = command_line.Parser(
        prog="soil_test",
        description="Footings on a soil: pressure at which it fails, safe load, sinkage, rut, shear; the force of "
        "digging; lunar by depth.",
    )
    result.add_argument("soil", nargs="?", default="lunar_nominal", metavar="NAME|FILE", help="of config/soils")
    result.add_argument("--body", default="moon", metavar="NAME", help="of config/bodies: its gravity (%(default)s)")
    command_line.add_changes(result, "change a key of the soil")
    result.add_argument(
        "--diameter",
        type=command_line.number_list,
        default=[0.05, 0.1, 0.2, 0.3],
        metavar="M[,M...]",
        help="of round pads [m]",
    )
    result.add_argument("--load", type=command_line.number, default=50.0, metavar="N", help="on each pad (%(default)s)")
    result.add_argument(
        "--safety", type=command_line.number, default=3.0, metavar="F", help="factor of safety (%(default)s)"
    )
    result.add_argument(
        "--depth",
        type=command_line.number_list,
        metavar="M[,M...]",
        help="lunar soil at these depths in place of its mean [m]",
    )
    result.add_argument(
        "--cut",
        type=command_line.number_list,
        default=[0.01, 0.02, 0.05, 0.1],
        metavar="M[,M...]",
        help="depths that a blade and a bucket dig [m]",
    )
    result.add_argument(
        "--blade", type=command_line.number, default=0.1, metavar="M", help="width of both (%(default)s)"
    )
    result.add_argument(
        "--rake", type=command_line.number, default=45.0, metavar="DEG", help="of both, 20 to 90 (%(default)s)"
    )
    result.add_argument("--json", action="store_true", help="print JSON")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables."""
    given = parser().parse_args(arguments)
    from sojourn_studies.soil_figures import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
