"""Writes one bag: a folder with an MCAP file (profile ros2, zstd chunks) and rosbag2's metadata.yaml.

A file that has grown to a given size is finished, and the bag goes on in the next one, which has schemas and channels
of its own, and says which file it goes on from; attachments are in the first, records of the whole run in the last.

The file can be read however the writer ends: twice each second of wall time (in real time three times) the chunk in
progress is finished and handed to the operating system, and metadata.yaml is there from the start. Killed, the bag
lacks what came since, and its summary, and a reader of streams still opens it.
"""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from io import BufferedWriter
from pathlib import Path
from typing import Any

import yaml
from mcap.writer import CompressionType

from sojourn_bags.definitions import ChannelSpec, definition, type_hash
from sojourn_bags.errors import BagExistsError, UnreadableBagError, UnwritableBagError
from sojourn_bags.metadata_file import METADATA_FILE, PartEntry, TopicEntry, bag_information, write_metadata_file
from sojourn_bags.part_ties import OURS, PART_RECORD, follows, goes_on
from sojourn_bags.parts import counts_in
from sojourn_bags.quick_writer import QuickWriter

FLUSH_S = 0.5
"""Wall time after which a chunk is finished [s], so that with what a busy machine adds it stays under a second: with
0.8 a recorder that was killed beside other work had lost 1.2, one of twenty."""
FLUSH_REALTIME_S = 0.3
"""In real time, where a successor goes on at once: a recorder that dies loses this, what it holds for the order of the
file, and the time until the other one listens, which together is to stay under a second."""
LARGEST_PART = 1_000_000_000
"""Bytes of a file after which the bag goes on in the next one, unless it is told otherwise."""
LOOK_AFTER = 1 << 20
"""Bytes of messages between two looks at the size of the file."""


@dataclass(frozen=True)
class Attachment:
    """A file inside the bag."""

    name: str
    media_type: str
    data: bytes


class BagWriter:
    """An open bag.

    Args:
        folder: the bag; made here, and never one that holds a bag already.
        channels: topics, by the index that `write` takes. Only those with a message show in the bag.
        attachments: files to put inside.
        offered: profiles that the publishers of a channel offer, asked at its first message; None for the one
            of the channel.

    Raises:
        BagExistsError: there is a bag in the folder. UnwritableBagError: it cannot be made or written.
    """

    def __init__(
        self,
        folder: Path,
        channels: Sequence[ChannelSpec],
        attachments: Sequence[Attachment] = (),
        offered: Callable[[ChannelSpec], Sequence[dict[str, Any]]] | None = None,
    ) -> None:
        self.folder = folder.absolute()
        self.closed = False
        self.largest_part = LARGEST_PART
        """Bytes of a file after which the bag goes on in the next one."""
        self.flush_s = FLUSH_S
        """Wall time after which the chunk in progress is finished [s]."""
        self._channels = tuple(channels)
        self._offered = [[spec.qos] for spec in self._channels]
        self._ask_offered = offered
        self._ids = [0] * len(self._channels)
        self.counts = [0] * len(self._channels)
        self._parts: list[PartEntry] = []
        """Files, the one that is being written last."""
        self._unseen = 0
        """Bytes of messages since the last look at the size of the file."""
        self._last_flush = time.monotonic()
        self._custom: dict[str, str] = {}
        self._begin_part()
        try:
            for attachment in attachments:
                self._writer.add_attachment(0, 0, attachment.name, attachment.media_type, attachment.data)
            self._writer.flush()
            write_metadata_file(self.folder, self._metadata())
        except OSError as error:
            raise UnwritableBagError(self.folder, str(error)) from error

    @property
    def path(self) -> Path:
        """The file that is being written."""
        return self.folder / self._parts[-1].file

    def write(self, index: int, log_time: int, publish_time: int, data: bytes) -> None:
        """Append one message.

        Args:
            index: channel. log_time: period it belongs to [ns]. publish_time: its header's stamp [ns].
            data: CDR as received.

        Raises:
            UnwritableBagError: the disk does not take it. The bag then stays as after a crash, and later
                messages are dropped.
        """
        if self.closed:
            return
        sequence = self.counts[index]
        if not self._registered[index]:
            self._register(index)
        self.counts[index] = sequence + 1
        self._part.take(log_time)
        try:
            self._writer.add_message(self._ids[index], log_time, data, publish_time, sequence)
            self._unseen += len(data)
            if self._unseen > LOOK_AFTER:
                self._look_at_size()
        except OSError as error:
            raise self._failure(error) from error

    def flush_if_due(self) -> None:
        """Finish the chunk once it is `flush_s` old; call it some times as often."""
        now = time.monotonic()
        if now - self._last_flush >= self.flush_s:
            self._last_flush = now
            if not self.closed and not self.path.exists():
                self.closed = True
                raise UnwritableBagError(self.folder, f"{self.path.name} has been removed")
            self.flush()

    def flush(self) -> None:
        """Hand everything written so far to the operating system. Raises UnwritableBagError."""
        if self.closed:
            return
        try:
            self._writer.flush()
        except OSError as error:
            raise self._failure(error) from error

    def close(self, records: Mapping[str, Mapping[str, str]] | None = None) -> None:
        """Write the last chunk, metadata records and summary, and metadata.yaml. Raises UnwritableBagError.

        Args:
            records: MCAP metadata records by name; in metadata.yaml they are custom data, as JSON text.
        """
        if self.closed:
            return
        self.closed = True
        records = records or {}
        self._custom = {name: json.dumps(dict(values)) for name, values in records.items()}
        metadata = self._metadata()
        text = yaml.safe_dump(metadata["rosbag2_bagfile_information"], sort_keys=False)
        try:
            self._writer.flush()
            for name, values in records.items():
                self._writer.add_metadata(name, dict(values))
            self._writer.add_metadata("rosbag2", {"serialized_metadata": text})
            self._end_part()
            write_metadata_file(self.folder, metadata)
        except OSError as error:
            raise UnwritableBagError(self.folder, str(error)) from error

    def recorded(self) -> dict[str, int]:
        """Messages written so far, by topic."""
        return {spec.topic: count for spec, count in zip(self._channels, self.counts, strict=True) if count}

    def _begin_part(self) -> None:
        """The next file. Raises BagExistsError, UnwritableBagError."""
        self._part = PartEntry(f"{self.folder.name}_{len(self._parts)}.mcap")
        try:
            self._stream = self._open(self.folder / self._part.file)
            self._parts.append(self._part)
            self._writer = QuickWriter(self._stream, compression=CompressionType.ZSTD)
            self._writer.start(profile="ros2", library=OURS)
        except FileExistsError as error:
            raise UnwritableBagError(self.folder, "a file stands where its folder should be") from error
        except OSError as error:
            raise UnwritableBagError(self.folder, str(error)) from error
        self._schemas: dict[str, int] = {}
        self._registered = [False] * len(self._channels)
        """In the file that is being written."""

    def _open(self, path: Path) -> BufferedWriter:
        self.folder.mkdir(parents=True, exist_ok=True)
        if not self._parts and ((self.folder / METADATA_FILE).exists() or any(self.folder.glob("*.mcap"))):
            raise BagExistsError(self.folder)
        return path.open("xb")

    def _end_part(self) -> None:
        """Raises OSError."""
        self._writer.finish()
        self._stream.close()

    def _look_at_size(self) -> None:
        """Go on in the next file where this one is large enough. Raises OSError, UnwritableBagError."""
        self._unseen = 0
        if self._stream.tell() < self.largest_part:
            return
        before = self.path
        self._writer.flush()
        self._writer.add_metadata(PART_RECORD, goes_on(len(self._parts) - 1))
        self._end_part()
        self._begin_part()
        self._writer.add_metadata(PART_RECORD, follows(len(self._parts) - 1, before))
        self._writer.flush()
        write_metadata_file(self.folder, self._metadata())

    def _failure(self, error: OSError) -> UnwritableBagError:
        """Give up: nothing more is written, what is on the disk stays as after a crash, and that is what counts."""
        self.closed = True
        found: dict[str, int] = {}
        with suppress(UnreadableBagError, OSError):
            found = counts_in(self.folder)
        self.counts = [found.get(spec.topic, 0) for spec in self._channels]
        with suppress(OSError):  # there may be room for this
            write_metadata_file(self.folder, self._metadata())
        return UnwritableBagError(self.folder, str(error))

    def _register(self, index: int) -> None:
        spec = self._channels[index]
        if self._ask_offered is not None and not self.counts[index]:
            self._offered[index] = list(self._ask_offered(spec)) or [spec.qos]
        self._registered[index] = True
        if spec.full_type not in self._schemas:
            self._schemas[spec.full_type] = self._writer.register_schema(
                spec.full_type, "ros2msg", definition(spec.full_type).encode()
            )
        self._ids[index] = self._writer.register_channel(
            spec.topic,
            "cdr",
            self._schemas[spec.full_type],
            {
                "offered_qos_profiles": yaml.safe_dump(self._offered[index], sort_keys=False).strip(),
                "topic_type_hash": type_hash(spec.full_type),
            },
        )

    def _metadata(self) -> dict[str, Any]:
        """Content of metadata.yaml."""
        topics = [
            TopicEntry(spec.topic, spec.full_type, list(offered), type_hash(spec.full_type), count)
            for spec, offered, count in zip(self._channels, self._offered, self.counts, strict=True)
        ]
        return bag_information(self._parts, topics, self._custom)
