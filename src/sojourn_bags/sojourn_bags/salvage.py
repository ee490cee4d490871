"""Reads the records of an MCAP file as far as they are whole: past the end of none, and through no damage unseen.

A crash leaves a file that ends anywhere, or one that the file system has filled with zeros to its end. Records are
framed by their lengths, chunks and attachments carry a CRC-32 (MCAP specification), so what is whole is known. A chunk
that is cut off is unpacked as far as it goes: zstd packs blocks of at most 128 kB, and each can be unpacked once it is
there.
"""

import struct
import zlib
from collections.abc import Container, Iterator
from io import SEEK_END, BytesIO
from pathlib import Path
from typing import BinaryIO

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Header, McapRecord, Message, Metadata, Schema

from sojourn_bags.errors import UnreadableBagError

MAGIC = b"\x89MCAP0\r\n"
CUT = "it ends before its time"
SECTOR = 512
"""Bytes. So many zeros at the end of a cut file are not data but what the file system put there."""
_FRAME = struct.Struct("<BQ")
_CHUNK = struct.Struct("<QQQII")
_MESSAGE = struct.Struct("<HIQQ")
_PIECE = 1 << 20
LARGEST_CHUNK = 1 << 26
"""Bytes of its content: what is said to hold more is not read, so that a small file cannot ask for all memory. Writers
make chunks of a megabyte or some.
"""
LARGEST_RECORD = 1 << 28
"""Bytes of a record, as an attachment."""
MOST_PACKED = 100
"""Bytes of content for each byte of the file that are unpacked in all; recorded runs have about five."""
LARGEST_WINDOW = 1 << 27
"""Of zstd, that of its level 22 [bytes]."""
_IN_CHUNK = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE)
_BROKEN = (McapError, struct.error, ValueError, zstandard.ZstdError, RuntimeError, EOFError)
"""What reading damaged bytes raises: ValueError for a check sum or a text, RuntimeError from lz4."""


class Salvage:
    """One reading of a file. Iterate over `records` first; then the rest is known.

    Args:
        path: MCAP file of profile ros2. topics: of which messages are wanted, None for all; the rest is passed
            over unread.

    Attributes:
        whole: the file ends as it should and everything in it is sound. all_messages: the damage, if any, is behind
            the last message.
        damage: what is wrong in words, "" if nothing. at: byte at which the first damage begins.
    """

    def __init__(self, path: Path, topics: Container[str] | None = None) -> None:
        self.path, self.topics = path, topics
        self.whole = self.all_messages = False
        self.damage = ""
        self.at = 0
        self._sound_end = 0
        self._size = self._unpacked = 0
        self._channels: set[int] = set()
        """Of messages that are wanted."""

    @property
    def records(self) -> Iterator[McapRecord]:
        """Header, schemas, channels, messages, attachments and metadata, in the order of the file.

        Raises UnreadableBagError for what is no MCAP file of ROS 2.
        """
        try:
            with self.path.open("rb") as stream:
                self._size = stream.seek(0, SEEK_END)
                self._sound_end = _end_without_zeros(stream, self._size)
                stream.seek(0)
                if stream.read(len(MAGIC)) != MAGIC:
                    raise UnreadableBagError(self.path, "it is no MCAP file (it does not begin like one)")
                yield from self._data_section(stream)
        except OSError as error:
            raise UnreadableBagError(self.path, error.strerror or str(error)) from error

    def _data_section(self, stream: BinaryIO) -> Iterator[McapRecord]:
        first = True
        while True:
            begin = stream.tell()
            frame = stream.read(min(_FRAME.size, max(0, self._size - begin)))  # the file may be growing
            opcode, length = _FRAME.unpack(frame) if len(frame) == _FRAME.size else (0, 0)
            if first and (opcode != Opcode.HEADER or begin + _FRAME.size + length > self._size):
                raise UnreadableBagError(self.path, "it is no MCAP file (it has no header)")
            if opcode == 0:
                self._damaged(begin, "zeros stand where a record should be" if len(frame) == _FRAME.size else CUT)
                return
            if min(length, self._size) > LARGEST_RECORD:
                self._damaged(begin, f"a record says that it is {length} bytes long: nothing after it is read")
                return
            content = stream.read(min(length, self._size - begin - _FRAME.size))
            if opcode == Opcode.FOOTER and len(content) == length:
                if stream.read(len(MAGIC)) != MAGIC:
                    self._damaged(begin, "its closing mark is missing")
                self.whole = not self.damage
                return
            if opcode == Opcode.CHUNK:
                yield from self._chunk(begin, content, length)
            elif len(content) == length:
                record = self._record(begin, opcode, content)
                if isinstance(record, Header) and record.profile != "ros2":
                    raise UnreadableBagError(self.path, f"its profile is {record.profile!r}, not 'ros2'")
                if record is not None:
                    yield record
            if len(content) < length:
                self._damaged(begin, CUT)
                return
            self.all_messages |= opcode == Opcode.DATA_END and not self.damage
            first = False

    def _record(self, begin: int, opcode: int, content: bytes) -> McapRecord | None:
        """A record outside of chunks, None for an index, for an unknown kind, and for what is damaged."""
        end = begin + _FRAME.size + len(content)
        zeroed = end > self._sound_end and (self._size - self._sound_end >= SECTOR or opcode == Opcode.METADATA)
        if zeroed and opcode in (*_IN_CHUNK, Opcode.METADATA):
            self._damaged(begin, "zeros stand where a record was")
            return None
        try:
            if opcode == Opcode.ATTACHMENT and not _crc_fits(content[:-4], int.from_bytes(content[-4:], "little")):
                self._damaged(begin, "an attachment does not match its check sum")
                return None
            return self._parse(opcode, content)
        except _BROKEN as error:
            self._damaged(begin, f"a record cannot be read ({error})")
            return None

    def _parse(self, opcode: int, content: bytes) -> McapRecord | None:
        if opcode == Opcode.MESSAGE:
            channel_id, sequence, log_time, publish_time = _MESSAGE.unpack_from(content)
            if channel_id not in self._channels:
                return None
            return Message(channel_id, log_time, content[_MESSAGE.size :], publish_time, sequence)
        stream = ReadDataStream(BytesIO(content))
        if opcode == Opcode.CHANNEL:
            channel = Channel.read(stream)
            if self.topics is None or channel.topic in self.topics:
                self._channels.add(channel.id)
            return channel
        for kind, known in ((Schema, Opcode.SCHEMA), (Attachment, Opcode.ATTACHMENT), (Metadata, Opcode.METADATA),
                            (Header, Opcode.HEADER)):  # fmt: skip
            if opcode == known:
                return kind.read(stream)
        return None

    def _chunk(self, begin: int, content: bytes, length: int) -> Iterator[McapRecord]:
        """Records of a chunk; of a damaged one those that are whole."""
        try:
            _, _, size, crc, name_length = _CHUNK.unpack_from(content)
            compression = content[_CHUNK.size : _CHUNK.size + name_length].decode()
            data = content[_CHUNK.size + name_length + 8 :]
        except (struct.error, UnicodeDecodeError):
            self._damaged(begin, "the head of a chunk cannot be read")
            return
        self._unpacked += size
        if size > LARGEST_CHUNK or self._unpacked > LARGEST_CHUNK + MOST_PACKED * self._size:
            self._damaged(begin, f"a chunk says that it holds {size} bytes, more than it can: it is passed over")
            return
        end = begin + _FRAME.size + len(content)
        zeroed = self._sound_end < end and self._size - self._sound_end >= SECTOR
        if len(content) == length and not (zeroed and not crc):
            unpacked = _unpack(compression, data, size, crc)
            if unpacked is not None:
                yield from self._split(unpacked)
                return
            self._damaged(begin, "a chunk does not match its check sum")
            zeroed = self._sound_end < end
            if not zeroed:  # damage in the middle of the file: nothing says where in the chunk
                return
        else:
            self._damaged(begin, CUT)
        sound = data[: len(data) - (end - self._sound_end)] if zeroed else data
        yield from self._split(_unpack_part(compression, sound, size))

    def _split(self, data: bytes) -> Iterator[McapRecord]:
        """Records that are whole at the beginning of a chunk's content."""
        place, view = 0, memoryview(data)
        while place + _FRAME.size <= len(data):
            opcode, length = _FRAME.unpack_from(data, place)
            place += _FRAME.size
            if not opcode or place + length > len(data):  # zeros are no records
                return
            is_wanted = opcode != Opcode.MESSAGE or int.from_bytes(view[place : place + 2], "little") in self._channels
            if opcode in _IN_CHUNK and is_wanted:
                try:
                    record = self._parse(opcode, bytes(view[place : place + length]))
                except _BROKEN:
                    return
                if record is not None:
                    yield record
            place += length

    def _damaged(self, at: int, what: str) -> None:
        """Remember the first damage."""
        if not self.damage:
            self.damage, self.at = what, at


def _end_without_zeros(stream: BinaryIO, size: int) -> int:
    """Place after the last byte that is not zero."""
    end, block = size, 1 << 20
    while end:
        begin = max(0, end - block)
        stream.seek(begin)
        kept = stream.read(end - begin).rstrip(b"\0")
        if kept:
            return begin + len(kept)
        end = begin
    return 0


def _crc_fits(data: bytes, crc: int) -> bool:
    """Zero means that the writer has not made one."""
    return crc in (0, zlib.crc32(data))


def _unpack(compression: str, data: bytes, size: int, crc: int) -> bytes | None:
    """Content of a whole chunk, None if it is damaged or is not of the size that it says."""
    try:
        unpacked = _unpack_lz4(data, size + 1) if compression == "lz4" else _unpack_part(compression, data, size + 1)
    except _BROKEN:
        return None
    return unpacked if len(unpacked) == size and _crc_fits(unpacked, crc) else None


def _unpack_lz4(data: bytes, size: int) -> bytes:
    """No more than is said; RuntimeError where it is broken."""
    import lz4.frame  # mcap brings it along; few bags are packed by it

    unpacker = lz4.frame.LZ4FrameDecompressor()
    unpacked: bytes = unpacker.decompress(data, max_length=size)
    return unpacked


def _unpack_part(compression: str, data: bytes, size: int) -> bytes:
    """Content of a chunk that may be cut off, as far as it can be unpacked, and no more than it says (`size`); nothing
    of one that is packed by lz4.
    """
    if not compression:
        return data
    if compression != "zstd":
        return b""
    parts: list[bytes] = []
    left = size
    with zstandard.ZstdDecompressor(max_window_size=LARGEST_WINDOW).stream_reader(data) as unpacker:
        while left > 0:
            try:
                part = unpacker.read(min(_PIECE, left))
            except zstandard.ZstdError:
                break
            if not part:
                break
            parts.append(part)
            left -= len(part)
    return b"".join(parts)
