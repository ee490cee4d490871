"""Report of any bag: scripts/report BAG draws report.png and summary.json anew, with --html one page for a person."""

from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line


def parser() -> command_line.Parser:
    """Options of scripts/report."""
    result = command_line.Parser(
        prog="report",
        description="Say how the run in a bag went: verdict in words, report.png and summary.json, or one page.",
        epilog="Exit status: 0 the report is written, whatever it says; 1 of a bag that is cut off; 2 it cannot be.",
    )
    result.add_argument("bag", type=Path, metavar="BAG", help="folder of a run, folder of a bag, or an .mcap file")
    result.add_argument("--html", action="store_true", help="one page in one file, report.html")
    result.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="picture or page, or a folder for it (default: report.png or report.html beside the bag)",
    )
    result.add_argument(
        "--no-contract", action="store_true", help="with --html: faster, without judging the messages by the contract"
    )
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Report of a bag; 0 if it could be written and the bag is whole."""
    given = parser().parse_args(arguments)
    from sojourn_bags.report_files import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
