"""A data sheet as one HTML page that needs nothing but itself: figures in tables, curves as drawings inside the
page.
"""

import html
import io
import math
import re
from collections.abc import Iterable

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as Drawing

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.sheet import Datasheet, FigureComparison
from sojourn_contract.page_policy import policy_tag

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#333333")
"""Distinct to colour-blind eyes too (Okabe and Ito 2008)."""
SIZE_INCHES = (5.2, 3.1)
MARGINS = {"left": 0.155, "right": 0.97, "bottom": 0.155, "top": 0.91}
"""Of the axes in a drawing, enough for every label: to have them found would double the time of a page."""
STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, sans-serif; color: #1c2430; background: #f6f7f9; margin: 0; }
main { max-width: 1180px; margin: 0 auto; padding: 24px; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 19px; margin: 0 0 10px; }
p { margin: 6px 0; color: #4a5567; } .lead { margin-bottom: 20px; }
section { background: #fff; border: 1px solid #dde2e9; border-radius: 8px; padding: 18px 20px; margin: 0 0 18px; }
.body { display: flex; flex-wrap: wrap; gap: 12px 28px; align-items: flex-start; }
.body > .tables { flex: 1 1 430px; } .curves { flex: 1 1 520px; display: flex; flex-direction: column; gap: 14px; }
.body > .tables:only-child { max-width: 560px; }
table { border-collapse: collapse; width: 100%; }
td, th { text-align: left; padding: 4px 10px 4px 0; border-bottom: 1px solid #edf0f4; vertical-align: top; }
th { font-weight: 600; color: #4a5567; border-bottom: 2px solid #dde2e9; }
td.value, th.value { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; font-weight: 600; }
td.unit { white-space: nowrap; } .note { color: #6b7686; font-size: 13px; }
.yes { color: #00684a; } .no { color: #a63d00; }
svg { max-width: 100%; height: auto; }
footer { color: #6b7686; font-size: 13px; padding: 0 4px 24px; }
"""


def number_text(value: float | str | None) -> str:
    """A value as a person would write it: three or four digits, no exponent between 0.001 and 100 000."""
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    if value == 0.0:
        return "0"
    if math.isinf(value):
        return "none"
    size = abs(value)
    if 1e-3 <= size < 1e5:
        digits = 0 if size >= 1000.0 else 3 - math.floor(math.log10(size))
        text = f"{value:,.{max(min(digits, 5), 0)}f}".replace(",", "\u202f")
        return text.rstrip("0").rstrip(".") if "." in text else text
    mantissa, exponent = f"{value:.3e}".split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa.rstrip('0').rstrip('.')} × 10{raised}"


def page(sheet: Datasheet, title: str, lead: Iterable[str], sources: str) -> str:
    """The page as text.

    Args:
        title: heading. lead: paragraphs under it. sources: where the numbers of the vehicle are from.
    """
    parts = [f"<h1>{html.escape(title)}</h1>", *(f'<p class="lead">{html.escape(text)}</p>' for text in lead)]
    if sheet.comparisons:
        parts.append(_comparison_section(sheet.comparisons))
    parts += [_section(section, number) for number, section in enumerate(sheet.sections)]
    parts.append(f"<footer>Numbers of the vehicle: {html.escape(sources)}</footer>")
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en"><head>{policy_tag()}<meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{html.escape(title)}</title><style>{STYLE}</style></head>\n<body><main>\n{body}\n</main></body></html>\n"
    )


def _section(section: Section, number: int) -> str:
    rows = "".join(_row(figure) for figure in section.figures)
    drawings = "".join(_drawing(curve, f"s{number}c{index}") for index, curve in enumerate(section.curves))
    text = f"<p>{html.escape(section.text)}</p>" if section.text else ""
    curves = f'<div class="curves">{drawings}</div>' if drawings else ""
    return (
        f"<section><h2>{html.escape(section.title)}</h2>{text}"
        f'<div class="body"><div class="tables"><table>{rows}</table></div>{curves}</div></section>'
    )


def _row(figure: Figure) -> str:
    note = f' <span class="note">({html.escape(figure.note)})</span>' if figure.note else ""
    return (
        f'<tr><td>{html.escape(figure.label)}{note}</td><td class="value">{html.escape(number_text(figure.value))}</td>'
        f'<td class="unit">{html.escape(figure.unit)}</td></tr>'
    )


def _comparison_section(comparisons: Iterable[FigureComparison]) -> str:
    rows = []
    for entry in comparisons:
        low, high = (number_text(value) for value in entry.published)
        published = low if low == high else f"{low} to {high}"
        verdict = '<span class="yes">agrees</span>' if entry.inside else '<span class="no">differs</span>'
        rows.append(
            f'<tr><td>{html.escape(entry.label)}</td><td class="value">{html.escape(published)}</td>'
            f'<td class="value">{html.escape(number_text(entry.own))}</td>'
            f'<td class="unit">{html.escape(entry.unit)}</td>'
            f'<td>{verdict}</td><td class="note">{html.escape(entry.source)}</td></tr>'
        )
    numbers = "".join(f'<th class="value">{name}</th>' for name in ("Published", "Here"))
    head = f"<tr><th>Figure</th>{numbers}<th></th><th></th><th>Source</th></tr>"
    return f"<section><h2>Published figures beside its own</h2><table>{head}{''.join(rows)}</table></section>"


def _drawing(curve: Curve, prefix: str) -> str:
    """The curve as SVG text with letters kept as letters; `prefix` keeps its inner names apart from other drawings'."""
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": prefix, "font.family": "sans-serif", "font.size": 9.5}):
        drawing = Drawing(figsize=SIZE_INCHES)
        FigureCanvasSVG(drawing)
        axes = drawing.subplots(gridspec_kw=MARGINS)
        for (name, (x, y)), color in zip(curve.lines.items(), COLORS * 4, strict=False):
            axes.plot(x, y, color=color, linewidth=1.8, label=name)
        for index, (name, (x_point, y_point)) in enumerate(curve.points.items()):
            axes.plot([x_point], [y_point], "o", color=COLORS[(index + 1) % len(COLORS)], label=name)
        if curve.logarithmic:
            axes.set_xscale("log")
            axes.set_yscale("log")
            largest = max(float(np.nanmax(y)) for _, y in curve.lines.values())
            axes.set_ylim(bottom=largest * 1e-6, top=largest * 3.0)
        elif _is_flat(curve):
            axes.set_ylim(bottom=0.0, top=1.2 * max(float(np.nanmax(y)) for _, y in curve.lines.values()))
        axes.set_title(curve.title, fontsize=10.5, loc="left")
        axes.set_xlabel(curve.x_label)
        axes.set_ylabel(curve.y_label)
        axes.grid(alpha=0.3)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        if len(curve.lines) + len(curve.points) > 1:
            axes.legend(fontsize=8.5, frameon=False)
        text = io.StringIO()
        drawing.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    drawn = text.getvalue()
    # names inside of one drawing must differ from those of the others in the page
    return re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", drawn[drawn.index("<svg") :])


def _is_flat(curve: Curve) -> bool:
    """Whether its lines change by less than a twentieth of their height: drawn from zero, or rounding would fill the
    axis.
    """
    values = np.concatenate([y[np.isfinite(y)] for _, y in curve.lines.values()])
    return bool(values.min() > 0.0 and np.ptp(values) < 0.05 * values.max())
