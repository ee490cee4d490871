"""An outcome over an input, a point a run, as SVG text."""

from collections.abc import Sequence
from html import escape

import numpy as np

from sojourn_bags.curves import COLORS
from sojourn_bags.page.chart import ticks
from sojourn_studies.campaign.findings import Row
from sojourn_studies.campaign.row import MET

WIDTH, HEIGHT = 520.0, 300.0
LEFT, RIGHT, TOP, BOTTOM = 70.0, 510.0, 10.0, 256.0
MOST_POINTS = 2000
"""More of them would only be black: every so-manieth run is drawn."""
_LOGARITHMIC_FROM = 30.0
"""Greatest over least value from which a positive input is drawn on a logarithmic scale [1]."""


def scatter(rows: Sequence[Row], key: str, outcome: str) -> str:
    """The picture; runs that met their goals are blue rings, the others orange crosses."""
    told = [row for row in rows if row[outcome] is not None]
    told = told[:: max(-(-len(told) // MOST_POINTS), 1)]
    x = np.array([row[key] for row in told], dtype=np.float64)
    y = np.array([row[outcome] for row in told], dtype=np.float64)
    logarithmic = bool(x.min() > 0.0 and x.max() / x.min() >= _LOGARITHMIC_FROM)
    across = np.log10(x) if logarithmic else x
    low_x, high_x = _range(across)
    low_y, high_y = _range(y)
    parts = []
    for tick in ticks(low_x, high_x, 5):
        place = LEFT + (tick - low_x) / (high_x - low_x) * (RIGHT - LEFT)
        text = f"{10.0**tick:.3g}" if logarithmic else f"{tick:.6g}"
        parts.append(f'<path class="grid" d="M{place:.1f} {TOP}V{BOTTOM}"/>')
        parts.append(f'<text class="tick" x="{place:.1f}" y="{BOTTOM + 15}" text-anchor="middle">{text}</text>')
    for tick in ticks(low_y, high_y, 5):
        place = BOTTOM - (tick - low_y) / (high_y - low_y) * (BOTTOM - TOP)
        parts.append(f'<path class="grid" d="M{LEFT} {place:.1f}H{RIGHT}"/>')
        parts.append(f'<text class="tick" x="{LEFT - 6}" y="{place + 4:.1f}" text-anchor="end">{tick:.6g}</text>')
    for row, one, two in zip(told, across, y, strict=True):
        right = LEFT + (one - low_x) / (high_x - low_x) * (RIGHT - LEFT)
        up = BOTTOM - (two - low_y) / (high_y - low_y) * (BOTTOM - TOP)
        if row["result"] == MET:
            mark = f'<circle cx="{right:.1f}" cy="{up:.1f}" r="3" fill="none" stroke="{COLORS[0]}">'
            end = "</circle>"
        else:
            cross = f"M{right - 3:.1f} {up - 3:.1f}l6 6m0 -6l-6 6"
            mark, end = f'<path d="{cross}" stroke="{COLORS[1]}" stroke-width="1.5">', "</path>"
        parts.append(f"{mark}<title>run {row['run']}: {row[key]:.4g}, {row[outcome]:.4g}</title>{end}")
    parts.append(f'<path class="axis" d="M{LEFT} {TOP}V{BOTTOM}H{RIGHT}"/>')
    middle = 0.5 * (LEFT + RIGHT)
    parts.append(f'<text x="{middle}" y="{HEIGHT - 8}" text-anchor="middle">{escape(key)}</text>')
    turned = f"translate(14 {0.5 * (TOP + BOTTOM)}) rotate(-90)"
    parts.append(f'<text transform="{turned}" text-anchor="middle">{escape(outcome)}</text>')
    label = escape(f"{outcome} over {key}")
    return f'<svg viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" role="img" aria-label="{label}">{"".join(parts)}</svg>'


def _range(values: np.ndarray) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    room = 0.04 * (high - low) or 0.5 * max(abs(high), 1e-9)
    return low - room, high + room
