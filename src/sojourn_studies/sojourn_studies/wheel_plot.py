"""Picture of what scripts/wheel_test measures: pull, side force, torque and sinkage over the slip."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sojourn_analysis.wheels.law_bench import Bed
from sojourn_analysis.wheels.wheel_bench import BenchResult, OverloadError
from sojourn_config.command_errors import UsageError
from sojourn_physics.soil.spread import draw_soils

POINTS = 41
DRAWS = 60
SEED = 1
BAND = (5.0, 95.0)
"""Percentiles of the band."""
PANELS = (
    ("drawbar_pull_n", "drawbar pull [N]", 1.0),
    ("side_force_n", "side force [N]", 1.0),
    ("torque_nm", "torque [N m]", 1.0),
    ("sinkage_m", "sinkage [mm]", 1e3),
)


def draw(path: Path, bed: Bed, angles: Sequence[float], marked: Sequence[BenchResult]) -> None:
    """Draw the curves of each slip angle [degree], their band if the soil has a spread, and the cases as marks.

    Raises:
        UsageError: the file cannot be written.
    """
    low = min([0.0, *(one.slip for one in marked)])
    high = max([0.95, *(one.slip for one in marked)])
    slips = np.linspace(low, high, POINTS).tolist()
    figure = Figure(figsize=(10.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 2, sharex=True)
    drawn = draw_soils(bed.soil, DRAWS, SEED) if bed.soil.spread else []
    for number, angle in enumerate(angles):
        colour = f"C{number}"
        curve = _curve(bed, slips, angle)
        band = [_curve(replace(bed, soil=other), slips, angle) for other in drawn]
        for (name, label, unit), axis in zip(PANELS, axes.flat, strict=True):
            if band:
                low_edge, high_edge = np.nanpercentile([unit * one[name] for one in band], BAND, axis=0)
                axis.fill_between(slips, low_edge, high_edge, color=colour, alpha=0.2, linewidth=0.0)
            axis.plot(slips, unit * curve[name], color=colour, label=f"slip angle {angle:g}°")
            here = [one for one in marked if one.slip_angle_deg == angle]
            axis.plot([one.slip for one in here], [unit * getattr(one, name) for one in here], "o", color=colour)
            axis.set_ylabel(label)
            axis.grid(alpha=0.3)
    for axis in axes[1]:
        axis.set_xlabel("slip ratio [-]")
    if len(angles) > 1:
        axes[0, 0].legend()
    band_text = f"; band: {BAND[0]:g} to {BAND[1]:g} % of {DRAWS} soils within the spread" if drawn else ""
    figure.suptitle(f"wheel {bed.wheel.name} on {bed.soil.name}, {bed.contact.model}, load {bed.load:g} N{band_text}")
    try:
        figure.savefig(path, dpi=120)
    except (OSError, ValueError) as error:
        raise UsageError(f"--plot {path}: cannot be written ({error})") from error


def _curve(bed: Bed, slips: Sequence[float], angle: float) -> dict[str, np.ndarray]:
    """The panels' quantities over the slip; not-a-number where the load is not carried."""
    values: dict[str, list[float]] = {name: [] for name, _, _ in PANELS}
    for slip in slips:
        try:
            one = bed.measure([slip], [angle])[0]
        except OverloadError:
            one = None
        for name, found in values.items():
            found.append(np.nan if one is None else getattr(one, name))
    return {name: np.array(found) for name, found in values.items()}
