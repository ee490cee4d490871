"""Beginnings of messages that repeat: header's frame, names. They are written and read once, and recognised after."""

from collections.abc import Callable
from typing import Generic, TypeVar

from sojourn_contract.codecs.cdr import BEGIN, HEADER, LITTLE, STAMP, STAMP_END, Reader, Writer, stamp_bytes
from sojourn_contract.stamps import NANOSECONDS

MOST = 64
"""Beginnings that are kept; of more the oldest goes."""
Texts = TypeVar("Texts")


class Beginnings(Generic[Texts]):
    """Of the messages of one type: all that stands between the stamp and the first number that changes.

    Args:
        write: writes what the texts say. read: reads it. size: of that first number [bytes].
    """

    def __init__(self, write: Callable[[Writer, Texts], None], read: Callable[[Reader], Texts], size: int = 1) -> None:
        self._write, self._read, self._size = write, read, size
        self._written: dict[Texts, bytes] = {}
        self._known: dict[int, tuple[bytes, Texts]] = {}
        """By the length of the message: what stood there last."""

    def bytes_of(self, stamp: int, texts: Texts) -> bytes:
        """The beginning of a message with a stamp [ns], up to where its first number stands."""
        written = self._written.get(texts)
        if written is None:
            writer = Writer()
            writer.stamp(0)
            self._write(writer, texts)
            writer.align(self._size)
            written = bytes(writer.data[STAMP_END:])
            _keep(self._written, texts, written)
        return HEADER + stamp_bytes(stamp) + written

    def read(self, data: bytes) -> tuple[int, Texts, int]:
        """Stamp [ns], what the beginning says, and where the first number stands. Raises CdrError, struct.error."""
        known = self._known.get(len(data))
        if known is not None and data.startswith(LITTLE) and data.startswith(known[0], STAMP_END):
            seconds, nanoseconds = STAMP.unpack_from(data, BEGIN)
            stamp, texts, end = seconds * NANOSECONDS + nanoseconds, known[1], STAMP_END + len(known[0])
        else:
            reader = Reader(data)
            stamp, texts, end = reader.stamp(), self._read(reader), reader.at
            if data.startswith(LITTLE):
                _keep(self._known, len(data), (data[STAMP_END:end], texts))
        return stamp, texts, end + ((BEGIN - end) & (self._size - 1))


def _keep(table: dict, key: object, value: object) -> None:  # type: ignore[type-arg]
    if len(table) >= MOST:
        del table[next(iter(table))]
    table[key] = value
