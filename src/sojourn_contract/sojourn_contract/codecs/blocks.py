"""Messages that are texts and then one block of numbers of 64 bits: poses, twists, odometry, inertial measurements."""

from typing import Any

import numpy as np

from sojourn_contract.codecs.beginnings import Beginnings
from sojourn_contract.codecs.cdr import DOUBLES, CdrError, Reader, Writer

Block = tuple[tuple[str, int], ...]
"""Fields of a value in the order in which the message has them, and how many numbers each is."""
POSE: Block = (("position", 3), ("orientation", 4))
POSE_WITH_COVARIANCE: Block = (*POSE, ("covariance", 36))
TWIST: Block = (("linear", 3), ("angular", 3))
WRENCH: Block = (("force", 3), ("torque", 3))
VECTOR: Block = (("vector", 3),)
ODOMETRY: Block = (*POSE, ("pose_covariance", 36), *TWIST, ("twist_covariance", 36))
IMU: Block = (
    ("orientation", 4), ("orientation_covariance", 9), ("angular_velocity", 3), ("angular_velocity_covariance", 9),
    ("linear_acceleration", 3), ("linear_acceleration_covariance", 9),
)  # fmt: skip


class BlockCodec:
    """Of a message whose value has a stamp, texts, then arrays.

    Args:
        kind: class of its value. block: its arrays. texts: how many texts it has.
    """

    def __init__(self, kind: Any, block: Block, texts: int = 1) -> None:
        self._kind, self._texts = kind, texts
        self._names, self._counts = [name for name, _ in block], [count for _, count in block]
        self._places = [kind._fields.index(name) for name in self._names]
        ends = dict(zip(self._names, np.cumsum(self._counts).tolist(), strict=True))
        self._parts = [slice(ends[name] - dict(block)[name], ends[name]) for name in kind._fields[1 + texts :]]
        """Of the value's arrays in the block, in the order of the value."""
        self._scratch = np.empty(sum(self._counts), DOUBLES)
        self._beginnings: Beginnings[tuple[str, ...]] = Beginnings(self._write_texts, self._read_texts, 8)

    def encode(self, value: Any) -> bytes:
        """CDR of a value. Raises ValueError for an array of another length."""
        arrays = [value[place] for place in self._places]
        if list(map(len, arrays)) != self._counts:
            given = zip(self._names, arrays, self._counts, strict=True)
            name, array, count = next(each for each in given if len(each[1]) != each[2])
            raise ValueError(f"{name}: {len(array)} numbers where there are {count}")
        np.concatenate(arrays, out=self._scratch)
        return self._beginnings.bytes_of(value[0], value[1 : 1 + self._texts]) + self._scratch.tobytes()

    def decode(self, data: bytes) -> Any:
        """The value in these bytes."""
        stamp, texts, at = self._beginnings.read(data)
        size = len(self._scratch)
        if at + 8 * size > len(data):
            raise CdrError(f"{size} numbers at byte {at} of {len(data)}")
        order = DOUBLES if data[1] else DOUBLES.newbyteorder(">")
        block = np.frombuffer(data, order, size, at).astype(np.float64)
        return self._kind(stamp, *texts, *[block[part] for part in self._parts])

    def _write_texts(self, writer: Writer, texts: tuple[str, ...]) -> None:
        writer.text(*texts)

    def _read_texts(self, reader: Reader) -> tuple[str, ...]:
        return tuple([reader.text() for _ in range(self._texts)])
