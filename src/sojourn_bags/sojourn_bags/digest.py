"""A bag as text that a person can read and git can compare: one line a topic and field.

Each line tells first and last value, extremes and mean to six digits, and a short hash of all values in full, so
that no change is too small to be seen. Where every value is the same, that value stands alone.
"""

import hashlib
import json
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.comparison_match import stamps_of
from sojourn_bags.comparison_result import at
from sojourn_bags.definitions import CONFIGURATION_NAME
from sojourn_bags.messages import Messages
from sojourn_bags.provenance import VERSIONS_NAME
from sojourn_bags.reading import Bag
from sojourn_contract.flow import place_of

_STATUSES = "diagnostic_msgs/msg/DiagnosticArray"
_JOINTS = "sensor_msgs/msg/JointState"
_CLOUD = "sensor_msgs/msg/PointCloud2"
_HASH_DIGITS = 8


def digest(bag: Bag) -> str:
    """The whole bag."""
    lines = [*_provenance(bag)]
    for name in sorted(bag.topics, key=lambda topic: (place_of(topic), topic)):
        messages = bag.topics[name]
        stamps = stamps_of(messages)
        lines += ["", f"{name}: {len(messages)} messages, {at(stamps[0])} to {at(stamps[-1])}"]
        lines += [f"  {line}" for line in _fields(messages)]
    return "\n".join(lines) + "\n"


def _provenance(bag: Bag) -> Iterator[str]:
    """Where the bag is from."""
    document = json.loads(bag.attachments[CONFIGURATION_NAME])
    yield f"scenario {document['name']}"
    for text in document["overrides"]:
        yield f"with {text}"
    for name in document["files"]:
        yield f"file {name} {_hash(bag.attachments[name])}"
    for name, version in json.loads(bag.attachments[VERSIONS_NAME]).items():
        yield f"version {name} {version}"


def _fields(messages: Messages) -> Iterator[str]:
    if messages.type == _STATUSES:
        yield from _status_fields(messages)
        return
    told: dict[str, list[str]] = {}
    for group in messages.groups:
        for path in group.layout.texts:
            told.setdefault(path, []).append(group.text(path))
    for path, texts in told.items():
        if not path.startswith(("name[", "fields[")):
            yield _text_line(path, texts)
    numbers = {path: messages.column(path) for path in messages.fields() if not _is_structure(path)}
    if messages.type == _JOINTS:
        joints = messages.joints()
        for kind in ("position", "velocity", "effort"):
            del numbers[kind]
            columns = getattr(joints, kind)
            numbers |= {f"{kind}[{name}]": columns[:, place] for place, name in enumerate(joints.names)}
    if messages.type == _CLOUD:
        numbers = messages.points()
    for path, values in numbers.items():
        yield _number_line(path, values)


def _status_fields(messages: Messages) -> Iterator[str]:
    """By sender and key: numbers as numbers, texts as how many different ones there are."""
    found: dict[str, list[str]] = {}
    for index in range(len(messages)):
        for status in messages.decode(index).status:
            found.setdefault(f"{status.name}: message", []).append(status.message)
            found.setdefault(f"{status.name}: level", []).append(str(int(status.level)))
            for pair in status.values:
                found.setdefault(f"{status.name}: {pair.key}", []).append(pair.value)
    for path, texts in found.items():
        try:
            yield _number_line(path, np.array([float(text) for text in texts]))
        except ValueError:
            yield _text_line(path, texts)


def _number_line(path: str, values: NDArray[np.float64]) -> str:
    values = np.where(np.isnan(values), np.nan, values)  # one NaN for all
    known = values[np.isfinite(values)]
    if values.size == 0:
        return f"{path} is empty"
    if known.size == 0 or (known.size == values.size and (known == known[0]).all()):
        return f"{path} = {values.flat[0]:.6g} {_hash(values.tobytes())}"
    first, last = values.flat[0], values.flat[-1]
    extremes = f"from {known.min():.6g} to {known.max():.6g}, mean {known.mean():.6g}"
    return f"{path} first {first:.6g}, last {last:.6g}, {extremes} {_hash(values.tobytes())}"


def _text_line(path: str, values: list[str]) -> str:
    different = list(dict.fromkeys(values))
    if len(different) == 1:
        return f"{path} = {different[0]!r}"
    return (
        f"{path} first {values[0]!r}, last {values[-1]!r}, {len(different)} texts {_hash(chr(0).join(values).encode())}"
    )


def _is_structure(path: str) -> bool:
    return path.startswith(("fields[", "header.stamp.", "stamp.", "clock."))


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:_HASH_DIGITS]
