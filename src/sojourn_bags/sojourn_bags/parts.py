"""The files of a bag, and their records as if they were in one.

A recorder goes on in the next file once one has become large, `NAME_0.mcap`, `NAME_1.mcap` and so on (as rosbag2 does).
Each file numbers its schemas and channels for itself: here a channel of the same topic, schema and settings keeps its
number.
"""

import re
from collections.abc import Container, Hashable, Iterator
from dataclasses import replace
from io import SEEK_END
from pathlib import Path

from mcap.records import Channel, Header, McapRecord, Message, Metadata, Schema

from sojourn_bags.errors import UnreadableBagError
from sojourn_bags.part_ties import PART_RECORD, PartTies
from sojourn_bags.salvage import MAGIC, Salvage

_NUMBERED = re.compile(r"(.*)_(\d+)\.mcap")


def parts_of(path: Path) -> tuple[Path, ...]:
    """The MCAP files of a bag in their order: of one that is a file itself, of its folder, or of a run's folder `bag`.

    Raises UnreadableBagError if there is none, or several that are not one bag.
    """
    if path.is_file():
        return (path,)
    for folder in (path, path / "bag"):
        files = sorted(folder.glob("*.mcap"))
        if len(files) == 1:
            return (files[0],)
        if files:
            return _in_order(path, files)
    raise UnreadableBagError(path, "there is no such file or folder, or no MCAP file in it")


def is_finished(path: Path) -> bool:
    """Whether nothing more comes to a bag: its last file has an end. What cannot be read is not finished."""
    try:
        with parts_of(path)[-1].open("rb") as stream:
            stream.seek(-len(MAGIC), SEEK_END)
            return stream.read() == MAGIC
    except (UnreadableBagError, OSError):
        return False


def _in_order(path: Path, files: list[Path]) -> tuple[Path, ...]:
    named = [_NUMBERED.fullmatch(file.name) for file in files]
    numbered = {int(name[2]): file for name, file in zip(named, files, strict=True) if name is not None}
    one_bag = len({name[1] if name else "" for name in named}) == 1 and len(numbered) == len(files)
    if not one_bag:
        raise UnreadableBagError(path, f"there are {len(files)} MCAP files in {files[0].parent}: name one")
    missing = next((number for number in range(len(files)) if number not in numbered), None)
    if missing is not None:
        raise UnreadableBagError(path, f"its part {missing} of at least {max(numbered) + 1} is missing")
    return tuple(numbered[number] for number in range(len(files)))


class BagSalvage:
    """One reading of all files of a bag, as `Salvage` of one. Iterate over `records` first; then the rest is known.

    Args:
        parts: MCAP files in their order. topics: as of `Salvage`; where it is not all of them, whether files fit is not
            looked at.

    Attributes:
        whole, all_messages, damage, at: as of `Salvage`; of several files the damage names its own, bytes are counted
            from the beginning of the first. Files that are not one bag are damage, too.
        misfit: which file is not where it belongs, and why, in words; "" where nothing before it is damaged.
    """

    def __init__(self, parts: tuple[Path, ...], topics: Container[str] | None = None) -> None:
        self.parts, self.topics = parts, topics
        self.whole = self.all_messages = False
        self.damage = self.misfit = ""
        self.at = 0

    @property
    def records(self) -> Iterator[McapRecord]:
        """As of `Salvage`, without what a file says of its place. Raises UnreadableBagError where the first file is
        none of ROS 2.
        """
        alone = len(self.parts) == 1
        numbers, ties, before = _RecordNumbers(), PartTies(alone), 0
        self.whole = self.all_messages = True
        for part in self.parts:
            salvage = Salvage(part, self.topics)
            ties.begin(part)
            try:
                yield from _fitting(salvage.records if alone else numbers.anew(salvage.records), ties)
                damage, at = salvage.damage, salvage.at
            except UnreadableBagError as error:
                if part == self.parts[0]:
                    raise
                damage, at = error.reason, 0
            self.whole &= salvage.whole
            self.all_messages &= salvage.all_messages
            if not damage:
                ties.end()
            self._note(damage if alone or not damage else f"{part.name}: {damage}", before + at)
            self._note_misfit(ties, before)
            before += part.stat().st_size
        ties.finish()
        self._note_misfit(ties, before)

    def _note(self, damage: str, at: int) -> None:
        if damage and not self.damage:
            self.damage, self.at = damage, at

    def _note_misfit(self, ties: PartTies, at: int) -> None:
        """Where nothing is damaged: behind damage no file goes on from the one before it."""
        if ties.broken and not self.damage and self.topics is None:
            self.misfit = ties.broken
            self.whole = self.all_messages = False
            self._note(self.misfit, at)


def _fitting(records: Iterator[McapRecord], ties: PartTies) -> Iterator[McapRecord]:
    """The records of a file, all but what it says of its place, by which it is looked at."""
    topics: dict[int, str] = {}
    for record in records:
        if isinstance(record, Message):
            ties.message(topics[record.channel_id], record.sequence)
        elif isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Header):
            ties.header(record.library)
        elif isinstance(record, Metadata) and record.name == PART_RECORD:
            ties.record(record.metadata)
            continue
        yield record


class _RecordNumbers:
    """Numbers of schemas and channels over all files."""

    def __init__(self) -> None:
        self._schemas: dict[Hashable, int] = {}
        self._channels: dict[Hashable, int] = {}

    def anew(self, records: Iterator[McapRecord]) -> Iterator[McapRecord]:
        """The records of one file with the numbers of the bag."""
        schemas, channels = {0: 0}, dict[int, int]()
        for record in records:
            if isinstance(record, Message):
                record.channel_id = channels[record.channel_id]
            elif isinstance(record, Schema):
                known: Hashable = record.name, record.encoding, record.data
                schemas[record.id] = self._schemas.setdefault(known, len(self._schemas) + 1)
                record = replace(record, id=schemas[record.id])
            elif isinstance(record, Channel):
                schema = schemas.get(record.schema_id, 0)
                known = record.topic, schema, record.message_encoding, tuple(sorted(record.metadata.items()))
                channels[record.id] = self._channels.setdefault(known, len(self._channels) + 1)
                record = replace(record, id=channels[record.id], schema_id=schema)
            yield record


def counts_in(path: Path) -> dict[str, int]:
    """Whole messages in a bag, by topic. Raises UnreadableBagError."""
    topics: dict[int, str] = {}
    counts: dict[str, int] = {}
    for record in BagSalvage(parts_of(path)).records:
        if isinstance(record, Channel):
            topics[record.id] = record.topic
        elif isinstance(record, Message):
            name = topics[record.channel_id]
            counts[name] = counts.get(name, 0) + 1
    return counts
