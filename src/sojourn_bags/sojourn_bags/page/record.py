"""Sections about the record: goals, what the nodes said, contract, completeness, where the bag is from."""

import hashlib
import json
from collections.abc import Mapping

import numpy as np

from sojourn_bags.completeness import RECORD
from sojourn_bags.contract_version import table_of_bag
from sojourn_bags.definitions import CONFIGURATION_NAME, RECOVERY_RECORD, RUN_RECORD
from sojourn_bags.page.chart import Span, strips
from sojourn_bags.page.html import PageSection, figure, paragraph, table
from sojourn_bags.page.story import ARM_SHADE, STATUS, Story
from sojourn_bags.provenance import VERSIONS_NAME
from sojourn_bags.summary import length_in_words, messages, unsent_words
from sojourn_contract.codecs import decode
from sojourn_contract.conformance.findings import number_text
from sojourn_contract.heartbeat import RUNNING, Heartbeat, read_heartbeats
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import topic

MOST_ROWS = 60
HEARTBEAT_S = 1.0
STATUSES = ("/drive/status", "/arm/status", "/power/status")


def goals(story: Story) -> PageSection:
    """Goals and how each ended."""
    if story.summary is None or story.run is None:
        return PageSection("goals", "Goals", paragraph("Goals cannot be judged without the scenario in the bag."))
    found = story.summary["goals"]
    parts = []
    if found:
        rows = [
            [goal["goal"], goal["outcome"], "yes" if goal["met"] else "no", _seconds(goal["start_s"]),
             _seconds(goal["end_s"] - goal["start_s"]),
             "" if goal["error_m"] is None else length_in_words(goal["error_m"]), goal["reason"]]
            for goal in found
        ]  # fmt: skip
        head = ("goal", "ended as", "met", "from [s]", "took [s]", "from the target in truth", "reason given")
        parts.append(table(head, rows, (3, 4, 5), [not goal["met"] for goal in found]))
        lanes: dict[str, list[Span]] = {"drive": [], "arm": []}
        for span in story.axis.spans:
            lanes["arm" if span.color == ARM_SHADE else "drive"].append(span)
        rows_of_spans = [(name, spans) for name, spans in lanes.items() if spans]
        note = "Blue is a drive goal, violet one of the arm; the charts below are shaded alike."
        parts.append(figure("When each goal was under way", strips(story.axis, rows_of_spans, "goals"), note))
    else:
        parts.append(paragraph("No goal was sent."))
    if unsent := unsent_words(story.summary["steps_not_sent"], story.run):
        parts.append(paragraph(unsent))
    return PageSection("goals", "Goals", "".join(parts))


def faults(story: Story) -> PageSection:
    """Faults that came, and how they showed; without a body where there were none."""
    found = [] if story.summary is None else story.summary["faults"]
    rows = [
        [fault["fault"], fault["kind"],
         *("" if fault[at] is None else _seconds(fault[at]) for at in ("begin_s", "end_s")),
         fault["words"], fault["expected"]]
        for fault in found
    ]  # fmt: skip
    head = ("fault", "kind", "from [s]", "until [s]", "how it showed", "expected")
    body = table(head, rows, (2, 3), [not fault["good"] for fault in found]) if found else ""
    return PageSection("faults", "Faults", body)


def heartbeats_of(story: Story) -> dict[str, list[tuple[float, Heartbeat]]]:
    """Heartbeats in the bag by node, each with its time on the page [s]."""
    messages_ = story.find("/diagnostics", STATUS)
    found: dict[str, list[tuple[float, Heartbeat]]] = {}
    if messages_ is None:
        return found
    times = story.times(messages_)
    for index in range(len(messages_)):
        for heartbeat in read_heartbeats(decode(topic(messages_.topic), messages_.data[index])):
            found.setdefault(heartbeat.role, []).append((float(times[index]), heartbeat))
    return found


def diagnostics(story: Story) -> PageSection:
    """Heartbeats, refusals, stalls, and what the statuses said."""
    found = heartbeats_of(story)
    parts = []
    if not found:
        parts.append(paragraph("The bag has no heartbeats on /diagnostics: refusals and stalls are not known."))
    else:
        rows, bad = [], []
        for role, beats in found.items():
            last = beats[-1][1]
            times = np.array([time for time, _ in beats])
            gap = float(np.diff(times).max()) if len(times) > 1 else 0.0
            refused = ", ".join(f"{count} of {topic}" for topic, count in last.refused.items())
            others = sorted({beat.state for _, beat in beats} - {RUNNING})
            words = [f"{state} at {_seconds(next(time for time, beat in beats if beat.state == state))} s"
                     for state in others]  # fmt: skip
            seconds = [_seconds(time) for time in (times[0], times[-1], gap)]
            refusal = last.values.get("last refusal", "")
            rows.append([role, str(len(beats)), *seconds, refused or "none", refusal, "; ".join(words)])
            bad.append(bool(refused or others or gap > 1.5 * HEARTBEAT_S))
        head = ("node", "heartbeats", "first [s]", "last [s]", "longest gap [s]", "messages refused", "last refusal",
                "other states than running")  # fmt: skip
        parts.append(table(head, rows, (1, 2, 3, 4), bad))
    parts.append(_changes(story, found))
    return PageSection("diagnostics", "Diagnostics", "".join(parts))


def _changes(story: Story, beats: Mapping[str, list[tuple[float, Heartbeat]]]) -> str:
    """Every change of what a node said of itself."""
    changes: list[tuple[float, str, str]] = []
    for role, heartbeats in beats.items():
        previous = RUNNING
        for time, beat in heartbeats:
            if beat.detail != previous:
                changes.append((time, role, beat.detail))
            previous = beat.detail
    for name in STATUSES:
        messages_ = story.find(name, STATUS)
        if messages_ is None:
            continue
        before = ""
        for time, values in zip(story.times(messages_), messages_.statuses(), strict=True):
            words = ": ".join(
                dict.fromkeys(text for text in (values.get("state", ""), values.get("reason", "")) if text)
            )
            if words != before:
                changes.append((float(time), name, words))
            before = words
    if not changes:
        return ""
    changes.sort(key=lambda change: change[0])
    rows = [[_seconds(time), who, words] for time, who, words in changes[:MOST_ROWS]]
    left = len(changes) - len(rows)
    note = paragraph(f"{left} more changes are left out.") if left > 0 else ""
    return (
        "<h3>What they said, where it changed</h3>" + table(("time [s]", "from", "state and reason"), rows, (0,)) + note
    )


def contract(story: Story) -> PageSection:
    """Violations of the contract."""
    parts = [paragraph(story.judgement_in_words)]
    parts += [paragraph(note[:1].upper() + note[1:] + ".", quiet=True) for note in story.judgement_notes]
    groups = story.judgement.groups if story.judgement is not None else []
    if groups:
        rows = []
        for group in groups[:MOST_ROWS]:
            first = group.first[0]
            worst = number_text((group.worst or first).finding.value)
            stamp = "" if first.stamp is None else _seconds(first.stamp / NANOSECONDS)
            finding = first.finding
            rows.append([group.topic, finding.field, group.rule, str(group.count), stamp, number_text(finding.value),
                         worst, finding.allowed])  # fmt: skip
        head = ("topic", "field", "rule", "count", "first at [s]", "first value", "worst value", "allowed")
        parts.append(table(head, rows, (3, 4), [True] * len(rows)))
    return PageSection("contract", "Contract", "".join(parts))


def completeness(story: Story) -> PageSection:
    """Messages published and recorded, by topic."""
    bag = story.bag
    parts = []
    if bag.misfit:
        parts.append(paragraph(f"This is not what was recorded: {bag.misfit}."))
    elif not bag.whole:
        parts.append(paragraph("The file is cut off or damaged: what is drawn is what could be read. scripts/recover "
                               "mends it and says what is lost."))  # fmt: skip
    recovery = bag.records.get(RECOVERY_RECORD)
    if recovery:
        original, damage, at = (recovery.get(key, "?") for key in ("original", "damage", "damage_at_byte"))
        parts.append(paragraph(f"This bag was mended from {original}, damaged from byte {at} on: {damage}."))
    if RECORD not in bag.records:
        parts.append(
            paragraph("The recorder has left no account in it: how many messages were published is not known.")
        )
    elif bag.records[RECORD].get("gaps"):
        parts.append(paragraph(f"The recorder's account has gaps: {bag.records[RECORD]['gaps']}."))
    order = {row.name: number for number, row in enumerate(table_of_bag(bag))}
    rows, bad = [], []
    for name, counts in sorted(messages(bag).items(), key=lambda item: (order.get(item[0], len(order)), item[0])):
        recorded, published = counts["recorded"] or 0, counts["published"]
        lost = 0 if published is None else max(0, published - recorded)
        stamps = np.array(bag[name].log_times) / 1e9 if name in bag else np.empty(0)
        span = float(stamps.max() - stamps.min()) if stamps.size > 1 else 0.0
        rate = f"{(stamps.size - 1) / span:.2f}" if span > 0.0 and stamps.size > 2 else ""
        gap = f"{np.diff(np.sort(stamps)).max():.2f}" if stamps.size > 2 else ""
        kind = bag[name].type.replace("/msg/", "/") if name in bag else ""
        sent = "not counted" if published is None else str(published)
        rows.append([name, kind, rate, gap, sent, str(recorded), str(lost) if lost else ""])
        bad.append(bool(lost))
    head = ("topic", "type", "rate [Hz]", "longest gap [s]", "published", "recorded", "lost")
    parts.append(table(head, rows, (2, 3, 4, 5, 6), bad))
    return PageSection("completeness", "Completeness", "".join(parts))


def provenance(story: Story) -> PageSection:
    """Scenario, seed, versions, digests of the configuration."""
    bag, run = story.bag, story.run
    size = sum(part.stat().st_size for part in bag.parts) / 1e6
    rows = [["file", ", ".join(map(str, bag.parts))], ["size", f"{size:.1f} MB"]]
    if run is not None:
        rows += [["scenario", run.name], ["description", run.scenario.description], ["seed", str(run.scenario.seed)],
                 ["overrides", ", ".join(run.overrides) or "none"]]  # fmt: skip
    for name, value in bag.records.get(RUN_RECORD, {}).items():
        if name != "scenario":
            rows.append([name.replace("_", " "), value])
    try:
        versions = json.loads(bag.attachments.get(VERSIONS_NAME, b"{}"))
    except ValueError:
        versions = {}
    parts = [table(("what", "value"), rows)]
    if isinstance(versions, dict) and versions:
        parts.append(
            "<h3>Versions</h3>"
            + table(("package", "version"), [[str(key), str(value)] for key, value in versions.items()])
        )
    else:
        parts.append(paragraph("The bag does not say with which versions it was made."))
    files = [name for name in bag.attachments if name != VERSIONS_NAME]
    if files:
        digests = [
            [_explained(name), str(len(bag.attachments[name])), hashlib.sha256(bag.attachments[name]).hexdigest()[:16]]
            for name in files
        ]
        parts.append("<h3>Configuration</h3>" + table(("file", "bytes", "SHA-256, first 16 digits"), digests, (1,)))
    else:
        parts.append(paragraph("No configuration is attached."))
    return PageSection("provenance", "Provenance", "".join(parts))


def _explained(name: str) -> str:
    return f"{name} (all values as used)" if name == CONFIGURATION_NAME else name


def _seconds(value: float) -> str:
    return f"{value:.2f}"
