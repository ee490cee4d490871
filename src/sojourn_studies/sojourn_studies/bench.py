"""Bench: what a step costs, how fast the loop runs, what a start takes. scripts/bench prints a table and writes JSON.

By default about three minutes on a quiet machine; with --full every survey and drive has its whole length. The
figures hold for the machine and the load of the moment: quote medians, and ratios in the yardstick Y (`bench_step`).
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

RESULT = "bench.json"
PART_NAMES = (
    "step", "period", "network", "start", "direct", "composed", "processes", "commands", "wheel", "contacts", "ground",
    "arm", "arm_limits", "wheels", "energy", "cameras",
)  # fmt: skip
OF_A_SCENARIO = ("step", "period", "direct", "composed", "processes")
"""Parts that can be measured of any scenario; the others have scenes of their own."""
SCENARIO = "lunar_sample"
"""The one that the bars are about."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/bench."""
    result = command_line.Parser(
        prog="bench",
        description="Measure the plant's step, the loop's speed, start-up and memory, contacts, the arm's planning.",
    )
    result.add_argument("--full", action="store_true", help="everything at its whole length: some twenty minutes")
    result.add_argument("--seconds", type=command_line.positive, help="simulated time of a run of the loop [s]")
    result.add_argument("--rounds", type=command_line.count, help="runs of the loop; the median counts")
    result.add_argument("--json", type=Path, metavar="FILE", help=f"new file to write (default: runs/<time>/{RESULT})")
    result.add_argument(
        "--scenario", metavar="NAME", help=f"measure {', '.join(OF_A_SCENARIO)} of this one (default: {SCENARIO})"
    )
    result.add_argument(
        "--only", action="append", choices=PART_NAMES, help="measure this part; again for more (default: all)"
    )
    for hidden in ("--child", "--run-dir", "--began"):
        result.add_argument(hidden, help=argparse.SUPPRESS)
    command_line.add_place(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print a table, write JSON."""
    given = parser().parse_args(arguments)
    from sojourn_studies.bench_parts import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
