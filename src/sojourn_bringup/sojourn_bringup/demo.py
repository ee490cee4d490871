"""The demonstration: scripts/demo runs a scenario to its end, then says how it went in words, numbers and a picture."""

import argparse
from collections.abc import Sequence

from sojourn_bringup.plan import add_console, add_patience
from sojourn_config import command_line

DEFAULT_SCENARIO = "lunar_sample"
MACHINE_SCENARIO = "machine_course"
"""What a machine named by --machine does, unless config/scenarios has one called NAME_course."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/demo."""
    result = command_line.Parser(
        prog="demo", description="Run a scenario in lock-step, say how it went, and leave bag, summary and picture."
    )
    result.add_argument(
        "--scenario",
        help=f"name in config/scenarios, or a YAML file (default: {DEFAULT_SCENARIO}; with --machine NAME_course or "
        f"{MACHINE_SCENARIO})",
    )
    command_line.add_machine(result)
    kind = result.add_mutually_exclusive_group()
    kind.add_argument("--composed", action="store_true", help="all nodes in one process (the default)")
    kind.add_argument(
        "--direct", action="store_true", help="all roles in one process without middleware: the same values, sooner"
    )
    kind.add_argument("--processes", action="store_true", help="each node as a process of its own")
    result.add_argument("--seed", metavar="N", help="seed in place of the scenario's")
    command_line.add_changes(result, "set a value of the scenario or of a file that it names")
    result.add_argument("--run-dir", metavar="DIR", help="folder of the run (default: a new one in runs/)")
    add_console(result)
    command_line.add_place(result)
    add_patience(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the demonstration; 0 only if every goal was met and the record is complete."""
    given = parser().parse_args(arguments)
    from sojourn_bringup.demonstration import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
