"""A sequence of commands from a file: checked, foreseen, carried out beside a running stack: scripts/sequence."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

SCENARIO = "lunar_sample"
"""Whose machine and ground are meant where nothing else says."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/sequence."""
    result = command_line.Parser(
        prog="sequence",
        description="Check a sequence of commands against machine, ground and contract, and carry it out beside a "
        "running stack. While it runs, type h (hold), r (resume), s (skip), a (abort), l (list), q (leave) and Enter.",
    )
    result.add_argument("file", type=Path, nargs="?", help="the sequence (YAML)")
    what = result.add_mutually_exclusive_group()
    what.add_argument("--check", action="store_true", help="check it, and send nothing")
    what.add_argument("--dry-run", action="store_true", help="ask the drive what each drive would take; nothing moves")
    what.add_argument("--as-scenario", action="store_true", help="print its steps as a scenario has them")
    what.add_argument("--from-scenario", action="store_true", help="print the steps of --scenario as a sequence")
    result.add_argument("--scenario", metavar="NAME", help=f"whose machine and ground it is for (default: {SCENARIO})")
    command_line.add_machine(result)
    result.add_argument("--who", metavar="NAME", help="who gives its words (default: the login name)")
    result.add_argument("--hold", action="store_true", help="begin held: r begins")
    result.add_argument("--json", type=Path, metavar="FILE", help="write the history there")
    result.add_argument(
        "--timeout", type=command_line.positive, default=30.0, metavar="S",
        help="of --dry-run: longest wait for each answer, wall time (default: %(default)g)",
    )  # fmt: skip
    command_line.add_place(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """0 only if each step came to a good end or was skipped (a check: if it is sound; a dry run: if all is allowed)."""
    given = parser().parse_args(arguments)
    from sojourn_operator.sequence.work import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
