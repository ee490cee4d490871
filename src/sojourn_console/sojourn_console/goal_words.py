"""A goal by hand in the words of the page: what a click is, and what the goal would take."""

import math
from collections.abc import Mapping, Sequence

from sojourn_console.draft import Draft
from sojourn_console.rehearsed import RECKONED, SIMULATED, RehearsedDrive, alike, ends
from sojourn_console.rehearser import Rehearser
from sojourn_operator.foresight_words import foresight_lines

LOOK, DRIVE, ROUTE, ARM, TASK = "look round", "drive to a place", "drive a route", "place the arm's tip", "arm task"
"""What a click in the scene can be."""
APART = 0.02
"""Figures of a drive that differ by less are one."""


def foresight_rows(status: Mapping[str, str]) -> list[tuple[str, str]]:
    """The drive's answer to a question, as names and values."""
    first, *rest = foresight_lines(status)
    rows = [("rehearsal", first)]
    for line in rest:
        name, _, value = line.partition(":")
        rows.append((name, value.strip()))
    return rows


def rehearsal_rows(rehearser: Rehearser) -> list[tuple[str, str]]:
    """What a rehearsal has found so far, as names and values."""
    rows = _found_rows(rehearser.found.get(RECKONED), rehearser.looks)
    rows += _found_rows(rehearser.found.get(SIMULATED))
    if rehearser.problem:
        return [*rows, (SIMULATED, rehearser.problem)]
    if rehearser.is_under_way and SIMULATED not in rehearser.found:
        rows.append((SIMULATED, "begins …"))
    return rows


def _found_rows(found: RehearsedDrive | None, looks: Sequence[RehearsedDrive] = ()) -> list[tuple[str, str]]:
    if found is None:
        return []
    same = alike(looks) if looks else [found]
    end = found.state if found.is_over else f"{found.time_s:.0f} s so far"
    counted = (
        [f"{state} in {count} of {len(looks)}" for state, count in ends(looks)] if len(same) < len(looks) else [end]
    )
    first = f"{counted[0]}: {found.reason}" if found.reason else counted[0]
    charge = f", charge {found.charge:.1%}, {found.mode.lower()}" if math.isfinite(found.charge) else ""
    slip = f", slip {found.slip:.0%}" if found.means == SIMULATED else ""
    return [
        (found.means, "; ".join([first, *counted[1:]])),
        ("driven", f"{found.length_m:.2f} m in {found.time_s:.0f} s{_spread('time_s', same, '.0f')}"),
        ("energy", f"{found.energy_wh:.2f} Wh{_spread('energy_wh', same, '.2f')}{charge}"),
        ("worst", f"tilt {found.tilt_deg:.1f}°{slip}"),
    ]


def _spread(name: str, looks: Sequence[RehearsedDrive], form: str) -> str:
    """By how much a figure differs from time to time; nothing where it hardly does."""
    values = [getattr(one, name) for one in looks]
    low, high = min(values), max(values)
    return f" ({low:{form}} to {high:{form}})" if high > (1.0 + APART) * low else ""


def hint_html(mode: str, draft: Draft) -> str:
    """What a click does now, and where the goal lies."""
    if mode == LOOK:
        words = "Choose what a click in the scene means to place a goal."
    elif not draft.points and mode != TASK:
        words = "Click on the ground." if mode == DRIVE else "Click on the ground, point by point."
    elif mode == ARM:
        words = "Tip in base_link: " + ", ".join(f"{one:.3f}" for one in draft.points[0]) + " m. Drag the handle."
    elif mode == TASK:
        words = "A click on the ground fills in its position in base_link."
    else:
        x, y, _ = draft.points[-1]
        words = (
            f"({x:.2f}, {y:.2f}) m"
            + (f", {len(draft.points)} points" if draft.kind == "route" else "")
            + ". Drag to move."
        )
    return f'<div style="font-size:.82em;opacity:.75;margin:0 14px">{words}</div>'
