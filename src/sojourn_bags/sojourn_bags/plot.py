"""Fields over time as a picture and as a table: a panel for each unit, all with one scale of time."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sojourn_bags.curves import COLORS, thinned
from sojourn_bags.fields import Series

WIDTH, PANEL, LEGEND_LINE, DOTS_PER_INCH = 12.0, 3.0, 0.18, 110
"""Sizes [inch]."""
DASHES = ("-", "--", ":", "-.")


def by_unit(found: Sequence[Series]) -> dict[str, list[Series]]:
    """Series by unit, in the order in which the units come."""
    panels: dict[str, list[Series]] = {}
    for one in found:
        panels.setdefault(one.unit, []).append(one)
    return panels


def draw(found: Sequence[Series], path: Path, title: str) -> None:
    """Draw series into a picture; those of one unit share a panel."""
    panels = by_unit(found)
    heights = [max(PANEL, 0.6 + LEGEND_LINE * len(group)) for group in panels.values()]
    figure = Figure(figsize=(WIDTH, 0.8 + sum(heights)), dpi=DOTS_PER_INCH, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    grid = figure.subplots(len(panels), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    for axes, (unit, group) in zip(grid, panels.items(), strict=True):
        for number, one in enumerate(group):
            style = DASHES[number // len(COLORS) % len(DASHES)]
            marker = "." if len(one.values) < 60 else ""
            times, values = thinned(one.times, one.values)
            axes.plot(
                times, values, style, color=COLORS[number % len(COLORS)], linewidth=1.2, marker=marker, label=one.name
            )
        axes.set_ylabel(f"[{unit}]" if unit else "no unit declared")
        axes.grid(alpha=0.25)
        axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    grid[-1].set_xlabel("stamp [s]")
    figure.savefig(path)


def write_table(found: Sequence[Series], path: Path) -> None:
    """Series as CSV: a row for each stamp, a column for each series, empty where it has no value there."""
    stamps = np.unique(np.concatenate([one.times for one in found]))
    columns = []
    for one in found:
        column = np.full(len(stamps), np.nan)
        column[np.searchsorted(stamps, one.times)] = one.values
        columns.append(column)
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["stamp [s]", *(f"{one.name} [{one.unit}]" if one.unit else one.name for one in found)])
        for row, stamp in enumerate(stamps):
            writer.writerow(
                [f"{stamp:.9f}", *("" if np.isnan(column[row]) else repr(float(column[row])) for column in columns)]
            )
