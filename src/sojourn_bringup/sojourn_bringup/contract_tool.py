"""Shows the contract, and judges a bag or a running stack by it: scripts/contract."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_bringup.bench_options import add_bench
from sojourn_bringup.references import default_reference
from sojourn_config import command_line

SCENARIO = "lunar_sample"
"""Whose machine is meant where nothing else says."""
LIVE_S = 10.0


def parser() -> argparse.ArgumentParser:
    """Options of scripts/contract."""
    result = command_line.Parser(prog="contract", description="Show the contract, or judge messages by it.")
    commands = result.add_subparsers(dest="command", required=True)
    show = commands.add_parser("show", help="print topics, fields, rules and joints")
    show.add_argument("--format", choices=("table", "json", "html"), default="table", help="default: %(default)s")
    show.add_argument("--scenario", metavar="NAME", help=f"whose machine to show (default: {SCENARIO})")
    command_line.add_machine(show)
    check = commands.add_parser(
        "check", help="judge every message; exit status 1 if there is any violation, or the bag is cut off"
    )
    source = check.add_mutually_exclusive_group(required=True)
    source.add_argument("--bag", type=Path, metavar="BAG", help="a bag, its folder, or the folder of a run")
    source.add_argument("--live", action="store_true", help="a running stack")
    source.add_argument("--exec", metavar="COMMAND", help="a program, alone: a bag's inputs are played to it")
    check.add_argument("--role", metavar="ROLE", help="with --exec: whom it stands in for")
    check.add_argument(
        "--reference", type=Path, default=default_reference(), metavar="BAG",
        help="with --exec: whose inputs it hears, recorded in lock-step (default: the reference run in test/replay)",
    )  # fmt: skip
    add_bench(check)
    check.add_argument("--node", metavar="NAME", help="judge this role alone (default: all)")
    check.add_argument("--scenario", metavar="NAME", help=f"whose machine runs (default: the bag's; live {SCENARIO})")
    command_line.add_machine(check)
    check.add_argument(
        "--seconds", type=command_line.positive, default=LIVE_S, metavar="S",
        help="how long to listen, wall time (default: %(default)g)",
    )  # fmt: skip
    check.add_argument("--json", type=Path, metavar="FILE", help="write all findings there")
    command_line.add_place(check)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Show or check. 0 without a violation, 1 with any, 2 if there was nothing to judge."""
    given = parser().parse_args(arguments)
    from sojourn_bringup.contract_verdicts import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
