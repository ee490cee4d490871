"""Messages about joints: states and trajectories."""

import struct

import numpy as np

from sojourn_contract.codecs.beginnings import Beginnings
from sojourn_contract.codecs.cdr import BEGIN, DOUBLES, LENGTH, CdrError, Reader, Writer
from sojourn_contract.values import NOTHING, JointState, JointTrajectory, TrajectoryPoint
from sojourn_machine.params import FloatArray

_ORDERS = ((DOUBLES.newbyteorder(">"), struct.Struct(">I")), (DOUBLES, LENGTH))
"""Numbers and lengths by the second byte of a message: big endian, little endian."""
_PADDED = struct.Struct("<I4x")
"""A length that stands on a multiple of 8, as numbers do that come after it."""
Names = tuple[str, tuple[str, ...]]
"""Frame of the header, names of the joints."""


class JointStateCodec:
    """sensor_msgs/JointState."""

    def __init__(self) -> None:
        self._beginnings: Beginnings[Names] = Beginnings(_write_names, _read_names, LENGTH.size)

    def encode(self, value: JointState) -> bytes:
        """CDR of a value."""
        data = self._beginnings.bytes_of(value.stamp, (value.frame, value.names))
        for array in (value.position, value.velocity, value.effort):
            count = len(array)
            length = _PADDED if count and len(data) & 4 else LENGTH
            data += length.pack(count) + np.asarray(array, DOUBLES).tobytes()
        return data

    def decode(self, data: bytes) -> JointState:
        """The value in these bytes."""
        stamp, (frame, names), at = self._beginnings.read(data)
        order, length = _ORDERS[data[1]]
        arrays = []
        for _ in range(3):
            (count,) = length.unpack_from(data, at)
            at += length.size
            array: FloatArray = NOTHING
            if count:
                at += (BEGIN - at) & 7
                if at + 8 * count > len(data):
                    raise CdrError(f"{count} numbers at byte {at} of {len(data)}")
                array = np.frombuffer(data, order, count, at).astype(np.float64)
                at += 8 * count
            arrays.append(array)
        return JointState._make((stamp, names, *arrays, frame))


class JointTrajectoryCodec:
    """trajectory_msgs/JointTrajectory."""

    def encode(self, value: JointTrajectory) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        writer.texts(value.names)
        writer.number("I", len(value.points))
        for point in value.points:
            for array in point[:4]:
                writer.sequence(array)
            writer.stamp(point.time_from_start)
        return bytes(writer.data)

    def decode(self, data: bytes) -> JointTrajectory:
        """The value in these bytes."""
        reader = Reader(data)
        stamp, frame = reader.header()
        names = reader.texts()
        points = tuple([_point(reader) for _ in range(reader.count(24))])
        return JointTrajectory(stamp, names, points, frame)


def _point(reader: Reader) -> TrajectoryPoint:
    arrays = [reader.sequence() for _ in range(4)]
    return TrajectoryPoint._make((*arrays, reader.stamp()))


def _write_names(writer: Writer, names: Names) -> None:
    writer.text(names[0])
    writer.texts(names[1])


def _read_names(reader: Reader) -> Names:
    return reader.text(), reader.texts()
