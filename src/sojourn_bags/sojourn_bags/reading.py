"""Reads a bag, whole or cut off by a crash, into numpy arrays.

bag = read_bag(path)
bag["/truth/odom"].column("pose.pose.position.x")      # shape (n,)
bag["/truth/joint_states"].joints().velocity           # shape (n, joints)
bag["/truth/contacts"].points()["sinkage"]             # shape (n, points)
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from mcap.records import Attachment, Channel, Message, Metadata, Schema

from sojourn_bags.completeness import RECORD, miscounted
from sojourn_bags.condensed import BATCH, CondensedMessages, Keep
from sojourn_bags.definitions import CONFIGURATION_NAME, RECOVERY_RECORD, THINNED_RECORD, learn, typestore
from sojourn_bags.errors import UnknownTopicInBagError
from sojourn_bags.messages import Messages
from sojourn_bags.parts import BagSalvage, parts_of
from sojourn_contract.run_table import row_named

FOREIGN_CLOCK_S = 60.0
"""A stamp this far from the period in which it was written is another clock's [s]."""


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
        index: f"stamped {messages.times[index]:.3f} s, and written at {messages.log_times[index] / 1e9:.3f} s"
        for index in np.flatnonzero(~(np.abs(apart) <= FOREIGN_CLOCK_S)).tolist()
    }


def bag_file(path: Path) -> Path:
    """The first MCAP file of a bag: itself, one in its folder, or in a run's folder `bag`; its attachments are in it.

    Raises UnreadableBagError if there is none, or several that are not one bag.
    """
    return parts_of(path)[0]


def read_bag(path: Path | str, keep: Keep | None = None) -> Bag:
    """Read a bag into memory, as far as it is whole.

    Args:
        path: of the bag, its folder, or its run's. keep: what to keep of a topic's messages where all of them might be
            too many: the bag is read by pieces then, and its topics that are not kept whole answer for that alone.

    Raises:
        UnreadableBagError: it is no ROS 2 bag. UnknownTopicInBagError: a topic does not have what is to be kept of it.
    """
    parts = parts_of(Path(path))
    bag = Bag(parts[0], parts=parts)
    schemas: dict[int, str] = {}
    channels: dict[int, Messages] = {}
    pieces = _Pieces(bag, keep)
    place = 0
    salvage = BagSalvage(parts)
    for record in salvage.records:
        if isinstance(record, Message):
            messages = channels[record.channel_id]
            messages.log_times.append(record.log_time)
            messages.data.append(record.data)
            messages.places.append(place)
            place += 1
            if len(messages.data) == BATCH:
                pieces.condense(messages)
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
        bag.misfit = miscounted(bag.records.get(RECORD, {}), pieces.counts(), THINNED_RECORD in bag.records)
        bag.whole = not bag.misfit
    pieces.finish()
    return bag


def read_beginning(path: Path) -> Bag:
    """What stands before the first message of a bag: how the run was configured. Raises UnreadableBagError."""
    parts = parts_of(path)
    bag = Bag(parts[0], parts=parts)
    for record in BagSalvage(parts).records:
        if isinstance(record, Attachment):
            bag.attachments[record.name] = record.data
        elif isinstance(record, Message):
            break
    return bag


class _Pieces:
    """Takes from the messages of a bag what is no message, and of topics that are condensed what is kept."""

    def __init__(self, bag: Bag, keep: Keep | None) -> None:
        self._bag = bag
        self._keep: Keep = keep or (lambda topic: None)
        self._read: dict[str, int] = {}
        self._condensed: dict[str, CondensedMessages] = {}

    def counts(self) -> dict[str, int]:
        """Messages read so far, by topic."""
        return {name: self._read.get(name, 0) + len(messages) for name, messages in self._bag.topics.items()}

    def condense(self, messages: Messages) -> None:
        """Take what is kept, where not all is."""
        kept = self._keep(messages.topic)
        if kept is None:
            return
        self._read[messages.topic] = self._read.get(messages.topic, 0) + len(messages)
        self._sift(messages)
        if messages.data:
            self._condensed.setdefault(messages.topic, CondensedMessages(messages, kept)).take(messages)

    def finish(self) -> None:
        """The rest of all topics; those of which no message is left are taken out."""
        for messages in self._bag.topics.values():
            self.condense(messages)
            self._sift(messages)
        topics = {**self._bag.topics, **self._condensed}
        self._bag.topics = {name: topics[name] for name in self._bag.topics if len(topics[name])}

    def _sift(self, messages: Messages) -> None:
        """Set aside what is no message of the topic. A bag of ours is known by what stands before its messages."""
        bag = self._bag
        bag.set_aside(messages, messages.unreadable())
        if CONFIGURATION_NAME in bag.attachments:
            bag.set_aside(messages, stamped_elsewhere(messages))
