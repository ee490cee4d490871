"""Two runs compared in words, as JSON and as a bag: the work of scripts/compare."""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

from sojourn_bags.compare_command import PREFIX
from sojourn_bags.comparison import compare, until
from sojourn_bags.comparison_bag import write_both
from sojourn_bags.comparison_result import Comparison, Verdict, at
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.contract_version import check_contract
from sojourn_bags.cut_off import unless_cut_off
from sojourn_bags.errors import BagsError
from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag, read_bag
from sojourn_config.command_errors import UsageError
from sojourn_config.command_line import only_owner


def read_runs(paths: Sequence[Path]) -> list[Bag]:
    """Read bags of this contract. Raises UsageError for what is none."""
    try:
        bags = [read_bag(path) for path in paths]
        for bag in bags:
            check_contract(bag)
            if not bag.topics:
                raise UsageError(f"{bag.path} holds no message")
        return bags
    except BagsError as error:
        raise UsageError(str(error)) from error


@only_owner()
def write_result(
    given: argparse.Namespace,
    comparison: Comparison,
    data: dict[str, object],
    sides: tuple[dict[str, Messages], dict[str, Messages]],
    prefix: str,
    source: Bag,
) -> None:
    """Write what --json and --bag ask for. Raises UsageError if it cannot be written."""
    try:
        if given.json is not None:
            given.json.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
        if given.both is not None:
            write_both(given.both, *sides, prefix, source, comparison.as_data())
    except OSError as error:
        raise UsageError(f"{given.json} cannot be written: {error.strerror or error}") from error
    except BagsError as error:
        raise UsageError(str(error)) from error


def exit_status(verdict: Verdict, exact: bool) -> int:
    """Status of the script: 0 where the verdict is good enough."""
    if verdict is Verdict.WITHIN_TOLERANCE:
        return int(exact)
    return int(verdict is Verdict.DIFFERENT)


def last_log_time(messages: dict[str, Messages]) -> int:
    """The latest log time [ns]; zero without messages."""
    return max((each.log_times[-1] for each in messages.values() if each.log_times), default=0)


def run(given: argparse.Namespace) -> int:
    """Compare and tell. Returns the exit status."""
    bags = read_runs((given.bag_a, given.bag_b))
    sides = [dict(bag.topics) for bag in bags]
    for name, bag in zip("AB", bags, strict=True):
        count, stamp = sum(len(each) for each in bag.topics.values()), last_log_time(bag.topics)
        print(f"{name}: {bag.path}, {count} messages, {at(stamp)}")
    cut = [bag for bag in bags if not bag.whole and not bag.misfit]
    if cut:
        end = min(last_log_time(bag.topics) for bag in cut)
        names = " and ".join(str(bag.path) for bag in cut)
        print(f"{names}: cut off, so both are compared as far as it is complete, before {at(end)}")
        sides = [until(side, end) for side in sides]
    try:
        comparison = compare(*sides)
    except ValueError as error:
        raise UsageError(f"a message cannot be read: {error}") from error
    print("\n".join(comparison_lines(comparison)))
    data = {"a": str(bags[0].path), "b": str(bags[1].path), "cut_off": [str(bag.path) for bag in cut]}
    write_result(given, comparison, data | comparison.as_data(), (sides[0], sides[1]), PREFIX, bags[0])
    return unless_cut_off(exit_status(comparison.verdict, given.exact), bags)
