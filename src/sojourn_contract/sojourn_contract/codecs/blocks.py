"""Messages that are texts and then one block of numbers of 64 bits: poses, twists, odometry, inertial measurements."""

from typing import Any

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.codecs.beginnings import Beginnings
from sojourn_contract.codecs.cdr import BEGIN, DOUBLES, CdrError, Reader, Writer, padding

Block = tuple[tuple[str, int], ...]
"""Fields of a value in the order in which the message has them, and how many numbers each is."""
POSE: Block = (("position", 3), ("orientation", 4))
TWIST: Block = (("linear", 3), ("angular", 3))
WRENCH: Block = (("force", 3), ("torque", 3))
VECTOR: Block = (("vector", 3),)
ODOMETRY: Block = (*POSE, ("pose_covariance", 36), *TWIST, ("twist_covariance", 36))
IMU: Block = (
    ("orientation", 4), ("orientation_covariance", 9), ("angular_velocity", 3), ("angular_velocity_covariance", 9),
    ("linear_acceleration", 3), ("linear_acceleration_covariance", 9),
)  # fmt: skip


class BlockCodec:
    """Of a message whose value has texts, then arrays.

    Args:
        kind: class of its value. block: its arrays. texts: names of its texts.
    """

    def __init__(self, kind: Any, block: Block, texts: tuple[str, ...] = ("frame",)) -> None:
        self._kind = kind
        self._texts = texts
        ends = np.cumsum([count for _, count in block]).tolist()
        self._size = ends[-1]
        self._slices = [(name, slice(end - count, end)) for (name, count), end in zip(block, ends, strict=True)]
        self._of_text = [kind._fields.index(name) for name in texts]
        self._of_array = [kind._fields.index(name) for name, _ in block]
        placed = ["stamp", *texts, *(name for name, _ in block)]
        self._order = [placed.index(name) for name in kind._fields]
        self._scratch = np.empty(self._size, DOUBLES)
        self._beginnings: Beginnings[tuple[str, ...]] = Beginnings(self._write_texts, self._read_texts)

    def encode(self, value: Any) -> bytes:
        """CDR of a value. Raises ValueError for an array of another length."""
        scratch = self._scratch
        for place, (name, part) in zip(self._of_array, self._slices, strict=True):
            array = value[place]
            if len(array) != part.stop - part.start:
                raise ValueError(f"{name}: {len(array)} numbers where there are {part.stop - part.start}")
            scratch[part] = array
        beginning = self._beginnings.bytes_of(value[0], tuple([value[place] for place in self._of_text]))
        return beginning + padding(len(beginning), 8) + scratch.tobytes()

    def decode(self, data: bytes) -> Any:
        """The value in these bytes."""
        texts, at = self._beginnings.read(data)
        at += (BEGIN - at) & 7
        if at + 8 * self._size > len(data):
            raise CdrError(f"{self._size} numbers at byte {at} of {len(data)}")
        kind = DOUBLES if data[1] else DOUBLES.newbyteorder(">")
        block = np.frombuffer(data, kind, self._size, at).astype(np.float64)
        placed = [stamps.from_cdr(data), *texts, *[block[part] for _, part in self._slices]]
        return self._kind(*[placed[place] for place in self._order])

    def _write_texts(self, writer: Writer, texts: tuple[str, ...]) -> None:
        for text in texts:
            writer.text(text)

    def _read_texts(self, reader: Reader) -> tuple[str, ...]:
        return tuple([reader.text() for _ in self._texts])
