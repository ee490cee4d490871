"""A bag that was cut off is used as far as it goes, but nothing that is found in it is a pass."""

import sys
from collections.abc import Iterable

from sojourn_bags.reading import Bag


def unless_cut_off(status: int, bags: Iterable[Bag]) -> int:
    """Exit status of a script that has read these bags: not zero where one is cut off, which a sentence says."""
    for bag in bags:
        if not bag.whole:
            print(f"{bag.path} is cut off, so this holds as far as it goes (scripts/recover mends it)", file=sys.stderr)
            status = status or 1
    return status
