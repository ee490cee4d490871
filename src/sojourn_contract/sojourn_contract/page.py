"""The contract as one HTML page that opens offline: what a flight-software team writes its node from."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from sojourn_contract.barrier import awaited_inputs
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.description import contract_data, contract_name
from sojourn_contract.manual import SECTIONS
from sojourn_contract.page_policy import policy_tag
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES

_STYLE = """
:root { color-scheme: light dark; --line: #8884; --soft: #8881; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 78rem; margin: 0 auto; padding: 1.5rem 1rem 4rem; }
h1 { margin: 0; font-size: 1.7rem; } 
h2 { margin: 2.2rem 0 .6rem; font-size: 1.25rem; border-bottom: 2px solid var(--line); }
h3 { margin: 1.6rem 0 .3rem; font-size: 1.02rem; } p { margin: .3rem 0; } li { margin: .2rem 0; max-width: 60rem; }
code { font: .92em ui-monospace, monospace; } nav a { margin-right: 1rem; }
table { border-collapse: collapse; margin: .5rem 0 1rem; } .wide { overflow-x: auto; }
th, td { text-align: left; vertical-align: top; padding: .2rem .7rem .2rem 0; border-bottom: 1px solid var(--line); }
th { font-weight: 600; } td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr:hover { background: var(--soft); } .quiet { opacity: .75; }
@media print { nav { display: none; } h3 { break-after: avoid; } }
"""


def contract_page(machine: JudgedMachine) -> str:
    """The page, for one rover."""
    data = contract_data(machine.table)
    parts = [
        f"<h1>The contract of Sojourn</h1><p class=quiet>Contract {escape(contract_name(data))}, rover "
        f"{escape(machine.name)}. Judged by <code>scripts/contract check</code>.</p>",
        "<nav><a href='#roles'>Roles</a><a href='#rules'>Rules</a><a href='#topics'>Topics</a>"
        "<a href='#fields'>Fields</a><a href='#machine'>Machine</a></nav>",
        _heading("roles", "Roles"),
        _roles(machine.table),
        _heading("rules", "Rules"),
        *(f"<h3>{escape(title)}</h3><ul>{_items(rules)}</ul>" for title, rules in SECTIONS),
        _heading("topics", "Topics"),
        _topics(data["topics"]),
        _heading("fields", "Fields"),
        *(_fields(name, topic) for name, topic in data["topics"].items()),
        _heading("machine", f"Machine: {machine.name}"),
        _rover(machine),
    ]
    head = (
        f"{policy_tag()}<meta charset=utf-8><meta name=viewport content='width=device-width'>"
        "<title>The contract of Sojourn</title>"
    )
    return (
        f"<!doctype html><html lang=en><head>{head}<style>{_STYLE}</style></head><body>{''.join(parts)}</body></html>\n"
    )


def _heading(anchor: str, text: str) -> str:
    return f"<h2 id={anchor}>{escape(text)}</h2>"


def _items(texts: Iterable[str]) -> str:
    return "".join(f"<li>{escape(text)}</li>" for text in texts)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], numbers: Sequence[str] = ()) -> str:
    """A table of cells that are HTML already, without columns that are empty. `numbers`: set to the right."""
    rows = list(rows)
    kept = [place for place in range(len(head)) if any(row[place] for row in rows)]
    head, rows = [head[place] for place in kept], [[row[place] for place in kept] for row in rows]
    top = "".join(f"<th>{escape(name)}</th>" for name in head)
    body = "".join(
        "<tr>"
        + "".join(
            f"<td{' class=number' if name in numbers else ''}>{cell}</td>" for name, cell in zip(head, row, strict=True)
        )
        + "</tr>"
        for row in rows
    )
    return f"<div class=wide><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"


def _code(text: str) -> str:
    return f"<code>{escape(text)}</code>" if text else ""


def _codes(texts: Iterable[str]) -> str:
    return "<br>".join(_code(text) for text in texts)


def _roles(table: TopicTable) -> str:
    rows = [
        (
            f"<b>{role}</b>",
            _codes(_with_rate(row) for row in awaited_inputs(role, ROLES, table)),
            _codes(row.name for row in table.inputs_of(role) if row.is_event),
            _codes(_with_rate(row) for row in table.outputs_of(role)),
        )
        for role in ROLES
        if role != "recorder"
    ]
    note = (
        "<p class=quiet>The recorder subscribes to every recorded topic and publishes <code>/recorder/tick</code>.</p>"
    )
    return _table(("role", "inputs that it waits for", "events", "outputs"), rows) + note


def _with_rate(row: Topic) -> str:
    return row.name if row.is_event else f"{row.name} {_rate(50.0 / row.every)}"


def _rate(rate: float | None) -> str:
    return "event" if rate is None else f"{rate:g} Hz"


def _topics(topics: Mapping[str, Any]) -> str:
    rows = [
        (
            f"<a href='#{name[1:]}'>{_code(name)}</a>",
            _code(topic["type"]),
            escape(f"{topic['publisher']} → {', '.join(topic['subscribers']) or 'bag, people'}"),
            _rate(topic["rate_hz"]),
            "" if topic["max_age_s"] is None else f"{topic['max_age_s']:g} s",
            escape(_qos(topic["qos"])),
            _codes([*(repr(frame) for frame in topic["frames"])])
            + (f"<br>child {_code(repr(topic['child_frame']))}" if topic["child_frame"] else ""),
            escape(topic["joints"]),
        )
        for name, topic in topics.items()
    ]
    head = ("topic", "type", "from → to", "rate", "age at most", "quality of service", "frame", "joints")
    return _table(head, rows, numbers=("rate", "age at most"))


def _qos(qos: Mapping[str, str]) -> str:
    if qos["lockstep"] == qos["realtime"]:
        return qos["lockstep"]
    return f"{qos['lockstep']}; in real time {qos['realtime']}"


def _fields(name: str, topic: Mapping[str, Any]) -> str:
    note = "" if topic["recorded"] else " (not in the bag)"
    head = f"<h3 id='{name[1:]}'>{_code(name)}</h3><p>{escape(topic['meaning'] + note)}</p>"
    if not topic["fields"]:
        return head
    rows = [
        (
            _code(rule["path"]),
            escape(rule["unit"]),
            escape(rule["frame"]),
            _range(rule["low"], rule["high"]),
            f"{rule['tolerance']:g}",
            escape(field_note(topic["type"], rule)),
        )
        for rule in topic["fields"]
    ]
    titles = ("field", "unit", "in frame", "plausible range", "tolerance of a replay", "note")
    return head + _table(titles, rows, numbers=("tolerance of a replay",))


def _range(low: float | None, high: float | None) -> str:
    return "" if low is None or high is None else f"{low:g} to {high:g}"


def field_note(type_name: str, rule: Mapping[str, Any]) -> str:
    """What else is to be said of a field."""
    notes = []
    if rule["optional"]:
        notes.append("may be empty" if type_name == "sensor_msgs/JointState" else "may be NaN")
    if rule.get("infinite"):
        notes.append("may be infinite")
    if rule["rate_of"]:
        window = rule.get("rate_window", 1)
        over = f" over at most {window} periods" if window > 1 else ""
        part = f" and {100.0 * rule['rate_part']:g} %" if rule.get("rate_part") else ""
        spread = f" and the root of {rule['rate_spread']}" if rule.get("rate_spread") else ""
        notes.append(
            f"change of {rule['rate_of']}{over}, within {rule['rate_tolerance']:g} {rule['unit']}{part}{spread}"
        )
    return "; ".join(notes)


def _rover(machine: JudgedMachine) -> str:
    groups = (("drive", machine.drive), ("steer", machine.steer), ("arm", machine.arm))
    group_of = {joint: name for name, joints in groups for joint in joints}
    rows = [
        (
            _code(name),
            group_of.get(name, "no motor"),
            "" if name not in group_of else "position" if name in machine.held else "rate",
            joint.kind,
            _range(*(None if abs(limit) == float("inf") else limit for limit in (joint.lower, joint.upper))),
            f"{joint.velocity:g}",
        )
        for name, joint in sorted(machine.joints.items(), key=lambda item: group_of.get(item[0], "~"))
    ]
    head = ("joint", "group", "held by", "kind", "stops [rad]", "rate limit [rad/s]")
    counts = ", ".join(f"{len(joints)} {name}" for name, joints in groups)
    return (
        f"<p>{len(machine.joints)} joints move: {counts}, the others have no motor. <code>/joint_states</code> and "
        f"<code>/truth/joint_states</code> hold all {len(machine.joints)}; <code>/drive_command</code> at most "
        f"{len(machine.drive) + len(machine.steer)}; <code>/arm_command</code> {len(machine.arm)}; "
        f"<code>/truth/contacts</code> {machine.contacts} points, wheels first.</p>"
        + _table(head, rows, numbers=("rate limit [rad/s]",))
        + f"<p>Loads of <code>/power/switches</code>: {', '.join(map(_code, machine.loads))}.</p>"
        + f"<p>Poses of <code>/arm/joint_goal</code>: {', '.join(map(_code, machine.poses))}.</p>"
    )
