"""The summary of a run, from its bag alone: what was asked and reached, what it cost, is the record whole.

Distances and errors are by the truth of the plant, not by what the rover believes.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.afloat import base_motion
from sojourn_bags.completeness import FOREIGN, RECORD, published_by, why_incomplete
from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.description import Run
from sojourn_bags.detection import judge_faults, sentence
from sojourn_bags.extent import sim_time
from sojourn_bags.goals import (
    ARM_TOPICS,
    DRIVE_TOPICS,
    UNFINISHED,
    GoalResult,
    Limits,
    judge_goals,
    missing_steps,
)
from sojourn_bags.machine import TrueMachine, poses_of, tilts
from sojourn_bags.onset import RESUMED
from sojourn_bags.power_modes import mode_changes, power_words
from sojourn_bags.reading import Bag
from sojourn_bags.transforms import TOPIC as TRANSFORMS_TOPIC

FloatArray = NDArray[np.float64]
JOULES_PER_WATT_HOUR = 3600.0
ELECTRICAL = "/truth/electrical"
"""Of the first store; of each further one below it."""


def summarise(bag: Bag, run: Run | None = None, wall_time_s: float | None = None) -> dict[str, Any]:
    """Summary of a run; numbers that the bag cannot give are None.

    Args:
        bag: its bag. run: description of its scenario, None for the one in the bag. wall_time_s: how long it
            took [s].

    Returns:
        scenario, seed, verdict (words), all_met, complete, sim_time_s, wall_time_s, real_time_factor,
        distance_m, goal_error_m (last drive goal), arm_error_m (worst place of the arm), energy_wh,
        soc_start, soc_least, soc_end, power_modes (each from when on), max_sinkage_m, max_tilt_deg, of what
        floats base_moved_m, base_turned_deg and centre_of_mass_moved_m, goals (each with its outcome),
        steps_not_sent, faults (each with how it showed), faults_met (whether all showed as they should),
        messages (topic -> published, recorded).
    """
    run = run or Run.of_bag(bag)
    has_truth = "/truth/odom" in bag
    machine = TrueMachine(bag, run.urdf) if has_truth and "/truth/joint_states" in bag else None
    end_s = sim_time(bag)
    accept = run.scenario.accept
    tip_link = "" if run.arm is None else run.arm["tip_link"]
    results = judge_goals(bag, machine, tip_link, Limits(accept.drive_m, accept.arm_m), end_s)
    record = bag.records.get(RUN_RECORD, {})
    operated = "operator" in record.get("participants", "operator").split(",") and RESUMED not in record
    topics = [step.action.topic for step in run.scenario.steps] if operated else []
    not_sent = missing_steps(topics, [result.goal for result in results])
    drive_errors = [result.error_m for result in results if result.goal.topic in DRIVE_TOPICS]
    arm_errors = [result.error_m for result in results if result.goal.topic in ARM_TOPICS]
    floats = run.machine.floats  # which has no way up, and does not drive
    upright = has_truth and not floats
    max_tilt_deg = float(np.degrees(tilts(poses_of(bag, "/truth/odom")[:, 3:]).max())) if upright else None
    rolled_over = max_tilt_deg is not None and max_tilt_deg >= run.machine.roll_over_tilt_deg
    charge = charges(bag)
    modes = mode_changes(bag)
    faults = judge_faults(bag, run.scenario.faults)
    incomplete = bag.misfit or ("" if bag.whole else bag.damage or "it is cut off or damaged")
    incomplete = incomplete or why_incomplete(bag.records.get(RECORD))
    distance = distance_driven(bag) if upright else None
    base = base_motion(bag, machine) if floats and machine is not None else None
    all_met = all(result.met for result in results) and not not_sent and not rolled_over
    summary: dict[str, Any] = {
        "scenario": run.name,
        "seed": run.scenario.seed,
        "verdict": "",
        "all_met": all_met,
        "complete": not incomplete,
        "sim_time_s": end_s,
        "wall_time_s": wall_time_s,
        "real_time_factor": end_s / wall_time_s if wall_time_s else None,
        "distance_m": distance,
        "goal_error_m": drive_errors[-1] if drive_errors else None,
        "arm_error_m": max((error for error in arm_errors if error is not None), default=None),
        "energy_wh": energy_used(bag),
        "soc_start": float(charge[0]) if charge.size else None,
        "soc_least": float(charge.min()) if charge.size else None,
        "soc_end": float(charge[-1]) if charge.size else None,
        "power_modes": [change.as_data() for change in modes],
        "max_sinkage_m": max_sinkage(bag, len(run.machine.stands_on)),
        "max_tilt_deg": max_tilt_deg,
        "rolled_over": rolled_over,
        **({} if base is None else base.figures()),
        "goals": [result.as_data() for result in results],
        "steps_not_sent": not_sent,
        "faults": [fault.as_data() for fault in faults],
        "faults_met": all(fault.good for fault in faults),
        "messages": messages(bag),
    }
    who = "rover" if run.machine.stands_on else "machine"
    foreign = bag.records.get(RECORD, {}).get(FOREIGN, "")
    warning = (
        f"Others than their publishers have spoken on {foreign}: what is judged by it may be false." if foreign else ""
    )
    verdict = [
        _verdict(summary, results, who, unsent_words(not_sent, run)) or _NO_GOALS[RESUMED in record],
        f"The record is not complete: {incomplete}." if incomplete else "",
    ]
    verdict += ["" if base is None else base.words(), sentence(faults), power_words(modes, charge.tolist()), warning]
    summary["verdict"] = " ".join(filter(None, verdict))
    return {
        key: None if isinstance(value, float) and not np.isfinite(value) else value for key, value in summary.items()
    }


def unsent_words(steps: int, run: Run) -> str:
    """How many steps of the scenario no goal in the bag is of, in a sentence; "" for none."""
    if not steps:
        return ""
    which = f"{steps} steps of the scenario were" if steps > 1 else "1 step of the scenario was"
    if run.scenario.link is None:
        return f"{which} never sent."
    return f"{which} never heard by the machine: not sent, or lost on the way."


def goal_lines(summary: dict[str, Any]) -> list[str]:
    """What became of each goal, a line each, for a terminal."""
    lines = []
    for goal in summary["goals"]:
        error = "" if goal["error_m"] is None else f", {length_in_words(goal['error_m'])} from the target in truth"
        reason = f" ({goal['reason']})" if goal["reason"] else ""
        lines.append(f"  {goal['goal']}: {goal['outcome']}{error}{reason}")
    return lines


def fault_lines(summary: dict[str, Any]) -> list[str]:
    """What became of each fault, a line each, for a terminal."""
    return [f"  {fault['fault']}: {fault['words']}" for fault in summary["faults"]]


def write_summary(summary: dict[str, Any], path: Path) -> None:
    """Write a summary as JSON."""
    path.write_text(json.dumps(summary, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def distance_driven(bag: Bag) -> float:
    """Length of the true path of base_link [m]."""
    steps = np.diff(poses_of(bag, "/truth/odom")[:, :3], axis=0)
    return float(np.linalg.norm(steps, axis=1).sum())


def is_of_store(topic: str) -> bool:
    """Whether a topic tells the truth of an energy store."""
    return topic == ELECTRICAL or topic.startswith(f"{ELECTRICAL}/")


def energy_used(bag: Bag) -> float | None:
    """Energy that left the stores, by their true voltages and currents (negative while discharging) [Wh]."""
    if ELECTRICAL not in bag:
        return None
    joules = 0.0
    for store in (bag[name] for name in bag.topics if is_of_store(name)):
        power = -store.column("voltage") * store.column("current")
        joules += float(np.trapezoid(power, store.times)) + float(power[0] * store.times[0])
    return joules / JOULES_PER_WATT_HOUR


def charges(bag: Bag) -> FloatArray:
    """True state of charge over time, empty where it is not recorded [1]."""
    return bag[ELECTRICAL].column("percentage") if ELECTRICAL in bag else np.empty(0)


def max_sinkage(bag: Bag, supports: int) -> float | None:
    """Deepest that anything has sunk on which the machine stands [m]: these are the first contacts."""
    if "/truth/contacts" not in bag:
        return None
    sinkage = bag["/truth/contacts"].points().get("sinkage", np.empty((0, 0)))[:, :supports]
    return float(np.nanmax(sinkage)) if np.isfinite(sinkage).any() else None


def messages(bag: Bag) -> dict[str, dict[str, int | None]]:
    """Messages published and recorded, by topic. Published is None where nobody counted."""
    counted = published_by(bag.records.get(RECORD, {})) or {}
    names = [*counted, *(name for name in bag.topics if name not in counted and name != TRANSFORMS_TOPIC)]
    return {
        name: {
            "published": counted.get(name),
            "recorded": len(bag[name]) if name in bag else 0,
        }
        for name in names
    }


_NO_GOALS = ("No goals were asked for.", "No goals were asked for in this record, which begins within its run.")


def _verdict(summary: dict[str, Any], results: list[GoalResult], who: str, unsent: str) -> str:
    """For a person, "" where nothing is to be told; `who`: what to call the machine, `unsent`: what to say of steps."""
    unmet = [result for result in results if not result.met and result.outcome != UNFINISHED]
    under_way = [result for result in results if result.outcome == UNFINISHED]
    parts = []
    if summary["rolled_over"]:
        parts.append(f"The rover rolled over: it tilted by {summary['max_tilt_deg']:.0f} degrees.")
    if unmet:
        first = unmet[0]
        why = f" ({first.reason})" if first.reason else ""
        parts.append(
            f"{len(unmet)} of {len(results)} goals not met: {first.goal.what}: {first.outcome}{why}{_off(first)}."
        )
    if under_way:
        which = ", ".join(f"{result.goal.what}{_off(result)}" for result in under_way)
        parts.append(f"Under way when the record ended, {len(under_way)} of {len(results)} goals: {which}.")
    parts.append(unsent)
    if summary["all_met"] and results:
        parts.append(_success(summary, who))
    return " ".join(filter(None, parts))


def _off(result: GoalResult) -> str:
    return "" if result.error_m is None else f", {length_in_words(result.error_m)} off"


def _success(summary: dict[str, Any], who: str) -> str:
    deeds = []
    if summary["goal_error_m"] is not None:
        from_goal = length_in_words(summary["goal_error_m"])
        deeds.append(f"drove {summary['distance_m']:.1f} m and stopped {from_goal} from the goal")
    if summary["arm_error_m"] is not None:
        deeds.append(f"placed the arm {length_in_words(summary['arm_error_m'])} from its target")
    done = f": the {who} {' and '.join(deeds)}" if deeds else ""
    return f"Every goal was met{done}."


def length_in_words(metres: float) -> str:
    """A distance in a unit that suits its size."""
    return f"{metres:.2f} m" if metres >= 0.1 else f"{1000.0 * metres:.1f} mm"
