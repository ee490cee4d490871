"""Picture of days of power: sources and loads, charge and modes, temperatures."""

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sojourn_config.command_errors import UsageError
from sojourn_studies.picture_style import BLUE, GREY, ORANGE
from sojourn_studies.power_days import PowerDays

SHADES = {"NOMINAL": "#ffffff", "LOW": "#fff3c4", "SAFE": "#ffd8a8", "SURVIVAL": "#ffb3b3", "SLEEP": "#d0d7e5"}
"""Ground behind the charge, by mode."""
CELSIUS = 273.15
SHOWN = 6
"""Loads that have a colour of their own; the rest is one."""


def draw(path: Path, found: PowerDays) -> None:
    """Draw the days into a file. Raises UsageError where it cannot be written."""
    figure = figure_of(found)
    FigureCanvasAgg(figure)
    try:
        figure.savefig(path, dpi=110)
    except (OSError, ValueError) as error:
        raise UsageError(f"--plot {path}: {error}") from error


def figure_of(found: PowerDays) -> Figure:
    """The days, drawn."""
    figure = Figure(figsize=(11.0, 8.0), layout="constrained")
    power, charge, heat = figure.subplots(3, 1, sharex=True, height_ratios=(1.5, 1.2, 0.8))
    figure.suptitle(f"{found.scenario.name}: {found.scenario.config.description}")
    _power(power, found)
    _charge(charge, found)
    _temperatures(heat, found)
    days = np.arange(0.0, found.hours[-1] + 1e-9, found.scenario.body.solar_day / 3600.0)
    for axis in (power, charge, heat):
        axis.set_xlim(0.0, float(found.hours[-1]))
        axis.spines[["top", "right"]].set_visible(False)
        for day in days[1:]:
            axis.axvline(day, color="0.8", linewidth=0.8)
    heat.set_xlabel("hours after the start")
    return figure


def _power(axis: Axes, found: PowerDays) -> None:
    loads = [load.name for load in found.scenario.power.loads]
    order = np.argsort(-found.used.sum(axis=0), kind="stable")
    named, rest = order[:SHOWN], order[SHOWN:]
    rows = [found.used[:, place] for place in named]
    names = [loads[place].replace("_", " ") for place in named]
    if len(rest):
        rows.append(found.used[:, rest].sum(axis=1))
        names.append("all others")
    axis.stackplot(found.hours, *rows, labels=names, alpha=0.65, step="pre")
    if found.scenario.power.sources:
        axis.plot(found.hours, found.offered, color="0.1", linewidth=1.0, linestyle="--", label="sources could give")
        axis.plot(found.hours, found.given, color="0.1", linewidth=1.6, label="sources give")
    top = 1.4 * max(found.used.sum(axis=1).max(), found.offered.max())  # room for the legend
    axis.set(ylabel="W", ylim=(0.0, top), title="What loads take, and what sources give")
    axis.legend(fontsize=8, ncols=3, loc="upper right")


def _charge(axis: Axes, found: PowerDays) -> None:
    seen = dict[str, str]()
    for begin, end, mode in _spans(found):
        axis.axvspan(begin, end, color=SHADES[mode], linewidth=0, label=None if mode in seen else mode)
        seen[mode] = mode
    for place, name in enumerate(found.scenario.power.all_stores):
        charges = [100.0 * min(max(step.charges[place], 0.0), 1.0) for step in found.steps]
        axis.plot(found.hours, charges, color=(BLUE, ORANGE, GREY)[place % 3], label=name.replace("_", " "))
    axis.set(ylabel="charge [%]", ylim=(0.0, 104.0), title="Charge, and the mode of the power manager")
    axis.legend(fontsize=8, ncols=3, loc="lower left")


def _spans(found: PowerDays) -> Iterator[tuple[float, float, str]]:
    """Spans of one mode: beginning and end [h], mode."""
    begin = 0.0
    for mode, steps in groupby(zip(found.hours, found.steps, strict=True), lambda pair: str(pair[1].manager.mode)):
        end = float(list(steps)[-1][0])
        yield begin, end, mode
        begin = end


def _temperatures(axis: Axes, found: PowerDays) -> None:
    for place, name in enumerate(found.scenario.power.all_stores):
        celsius = found.temperatures[:, place] - CELSIUS
        axis.plot(found.hours, celsius, color=(BLUE, ORANGE, GREY)[place % 3], label=name.replace("_", " "))
    for name, kelvin in found.nodes.items():
        axis.plot(found.hours, kelvin - CELSIUS, linewidth=1.0, linestyle="--", label=name.replace("_", " "))
    axis.set(ylabel="°C", title="Temperatures")
    axis.legend(fontsize=8, ncols=4, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, frameon=False)
