"""Compares two runs, field by field on every topic: scripts/compare BAG_A BAG_B."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

PREFIX = "/b"


def parser() -> argparse.ArgumentParser:
    """Options of scripts/compare."""
    result = command_line.Parser(
        prog="compare",
        description="Compare two runs, field by field on every topic, within the tolerances of the contract. "
        "The status is 0 if they are identical or within tolerance, 1 if they are different or one is cut off.",
    )
    for name in ("A", "B"):
        result.add_argument(f"bag_{name.lower()}", type=Path, metavar=f"BAG_{name}", help="a run's folder or a bag")
    result.add_argument("--exact", action="store_true", help="status 1 also for what is within tolerance")
    command_line.add_result(result, f"B's topics under {PREFIX}/...")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare and tell. Returns the exit status."""
    given = parser().parse_args(arguments)
    from sojourn_bags.compare_runs import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
