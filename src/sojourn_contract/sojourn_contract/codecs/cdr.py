"""Primitives of CDR (OMG DDS-XTypes 1.3, sec. 7.4.1, plain CDR version 1), in which ROS serialises messages.

After a header of 4 bytes, whose second says the byte order, each primitive stands on a multiple of its own size,
counted from the header's end; a sequence or text begins with its length as uint32; a text ends with a zero byte, which
its length counts. What stands between fields and behind the last one means nothing.
"""

import struct
from typing import Any

import numpy as np

from sojourn_contract.stamps import NANOSECONDS
from sojourn_machine.params import FloatArray

HEADER = b"\0\1\0\0"
"""Of plain CDR, little endian."""
BEGIN = len(HEADER)
STAMP = struct.Struct("<iI")
STAMP_END = BEGIN + STAMP.size
LITTLE = HEADER[:2]
_NUMBERS = {order: {code: struct.Struct(order + code) for code in "BiIf"} for order in "<>"}
"""By byte order and code."""
LENGTH = _NUMBERS["<"]["I"]
DOUBLES = np.dtype("<f8")
_PADDING = tuple(bytes(count) for count in range(8))


class CdrError(ValueError):
    """Bytes that hold no such message."""


def padding(at: int, size: int) -> bytes:
    """Zeros up to the next multiple of `size` (a power of two of at most 8) in a message that is `at` bytes long."""
    return _PADDING[(BEGIN - at) & (size - 1)]


def stamp_bytes(stamp: int) -> bytes:
    """A stamp [ns] as a Time."""
    return STAMP.pack(stamp // NANOSECONDS, stamp % NANOSECONDS)


class Writer:
    """Writes one message, field by field. Little endian."""

    def __init__(self) -> None:
        self.data = bytearray(HEADER)

    def align(self, size: int) -> None:
        """Go to the next multiple of `size`."""
        self.data += padding(len(self.data), size)

    def stamp(self, stamp: int) -> None:
        """A Time or a Duration [ns]."""
        self.align(4)
        self.data += stamp_bytes(stamp)

    def number(self, code: str, value: float) -> None:
        """A number by its code of `struct`."""
        form = _NUMBERS["<"][code]
        self.align(form.size)
        self.data += form.pack(value)

    def text(self, *texts: str) -> None:
        """A text, or several one after another."""
        data = self.data
        for text in texts:
            word = text.encode()
            data += padding(len(data), 4) + LENGTH.pack(len(word) + 1) + word + b"\0"

    def header(self, stamp: int, frame: str) -> None:
        """A Header."""
        self.stamp(stamp)
        self.text(frame)

    def texts(self, texts: tuple[str, ...]) -> None:
        """A sequence of texts."""
        self.number("I", len(texts))
        self.text(*texts)

    def doubles(self, values: FloatArray) -> None:
        """Numbers of 64 bits without a length."""
        self.align(8)
        self.data += np.asarray(values, DOUBLES).tobytes()

    def sequence(self, values: FloatArray) -> None:
        """A sequence of numbers of 64 bits."""
        self.number("I", len(values))
        if len(values):
            self.doubles(values)

    def octets(self, data: bytes) -> None:
        """A sequence of bytes."""
        self.number("I", len(data))
        self.data += data


class Reader:
    """Reads one message, field by field, from a byte on. Raises CdrError, or struct.error where it ends too early."""

    def __init__(self, data: bytes, at: int = BEGIN) -> None:
        if len(data) < BEGIN or data[0] != 0 or data[1] > 1:
            raise CdrError("no plain CDR")
        self.data = data
        self.order = "<" if data[1] else ">"
        self._forms = _NUMBERS[self.order]
        self.at = at

    def number(self, code: str) -> int | float:
        """A number by its code of `struct`."""
        form = self._forms[code]
        at = self.at + ((BEGIN - self.at) & (form.size - 1))
        self.at = at + form.size
        number: int | float = form.unpack_from(self.data, at)[0]
        return number

    def count(self, least: int = 1) -> int:
        """Length of a sequence whose elements take at least so many bytes each."""
        count = int(self.number("I"))
        if count * least > len(self.data) - self.at:
            raise CdrError(f"a length of {count} at byte {self.at - 4}, with {len(self.data) - self.at} bytes left")
        return count

    def stamp(self) -> int:
        """A Time or a Duration [ns]."""
        return int(self.number("i")) * NANOSECONDS + int(self.number("I"))

    def flat(self, form: struct.Struct) -> tuple[Any, ...]:
        """Fields without padding between them, from here on."""
        at, self.at = self.at, self.at + form.size
        return form.unpack_from(self.data, at)

    def text(self) -> str:
        """A text, up to its first zero; what is no UTF-8 is replaced, as the ROS library has it."""
        count = self.count()
        at, self.at = self.at, self.at + count
        return self.data[at : self.at].partition(b"\0")[0].decode(errors="replace")

    def header(self) -> tuple[int, str]:
        """Stamp [ns] and frame of a Header."""
        return self.stamp(), self.text()

    def texts(self) -> tuple[str, ...]:
        """A sequence of texts."""
        return tuple(self.text() for _ in range(self.count(4)))

    def numbers(self, code: str, count: int) -> FloatArray:
        """An array of numbers by their code of numpy, as float64 of its own."""
        kind = np.dtype(self.order + code)
        at = self.at + ((BEGIN - self.at) & (kind.itemsize - 1))
        if at + count * kind.itemsize > len(self.data):
            raise CdrError(f"{count} numbers at byte {at} of {len(self.data)}")
        self.at = at + count * kind.itemsize
        return np.frombuffer(self.data, kind, count, at).astype(np.float64)

    def sequence(self, code: str = "f8") -> FloatArray:
        """A sequence of numbers, as float64."""
        count = self.count(int(code[1]))
        return self.numbers(code, count) if count else np.zeros(0)

    def octets(self) -> bytes:
        """A sequence of bytes."""
        count = self.count()
        at, self.at = self.at, self.at + count
        return self.data[at : self.at]
