"""A new bag of the records of another: all of them, or some. It is written beside, the old one is only read."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from mcap.records import Attachment, Channel, McapRecord, Message, Metadata, Schema
from mcap.writer import CompressionType, Writer

from sojourn_bags.metadata_file import PartEntry, TopicEntry, bag_information, write_metadata_file
from sojourn_bags.part_ties import OURS

CHUNK = 1 << 20
"""Bytes of content after which a chunk ends."""


class BagCopy:
    """A bag in the making, with numbers of schemas and channels of its own. A context manager, which closes the file
    and writes metadata.yaml where all went well.

    Args:
        file: the new MCAP file. chunk: bytes of content after which a chunk ends; larger ones are packed better.

    Raises:
        OSError: it cannot be written.
    """

    def __init__(self, file: Path, chunk: int = CHUNK) -> None:
        self._file = file
        self._stream = file.open("xb")
        self.writer = Writer(self._stream, chunk_size=chunk, compression=CompressionType.ZSTD)
        self.writer.start(profile="ros2", library=OURS)
        self._counts: dict[str, int] = {}
        self._part = PartEntry(file.name)
        self.channels: dict[int, tuple[int, Channel]] = {}
        self.schemas: dict[int, tuple[int, Schema]] = {0: (0, Schema(0, b"", "", ""))}
        self.texts: dict[str, str] = {}
        self._known: dict[int, Schema] = {}
        """Schemas of the old file: those of which there is a channel are in the new one."""

    def __enter__(self) -> "BagCopy":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_error: object) -> None:
        try:
            if kind is None:
                self._finish()
        finally:
            self._stream.close()

    def take(self, record: McapRecord) -> None:
        """Copy a record."""
        writer = self.writer
        if isinstance(record, Message):
            number = self.channels[record.channel_id][0]
            writer.add_message(number, record.log_time, record.data, record.publish_time, record.sequence)
            self._count(self.channels[record.channel_id][1].topic, record.log_time)
        elif isinstance(record, Schema):
            self._known.setdefault(record.id, record)
        elif isinstance(record, Channel) and record.id not in self.channels:
            schema = self._schema(record.schema_id)
            number = writer.register_channel(record.topic, record.message_encoding, schema, record.metadata)
            self.channels[record.id] = (number, record)
        elif isinstance(record, Attachment):
            writer.add_attachment(record.create_time, record.log_time, record.name, record.media_type, record.data)
        elif isinstance(record, Metadata) and record.name != "rosbag2":  # which holds the counts of the old file
            self.add_metadata(record.name, record.metadata)

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """A metadata record, in the file and for metadata.yaml."""
        self.writer.add_metadata(name, dict(values))
        self.texts[name] = json.dumps(dict(values))

    def _finish(self) -> None:
        information = bag_information([self._part], self._topics(), self.texts)
        text = yaml.safe_dump(information["rosbag2_bagfile_information"], sort_keys=False)
        self.writer.add_metadata("rosbag2", {"serialized_metadata": text})
        self.writer.finish()
        write_metadata_file(self._file.parent, information)

    def _schema(self, number: int) -> int:
        """The new number of a schema; 0, that of none, where the old file does not have it."""
        if number in self._known and number not in self.schemas:
            record = self._known[number]
            new = self.writer.register_schema(record.name, record.encoding, record.data)
            self.schemas[number] = (new, record)
        return self.schemas.get(number, self.schemas[0])[0]

    def _count(self, name: str, log_time: int) -> None:
        self._part.take(log_time)
        self._counts[name] = self._counts.get(name, 0) + 1

    def _topics(self) -> list[TopicEntry]:
        """Entries for metadata.yaml; a topic of several channels is one."""
        entries: dict[str, TopicEntry] = {}
        for _, channel in self.channels.values():
            qos = _qos(channel)
            if channel.topic in entries:
                entries[channel.topic].qos.extend(qos)
                continue
            type_name = self.schemas.get(channel.schema_id, self.schemas[0])[1].name
            hash_text = channel.metadata.get("topic_type_hash", "")
            entries[channel.topic] = TopicEntry(
                channel.topic, type_name, qos, hash_text, self._counts.get(channel.topic, 0)
            )
        return list(entries.values())


def _qos(channel: Channel) -> list[dict[str, Any]]:
    """Offered quality of service of a channel, [] where it says none that can be read."""
    try:
        profiles = yaml.safe_load(channel.metadata.get("offered_qos_profiles", "")) or []
    except yaml.YAMLError:
        return []
    if not isinstance(profiles, list):
        return []
    return [profile for profile in profiles if isinstance(profile, dict)]
