"""A bag that was cut off is used as far as it goes, but nothing that is found in it is a pass; one that is not what was
recorded, as its files are not those of one bag, is not replayed at all.
"""

import sys
from collections.abc import Iterable

from sojourn_bags.errors import ReplayError
from sojourn_bags.reading import Bag


def check_recorded(bag: Bag) -> None:
    """Raise ReplayError for a bag that is not what was recorded."""
    if bag.misfit:
        raise ReplayError(f"{bag.path} is not what was recorded: {bag.misfit}")


def unless_cut_off(status: int, bags: Iterable[Bag]) -> int:
    """Exit status of a script that has read these bags: not zero where one is cut off, or is not what was recorded,
    which a sentence says.
    """
    for bag in bags:
        if not bag.whole:
            as_far = f"{bag.path} is cut off, so this holds as far as it goes (scripts/recover mends it)"
            print(f"{bag.path} is not what was recorded: {bag.misfit}" if bag.misfit else as_far, file=sys.stderr)
            status = status or 1
    return status
