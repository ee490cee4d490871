"""Reads a bag, whole or cut off by a crash, into numpy arrays.

bag = read_bag(path)
bag["/truth/odom"].column("pose.pose.position.x")      # shape (n,)
bag["/truth/joint_states"].joints().velocity           # shape (n, joints)
bag["/truth/contacts"].points()["sinkage"]             # shape (n, points)
"""

from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from numpy.typing import NDArray

from sojourn_bags.completeness import RECORD, miscounted
from sojourn_bags.definitions import RECOVERY_RECORD, RUN_RECORD, THINNED_RECORD, deserialized, learn, typestore
from sojourn_bags.errors import UnknownTopicInBagError, UnreadableMessageError
from sojourn_bags.layout import MessageLayout, layout_of
from sojourn_bags.parts import BagSalvage, parts_of
from sojourn_contract.run_table import row_named

FloatArray = NDArray[np.float64]
CLOUD = "sensor_msgs/msg/PointCloud2"
FOREIGN_CLOCK_S = 60.0
"""A stamp this far from the period in which it was written is another clock's [s]."""
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
    log_times: list[int] = field(default_factory=list)
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
        """Keys and values of the first status of each DiagnosticArray, with its `name` and `message`."""
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


@dataclass(frozen=True)
class Unusable:
    """A message that is in the bag and cannot be used: its topic, when it was written [ns], and what is wrong."""

    topic: str
    log_time: int
    reason: str


@dataclass
class Bag:
    """A bag in memory.

    Attributes:
        path: its MCAP file, the first of its `parts`. whole: False if it was cut off, `damage` says how.
        topics: messages by topic. attachments: files inside, by name. records: metadata records, by name.
        unusable: messages that were written as they came, and are no messages of their topic; they are not in `topics`.
        misfit: why this is not what was recorded, though nothing of it is damaged, in words: it is not whole then.
    """

    path: Path
    whole: bool = False
    topics: dict[str, Messages] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    records: dict[str, dict[str, str]] = field(default_factory=dict)
    unusable: list[Unusable] = field(default_factory=list)
    parts: tuple[Path, ...] = ()
    damage: str = ""
    misfit: str = ""

    def __post_init__(self) -> None:
        self.parts = self.parts or (self.path,)

    def set_aside(self, messages: Messages, reasons: Mapping[int, str]) -> None:
        """Take messages out, by index, and keep why."""
        self.unusable += [Unusable(messages.topic, messages.log_times[index], reasons[index]) for index in reasons]
        messages.take_out(reasons.keys())

    def __getitem__(self, topic: str) -> Messages:
        if topic not in self.topics:
            raise UnknownTopicInBagError(topic, sorted(self.topics))
        return self.topics[topic]

    def __contains__(self, topic: str) -> bool:
        return topic in self.topics


def stamped_elsewhere(messages: Messages) -> dict[int, str]:
    """Messages of a periodic topic that no clock of the run has stamped, or that have no stamp that anybody could read.
    Bags of ours are filed by period.
    """
    row = row_named(messages.topic)
    if row is None or row.is_event or not len(messages):
        return {}
    if messages.type not in typestore().fielddefs:  # its schema is damaged
        return dict.fromkeys(range(len(messages)), f"its type is {messages.type!r}, which is not known")
    apart = messages.times - np.array(messages.log_times) * 1e-9
    return {
        int(index): f"stamped {messages.times[index]:.3f} s, and written at {messages.log_times[index] / 1e9:.3f} s"
        for index in np.flatnonzero(~(np.abs(apart) <= FOREIGN_CLOCK_S))
    }


def bag_file(path: Path) -> Path:
    """The first MCAP file of a bag: itself, one in its folder, or in a run's folder `bag`; its attachments are in it.

    Raises UnreadableBagError if there is none, or several that are not one bag.
    """
    return parts_of(path)[0]


def read_bag(path: Path | str) -> Bag:
    """Read a bag into memory, as far as it is whole. Raises UnreadableBagError for what is no ROS 2 bag."""
    parts = parts_of(Path(path))
    bag = Bag(parts[0], parts=parts)
    schemas: dict[int, str] = {}
    channels: dict[int, Messages] = {}
    place = 0
    salvage = BagSalvage(parts)
    for record in salvage.records:
        if isinstance(record, Message):
            messages = channels[record.channel_id]
            messages.log_times.append(record.log_time)
            messages.data.append(record.data)
            messages.places.append(place)
            place += 1
        elif isinstance(record, Schema):
            schemas[record.id] = record.name
            if record.encoding == "ros2msg":
                learn(record.name, record.data.decode(errors="replace"))
        elif isinstance(record, Channel) and record.id not in channels:
            messages = bag.topics.setdefault(record.topic, Messages(record.topic, schemas.get(record.schema_id, "")))
            messages.offered_qos = messages.offered_qos or record.metadata.get("offered_qos_profiles", "")
            channels[record.id] = messages
        elif isinstance(record, Attachment):
            bag.attachments[record.name] = record.data
        elif isinstance(record, Metadata):
            bag.records[record.name] = record.metadata
    bag.whole, bag.damage, bag.misfit = salvage.whole, salvage.damage, salvage.misfit
    if bag.whole and RECOVERY_RECORD not in bag.records:
        counts = {name: len(messages) for name, messages in bag.topics.items()}
        bag.misfit = miscounted(bag.records.get(RECORD, {}), counts, THINNED_RECORD in bag.records)
        bag.whole = not bag.misfit
    for messages in bag.topics.values():
        bag.set_aside(messages, messages.unreadable())
        if RUN_RECORD in bag.records:
            bag.set_aside(messages, stamped_elsewhere(messages))
    bag.topics = {name: messages for name, messages in bag.topics.items() if len(messages)}
    return bag
