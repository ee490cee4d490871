"""Fields of a bag as a picture, a table and their extremes: the work of scripts/plot."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console

from sojourn_bags.cut_off import unless_cut_off
from sojourn_bags.errors import BagsError
from sojourn_bags.fields import Series, series
from sojourn_bags.plot import draw, write_table
from sojourn_bags.reading import read_bag
from sojourn_config.command_errors import UsageError
from sojourn_config.command_line import only_owner


def summary(found: Sequence[Series]) -> str:
    """Least, mean and greatest value of each series, a line each; the name stands last, as it is the longest."""
    lines = [f"{'min':>13} {'mean':>13} {'max':>13} {'values':>8}  field"]
    for one in found:
        values = one.values[np.isfinite(one.values)]
        numbers = (values.min(), values.mean(), values.max()) if values.size else (np.nan,) * 3
        unit = f" [{one.unit}]" if one.unit else ""
        lines.append(" ".join(f"{number:13.6g}" for number in numbers) + f" {values.size:8d}  {one.name}{unit}")
    return "\n".join(lines)


@only_owner()
def run(given: argparse.Namespace) -> int:
    """Draw fields of a bag."""
    console = Console(highlight=False, soft_wrap=True)
    picture: Path = given.out or Path("plot.png")
    if picture.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise UsageError(f"--out {picture}: allowed is a name that ends in .png, .pdf or .svg")
    try:
        bag = read_bag(given.bag)
        found = list({one.name: one for text in given.fields for one in series(bag, text)}.values())
        draw(
            found, picture, str(bag.path) + (" (not as recorded)" if bag.misfit else "" if bag.whole else " (cut off)")
        )
        if given.csv:
            write_table(found, given.csv)
    except BagsError as error:
        raise UsageError(str(error)) from error
    except OSError as error:
        raise UsageError(f"{error.filename}: {error.strerror}") from error
    console.print(summary(found), markup=False)
    console.print(" and ".join(str(path) for path in (picture, given.csv) if path), markup=False)
    return unless_cut_off(0, [bag])
