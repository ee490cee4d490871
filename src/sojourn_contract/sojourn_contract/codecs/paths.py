"""Paths of poses."""

from sojourn_contract.codecs.cdr import Reader, Writer
from sojourn_contract.values import Path, PoseStamped


class PathCodec:
    """nav_msgs/Path."""

    def encode(self, value: Path) -> bytes:
        """CDR of a value."""
        writer = Writer()
        writer.header(value.stamp, value.frame)
        writer.number("I", len(value.poses))
        data, headers = writer.data, dict[tuple[int, str, int], bytes]()  # most poses have the same one
        for pose in value.poses:
            begin = len(data)
            key = pose.stamp, pose.frame, begin & 7
            header = headers.get(key)
            if header is None:
                writer.header(pose.stamp, pose.frame)
                writer.align(8)
                headers[key] = bytes(data[begin:])
            else:
                data += header
            writer.doubles(pose.position)
            writer.doubles(pose.orientation)
        return bytes(data)

    def decode(self, data: bytes) -> Path:
        """The value in these bytes."""
        reader = Reader(data)
        stamp, frame = reader.header()
        return Path(stamp, frame, tuple([_pose(reader) for _ in range(reader.count(68))]))


def _pose(reader: Reader) -> PoseStamped:
    stamp, frame = reader.header()
    return PoseStamped(stamp, frame, reader.numbers("f8", 3), reader.numbers("f8", 4))
