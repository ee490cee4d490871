"""What scripts/contract shows in a terminal: the contract as a table, and the verdict of a check."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table

from sojourn_contract.conformance.findings import Report, number_text
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.description import contract_data, contract_name
from sojourn_contract.flow import place_of
from sojourn_contract.manual import SECTIONS
from sojourn_contract.page import field_note


def show_contract(screen: Console, machine: JudgedMachine) -> None:
    """Topics with their fields, rules, and the rover's joints."""
    data = contract_data(machine.table)
    screen.print(f"Contract {contract_name(data)}, rover {machine.name}", style="bold", soft_wrap=True)
    screen.print(_topic_table(data["topics"]))
    screen.print(_field_table(data["topics"]))
    for title, rules in SECTIONS:
        screen.print(f"\n{title}", style="bold")
        for rule in rules:
            screen.print(Padding(escape(rule), (0, 0, 0, 2)))
    screen.print("\nThe rover", style="bold")
    groups = (("drive", machine.drive), ("steer", machine.steer), ("arm", machine.arm))
    motors = set(machine.motors)
    passive = tuple(name for name in machine.joints if name not in motors)
    for title, names in (*groups, ("no motor", passive), ("loads", machine.loads), ("poses", machine.poses)):
        screen.print(Padding(escape(f"{title}: {', '.join(names)}"), (0, 0, 0, 2)))
    screen.print(f"  /truth/contacts: {machine.contacts} points")


def show_report(screen: Console, report: Report, notes: Sequence[str], what: str) -> None:
    """One line a violation, a table by topic, and the verdict."""
    for note in notes:
        screen.print(f"note: {escape(note)}", soft_wrap=True)
    for line in report.lines():
        screen.print(escape(line), soft_wrap=True)
    table = _table("topic", "messages", "violations", "worst")
    told = {*report.messages, *(group.topic for group in report.groups)}
    for name in sorted(told, key=lambda name: (place_of(name), name)):
        groups = report.of_topic(name)
        count = sum(group.count for group in groups)
        table.add_row(
            name, str(report.messages.get(name, 0)), str(count), escape(_worst(groups)), style="red" if count else None
        )
    screen.print(table)
    messages = sum(report.messages.values())
    if report.violations:
        topics = len({group.topic for group in report.groups})
        verdict = f"{report.violations} violations on {topics} topics, in {messages} messages of {what}"
    else:
        verdict = f"{what} keeps the contract: no violation in {messages} messages"
    screen.print(escape(verdict), style="bold red" if report.violations else "bold green", soft_wrap=True)


def _table(*titles: str) -> Table:
    """An empty table without frames; what does not fit goes on in the next line."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for title in titles:
        table.add_column(title, overflow="fold", no_wrap=title is titles[0])
    return table


def _topic_table(topics: Mapping[str, Any]) -> Table:
    table = _table("topic, type", "from → to", "rate", "age", "frame, joints, quality of service")
    for name, topic in topics.items():
        table.add_row(
            f"[bold]{name}[/bold]\n{topic['type']}",
            f"{topic['publisher']} → {', '.join(topic['subscribers']) or 'bag, people'}",
            "event" if topic["rate_hz"] is None else f"{topic['rate_hz']:g} Hz",
            "" if topic["max_age_s"] is None else f"{topic['max_age_s']:g} s",
            escape("\n".join(_conditions(topic))),
        )
    return table


def _field_table(topics: Mapping[str, Any]) -> Table:
    table = _table("field", "unit, frame", "range", "replay", "note")
    for name, topic in topics.items():
        if topic["fields"]:
            table.add_row(f"[bold]{name}[/bold]")
        for rule in topic["fields"]:
            unit = " in ".join(part for part in (rule["unit"], rule["frame"]) if part)
            bounds = "" if rule["low"] is None else f"{rule['low']:g} to {rule['high']:g}"
            note = escape(field_note(topic["type"], rule))
            table.add_row(f"  {rule['path']}", escape(unit), bounds, f"±{rule['tolerance']:g}", note)
    return table


def _worst(groups: Sequence[Any]) -> str:
    """The most frequent violation of a topic and its worst value."""
    if not groups:
        return ""
    found = groups[0].worst.finding
    return f"{found.field} = {number_text(found.value)} ({groups[0].count} times)"


def _conditions(topic: Mapping[str, Any]) -> Iterator[str]:
    if topic["frames"]:
        yield "frame " + " or ".join(repr(frame) for frame in topic["frames"])
    if topic["child_frame"]:
        yield f"child frame {topic['child_frame']!r}"
    if topic["joints"]:
        yield f"joints: {topic['joints']}"
    qos = topic["qos"]
    yield qos["lockstep"]
    if qos["realtime"] != qos["lockstep"]:
        yield f"(real time: {qos['realtime']})"
