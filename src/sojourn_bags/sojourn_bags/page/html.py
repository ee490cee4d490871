"""Pieces of an HTML page: tables, figures, sections, and the page around them, all in one file."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from sojourn_contract.page_policy import policy_tag

STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: #1c1c1c; background: #fff;
  margin: 0 auto; max-width: 1140px; padding: 0 18px 60px; }
h1 { font-size: 24px; margin: 22px 0 4px; } h2 { font-size: 19px; margin: 34px 0 4px; border-bottom: 2px solid #ddd; }
h3 { font-size: 15px; margin: 16px 0 0; } p { margin: 4px 0 8px; } .quiet { color: #555; } code { font-size: 13px; }
nav a { margin-right: 14px; white-space: nowrap; }
.verdict { border-left: 10px solid; padding: 10px 14px; margin: 12px 0; font-size: 17px; background: #f6f6f6; }
.good { border-color: #0072b2; } .bad { border-color: #d55e00; } .open { border-color: #999; }
.verdict b { display: block; font-size: 13px; letter-spacing: .06em; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(168px, 1fr)); gap: 8px; margin: 12px 0; }
.tile { border: 1px solid #ddd; border-radius: 4px; padding: 6px 10px; }
.tile span { display: block; font-size: 12px; color: #555; } .tile b { font-size: 18px; }
.tile small { display: block; font-size: 12px; color: #555; }
table { border-collapse: collapse; font-size: 13px; margin: 6px 0; }
th, td { text-align: left; padding: 2px 14px 2px 0; border-bottom: 1px solid #e6e6e6; vertical-align: top; }
th { border-bottom: 2px solid #bbb; } td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
td { overflow-wrap: break-word; } td.n { white-space: nowrap; } tr.bad td { background: #fde8dc; font-weight: 600; }
svg, img { width: 100%; height: auto; display: block; } figure { margin: 4px 0 10px; }
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: #333; }
svg text.tick { fill: #555; font-size: 11px; }
svg .curve { fill: none; stroke-width: 1.5; } svg .band { fill: none; stroke-width: .7; stroke-opacity: .28; }
svg .grid { stroke: #e4e4e4; stroke-width: 1; } svg .axis { stroke: #777; fill: none; }
svg .shade { fill-opacity: .08; } .faint { color: #999; } pre { font-size: 12px; white-space: pre-wrap; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(420px, 1fr)); gap: 10px 24px; }
svg .mark { stroke: #111; stroke-dasharray: 5 4; } svg .now { stroke: #d00; stroke-width: 1; }
@media (max-width: 700px) { body { padding: 0 10px 40px; font-size: 14px; } h1 { font-size: 20px; }
  figure, section { overflow-x: auto; } svg { min-width: 760px; } table { font-size: 12px; }
  nav a { line-height: 1.9; } }
@media print { body { max-width: none; font-size: 11px; padding: 0; } nav { display: none; }
  table { font-size: 9px; } td, th { padding-right: 8px; }
  figure, tr, .tiles, .verdict { break-inside: avoid; } h2, h3 { break-after: avoid; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
"""

POINTER = """
// A line at the same time in every chart, under the pointer.
const charts = [...document.querySelectorAll("svg.time")], LEFT = %d, RIGHT = %d, BEGIN = %r, END = %r;
const make = (chart, kind) => chart.appendChild(document.createElementNS("http://www.w3.org/2000/svg", kind));
const marks = charts.map(chart => [make(chart, "path"), make(chart, "text")]);
const show = (x) => marks.forEach(([line, text], i) => {
  const inside = x >= LEFT && x <= RIGHT, height = charts[i].viewBox.baseVal.height;
  line.setAttribute("class", "now"); line.setAttribute("d", inside ? `M${x} 8V${height - 26}` : "");
  text.setAttribute("x", x + 3); text.setAttribute("y", height - 30);
  text.textContent = inside ? (BEGIN + (x - LEFT) / (RIGHT - LEFT) * (END - BEGIN)).toFixed(2) + " s" : "";
});
charts.forEach(chart => {
  chart.addEventListener("mousemove", e => {
    const box = chart.getBoundingClientRect(); show((e.clientX - box.left) / box.width * chart.viewBox.baseVal.width);
  });
  chart.addEventListener("mouseleave", () => show(-1));
});
"""


class Markup(str):
    """Text of a cell that is HTML already."""


@dataclass(frozen=True)
class PageSection:
    """A part of the page: a word for its address, its title, and its content as HTML."""

    key: str
    title: str
    body: str


@dataclass(frozen=True)
class Tile:
    """A key number: what it is, the number with its unit, and a word of comment."""

    name: str
    value: str
    comment: str = ""


def paragraph(text: str, quiet: bool = False) -> str:
    """A paragraph of plain text."""
    return f'<p class="quiet">{escape(text)}</p>' if quiet else f"<p>{escape(text)}</p>"


def figure(title: str, content: str, note: str = "") -> str:
    """A chart or picture under its title; the note stands below the title."""
    words = f'<p class="quiet">{escape(note)}</p>' if note else ""
    return f"<figure><h3>{escape(title)}</h3>{words}{content}</figure>"


def table(
    head: Sequence[str], rows: Sequence[Sequence[str]], numbers: Sequence[int] = (), bad: Sequence[bool] = ()
) -> str:
    """A table of plain texts, or of HTML where a cell is Markup. `numbers` are the columns set flush right; a row that
    is `bad` is marked.
    """

    def line(cells: Sequence[str], kind: str, mark: bool) -> str:
        inside = "".join(
            f"<{kind}{' class=n' if column in numbers else ''}>"
            f"{cell if isinstance(cell, Markup) else escape(cell)}</{kind}>"
            for column, cell in enumerate(cells)
        )
        return f"<tr{' class=bad' if mark else ''}>{inside}</tr>"

    flags = bad or [False] * len(rows)
    body = "".join(line(row, "td", flag) for row, flag in zip(rows, flags, strict=True))
    return f"<table><thead>{line(head, 'th', False)}</thead><tbody>{body}</tbody></table>"


def tiles(found: Sequence[Tile]) -> str:
    """Key numbers side by side."""
    inside = "".join(
        f'<div class="tile"><span>{escape(tile.name)}</span><b>{escape(tile.value)}</b>'
        f"<small>{escape(tile.comment)}</small></div>"
        for tile in found
    )
    return f'<div class="tiles">{inside}</div>'


def document(title: str, head: str, sections: Sequence[PageSection], script: str = "") -> str:
    """The whole page; it needs nothing beside itself."""
    links = "".join(f'<a href="#{section.key}">{escape(section.title)}</a> ' for section in sections)
    body = "".join(
        f'<section id="{section.key}"><h2>{escape(section.title)}</h2>{section.body}</section>' for section in sections
    )
    code = f"<script>{script}</script>" if script else ""
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head>{policy_tag(script)}<meta charset="utf-8">'
        f"<title>{escape(title)}</title>"
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{STYLE}</style></head><body>'
        f"<h1>{escape(title)}</h1>{head}<nav>{links}</nav>{body}{code}</body></html>\n"
    )
