"""Mends a bag that a crash has cut off, and says what is lost.

The new bag holds every whole message of the old one with its times and number, the schemas, channels, attachments and
metadata, and rosbag2's metadata.yaml. The old one is only read. What is certainly lost follows from the last heartbeats
in the bag: by then the nodes had published so many messages of each topic. What came after them nobody can know.
"""

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mcap.records import Channel, Message, Metadata

from sojourn_bags.bag_copy import BagCopy
from sojourn_bags.completeness import HEARTBEATS, RECORD, Completeness, Count, PublishedCounts
from sojourn_bags.definitions import RECOVERY_RECORD
from sojourn_bags.errors import BagExistsError, NothingToRecoverError, UnwritableBagError
from sojourn_bags.metadata_file import METADATA_FILE
from sojourn_bags.parts import BagSalvage, parts_of
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.run_table import row_named
from sojourn_contract.topics import topic


@dataclass
class Findings:
    """What a reading of a damaged bag gives.

    Attributes:
        path: the MCAP file, the first of its `parts`. whole: nothing is damaged. all_messages: the damage is behind the
            last message.
        damage, at: what is wrong, and from which byte of `size`.
        counts: whole messages, by topic. last: newest log time of each topic [ns].
        published: messages sent, by topic, as the last heartbeats say. heartbeat: stamp of the last one [ns], None
            without any. names: metadata records that are there.
    """

    path: Path
    whole: bool = False
    all_messages: bool = False
    damage: str = ""
    at: int = 0
    size: int = 0
    counts: dict[str, int] = field(default_factory=dict)
    first: dict[str, int] = field(default_factory=dict)
    last: dict[str, int] = field(default_factory=dict)
    published: dict[str, int] = field(default_factory=dict)
    heartbeat: int | None = None
    names: set[str] = field(default_factory=set)
    parts: tuple[Path, ...] = ()

    @property
    def total(self) -> int:
        """Messages that can be recovered."""
        return sum(self.counts.values())

    @property
    def lost(self) -> dict[str, int]:
        """Messages that are certainly lost, by topic: published and not there."""
        known = {name: count - self.counts.get(name, 0) for name, count in self.published.items()}
        return {name: count for name, count in known.items() if count > 0 and self._is_recorded(name)}

    def _is_recorded(self, name: str) -> bool:
        """Whether the recorder wrote this topic: not the tick by which it answers the plant."""
        return name in self.counts or _is_logged(name)


def _is_logged(name: str) -> bool:
    row = row_named(name)
    return row is not None and row.logged


def examine(path: Path) -> Findings:
    """Read a bag and find out what is there. Raises UnreadableBagError for what is no bag."""
    parts = parts_of(path)
    found = Findings(parts[0], parts=parts)
    found.size = sum(part.stat().st_size for part in parts)
    salvage = BagSalvage(parts)
    topics: dict[int, str] = {}
    counts = PublishedCounts()
    for record in salvage.records:
        if isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Metadata):
            found.names.add(record.name)
        elif isinstance(record, Message):
            name = topics[record.channel_id]
            found.counts[name] = found.counts.get(name, 0) + 1
            found.first[name] = min(record.log_time, found.first.get(name, record.log_time))
            found.last[name] = max(record.log_time, found.last.get(name, 0))
            if name == HEARTBEATS:
                _hear(record.data, counts, found)
    found.published = counts.totals()
    found.whole, found.all_messages = salvage.whole, salvage.all_messages
    found.damage, found.at = salvage.damage, salvage.at
    return found


def recovered_folder(file: Path) -> Path:
    """Where a mended bag goes if nobody says: beside the bag's folder, or beside a file that stands alone."""
    if (file.parent / METADATA_FILE).exists():
        return file.parent.with_name(file.parent.name + "_recovered")
    return file.with_name(file.stem + "_recovered")


def recover(found: Findings, folder: Path) -> Path:
    """Write what is whole of an examined bag into a new one. Returns its MCAP file.

    Raises:
        NothingToRecoverError: there is no whole message. BagExistsError: there is a bag in the folder.
        UnwritableBagError: it cannot be written; what was written of it is removed.
    """
    if not found.total:
        raise NothingToRecoverError(found.path)
    if folder.exists() and ((folder / METADATA_FILE).exists() or any(folder.glob("*.mcap"))):
        raise BagExistsError(folder)
    made = not folder.exists()
    file = folder / f"{folder.name}_0.mcap"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _write(found, file)
    except OSError as error:
        if made:
            shutil.rmtree(folder, ignore_errors=True)
        else:
            file.unlink(missing_ok=True)
        raise UnwritableBagError(folder, error.strerror or str(error)) from error
    return file


def _hear(data: bytes, counts: PublishedCounts, found: Findings) -> None:
    """Take the counters of a heartbeat; what is none, as other people's diagnostics, is passed over."""
    try:
        heartbeats = read_heartbeats(decode(topic(HEARTBEATS), data))
    except RefusedMessageError:
        return
    for heartbeat in heartbeats:
        counts.hear(heartbeat)
        if heartbeat.published:
            found.heartbeat = max(found.heartbeat or 0, heartbeat.stamp)


def _write(found: Findings, file: Path) -> None:
    with BagCopy(file) as copy:
        for record in BagSalvage(found.parts).records:
            if isinstance(record, Metadata) and record.name == RECORD and not found.all_messages:
                copy.add_metadata(RECORD, _no_longer_complete(record.metadata, found.damage))
            else:
                copy.take(record)
        copy.add_metadata(RECOVERY_RECORD, _recovery_record(found))
        if RECORD not in found.names and found.published:
            copy.add_metadata(RECORD, _account(found).as_record() | {"complete": "false"})


def _recovery_record(found: Findings) -> dict[str, str]:
    return {
        "original": found.path.name,
        "original_bytes": str(found.size),
        "damage": found.damage,
        "damage_at_byte": str(found.at),
        "messages": str(found.total),
        "certainly_lost": json.dumps(found.lost),
        "last_heartbeat_ns": "" if found.heartbeat is None else str(found.heartbeat),
    }


def _no_longer_complete(record: Mapping[str, str], damage: str) -> dict[str, str]:
    """The recorder's account of a bag some of whose messages are not there any more, or not where they were."""
    return {**record, "complete": "false", "gaps": record.get("gaps") or damage}


def _account(found: Findings) -> Completeness:
    """Account of the mended bag, from the heartbeats in it."""
    names = dict.fromkeys([*found.counts, *found.lost])
    counts = {name: Count(found.published.get(name), found.counts.get(name, 0)) for name in names}
    return Completeness(counts)
