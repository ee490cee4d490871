"""Where each number stands in a serialised message, so that a topic is read with one numpy view a field.

CDR (OMG DDS-XTypes 1.3, sec. 7.4.1, plain CDR version 1): after a header of 4 bytes, each primitive stands on
a multiple of its own size, a sequence or text begins with its length as uint32, a text ends with a zero byte.
Two messages of one type whose lengths agree have one layout; padding between fields is not initialised and
never looked at.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype

from sojourn_bags.definitions import typestore

_CODES = {
    "bool": "u1", "byte": "u1", "octet": "u1", "char": "u1", "uint8": "u1", "int8": "i1",
    "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
_HEADER = 4


@dataclass(frozen=True)
class Number:
    """A number or an array of numbers: byte offset, type, and how many (None for a single one)."""

    offset: int
    dtype: np.dtype
    count: int | None

    @property
    def end(self) -> int:
        """First byte after it."""
        return self.offset + self.dtype.itemsize * (1 if self.count is None else self.count)


@dataclass(frozen=True)
class Text:
    """A text: offset of its first byte and its length without the closing zero."""

    offset: int
    length: int


@dataclass
class MessageLayout:
    """Fields of one message by path, as `pose.pose.position.x`, `position` or `fields[0].name`.

    Attributes:
        numbers, texts: the leaves. lengths: offsets of the uint32 that decide where the rest stands.
        type: of the message. size: bytes of the message. parts: first byte of each field of the message itself.
    """

    numbers: dict[str, Number] = field(default_factory=dict)
    texts: dict[str, Text] = field(default_factory=dict)
    lengths: list[int] = field(default_factory=list)
    size: int = 0
    type: str = ""
    parts: dict[str, int] = field(default_factory=dict)

    def structure(self) -> NDArray[np.int64]:
        """Bytes that are equal in every message of this layout: byte order and lengths."""
        offsets = [1] + [offset + byte for offset in self.lengths for byte in range(4)]
        return np.array(offsets, dtype=np.int64)

    def column(self, rows: NDArray[np.uint8], path: str) -> NDArray:
        """Values of one field in many messages: shape (n,), or (n, k) for an array.

        Args:
            rows: shape (n, bytes), one message a row.
        """
        number = self.numbers[path]
        values = np.ascontiguousarray(rows[:, number.offset : number.end]).view(number.dtype)
        return values[:, 0] if number.count is None else values


class _Walker:
    """Walks through one message by its type."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.order = "<" if data[1] & 1 else ">"
        self.at = _HEADER
        self.layout = MessageLayout()

    def message(self, type_name: str, prefix: str) -> None:
        """All fields of a message."""
        _, fields = typestore().fielddefs[type_name]
        for name, (node, argument) in fields:
            if not prefix:
                self.layout.parts[name] = self.at
            self.node(node, argument, prefix + name)

    def node(self, node: Nodetype, argument, path: str) -> None:
        """One field: a base value, a message, an array or a sequence."""
        if node == Nodetype.BASE:
            self.base(argument[0], path)
        elif node == Nodetype.NAME:
            self.message(argument, path + ".")
        else:
            (inner, inner_argument), length = argument
            count = self.length() if node == Nodetype.SEQUENCE else length
            if inner == Nodetype.BASE and inner_argument[0] not in ("string", "wstring"):
                self.numbers(inner_argument[0], path, count)
                return
            for index in range(count):
                self.node(inner, inner_argument, f"{path}[{index}]")

    def base(self, name: str, path: str) -> None:
        """A single number or a text."""
        if name not in ("string", "wstring"):
            self.numbers(name, path, None)
            return
        length = self.length()
        if not length:
            raise ValueError(f"the text {path} at byte {self.at} has no closing zero")
        self.layout.texts[path] = Text(self.at, max(0, length - 1))
        self.at += length

    def numbers(self, name: str, path: str, count: int | None) -> None:
        """A number, or `count` of them."""
        dtype = np.dtype(self.order + _CODES[name])
        if count != 0:
            self.align(dtype.itemsize)
        number = Number(self.at, dtype, count)
        self.layout.numbers[path] = number
        self.at = number.end

    def length(self) -> int:
        """Length of a text or sequence."""
        self.align(4)
        value = int.from_bytes(self.data[self.at : self.at + 4], "little" if self.order == "<" else "big")
        if value > len(self.data):
            raise ValueError(f"a length of {value} at byte {self.at} of a message of {len(self.data)} bytes")
        self.layout.lengths.append(self.at)
        self.at += 4
        return value

    def align(self, size: int) -> None:
        """Step to the next multiple of `size`, counted from the end of the header."""
        self.at = _HEADER + -(-(self.at - _HEADER) // size) * size


def layout_of(type_name: str, data: bytes) -> MessageLayout:
    """Layout of one message of type "package/msg/Name". Raises ValueError if it is cut off."""
    if len(data) < _HEADER:
        raise ValueError(f"a message of {len(data)} bytes has no header")
    if data[0] or data[1] > 1:
        raise ValueError(f"the header {data[:2].hex()} of a message is not that of plain CDR")
    walker = _Walker(data)
    walker.message(type_name, "")
    if walker.at > len(data):
        raise ValueError(f"a {type_name} of {len(data)} bytes is cut off: {walker.at} are announced")
    walker.layout.size, walker.layout.type = walker.at, type_name
    return walker.layout
