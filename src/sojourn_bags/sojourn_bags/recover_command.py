"""Mends a bag that a crash has cut off: scripts/recover BAG writes a whole one beside it and says what is lost."""

from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line


def parser() -> command_line.Parser:
    """Options of scripts/recover."""
    result = command_line.Parser(
        prog="recover",
        description="Mend a bag that was cut off: write what is whole of it into a new bag, and say what is lost.",
        epilog="The original is never changed. Exit status: 0 mended or whole, 1 nothing to recover, 2 not a bag.",
    )
    result.add_argument("bag", type=Path, metavar="BAG", help="folder of a run, folder of a bag, or an .mcap file")
    result.add_argument(
        "--out", type=Path, metavar="DIR", help="folder of the new bag (default: beside it, ..._recovered)"
    )
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Mend a bag; 0 if there is a whole one in the end."""
    given = parser().parse_args(arguments)
    from sojourn_bags.recovery_words import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
