"""The report of a bag as one page: everything in one file that opens offline, prints, and can be sent by mail."""

from pathlib import Path

import numpy as np

from sojourn_bags.page import afloat, ground, machine_parts, motion, record
from sojourn_bags.page.chart import LEFT, RIGHT
from sojourn_bags.page.html import POINTER, Tile, document, paragraph, tiles
from sojourn_bags.page.story import Story
from sojourn_bags.reading import Bag
from sojourn_bags.summary import length_in_words

SECTIONS = (
    record.goals,
    record.faults,
    ground.section,
    motion.wheels,
    motion.attitude,
    machine_parts.power,
    machine_parts.arm,
    record.diagnostics,
    record.contract,
    record.completeness,
    record.provenance,
)

OF_WHEELS = (motion.wheels, motion.attitude)
"""Left out for a machine that stands on nothing."""


def write_page(bag: Bag, path: Path, judged: bool = True) -> Story:
    """Write the page of a bag, with its messages judged by the contract or without. Returns what it tells."""
    story = Story(bag)
    if judged:
        story.judge()
    machine = None if story.run is None else story.run.machine
    kept = [make for make in SECTIONS if machine is None or machine.stands_on or make not in OF_WHEELS]
    if machine is not None and machine.floats:
        kept = [afloat.base if make is ground.section else make for make in kept]
    sections = [make(story) for make in kept]
    sections = [section for section in sections if section.body or section.key != "faults"]
    name = story.run.name if story.run else bag.path.name
    script = POINTER % (LEFT, RIGHT, story.axis.begin, story.axis.end)
    path.write_text(document(f"Run report: {name}", _headline(story), sections, script), encoding="utf-8")
    return story


def _headline(story: Story) -> str:
    """Verdict and key numbers."""
    summary = story.summary
    if summary is None:
        words = f"No verdict: {story.why_no_run}. What the bag does hold is below."
        return f'<div class="verdict open"><b>NOT JUDGED</b>{paragraph(words)}</div>{tiles(_common(story))}'
    if not summary["all_met"]:
        look, word = "bad", "FAILED"
    elif not summary["faults_met"]:
        look, word = "bad", "FAULT NOT RECOGNISED"
    else:
        look, word = ("good", "PASSED") if summary["complete"] else ("bad", "RECORD NOT COMPLETE")
    where = f"{summary['scenario']}, seed {summary['seed']}: " + (story.run.scenario.description if story.run else "")
    head = f'<div class="verdict {look}"><b>{word}</b>{paragraph(summary["verdict"])}</div>'
    return paragraph(where, quiet=True) + head + tiles(_numbers(story))


def _common(story: Story) -> list[Tile]:
    bag = story.bag
    count = sum(len(messages) for messages in bag.topics.values())
    return [
        Tile("duration", f"{story.axis.end - story.axis.begin:.1f} s"),
        Tile("messages", str(count), f"on {len(bag.topics)} topics"),
        Tile("file", "not as recorded" if bag.misfit else "whole" if bag.whole else "cut off or damaged"),
    ]


def _numbers(story: Story) -> list[Tile]:
    summary = story.summary or {}
    met = sum(goal["met"] for goal in summary["goals"])
    found = [
        Tile("goals met", f"{met} of {len(summary['goals'])}"),
        Tile("simulated", f"{summary['sim_time_s']:.1f} s"),
    ]
    for key, name, scale, unit in (
        ("distance_m", "driven", 1.0, "m"),
        ("energy_wh", "energy used", 1.0, "Wh"),
        ("max_sinkage_m", "largest sinkage", 1000.0, "mm"),
        ("max_tilt_deg", "largest tilt", 1.0, "°"),
    ):
        if summary[key] is not None:
            found.append(Tile(name, f"{scale * summary[key]:.2f} {unit}"))
    for key, name in (("goal_error_m", "off the last drive goal"), ("arm_error_m", "arm off its target, at worst")):
        if summary[key] is not None:
            found.append(Tile(name, length_in_words(summary[key]), "in truth"))
    if summary["soc_end"] is not None:
        found.append(
            Tile(
                "charge at the end", f"{100.0 * summary['soc_end']:.1f} %", f"from {100.0 * summary['soc_start']:.1f} %"
            )
        )
    margin = story.margin
    if margin is not None and np.isfinite(margin.values).any():
        row = int(np.nanargmin(margin.values))
        found.append(
            Tile("least tip-over margin", f"{np.degrees(margin.values[row]):.1f}°", f"at {margin.times[row]:.1f} s")
        )
    refused = sum(sum(beats[-1][1].refused.values()) for beats in record.heartbeats_of(story).values())
    found.append(Tile("messages refused", str(refused)))
    if story.judgement is not None:
        found.append(Tile("contract violations", str(story.judgement.violations)))
    found.append(Tile("record", "complete" if summary["complete"] else "not complete",
                      f"{sum(len(messages) for messages in story.bag.topics.values())} messages"))  # fmt: skip
    return found
