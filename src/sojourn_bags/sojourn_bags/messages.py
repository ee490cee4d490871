"""Messages of one topic of a bag, read field by field into numpy arrays."""

from collections.abc import Collection, MutableSequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.definitions import deserialized
from sojourn_bags.errors import UnknownTopicInBagError, UnreadableMessageError
from sojourn_bags.layout import MessageLayout, layout_of

FloatArray = NDArray[np.float64]
CLOUD = "sensor_msgs/msg/PointCloud2"
_POINT_CODES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""Types of a sensor_msgs/PointField."""


@dataclass(frozen=True)
class JointHistory:
    """Joint states of a run.

    Attributes:
        names: every joint that occurs. position, velocity, effort: shape (n, len(names)) [rad, rad/s, N m];
            NaN where a message does not hold the joint or the field.
    """

    names: tuple[str, ...]
    position: FloatArray
    velocity: FloatArray
    effort: FloatArray

    def index(self, name: str) -> int:
        """Column of a joint. Raises UnknownTopicInBagError."""
        if name not in self.names:
            raise UnknownTopicInBagError(f"joint {name}", list(self.names))
        return self.names.index(name)


@dataclass(frozen=True)
class LayoutGroup:
    """Messages of one layout: their indices in the topic, and their bytes, one message a row."""

    indices: NDArray[np.int64]
    rows: NDArray[np.uint8]
    layout: MessageLayout

    def split(self, begin: int, end: int) -> list["LayoutGroup"]:
        """Split by the bytes in [begin, end), which are text and so without padding that varies."""
        keys: dict[bytes, list[int]] = {}
        for number, key in enumerate(np.ascontiguousarray(self.rows[:, begin:end])):
            keys.setdefault(key.tobytes(), []).append(number)
        if len(keys) == 1:
            return [self]
        return [LayoutGroup(self.indices[chosen], self.rows[chosen], self.layout) for chosen in keys.values()]

    def unusable(self) -> dict[int, str]:
        """Rows that cannot be decoded, or whose points are not where their fields say, and why."""
        found = {int(row): "it has no CDR header" for row in np.flatnonzero(self.rows[:, 0])}
        for path, text in self.layout.texts.items():
            column = self.rows[:, text.offset : text.offset + text.length]
            for row in np.flatnonzero(self.rows[:, text.offset + text.length]):
                found[int(row)] = f"{path} has no closing zero"
            for row in np.flatnonzero((column >= 0x80).any(axis=1)):
                try:
                    column[row].tobytes().decode()
                except UnicodeDecodeError as error:
                    found[int(row)] = f"{path}: {error}"
        if self.layout.type == CLOUD:
            found |= self._unusable_clouds()
        sample = next((row for row in range(len(self.rows)) if row not in found), None)
        if sample is not None:
            try:
                deserialized(self.layout.type, self.rows[sample].tobytes())
            except UnreadableMessageError as error:  # the others are laid out alike
                found |= dict.fromkeys(range(len(self.rows)), str(error))
        return found

    def _unusable_clouds(self) -> dict[int, str]:
        """Clouds of one length have their points in the same places: those that say otherwise, and all without any."""
        paths = [path for path in self.layout.numbers if path.startswith(("height", "width", "fields", "point_step"))]
        told = np.stack([self.layout.column(self.rows, path) for path in [*paths, "is_bigendian"]], axis=1)
        _, which, counts = np.unique(told, axis=0, return_inverse=True, return_counts=True)
        usual = np.flatnonzero(which.ravel() == int(counts.argmax()))
        found = {
            row: "its fields are not those of the others" for row in set(range(len(self.rows))) - {*usual.tolist()}
        }
        try:
            points_of(LayoutGroup(self.indices[usual], self.rows[usual], self.layout))
        except (ValueError, KeyError, TypeError, IndexError) as error:
            found |= {row: f"its points cannot be found ({error})" for row in usual.tolist()}
        return found

    def text(self, path: str) -> str:
        """A text of the group's first message."""
        text = self.layout.texts[path]
        return self.rows[0, text.offset : text.offset + text.length].tobytes().decode(errors="replace")


@dataclass
class Messages:
    """Messages of one topic, in the order of the file.

    Attributes:
        topic: name. type: "package/msg/Name". log_times: [ns]. data: CDR of each. places: number of each
            in the file, over all topics; empty where the messages are from elsewhere.
        offered_qos: profiles of its publishers, YAML text as rosbag2 writes it.
    """

    topic: str
    type: str
    log_times: MutableSequence[int] = field(default_factory=list)
    data: list[bytes] = field(default_factory=list)
    places: list[int] = field(default_factory=list)
    offered_qos: str = ""

    def __len__(self) -> int:
        return len(self.data)

    @cached_property
    def times(self) -> FloatArray:
        """Header stamps, shape (n,) [s]."""
        prefix = "clock" if self.type == "rosgraph_msgs/msg/Clock" else "header.stamp"
        prefix = "stamp" if self.type == "std_msgs/msg/Header" else prefix
        return self.column(f"{prefix}.sec") + 1e-9 * self.column(f"{prefix}.nanosec")

    @cached_property
    def groups(self) -> list[LayoutGroup]:
        """The messages by layout; most topics have one. Raises ValueError for one that cannot be read."""
        return self._grouped(None)

    def unreadable(self) -> dict[int, str]:
        """Messages that are none of their type, by index: what is wrong with each. A type that is not known is left
        alone.
        """
        unreadable: dict[int, str] = {}
        with suppress(KeyError):
            groups = self._grouped(unreadable)
            for group in groups:
                unreadable |= {int(group.indices[row]): what for row, what in group.unusable().items()}
            if not unreadable:
                self.__dict__["groups"] = groups
        return unreadable

    def take_out(self, indices: Collection[int]) -> None:
        """Remove messages."""
        if not indices:
            return
        kept = [index for index in range(len(self.data)) if index not in indices]
        self.log_times = [self.log_times[index] for index in kept]
        self.data = [self.data[index] for index in kept]
        self.places = [self.places[index] for index in kept] if self.places else []
        for name in ("groups", "times"):
            self.__dict__.pop(name, None)

    def clear(self) -> None:
        """Remove all messages."""
        self.take_out(range(len(self.data)))

    def _grouped(self, unreadable: dict[int, str] | None) -> list[LayoutGroup]:
        sizes = np.array([len(message) for message in self.data], dtype=np.int64)
        left = np.arange(len(self.data), dtype=np.int64)
        found = []
        while left.size:
            try:
                layout = layout_of(self.type, self.data[int(left[0])])
            except ValueError as error:
                if unreadable is None:
                    raise
                unreadable[int(left[0])] = str(error)
                left = left[1:]
                continue
            alike = left[sizes[left] == sizes[left[0]]]
            joined = b"".join(self.data[index] for index in alike)
            rows = np.frombuffer(joined, dtype=np.uint8).reshape(len(alike), -1)
            structure = layout.structure()
            same = (rows[:, structure] == rows[0, structure]).all(axis=1)
            found.append(LayoutGroup(alike[same], rows[same], layout))
            left = np.setdiff1d(left, alike[same], assume_unique=True)
        return found

    def fields(self) -> list[str]:
        """Paths of all numbers that occur."""
        return list(dict.fromkeys(path for group in self.groups for path in group.layout.numbers))

    def column(self, path: str) -> FloatArray:
        """A field of every message: shape (n,), or (n, k) for an array; NaN where a message does not have it.

        Raises UnknownTopicInBagError if none has it.
        """
        parts = [
            (group, group.layout.column(group.rows, path)) for group in self.groups if path in group.layout.numbers
        ]
        if not parts:
            raise UnknownTopicInBagError(f"{self.topic}.{path}", self.fields())
        width = max((values.shape[1] for _, values in parts if values.ndim == 2), default=None)
        column = np.full((len(self.data),) if width is None else (len(self.data), width), np.nan)
        for group, values in parts:
            if values.ndim == 2:
                column[group.indices, : values.shape[1]] = values
            else:
                column[group.indices] = values
        return column

    def columns(self, *paths: str) -> FloatArray:
        """Several single numbers side by side: shape (n, len(paths))."""
        return np.stack([self.column(path) for path in paths], axis=1)

    def joints(self) -> JointHistory:
        """A JointState topic, by joint. Raises UnknownTopicInBagError if it is another type."""
        if self.type != "sensor_msgs/msg/JointState":
            raise UnknownTopicInBagError(f"a joint state on {self.topic}", [self.type])
        groups = [
            part
            for group in self.groups
            for part in group.split(group.layout.parts["name"], group.layout.parts["position"])
        ]
        named = [[group.text(path) for path in group.layout.texts if path.startswith("name[")] for group in groups]
        names = tuple(dict.fromkeys(name for group_names in named for name in group_names))
        arrays = {key: np.full((len(self.data), len(names)), np.nan) for key in ("position", "velocity", "effort")}
        for group, group_names in zip(groups, named, strict=True):
            targets = np.array([names.index(name) for name in group_names], dtype=np.int64)
            for key, array in arrays.items():
                values = group.layout.column(group.rows, key)
                if values.shape[1] == len(targets):
                    array[np.ix_(group.indices, targets)] = values
        return JointHistory(names, **arrays)

    def points(self) -> dict[str, FloatArray]:
        """A PointCloud2 topic by its point fields: each (n, most points), NaN where a cloud has fewer."""
        if self.type != CLOUD:
            raise UnknownTopicInBagError(f"a point cloud on {self.topic}", [self.type])
        found: dict[str, FloatArray] = {}
        parts = [(group, points_of(group)) for group in self.groups]
        most = max((values.shape[1] for _, fields in parts for values in fields.values()), default=0)
        for group, fields in parts:
            for name, values in fields.items():
                array = found.setdefault(name, np.full((len(self.data), most), np.nan))
                array[np.ix_(group.indices, np.arange(values.shape[1]))] = values
        return found

    def decode(self, index: int) -> Any:
        """One message as an object of the type store. Raises UnreadableMessageError."""
        return deserialized(self.type, self.data[index])

    def statuses(self) -> list[dict[str, str]]:
        """Keys and values of the first status of each DiagnosticArray, with its `name` and `message`.

        Raises UnknownTopicInBagError if it is another type.
        """
        if self.type != "diagnostic_msgs/msg/DiagnosticArray":
            raise UnknownTopicInBagError(f"a status on {self.topic}", [self.type])
        found = []
        for index in range(len(self.data)):
            status = self.decode(index).status
            values = {pair.key: pair.value for pair in status[0].values} if status else {}
            found.append({"name": status[0].name, "message": status[0].message, **values} if status else {})
        return found


def points_of(group: LayoutGroup) -> dict[str, NDArray]:
    """Points of PointCloud2 messages by their fields: each (messages, points), in its own number type."""
    layout = group.layout

    def first(path: str) -> int:
        return int(layout.column(group.rows[:1], path)[0])

    step, count = first("point_step"), first("width") * first("height")
    order = ">" if first("is_bigendian") else "<"
    raw = layout.column(group.rows, "data")[:, : step * count].reshape(len(group.indices), count, step)
    found = {}
    for path in (path for path in layout.texts if path.endswith("].name")):
        prefix = path.removesuffix("name")
        dtype = np.dtype(order + _POINT_CODES[first(prefix + "datatype")])
        offset = first(prefix + "offset")
        values = np.ascontiguousarray(raw[:, :, offset : offset + dtype.itemsize]).view(dtype)
        found[group.text(path)] = values[:, :, 0]
    return found
