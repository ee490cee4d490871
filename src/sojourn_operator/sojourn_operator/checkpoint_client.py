"""Asks a running stack to keep its state: scripts/checkpoint."""

import argparse
from collections.abc import Sequence

from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/checkpoint."""
    result = command_line.Parser(
        prog="checkpoint",
        description="Keep the state of a running stack, in checkpoints/ of its folder: of one whose nodes were "
        "started with --checkpoint-every S.",
    )
    command_line.add_place(result)
    result.add_argument(
        "--timeout", type=command_line.positive, default=60.0, metavar="S", help="longest wait (wall time)"
    )
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Ask for a checkpoint; 0 only if it is kept."""
    given = parser().parse_args(arguments)
    from sojourn_operator.checkpoint_asking import ask  # not above: --help needs none of it

    kept, words = ask(given.domain, given.namespace, given.timeout)
    command_line.say(words)
    return 0 if kept else 1


if __name__ == "__main__":
    command_line.run_script(main)
