"""Charts over time as SVG text. All of one page have one scale of time, at the same place, so that they line up."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

from sojourn_bags.curves import COLORS, FloatArray, means, thinned

WIDTH, LEFT, RIGHT = 1100.0, 74.0, 872.0
"""Of a chart, and of the part in which the curves are [px]; the legend stands right of it."""
TOP, BOTTOM = 8.0, 26.0
HEIGHT, ROW = 190.0, 18.0
LEGEND_LINE = 16.0
POINTS = 800
"""Of the band of a curve: its least and its greatest value for every two pixels."""
DASHES = ("", "6 3", "2 2.5", "8 2.5 2 2.5")


@dataclass(frozen=True)
class Span:
    """A stretch of time that is marked: begin and end [s], colour, a word for it."""

    begin: float
    end: float
    color: str
    text: str = ""


@dataclass(frozen=True)
class ChartLine:
    """A curve: times [s], values, name for the legend, colour, and number of the dash pattern."""

    times: FloatArray
    values: FloatArray
    name: str
    color: str = COLORS[0]
    dash: int = 0


@dataclass(frozen=True)
class TimeAxis:
    """The scale of time of a page: from `begin` to `end` [s]; `spans` are shaded in every chart."""

    begin: float
    end: float
    spans: tuple[Span, ...] = field(default=())

    def x(self, times: FloatArray | float) -> FloatArray:
        """Place on the chart [px]."""
        length = max(self.end - self.begin, 1e-9)
        return np.asarray(LEFT + (np.asarray(times) - self.begin) / length * (RIGHT - LEFT))


def wheel_curves(times: FloatArray, values: FloatArray, names: Sequence[str]) -> list[ChartLine]:
    """A curve a column. Right-hand ones are dashed in the colour of their left-hand fellows, where all have a side."""
    paired = bool(names) and all({"left", "right"} & set(name.replace("_", " ").split()) for name in names)
    curves, families = [], list(dict.fromkeys(_without_side(name) for name in names))
    for column, name in enumerate(names):
        number = families.index(_without_side(name)) if paired else column
        dash = int("right" in name) if paired else number // len(COLORS)
        color = COLORS[number % len(COLORS)]
        curves.append(ChartLine(times, values[:, column], name.replace("_", " "), color, dash))
    return curves


def _without_side(name: str) -> str:
    return name.replace("left", "").replace("right", "")


def chart(
    axis: TimeAxis,
    curves: Sequence[ChartLine],
    label: str,
    lines: Sequence[tuple[float, str]] = (),
    height: float = HEIGHT,
) -> str:
    """Curves over time: a faint band holds every value, the bold line is the mean.

    Args:
        label: quantity with its unit. lines: values to mark, each with a word. height: [px].
    """
    height = max(height, TOP + BOTTOM + LEGEND_LINE * len(curves))
    short = [(curve, *thinned(curve.times, curve.values, POINTS)) for curve in curves]
    low, high = _range([values for _, _, values in short], [value for value, _ in lines])
    bottom = height - BOTTOM

    def y(values: FloatArray | float) -> FloatArray:
        return np.asarray(bottom - (np.asarray(values) - low) / (high - low) * (bottom - TOP))

    parts = [_frame(axis, height, bottom)]
    for tick in ticks(low, high, 5):
        place = float(y(tick))
        parts.append(f'<path class="grid" d="M{LEFT:.1f} {place:.1f}H{RIGHT:.1f}"/>')
        parts.append(
            f'<text class="tick" x="{LEFT - 6:.1f}" y="{place + 4:.1f}" text-anchor="end">{_number(tick)}</text>'
        )
    middle = 0.5 * (TOP + bottom)
    turned = f"translate(14 {middle:.1f}) rotate(-90)"
    parts.append(f'<text class="label" transform="{turned}" text-anchor="middle">{escape(label)}</text>')
    for value, word in lines:
        place = float(y(value))
        parts.append(f'<path class="mark" d="M{LEFT:.1f} {place:.1f}H{RIGHT:.1f}"/>')
        parts.append(
            f'<text class="word" x="{RIGHT - 4:.1f}" y="{place - 4:.1f}" text-anchor="end">{escape(word)}</text>'
        )
    for number, (curve, times, values) in enumerate(short):
        style = f'stroke="{curve.color}"' + (f' stroke-dasharray="{DASHES[curve.dash]}"' if curve.dash else "")
        mean_times, mean_values = means(curve.times, curve.values)
        if len(curve.values) > POINTS and _is_noisy(
            times, values, mean_times, mean_values, (high - low) / (bottom - TOP)
        ):
            parts.append(f'<path class="band" stroke="{curve.color}" d="{_path(axis.x(times), y(values))}"/>')
            times, values = mean_times, mean_values
        parts.append(f'<path class="curve" {style} d="{_path(axis.x(times), y(values))}"/>')
        place = TOP + 8.0 + LEGEND_LINE * number
        parts.append(f'<path class="curve" {style} d="M{RIGHT + 12:.0f} {place:.0f}h26"/>')
        parts.append(f'<text class="word" x="{RIGHT + 44:.0f}" y="{place + 4:.0f}">{escape(curve.name)}</text>')
    return _svg(height, parts, label)


def strips(axis: TimeAxis, rows: Sequence[tuple[str, Sequence[Span]]], label: str) -> str:
    """Rows of stretches of time, each row with its name beside it and a word in each stretch that has room for it."""
    height = TOP + BOTTOM + ROW * len(rows)
    parts = [_frame(axis, height, height - BOTTOM)]
    for number, (name, spans) in enumerate(rows):
        place = TOP + ROW * number
        parts.append(f'<text class="word" x="{RIGHT + 12:.0f}" y="{place + 13:.0f}">{escape(name)}</text>')
        for span in spans:
            begin, end = float(axis.x(span.begin)), float(axis.x(span.end))
            width = max(end - begin, 1.0)
            box = f'x="{begin:.1f}" y="{place + 2:.0f}" width="{width:.1f}" height="{ROW - 4:.0f}"'
            words = f"{escape(span.text)}, {span.begin:.2f} to {span.end:.2f} s"
            parts.append(f'<rect {box} fill="{span.color}"><title>{words}</title></rect>')
            if width > 6.5 * len(span.text) + 6.0:
                ink = "#ffffff" if _is_dark(span.color) else "#222222"
                spot = f'x="{begin + 4:.1f}" y="{place + 13:.0f}"'
                parts.append(f'<text class="word" style="fill:{ink}" {spot}>{escape(span.text)}</text>')
    return _svg(height, parts, label)


def ticks(low: float, high: float, wanted: int) -> list[float]:
    """Round values from low to high, about so many."""
    raw = (high - low) / wanted
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if factor * power >= raw * 0.999)
    return [number * step for number in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _frame(axis: TimeAxis, height: float, bottom: float) -> str:
    """Shaded goals, lines and numbers of the axis of time."""
    parts = []
    for span in axis.spans:
        begin, end = float(axis.x(span.begin)), float(axis.x(span.end))
        parts.append(
            f'<rect class="shade" x="{begin:.1f}" y="{TOP:.0f}" width="{end - begin:.1f}" height="{bottom - TOP:.1f}" '
            f'fill="{span.color}"/>'
        )
    for tick in ticks(axis.begin, max(axis.end, axis.begin + 1e-6), 10):
        place = float(axis.x(tick))
        parts.append(f'<path class="grid" d="M{place:.1f} {TOP:.0f}V{bottom:.1f}"/>')
        parts.append(
            f'<text class="tick" x="{place:.1f}" y="{bottom + 14:.1f}" text-anchor="middle">{_number(tick)}</text>'
        )
    parts.append(f'<text class="tick" x="{RIGHT + 12:.1f}" y="{bottom + 14:.1f}">time [s]</text>')
    parts.append(f'<path class="axis" d="M{LEFT:.1f} {TOP:.0f}V{bottom:.1f}H{RIGHT:.1f}"/>')
    return "".join(parts)


def _svg(height: float, parts: Sequence[str], label: str) -> str:
    return (
        f'<svg class="time" viewBox="0 0 {WIDTH:.0f} {height:.0f}" role="img" aria-label="{escape(label)}">'
        f"{''.join(parts)}</svg>"
    )


def _range(curves: Sequence[FloatArray], marks: Sequence[float]) -> tuple[float, float]:
    """Least and greatest value with some room; of constant curves a range that does not look like noise."""
    finite = [values[np.isfinite(values)] for values in curves]
    joined = np.concatenate([*finite, np.array(marks, dtype=np.float64)])
    low, high = (float(joined.min()), float(joined.max())) if joined.size else (0.0, 1.0)
    least = max(1e-3 * max(abs(low), abs(high)), 1e-9)
    if high - low < least:
        low, high = low - 0.5 * least, high + 0.5 * least
    room = 0.05 * (high - low)
    return low - room, high + room


def _is_noisy(
    times: FloatArray, values: FloatArray, mean_times: FloatArray, mean_values: FloatArray, pixel: float
) -> bool:
    """Whether some values are more than three pixels from the mean."""
    if len(mean_times) < 2:
        return False
    off = np.abs(values - np.interp(times, mean_times, mean_values))
    return bool(np.nanmax(np.append(off, 0.0)) > 3.0 * pixel)


def _path(x: FloatArray, y: FloatArray) -> str:
    """Path through the points; it breaks where one is not a number."""
    parts, pen = [], "M"
    for across, up in zip(x.tolist(), y.tolist(), strict=True):
        if not (math.isfinite(across) and math.isfinite(up)):
            pen = "M"
            continue
        parts.append(f"{pen}{across:.1f} {up:.1f}")
        pen = "L"
    return "".join(parts)


def _number(value: float) -> str:
    """A tick's number, without the noise of its last digits."""
    return f"{value:.6g}" if abs(value) > 1e-12 else "0"


def _is_dark(color: str) -> bool:
    red, green, blue = (int(color[place : place + 2], 16) for place in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue < 140.0
