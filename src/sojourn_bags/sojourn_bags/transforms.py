"""Builds the /tf messages of a bag from the recorded odometry, byte by byte.

The tree is map -> odom -> base_link (REP 105). odom -> base_link is the rover's own estimate, /odom as it is.
map -> odom is what a perfect localiser would say, from the truth:

    T_map_odom = T_map_base(/truth/odom) inverse(T_odom_base(/odom))

so that base_link stands in map where the machine truly is, and odom in map shows how far the estimate has
drifted. Without a drive node base_link hangs directly under map; without a plant there is odom -> base_link
alone.
"""

import struct
from dataclasses import dataclass
from typing import TypeAlias

from sojourn_bags.definitions import ChannelSpec, typestore

TOPIC = "/tf"
TYPE = "tf2_msgs/TFMessage"
MAP, ODOM, BASE = "map", "odom", "base_link"

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]
"""x y z w."""
_SEVEN = struct.Struct("<7d")
_STAMP = struct.Struct("<iI")


def channel() -> ChannelSpec:
    """Channel of /tf, with the quality of service of tf2's broadcaster (keep last 100, reliable)."""
    endless = {"sec": 9223372036, "nsec": 854775807}
    return ChannelSpec(
        TOPIC,
        TYPE,
        {
            "history": "keep_last",
            "depth": 100,
            "reliability": "reliable",
            "durability": "volatile",
            "deadline": dict(endless),
            "lifespan": dict(endless),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(endless),
            "avoid_ros_namespace_conventions": False,
        },
    )


@dataclass(frozen=True)
class Transform:
    """Pose of a child frame in its parent: translation [m] and rotation."""

    translation: Vector
    rotation: Quaternion

    def inverse(self) -> "Transform":
        """The parent in the child frame."""
        x, y, z, w = self.rotation
        back = (-x, -y, -z, w)
        rotated = rotate(back, self.translation)
        return Transform((-rotated[0], -rotated[1], -rotated[2]), back)

    def __matmul__(self, other: "Transform") -> "Transform":
        """Pose of the other's child in this parent."""
        moved = rotate(self.rotation, other.translation)
        x, y, z = self.translation
        return Transform((x + moved[0], y + moved[1], z + moved[2]), multiply(self.rotation, other.rotation))


def multiply(first: Quaternion, second: Quaternion) -> Quaternion:
    """Rotation by `second`, then by `first`."""
    a, b, c, d = first
    e, f, g, h = second
    return (
        d * e + a * h + b * g - c * f,
        d * f - a * g + b * h + c * e,
        d * g + a * f - b * e + c * h,
        d * h - a * e - b * f - c * g,
    )


def rotate(rotation: Quaternion, vector: Vector) -> Vector:
    """A vector turned by a unit quaternion: v + 2 q x (q x v + w v)."""
    a, b, c, w = rotation
    x, y, z = vector
    u, v, t = b * z - c * y + w * x, c * x - a * z + w * y, a * y - b * x + w * z
    return (x + 2.0 * (b * t - c * v), y + 2.0 * (c * u - a * t), z + 2.0 * (a * v - b * u))


def pose_of_odometry(data: bytes) -> Transform:
    """Pose of a nav_msgs/Odometry in CDR: stamp, two texts, then seven doubles on multiples of 8 bytes.

    Raises struct.error for a message that is cut off.
    """
    if len(data) < 12:
        raise struct.error(f"{len(data)} bytes hold no stamp")
    order = "<" if data[1] & 1 else ">"
    offset = 12
    for _ in range(2):
        (length,) = struct.unpack_from(order + "I", data, offset)
        offset = (offset + 4 + length + 3) // 4 * 4
    offset = 4 + (offset - 4 + 7) // 8 * 8
    x, y, z, a, b, c, w = struct.unpack_from(order + "7d", data, offset)
    return Transform((x, y, z), (a, b, c, w))


class TransformTemplate:
    """CDR of a TFMessage with fixed frames, into which stamp and numbers are put.

    Args:
        links: (parent, child) of each transform.
    """

    def __init__(self, links: tuple[tuple[str, str], ...]) -> None:
        types = typestore().types
        time, header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
        stamped, message = types["geometry_msgs/msg/TransformStamped"], types["tf2_msgs/msg/TFMessage"]
        vector, quaternion = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Quaternion"]
        transform = types["geometry_msgs/msg/Transform"]
        # Marks that are found again in the serialised text: no two numbers of it are equal.
        marks = [[100.0 * number + axis + 1.5 for axis in range(7)] for number in range(len(links))]
        transforms = [
            stamped(
                header=header(stamp=time(sec=-1 - number, nanosec=0xFFFF0000 + number), frame_id=parent),
                child_frame_id=child,
                transform=transform(translation=vector(*mark[:3]), rotation=quaternion(*mark[3:])),
            )
            for number, ((parent, child), mark) in enumerate(zip(links, marks, strict=True))
        ]
        self._data = bytearray(typestore().serialize_cdr(message(transforms=transforms), "tf2_msgs/msg/TFMessage"))
        self._numbers = [self._data.index(_SEVEN.pack(*mark)) for mark in marks]
        self._stamps = [self._data.index(_STAMP.pack(-1 - number, 0xFFFF0000 + number)) for number in range(len(links))]

    def fill(self, stamp: int, transforms: tuple[Transform, ...]) -> bytes:
        """The message stamped `stamp` [ns], one transform a link."""
        seconds, nanoseconds = divmod(stamp, 1_000_000_000)
        for at_stamp, at_numbers, transform in zip(self._stamps, self._numbers, transforms, strict=True):
            _STAMP.pack_into(self._data, at_stamp, seconds, nanoseconds)
            _SEVEN.pack_into(self._data, at_numbers, *transform.translation, *transform.rotation)
        return bytes(self._data)


class TransformSource:
    """Makes /tf messages from the odometry of the run, one a stamp."""

    def __init__(self) -> None:
        self._both = TransformTemplate(((MAP, ODOM), (ODOM, BASE)))
        self._truth_only = TransformTemplate(((MAP, BASE),))
        self._odom_only = TransformTemplate(((ODOM, BASE),))

    def message(self, stamp: int, truth: bytes | None, odometry: bytes | None) -> bytes | None:
        """CDR of /tf at a stamp [ns] from the CDR of /truth/odom and /odom, or None without either."""
        if odometry is None:
            return None if truth is None else self._truth_only.fill(stamp, (pose_of_odometry(truth),))
        base_in_odom = pose_of_odometry(odometry)
        if truth is None:
            return self._odom_only.fill(stamp, (base_in_odom,))
        return self._both.fill(stamp, (pose_of_odometry(truth) @ base_in_odom.inverse(), base_in_odom))
