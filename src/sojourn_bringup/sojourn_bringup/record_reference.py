"""Records the reference bags that the tests replay: scripts/record_reference.

Each is a short run whose scenario stands in test/replay. Beside the bag stands its digest, a text by which a
reviewer sees what has changed. A bag whose content is the same as before is left alone.
"""

import argparse
from collections.abc import Sequence

from sojourn_config import command_line

DIGEST = "digest.txt"


def parser() -> argparse.ArgumentParser:
    """Options of scripts/record_reference."""
    result = command_line.Parser(prog="record_reference", description="Record the bags in test/replay again.")
    result.add_argument("name", nargs="*", metavar="NAME", help="of a scenario in test/replay (default: all)")
    command_line.add_place(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Renew reference bags and tell what has changed."""
    given = parser().parse_args(arguments)
    from sojourn_bringup.reference_recording import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
