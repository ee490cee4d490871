"""Draws the pictures of the manuals again, from the models and parameter sets themselves, into src/*/doc/.

    scripts/pictures             all of them
    scripts/pictures arm power   some of them; names are those of FIGURES in picture_list.py
    scripts/pictures report RUN  the report of a finished run (a folder in runs/), reduced, for README.md
    scripts/pictures course RUN [NAME]  the machine of a run of scripts/demo --machine NAME, and its track, for
                                 sojourn_machine; NAME: of the picture, where the machine is a folder of its own
    scripts/pictures view RUN CAMERA TIME  what a camera of a run has seen at that second, for sojourn_sensors

For maintainers, after a change of a model or of a parameter set. Takes about two minutes, most of it for the arm.
"""

import argparse
from collections.abc import Sequence

from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/pictures."""
    result = command_line.Parser(
        prog="pictures", formatter_class=argparse.RawDescriptionHelpFormatter, description=__doc__
    )
    result.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="pictures to draw, report RUN, course RUN [NAME], or view RUN CAMERA TIME",
    )
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw what is asked for."""
    given = parser().parse_args(arguments)
    from sojourn_studies.picture_list import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
