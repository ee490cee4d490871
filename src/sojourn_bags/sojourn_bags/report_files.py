"""The report of a bag as a picture or as a page: the work of scripts/report."""

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from sojourn_bags.cut_off import unless_cut_off
from sojourn_bags.errors import BagsError
from sojourn_bags.page.page import write_page
from sojourn_bags.reading import Bag, bag_file, read_bag
from sojourn_bags.report import write_report
from sojourn_bags.summary import fault_lines, goal_lines, summarise, write_summary
from sojourn_config.command_errors import UsageError
from sojourn_config.command_line import only_owner


def place_of(bag: Path) -> Path:
    """Folder of the run, of the bag, or of the file: where its report belongs."""
    folder = bag_file(bag).absolute().parent
    return folder.parent if folder.name == "bag" else folder


def say(summary: dict[str, Any], console: Console) -> None:
    """Verdict, and what became of each goal."""
    console.print(str(summary["verdict"]), markup=False)
    for line in (*goal_lines(summary), *fault_lines(summary)):
        console.print(line, markup=False)


def _picture(bag: Bag, picture: Path, console: Console) -> None:
    summary = summarise(bag)
    data = picture.with_name("summary.json")
    say(summary, console)
    write_summary(summary, data)
    write_report(bag, picture, summary=summary)
    console.print(f"{picture} and {data}", markup=False)


def _page(bag: Bag, page: Path, judged: bool, console: Console) -> None:
    story = write_page(bag, page, judged)
    if story.summary is None:
        console.print(f"No verdict: {story.why_no_run}.", markup=False)
    else:
        say(story.summary, console)
    console.print(story.judgement_in_words, markup=False)
    console.print(str(page), markup=False)


@only_owner()
def run(given: argparse.Namespace) -> int:
    """Report of a bag; 0 if it could be written and the bag is whole."""
    console = Console(highlight=False, soft_wrap=True)
    try:
        bag = read_bag(given.bag)
        out: Path = given.out or place_of(given.bag)
        if out.is_dir():
            out /= "report.html" if given.html else "report.png"
        if given.html:
            _page(bag, out, not given.no_contract, console)
        else:
            _picture(bag, out, console)
    except BagsError as error:
        hint = "" if given.html else " (--html writes a page of what there is)"
        raise UsageError(f"{error}{hint}") from error
    except OSError as error:
        raise UsageError(f"{error.filename}: {error.strerror}") from error
    return unless_cut_off(0, [bag])
