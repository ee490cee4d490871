"""Any field of a bag over time, by the name that a person types: TOPIC.FIELD, TOPIC.FIELD[INDEX] or TOPIC.FIELD[NAME].

A field that holds several numbers gives a series each: a vector its parts, an array its elements, joint states their
joints, contacts their wheels and those pads that touch the ground. A DiagnosticArray has its keys as fields.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from sojourn_bags.curves import FloatArray
from sojourn_bags.definitions import full_type
from sojourn_bags.description import Run
from sojourn_bags.errors import IncompleteConfigError, UnknownFieldError, UnknownTopicInBagError
from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag
from sojourn_contract.run_table import row_named
from sojourn_contract.switches import fraction_of
from sojourn_contract.topic_types import FieldRule
from sojourn_contract.topics import TOPICS

CONTACTS = "/truth/contacts"
NEAREST = 5
CLOUD = "sensor_msgs/msg/PointCloud2"
JOINT_FIELDS = ("position", "velocity", "effort")
SUFFIX_UNITS = {
    "_rad_s": "rad/s",
    "_m_s": "m/s",
    "_rad": "rad",
    "_wh": "Wh",
    "_deg": "degree",
    "_ns": "ns",
    "_nm": "N m",
    "_kg": "kg",
    "_n": "N",
    "_j": "J",
    "_m": "m",
    "_s": "s",
}
"""What the end of a status key says of its unit; longer ends first."""
_SELECTED = re.compile(r"(?P<path>.+?)\[(?P<which>[^\[\]]*)\]")


@dataclass(frozen=True)
class Series:
    """One number over time.

    Args:
        name: as a person would type it. unit: SI, "" where it has none or none is declared.
        times: stamps, shape (n,) [s]. values: shape (n,).
    """

    name: str
    unit: str
    times: FloatArray
    values: FloatArray


def series(bag: Bag, text: str) -> list[Series]:
    """Series of a field. Raises UnknownFieldError, with the nearest names that there are."""
    topic, _, path = text.partition(".")
    if topic not in bag:
        raise UnknownFieldError(topic, "is not in the bag", _nearest(topic, sorted(bag.topics)))
    messages = bag[topic]
    if not path:
        typed = [f"{topic}.{name}" for name in names(bag, messages)]
        raise UnknownFieldError(topic, "needs a field after a dot", typed[:NEAREST])
    parts = _parts(bag, messages, path)
    if not parts:
        typed = [f"{topic}.{name}" for name in names(bag, messages)]
        raise UnknownFieldError(text, "is not in the bag", _nearest(text, typed))
    stamps = _stamps(messages)
    found = []
    for name, values in parts:
        known = np.isfinite(values) if messages.type in _SPARSE else np.ones(len(values), dtype=bool)
        found.append(Series(f"{topic}.{name}", unit_of(messages, name), stamps[known], values[known]))
    return found


def unit_of(messages: Messages, path: str) -> str:
    """Unit of a field: as the contract declares it for the topic, or for another topic of the same type."""
    bare = path.partition("[")[0]
    if bare.endswith("stamp.sec") or bare == "clock.sec":
        return "s"
    if bare.endswith("nanosec"):
        return "ns"
    named = row_named(messages.topic)
    alike = (row for row in TOPICS if messages.type not in _SPARSE and full_type(row.type) == messages.type)
    rows = [named] if named is not None else list(alike)
    for row in rows:
        for rule in row.fields:
            if _covers(rule, bare):
                return _plain(rule.unit)
    if messages.type in _SPARSE:
        if messages.topic == "/truth/loads":
            return UNITS_OF_LOADS.get(bare.partition(" ")[0], "")
        return next((unit for end, unit in SUFFIX_UNITS.items() if bare.endswith(end)), "")
    return ""


UNITS_OF_LOADS = {"power": "W", "source": "W", "energy": "J", "network": "J", "temperature": "K", "winding": "K"}
"""By the first word of a key of /truth/loads."""
_SPARSE = frozenset({"diagnostic_msgs/msg/DiagnosticArray"})
"""Types whose messages may lack a field: it is drawn where it is there."""


def _parts(bag: Bag, messages: Messages, path: str) -> list[tuple[str, FloatArray]]:
    """Name below the topic and values, for each number that the path names."""
    columns = _columns(bag, messages, path)
    if columns is not None:
        return _touched(columns) if messages.type == CLOUD else columns
    chosen = _SELECTED.fullmatch(path)
    if chosen is None:
        return []
    columns = _columns(bag, messages, chosen["path"])
    if not columns:
        return []
    which = chosen["which"]
    labels = [name.removeprefix(chosen["path"]).strip("[]") for name, _ in columns]
    if which in labels:
        return [columns[labels.index(which)]]
    if which.isdigit() and int(which) < len(columns):
        return [columns[int(which)]]
    there = [name for name, _ in columns]
    raise UnknownFieldError(f"{messages.topic}.{path}", "is not in the bag", _nearest(path, there) or there[:NEAREST])


def _touched(columns: list[tuple[str, FloatArray]]) -> list[tuple[str, FloatArray]]:
    """Points of a cloud without those that are zero throughout, as pads that never touch the ground, if any are not."""
    return [column for column in columns if np.nan_to_num(column[1]).any()] or columns


def _columns(bag: Bag, messages: Messages, path: str) -> list[tuple[str, FloatArray]] | None:
    """Columns of a path without a choice at its end, None if there is no such path."""
    kinds: Mapping[str, Callable[[Bag, Messages, str], list[tuple[str, FloatArray]] | None]] = {
        "sensor_msgs/msg/JointState": _of_joints,
        "sensor_msgs/msg/PointCloud2": _of_points,
        "diagnostic_msgs/msg/DiagnosticArray": _of_status,
    }
    special = kinds.get(messages.type)
    found = special(bag, messages, path) if special else None
    return found if found is not None else _of_message(messages, path)


def _of_joints(_: Bag, messages: Messages, path: str) -> list[tuple[str, FloatArray]] | None:
    if path not in JOINT_FIELDS:
        return None
    joints = messages.joints()
    values: FloatArray = getattr(joints, path)
    return [(f"{path}[{name}]", values[:, column]) for column, name in enumerate(joints.names)
            if np.isfinite(values[:, column]).any()]  # fmt: skip


def _of_points(bag: Bag, messages: Messages, path: str) -> list[tuple[str, FloatArray]] | None:
    points = messages.points()
    if path not in points:
        return None
    labels = _contact_names(bag) if messages.topic == CONTACTS else []
    width = points[path].shape[1]
    labels += [str(number) for number in range(len(labels), width)]
    return [(f"{path}[{labels[column]}]", points[path][:, column]) for column in range(width)]


def _of_status(_: Bag, messages: Messages, path: str) -> list[tuple[str, FloatArray]] | None:
    """A key of the statuses; one series for each name that a status has, as the nodes on /diagnostics."""
    found: dict[str, FloatArray] = {}
    texts: dict[str, None] = {}
    for index in range(len(messages)):
        for status in messages.decode(index).status:
            for pair in status.values:
                if pair.key != path:
                    continue
                value = _number(pair.value)
                if value is None:
                    texts[pair.value] = None
                    continue
                found.setdefault(status.name, np.full(len(messages), np.nan))[index] = value
    if not found and texts:
        what = ", ".join(repr(text) for text in list(texts)[:3])
        raise UnknownFieldError(f"{messages.topic}.{path}", f"holds texts ({what}) and no numbers", [])
    if not found:
        return None
    return [(path if len(found) == 1 else f"{path}[{name}]", values) for name, values in found.items()]


def _of_message(messages: Messages, path: str) -> list[tuple[str, FloatArray]] | None:
    alike = [name for name in _known_fields(messages) if name == path or name.startswith((path + ".", path + "["))]
    found = []
    for name in alike:
        values = messages.column(name)
        if values.ndim == 1:
            found.append((name, values))
        else:
            found += [(f"{name}[{column}]", values[:, column]) for column in range(values.shape[1])]
    return found or None


def _known_fields(messages: Messages) -> list[str]:
    try:
        return messages.fields()
    except KeyError as error:
        text = f"{messages.type}, a type that is not known and that the bag does not define"
        raise UnknownFieldError(messages.topic, f"cannot be drawn: it is a {text}", []) from error


def names(bag: Bag, messages: Messages) -> list[str]:
    """Names of fields of a topic that can be typed, most telling first."""
    if messages.type == "sensor_msgs/msg/JointState":
        joints = messages.joints()
        return [*JOINT_FIELDS, *(f"{field}[{name}]" for field in JOINT_FIELDS for name in joints.names)]
    if messages.type == "sensor_msgs/msg/PointCloud2":
        labels = _contact_names(bag) if messages.topic == CONTACTS else []
        fields = list(messages.points())
        return [*fields, *(f"{field}[{name}]" for field in fields for name in labels)]
    if messages.type in _SPARSE:
        keys: dict[str, None] = {}
        for index in range(len(messages)):
            keys.update(dict.fromkeys(pair.key for status in messages.decode(index).status for pair in status.values))
        return list(keys)
    return [name for name in _known_fields(messages) if not name.startswith("header.")] or _known_fields(messages)


def _nearest(name: str, known: Sequence[str]) -> list[str]:
    """Names that look like it: by spelling, or with the same last word."""
    close = get_close_matches(name, known, NEAREST, 0.6)
    word = name.rpartition("/")[2].rpartition(".")[2].partition("[")[0].lower()
    alike = [other for other in known if word and word in other.lower() and other not in close]
    return ([*close, *alike] or get_close_matches(name, known, NEAREST, 0.0))[:NEAREST]


def _contact_names(bag: Bag) -> list[str]:
    try:
        machine = Run.of_bag(bag).machine
    except IncompleteConfigError:
        return []
    return [support.name for support in machine.supports]


def _stamps(messages: Messages) -> FloatArray:
    """Stamps of the headers; times of recording where there is no header, or none is stamped."""
    try:
        stamps = messages.times
    except UnknownTopicInBagError:
        stamps = np.zeros(0)
    return stamps if np.any(stamps) else np.array(messages.log_times) / 1e9


def _number(text: str) -> float | None:
    """Number of a status text; switches and flags are 1 and 0."""
    if text in ("true", "false"):
        return float(text == "true")
    try:
        return float(text)
    except ValueError:
        return fraction_of(text)


def _covers(rule: FieldRule, path: str) -> bool:
    """Whether a rule is about a field; a cloud's rule may name several."""
    return any(path == part or path.startswith((part + ".", part + "[")) for part in rule.path.split())


def _plain(unit: str) -> str:
    """Unit without the words beside it; "1" is none."""
    plain = unit.partition(",")[0]
    return "" if plain == "1" else plain
