"""Reference bags recorded, compared with those in their places, and put there: the work of scripts/record_reference."""

import argparse
import difflib
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.completeness import RECORD
from sojourn_bags.contract_version import check_contract
from sojourn_bags.description import Run
from sojourn_bags.digest import digest
from sojourn_bags.errors import BagsError, OtherContractError
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.thinning import thinned
from sojourn_bringup import start, start_run
from sojourn_bringup.record_reference import DIGEST
from sojourn_bringup.references import REFERENCES, THEMES, ReferenceBag, references_folder
from sojourn_bringup.screen import Screen
from sojourn_config.command_errors import CommandError, UsageError


def record(reference: ReferenceBag, folder: Path, domain: int) -> Bag:
    """Run the scenario and return its bag, which is in `folder`. Raises CommandError if it went otherwise.

    What is replayed without middleware is recorded without it: the values are the same.
    """
    layout: start_run.Layout = "direct" if reference.roles else "composed"
    arguments = [str(references_folder() / f"{reference.name}.yaml"), f"--{layout}", "--run-dir", str(folder)]
    arguments += ["--domain", str(domain)]
    for text in reference.overrides:
        arguments += ["--set", text]
    screen = Screen()
    plan = start_run.make_plan(start.parser().parse_args(arguments), screen)
    outcome = start_run.run_plan(plan, layout, screen)
    found = tuple(result.outcome for result in outcome.results)
    if found != reference.outcomes:
        raise CommandError(
            f"{reference.name}: the steps ended {', '.join(found) or 'not at all'}, and should end "
            f"{', '.join(reference.outcomes)}: {outcome.message}"
        )
    bag = read_bag(plan.bag())
    if bag.records[RECORD]["complete"] != "true":
        raise CommandError(f"{reference.name}: the bag is not complete: {bag.records[RECORD]['gaps']}")
    return read_bag(thinned(bag, folder / "thinned" / "bag", reference.roles)) if reference.roles else bag


def renew(reference: ReferenceBag, domain: int) -> list[str]:
    """Record a reference bag and put it in its place unless it is the same. Returns what has changed, as lines."""
    place = references_folder() / reference.name
    with tempfile.TemporaryDirectory(prefix="sojourn-reference-") as base:
        bag = record(reference, Path(base) / "run", domain)
        lines = changes(place, bag)
        if not lines:
            return [f"{reference.name}: unchanged"]
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(bag.path.parent, place / "bag")
        (place / DIGEST).write_text(digest(read_bag(place)), encoding="utf-8")
    return [*lines, f"{reference.name}: renewed, {(place / 'bag' / bag.path.name).stat().st_size / 1e6:.2f} MB"]


def changes(place: Path, bag: Bag) -> list[str]:
    """What is different from the bag in its place, in lines; empty where nothing is."""
    try:
        before = read_bag(place)
        comparison = compare(before.topics, bag.topics)
        old, new = Run.of_bag(before), Run.of_bag(bag)
        text = (place / DIGEST).read_text(encoding="utf-8")
    except (BagsError, OSError, ValueError) as error:
        return [f"nothing to compare with: {error}"]
    contract = list(_change_of_contract(before))
    same = not contract and (old.resolved, old.overrides, old.files) == (new.resolved, new.overrides, new.files)
    if comparison.verdict is Verdict.IDENTICAL and same:
        return []
    renewed = difflib.unified_diff(text.splitlines(), digest(bag).splitlines(), "before", "now", lineterm="", n=0)
    return [*contract, *renewed, *comparison_lines(comparison, "before", "now")]


def _change_of_contract(before: Bag) -> Iterator[str]:
    """In what our contract is another than that of a bag; nothing where it is the same."""
    try:
        check_contract(before)
    except OtherContractError as error:
        yield str(error)


def run(given: argparse.Namespace) -> int:
    """Renew the reference bags that are asked for, all by default, and tell what has changed."""
    known = {reference.name: reference for reference in (*REFERENCES, *THEMES)}
    for name in given.name:
        if name not in known:
            raise UsageError(f"record_reference: there is no {name!r}, allowed is one of {', '.join(known)}")
    for reference in [known[name] for name in given.name] or known.values():
        print("\n".join(renew(reference, given.domain)))
    return 0
