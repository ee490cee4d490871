"""A message of which one bit is another, as after an upset of memory or wire: of its numbers, texts or bytes.

Its stamp stays, by which it is waited for, and so do the whole numbers that tell lengths and kinds.
"""

import struct
from typing import Any

import numpy as np

from sojourn_contract.values import Message
from sojourn_machine.params import FloatArray

CHARACTER, BYTE, NUMBER = 7, 8, 64
"""Bits that may be others: of a character, of a byte, of a number."""


def bits_of(value: Any) -> int:
    """How many bits of a value may be others; of a message all but its stamp's."""
    if isinstance(value, str):
        return CHARACTER * len(value)
    if isinstance(value, bytes):
        return BYTE * len(value)
    if isinstance(value, np.ndarray):
        return NUMBER * value.size
    if isinstance(value, float):
        return NUMBER
    return sum(bits_of(part) for part in value) if isinstance(value, tuple) else 0


def with_bit_flipped(value: Message, bit: int) -> Message:
    """A value of which this bit is another, 0 <= bit < bits_of(value)."""
    if isinstance(value, str):
        place, bit = divmod(bit, CHARACTER)
        return value[:place] + chr(ord(value[place]) ^ 1 << bit) + value[place + 1 :]
    if isinstance(value, bytes):
        place, bit = divmod(bit, BYTE)
        return value[:place] + bytes([value[place] ^ 1 << bit]) + value[place + 1 :]
    if isinstance(value, np.ndarray):
        place, bit = divmod(bit, NUMBER)
        return _changed(value, place, bit)
    if isinstance(value, float):
        return struct.unpack("<d", struct.pack("<Q", struct.unpack("<Q", struct.pack("<d", value))[0] ^ 1 << bit))[0]
    parts = list(value)
    for place, part in enumerate(parts):
        bits = bits_of(part)
        if bit < bits:
            parts[place] = with_bit_flipped(part, bit)
            break
        bit -= bits
    return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)


def _changed(numbers: FloatArray, place: int, bit: int) -> FloatArray:
    changed = numbers.copy()
    changed.reshape(-1).view(np.uint64)[place] ^= np.uint64(1 << bit)
    return changed
