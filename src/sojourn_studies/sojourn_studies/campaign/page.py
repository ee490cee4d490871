"""What came of a campaign as one page that needs nothing but itself; reports of runs that are kept are beside it."""

import json
import shlex
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from sojourn_bags.page.html import Markup, PageSection, Tile, document, figure, paragraph, table, tiles
from sojourn_studies.campaign.findings import OUTCOMES, SHARES, CampaignFindings, Influence, Row
from sojourn_studies.campaign.rates import CONFIDENCE, Rate
from sojourn_studies.campaign.row import LOST, MET, RAISED, UNMET
from sojourn_studies.campaign.scatter import scatter
from sojourn_studies.campaign.task import REPORT

MOST_SCATTERS = 6
PERCENT = f"{100.0 * CONFIDENCE:.0f} %"


def write_page(path: Path, found: CampaignFindings, about: Mapping[str, Any], commands: Mapping[int, str]) -> None:
    """Write the page.

    Args:
        about: campaign, configuration and versions by name, as they identify the campaign. commands: that does a run
            again, by its number, of those that are shown.
    """
    sections = [
        PageSection("rates", "Rates of success", _rates(found)),
        PageSection("outcomes", "Outcomes", _outcomes(found)),
        PageSection("sensitivity", "What the outcomes depend on", _sensitivity(found)),
        PageSection("worst", "Worst runs", _worst(found, path.parent, commands)),
        *([PageSection("reasons", "Runs without a result", _reasons(found))] if found.reasons() else []),
        PageSection("about", "The campaign", _about(about)),
    ]
    description = str(about.get("description", ""))
    title = f"Campaign: {about.get('name', '')}"
    fresh = path.with_suffix(".fresh")
    fresh.write_text(document(title, paragraph(description, quiet=True) + _headline(found), sections), encoding="utf-8")
    fresh.rename(path)


def in_words(rate: Rate) -> str:
    """A rate with its interval."""
    if rate.runs == 0:
        return "no run"
    return f"{100.0 * rate.share:.1f} % ({PERCENT} interval {100.0 * rate.low:.1f} to {100.0 * rate.high:.1f} %)"


def _headline(found: CampaignFindings) -> str:
    rate, results = found.rate, found.results
    words = f"{rate.met} of {rate.runs} runs met their goals: {in_words(rate)}."
    done = len(found.judged)  # the same command does those again that were lost
    state = "THE CAMPAIGN IS DONE" if done >= found.total else f"{done} OF {found.total} RUNS ARE DONE"
    counts = [Tile(name, str(results[name])) for name in (MET, UNMET, RAISED, LOST) if results[name] or name == MET]
    head = f'<div class="verdict open"><b>{state}</b>{paragraph(words)}</div>'
    return head + tiles([Tile("runs", f"{done} of {found.total}"), *counts])


def _rates(found: CampaignFindings) -> str:
    note = (
        f"Of each group the share of runs that met their goals, with its exact {PERCENT} interval (Clopper and Pearson "
        "1934). A run that could not be run counts as one that failed; one that was lost with its worker, or because "
        "that had no room or memory, does not count."
    )
    rows = [["all", "", *_cells(found.rate)], *([one.key, one.value, *_cells(one.rate)] for one in found.groups())]
    head = ("input", "value", "runs", "met", "share [%]", "from [%]", "to [%]")
    return paragraph(note, quiet=True) + table(head, rows, (2, 3, 4, 5, 6))


def _cells(rate: Rate) -> list[str]:
    shares = [f"{100.0 * share:.1f}" if rate.runs else "" for share in (rate.share, rate.low, rate.high)]
    return [str(rate.runs), str(rate.met), *shares]


def _outcomes(found: CampaignFindings) -> str:
    names = ("least", "5 %", "median", "95 %", "greatest")
    rows = [[name, *(f"{value:.4g}" for value in values)] for name, values in found.spreads().items()]
    return table(("figure, by the truth", *names), rows, tuple(range(1, len(SHARES) + 1)))


def _sensitivity(found: CampaignFindings) -> str:
    if not found.influences:
        return paragraph("Too few runs, or nothing varies, to say what the outcomes depend on.")
    note = (
        "S is the first-order index: the share of the outcome's variance that is gone once the input is known (Sobol "
        "1993; correlation ratio over classes: McKay 1995, Plischke et al. 2013; less what chance gives: Kelley 1935). "
        f"r is Spearman's rank correlation with its {PERCENT} interval (Bonett and Wright 2000). Faint: not told from "
        "chance, which gives as much in one campaign of a hundred or more (permutation test: Fisher 1935)."
    )
    by_place = {(one.key, one.outcome): one for one in found.influences}
    outcomes = [name for name in OUTCOMES if any(name == one.outcome for one in found.influences)]
    rows = [[key, *(_influence(by_place.get((key, name))) for name in outcomes)] for key in found.inputs]
    return paragraph(note, quiet=True) + table(("input", *outcomes), rows) + _scatters(found)


def _influence(one: Influence | None) -> Markup:
    if one is None:
        return Markup("")
    words = f"S {one.first_order.value:.2f}"
    if one.correlation is not None:
        value, low, high = one.correlation
        words += f"<br>r {value:+.2f}<br><small>{low:+.2f} to {high:+.2f}</small>"
    return Markup(f"<b>{words}</b>" if one.first_order.is_told else f'<span class="faint">{words}</span>')


def _scatters(found: CampaignFindings) -> str:
    drawn = []
    for one in found.influences:
        if one.correlation is None or not one.first_order.is_told or one.outcome not in found.spreads():
            continue
        drawn.append(figure(f"{one.outcome} over {one.key}", scatter(found.judged, one.key, one.outcome)))
        if len(drawn) == MOST_SCATTERS:
            break
    return f'<div class="pair">{"".join(drawn)}</div>' if drawn else ""


def _worst(found: CampaignFindings, folder: Path, commands: Mapping[int, str]) -> str:
    head = ("run", "ended", "reason", "goal error [m]", "arm error [m]", *found.inputs, "report, or what does it again")
    rows, bad = [], []
    for row in found.worst():
        errors = ["" if row[name] is None else f"{row[name]:.3g}" for name in ("goal_error_m", "arm_error_m")]
        inputs = [_short(row[key]) for key in found.inputs]
        where = _where(row, folder, commands)
        rows.append([str(row["run"]), row["result"], _short(row["reason"], 200), *errors, *inputs, where])
        bad.append(row["result"] != MET)
    return table(head, rows, (0, 3, 4), bad)


def _where(row: Row, folder: Path, commands: Mapping[int, str]) -> str:
    place = f"runs/{row['run']:05d}/{REPORT}"
    if (folder / place).is_file():
        return Markup(f'<a href="{place}">report</a>')
    command = escape(commands.get(row["run"], ""))
    return Markup(f"<details><summary>command</summary><code>{command}</code></details>")


def _reasons(found: CampaignFindings) -> str:
    return table(("runs", "reason"), [[str(count), reason] for reason, count in found.reasons()], (0,))


def _about(about: Mapping[str, Any]) -> str:
    return f"<pre>{escape(json.dumps(about, indent=1, ensure_ascii=False))}</pre>"


def command_of(scenario: str, overrides: Sequence[str]) -> str:
    """What does a run again, by itself."""
    return " ".join(["scripts/start.py", scenario, "--direct", *(f"--set {shlex.quote(text)}" for text in overrides)])


def _short(value: Any, most: int = 60) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return text if len(text) <= most else text[: most - 1] + "…"
