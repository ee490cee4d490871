"""A run as a row of the table: what it was, how it ended, its figures. All of it follows from the campaign alone."""

import json
from collections.abc import Mapping
from typing import Any

from sojourn_studies.campaign.draws import Draw

MET, UNMET, RAISED, LOST = "met", "not met", "raised", "lost"
"""How a run ends: its goals met or not; it could not be run; or nothing is known of it, as its worker was gone, had no
room or memory, or was not like the others."""
ENDS = (MET, UNMET, RAISED, LOST)
FIGURES = (
    "sim_time_s",
    "distance_m",
    "goal_error_m",
    "arm_error_m",
    "energy_wh",
    "soc_start",
    "soc_end",
    "max_sinkage_m",
    "max_tilt_deg",
)
"""Numbers of a run's summary that the table has, with their units in their names; none where a run has none."""
FIXED = ("run", "scenario", "seed", "result", "reason", "goals", "goals_met", *FIGURES, "rolled_over", "kept")
"""Columns that every table has; the others are the keys that vary."""


def finished_row(draw: Draw, summary: Mapping[str, Any], seed: int) -> dict[str, Any]:
    """Of a run that came to its end."""
    met = bool(summary["all_met"] and summary["complete"])
    goals = summary["goals"]
    return {
        **_begun(draw, seed),
        "result": MET if met else UNMET,
        "reason": "" if met else str(summary["verdict"]),
        "goals": len(goals) + int(summary["steps_not_sent"]),
        "goals_met": sum(bool(goal["met"]) for goal in goals),
        **{name: summary[name] for name in FIGURES},
        "rolled_over": bool(summary["rolled_over"]),
        "kept": False,
    }


def unfinished_row(draw: Draw, result: str, reason: str) -> dict[str, Any]:
    """Of a run that did not: RAISED or LOST."""
    nothing = dict.fromkeys((*FIGURES, "goals", "goals_met", "rolled_over"))
    seed = draw.values.get("seed")
    return {**_begun(draw, seed), "result": result, "reason": reason, **nothing, "kept": False}


def _begun(draw: Draw, seed: int | None) -> dict[str, Any]:
    varied = {key: plain(value) for key, value in draw.values.items() if key not in ("scenario", "seed")}
    return {"run": draw.number, "scenario": draw.scenario, "seed": seed, **varied}


def plain(value: Any) -> Any:
    """A value as one cell: lists and tables as JSON."""
    return json.dumps(value) if isinstance(value, list | dict | tuple) else value
