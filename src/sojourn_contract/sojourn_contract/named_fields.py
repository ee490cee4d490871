"""Any field of any topic by the name that a person types, read from the values of messages as they come.

    /drive/status.state                     a key of a status; `level` and `message` are those of the status itself
    /diagnostics.state[drive]               of the status that is called drive; without it, of each
    /battery_state.percentage               a number
    /odom.pose.pose.position.x              part of a vector
    /joint_states.effort[NAME], [0]         of a joint by its name or its place; without it, of each
    /truth/contacts.slip_ratio[0]           of a point of a cloud
    /imu/data.orientation.tilt_deg          from the vertical to the frame's z axis; also roll_deg, pitch_deg, yaw_deg

Names are those of ROS, as `scripts/plot` takes them. Angles of an orientation (x, y, z, w), Diebel 2006, Representing
Attitude, eq. 290; tilt = arccos(1 - 2 (x^2 + y^2)).
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from sojourn_contract.clouds import columns_of
from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import DiagnosticArray, JointState, Message, PointCloud2
from sojourn_machine.params import FloatArray

FieldValue = float | str
NEAREST = 3
_NAME = re.compile(r"(?P<topic>/[^.\[\]]+)\.(?P<path>[^\[\]]+?)(\[(?P<which>[^\[\]]+)\])?")
_AXES = "xyzw"
_ANGLES: Mapping[str, Callable[[float, float, float, float], float]] = {
    "tilt_deg": lambda x, y, z, w: math.acos(max(-1.0, min(1.0, 1.0 - 2.0 * (x * x + y * y)))),
    "roll_deg": lambda x, y, z, w: math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
    "pitch_deg": lambda x, y, z, w: math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x)))),
    "yaw_deg": lambda x, y, z, w: math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
}
_VECTORS: Mapping[str, Mapping[str, str]] = {
    "geometry_msgs/PoseStamped": {"pose.position": "position", "pose.orientation": "orientation"},
    "geometry_msgs/PoseWithCovarianceStamped": {
        "pose.pose.position": "position", "pose.pose.orientation": "orientation", "pose.covariance": "covariance",
    },
    "geometry_msgs/TwistStamped": {"twist.linear": "linear", "twist.angular": "angular"},
    "geometry_msgs/Vector3Stamped": {"vector": "vector"},
    "geometry_msgs/WrenchStamped": {"wrench.force": "force", "wrench.torque": "torque"},
    "nav_msgs/Odometry": {
        "pose.pose.position": "position", "pose.pose.orientation": "orientation", "pose.covariance": "pose_covariance",
        "twist.twist.linear": "linear", "twist.twist.angular": "angular", "twist.covariance": "twist_covariance",
    },
    "sensor_msgs/Imu": {name: name for name in ("orientation", "angular_velocity", "linear_acceleration")},
}  # fmt: skip
"""Of types with vectors: names in ROS, and in the value."""
_NUMBERS: Mapping[str, Mapping[str, str]] = {
    "sensor_msgs/BatteryState": {
        name: name
        for name in (
            "voltage", "temperature", "current", "charge", "capacity", "design_capacity", "percentage",
            "power_supply_status", "power_supply_health", "present",
        )
    },
    "nav_msgs/OccupancyGrid": {"info.resolution": "resolution", "info.width": "width", "info.height": "height"},
    "std_msgs/Header": {"frame_id": "frame"},
}  # fmt: skip
_JOINTS = ("position", "velocity", "effort")
_STATUS = "diagnostic_msgs/DiagnosticArray"
_CLOUD = "sensor_msgs/PointCloud2"
_JOINT_STATE = "sensor_msgs/JointState"


@dataclass(frozen=True)
class NamedField:
    """A field.

    Args:
        row: its topic. path: below it. which: the one of several that is meant; "": all.
    """

    row: Topic
    path: str
    which: str = ""

    @property
    def name(self) -> str:
        """As a person types it."""
        return f"{self.row.name}.{self.path}" + (f"[{self.which}]" if self.which else "")

    def values(self, message: Message) -> Iterator[tuple[str, FieldValue]]:
        """What a message of its topic has for it: (label, value), the label "" for a field that there is once. A key
        that a status lacks, a joint that is not named and a number that is not measured give nothing.
        """
        for label, value in self._all(message):
            if (not self.which or self.which == label) and not (isinstance(value, float) and math.isnan(value)):
                yield ("" if self.which else label), value

    def _all(self, message: Message) -> Iterator[tuple[str, FieldValue]]:
        if isinstance(message, DiagnosticArray):
            yield from _of_status(self.row, message, self.path)
        elif isinstance(message, JointState):
            array: FloatArray = getattr(message, self.path)
            for place, (joint, value) in enumerate(zip(message.names, array.tolist(), strict=False)):
                yield (self.which if self.which == str(place) else joint), value
        elif isinstance(message, PointCloud2):
            column = columns_of(self.row.name, message, (self.path,))[self.path]
            yield from ((str(place), value) for place, value in enumerate(column.tolist()))
        elif self.path in (numbers := _NUMBERS.get(self.row.type, {})):
            value = getattr(message, numbers[self.path])
            yield "", value if isinstance(value, str) else float(value)
        else:
            yield from self._of_vector(message)

    def _of_vector(self, message: Message) -> Iterator[tuple[str, FieldValue]]:
        vectors = _VECTORS[self.row.type]
        head, _, last = self.path.rpartition(".")
        if self.path in vectors:
            array = np.asarray(getattr(message, vectors[self.path]))
            labels: Sequence[str] = _AXES if len(array) <= len(_AXES) else [str(place) for place in range(len(array))]
            yield from zip(labels, array.tolist(), strict=False)
        elif last in _ANGLES:
            quaternion = getattr(message, vectors[head]).tolist()
            norm = math.hypot(*quaternion)
            if norm > 0.0:  # not: no orientation
                yield "", math.degrees(_ANGLES[last](*(part / norm for part in quaternion)))
        else:
            yield "", float(getattr(message, vectors[head])[_AXES.index(last)])


def named_field(text: str, table: TopicTable) -> NamedField:
    """The field of a name.

    Raises:
        UnknownFieldNameError: no such topic in the table, or no such field in its type, with the nearest. The keys of
            a status are known when one has come: see `unknown_key`.
    """
    found = _NAME.fullmatch(text)
    if found is None:
        raise UnknownFieldNameError(text, "is no field: allowed is TOPIC.FIELD or TOPIC.FIELD[WHICH]", ())
    row = table.get(found["topic"])
    if row is None:
        names = [known.name for known in table]
        raise UnknownFieldNameError(text, f"{found['topic']} is no topic of the contract", _near(found["topic"], names))
    path = found["path"]
    known = list(fields_of(row))
    if row.type not in (_STATUS, _CLOUD) and path not in known:
        reason = f"{row.type} has no such field" if known else f"fields of {row.type} cannot be read one by one"
        raise UnknownFieldNameError(text, reason, [f"{row.name}.{name}" for name in _near(path, known)])
    return NamedField(row, path, found["which"] or "")


def fields_of(row: Topic) -> Iterator[str]:
    """Names of the fields that every message of a topic has; those of statuses and clouds are in each message."""
    yield from _NUMBERS.get(row.type, ())
    if row.type == _JOINT_STATE:
        yield from _JOINTS
    for name, attribute in _VECTORS.get(row.type, {}).items():
        yield name
        if "covariance" in attribute:
            continue
        yield from (f"{name}.{axis}" for axis in (_AXES if attribute == "orientation" else _AXES[:3]))
        if attribute == "orientation":
            yield from (f"{name}.{angle}" for angle in _ANGLES)


def unknown_key(field: NamedField, message: Message) -> UnknownFieldNameError | None:
    """What is wrong with a field that a message of its topic does not have; None where it has it."""
    if isinstance(message, DiagnosticArray):
        keys = list(dict.fromkeys(key for status in message.status for key, _ in status.values))
        known = [*keys, "level", "message"]
    elif isinstance(message, PointCloud2):
        known = [point.name for point in message.fields]
    else:
        return None
    if field.path in known:
        return None
    near = [f"{field.row.name}.{name}" for name in _near(field.path, known)]
    return UnknownFieldNameError(field.name, f"is not in {field.row.name}", near)


def _of_status(row: Topic, message: DiagnosticArray, path: str) -> Iterator[tuple[str, FieldValue]]:
    """Of each status that has the key; by its name where there are several, or every role says its own."""
    named = len(message.status) > 1 or row.publisher == "all"
    for status in message.status:
        values: Mapping[str, FieldValue] = {
            "level": float(status.level), "message": status.message, **dict(status.values),
        }  # fmt: skip
        if path in values:
            yield (status.name if named else ""), as_number(values[path])


def as_number(value: FieldValue) -> FieldValue:
    """A text that is a number as one."""
    if isinstance(value, float):
        return value
    try:
        return float(value)
    except ValueError:
        return value


def _near(name: str, known: Sequence[str]) -> list[str]:
    return get_close_matches(name, known, NEAREST, 0.5) or sorted(known)[:NEAREST]
