"""A writer of MCAP that takes a message in a quarter of the time: what it writes is, byte for byte, what the library's
does (a test compares them), only each record is made in one piece instead of number by number, and a chunk that is full
is packed in a thread while the next one fills.

The library has no way in for this: its chunk and its statistics are reached by their private names, here alone.

Source: MCAP specification (mcap.dev/spec), records Message (op 0x05) and Message Index (op 0x07).
"""

import struct
import zlib
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import IO, Any, NamedTuple

import zstandard
from mcap._chunk_builder import ChunkBuilder
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex, MessageIndex
from mcap.writer import CompressionType, Writer

_MESSAGE = struct.Struct("<BQHIQQ")
"""Opcode, length, channel, sequence, log time, publish time."""
_PREFIX = 9
"""Bytes of a record before its content: opcode and length."""
_INDEX = struct.Struct("<HI")
"""Channel, length of the entries."""
_BLOCK = 1 << 15
"""Of chunk indices that are packed together [bytes]."""


class QuickWriter(Writer):
    """As the library's writer, with chunks, all indices and statistics.

    Args:
        stream: to write to. settings: as of the library's writer.
    """

    def __init__(self, stream: IO[Any], **settings: Any) -> None:
        super().__init__(stream, **settings)
        private = vars(self)
        self._chunk, self._statistics = private["_Writer__chunk_builder"], private["_Writer__statistics"]
        self._chunk_size = private["_Writer__chunk_size"]
        self._packs = private["_Writer__compression"] is CompressionType.ZSTD
        private["_Writer__chunk_indices"] = _PackedIndices()
        self._packer = ThreadPoolExecutor(1, "packer")
        self._full: tuple[ChunkBuilder, bytes, Future[tuple[bytes, int]]] | None = None
        """A chunk that is being packed: what is known of it, its content, that content packed and its checksum."""

    def add_message(self, channel_id: int, log_time: int, data: bytes, publish_time: int, sequence: int = 0) -> None:
        """Append a message; times in [ns]."""
        length = _MESSAGE.size - _PREFIX + len(data)
        head = _MESSAGE.pack(Opcode.MESSAGE, length, channel_id, sequence, log_time, publish_time)
        chunk, statistics = self._chunk, self._statistics
        for times, count in ((statistics, statistics.message_count), (chunk, chunk.num_messages)):
            if not count or log_time < times.message_start_time:
                times.message_start_time = log_time
            if log_time > times.message_end_time:
                times.message_end_time = log_time
        statistics.channel_message_counts[channel_id] += 1
        statistics.message_count += 1
        chunk.num_messages += 1
        index = chunk.message_indices.get(channel_id)
        if index is None:
            index = chunk.message_indices[channel_id] = _QuickIndex(channel_id, [])
        buffer = chunk.record_writer._buffer
        index.records.append((log_time, buffer.tell()))
        buffer.write(head)
        buffer.write(data)
        if buffer.tell() > self._chunk_size:
            self._begin_to_pack() if self._packs else self.flush()

    def finish(self) -> None:
        """As the library's, which would put the end of the data before a chunk that is still being packed."""
        self._write_full()
        self._packer.shutdown()
        super().finish()

    def _Writer__flush(self) -> None:
        """The library's one way to the stream, whatever it writes: the chunk that is being packed comes before that."""
        self._write_full()
        self._to_stream()

    def _to_stream(self) -> None:
        """What the library does there. Looked up each time: a writer that held it would hold itself, and outlive its
        file with all its indices until Python looks for such circles, which a recorder's gives it little cause to do.
        """
        super()._Writer__flush()  # type: ignore[misc]

    def _begin_to_pack(self) -> None:
        self._write_full()
        chunk, self._chunk = self._chunk, ChunkBuilder()
        vars(self)["_Writer__chunk_builder"] = self._chunk
        data = chunk.end()
        self._full = chunk, data, self._packer.submit(_packed, data)

    def _write_full(self) -> None:
        """Write the chunk that is being packed, if there is one, and its message indices. Raises OSError."""
        if self._full is None:
            return
        (chunk, data, packed), self._full = self._full, None
        content, checksum = packed.result()
        private = vars(self)
        stream, builder = private["_Writer__stream"], private["_Writer__record_builder"]
        self._to_stream()
        begin, first, last = stream.tell(), chunk.message_start_time, chunk.message_end_time
        Chunk("zstd", content, last, first, checksum, len(data)).write(builder)
        length = builder.count
        self._to_stream()
        indices, offsets = stream.tell(), dict[int, int]()
        for channel, index in chunk.message_indices.items():
            offsets[channel] = indices + builder.count
            index.write(builder)
        known = ChunkIndex(
            chunk_length=length,
            chunk_start_offset=begin,
            compression="zstd",
            compressed_size=len(content),
            message_end_time=last,
            message_index_length=builder.count,
            message_index_offsets=offsets,
            message_start_time=first,
            uncompressed_size=len(data),
        )
        private["_Writer__chunk_indices"].append(known)
        self._statistics.chunk_count += 1
        self._to_stream()


def _packed(data: bytes) -> tuple[bytes, int]:
    """As the library packs a chunk, and its checksum."""
    return zstandard.compress(data), zlib.crc32(data)


class _PackedIndices:
    """Of the chunks of a file, for its end: as they will be written, by blocks and packed, for they are much alike. A
    recorder of a whole day would grow by megabytes of their numbers.
    """

    def __init__(self) -> None:
        self._packed: list[bytes] = []
        self._last = b""

    def append(self, index: ChunkIndex) -> None:
        """Keep a chunk's."""
        builder = RecordBuilder()
        index.write(builder)
        self._last += builder.end()
        if len(self._last) >= _BLOCK:
            self._packed.append(zlib.compress(self._last))  # zstandard gives its bytes more memory than they need
            self._last = b""

    def __iter__(self) -> Iterator["_Records"]:
        """Block by block."""
        yield from (_Records(zlib.decompress(block)) for block in self._packed)
        yield _Records(self._last)


class _Records(NamedTuple):
    content: bytes

    def write(self, stream: RecordBuilder) -> None:
        stream.write(self.content)


class _QuickIndex(MessageIndex):
    """Where the messages of a channel stand in a chunk."""

    def write(self, stream: RecordBuilder) -> None:
        numbers = [number for record in self.records for number in record]
        stream.start_record(Opcode.MESSAGE_INDEX)
        stream.write(_INDEX.pack(self.channel_id, 8 * len(numbers)))
        stream.write(struct.pack(f"<{len(numbers)}Q", *numbers))
        stream.finish_record()
