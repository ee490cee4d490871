"""What the system tests read of a bag: every message with all of its fields, in the order of the file."""

import dataclasses
import struct
from pathlib import Path
from typing import Any

import numpy as np
from mcap.reader import make_reader

from sojourn_bags.definitions import typestore

Record = tuple[str, int, Any]


def records(run_dir: Path) -> list[Record]:
    """(topic, log time [ns], values of all fields) of every message of a run's bag, in the order of the file."""
    (file,) = (run_dir / "bag").glob("*.mcap")
    store, found = typestore(), []
    with file.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
            decoded = store.deserialize_cdr(message.data, schema.name)
            found.append((channel.topic, message.log_time, values(decoded)))
    return found


def values(part: Any) -> Any:
    """A message as tuples that compare exactly: floats by their bits, so that NaN equals NaN and 0.0 is not -0.0."""
    if dataclasses.is_dataclass(part):
        return tuple((field.name, values(getattr(part, field.name))) for field in dataclasses.fields(part))
    if isinstance(part, np.ndarray):
        return (str(part.dtype), part.shape, part.tobytes())
    if isinstance(part, float):
        return struct.pack("<d", part)
    if isinstance(part, list | tuple):
        return tuple(values(item) for item in part)
    return part


def first_difference(one: list[Record], other: list[Record]) -> str:
    """The first message that is not the same, in words; "" where all are."""
    for number, (left, right) in enumerate(zip(one, other, strict=False)):
        if left != right:
            return f"message {number}:\n{left}\n{right}"
    return "" if len(one) == len(other) else f"{len(one)} and {len(other)} messages"
