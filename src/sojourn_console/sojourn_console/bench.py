"""What the page costs, and whether it grows: scripts/bench_console."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

HELP = "What the console's page costs the processor, and whether its memory grows."


def parser() -> argparse.ArgumentParser:
    """Options of scripts/bench_console."""
    result = command_line.Parser(prog="bench_console", description=HELP)
    result.add_argument("bag", type=Path, help="a run, or its bag, that is played on end")
    result.add_argument(
        "--hours", type=command_line.positive, default=0.1, metavar="H", help="of the page (default: %(default)s)"
    )
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, and tell."""
    given = parser().parse_args(arguments)
    from sojourn_bags.errors import BagsError  # here, and what follows: --help needs none of it
    from sojourn_console.endurance import endurance
    from sojourn_console.errors import ConsoleError
    from sojourn_console.frames import FRAMES
    from sojourn_contract.stop_flag import StopFlag

    stop = StopFlag().install()
    try:
        found = endurance(given.bag, given.hours, command_line.say, lambda: not stop.is_set)
    except BagsError as error:
        raise ConsoleError(str(error)) from error
    print("\n".join(found.lines(FRAMES)))
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
