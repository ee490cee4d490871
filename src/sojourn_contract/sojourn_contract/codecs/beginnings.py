"""Beginnings of messages that repeat: header's frame, names. They are written and read once, and recognised after."""

from collections.abc import Callable
from typing import Generic, TypeVar

from sojourn_contract.codecs.cdr import BEGIN, HEADER, Reader, Writer, stamp_bytes

MOST = 64
"""Beginnings that are kept; of more the oldest goes."""
STAMP_END = BEGIN + 8
LITTLE = HEADER[:2]
Texts = TypeVar("Texts")


class Beginnings(Generic[Texts]):
    """Of the messages of one type: all that stands between the stamp and the first number that changes.

    Args:
        write: writes what the texts say. read: reads it.
    """

    def __init__(self, write: Callable[[Writer, Texts], None], read: Callable[[Reader], Texts]) -> None:
        self._write, self._read = write, read
        self._written: dict[Texts, bytes] = {}
        self._known: dict[int, tuple[bytes, Texts]] = {}
        """By the length of the message: what stood there last."""

    def bytes_of(self, stamp: int, texts: Texts) -> bytes:
        """The beginning of a message with a stamp [ns]."""
        written = self._written.get(texts)
        if written is None:
            writer = Writer()
            writer.stamp(0)
            self._write(writer, texts)
            written = bytes(writer.data[STAMP_END:])
            _keep(self._written, texts, written)
        return HEADER + stamp_bytes(stamp) + written

    def read(self, data: bytes) -> tuple[Texts, int]:
        """What the beginning says, and where it ends. Raises CdrError, struct.error."""
        known = self._known.get(len(data))
        if known is not None and data.startswith(LITTLE) and data.startswith(known[0], STAMP_END):
            return known[1], STAMP_END + len(known[0])
        reader = Reader(data)
        reader.stamp()
        texts = self._read(reader)
        if data.startswith(LITTLE):
            _keep(self._known, len(data), (data[STAMP_END : reader.at], texts))
        return texts, reader.at


def _keep(table: dict, key: object, value: object) -> None:  # type: ignore[type-arg]
    if len(table) >= MOST:
        del table[next(iter(table))]
    table[key] = value
