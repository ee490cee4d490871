"""Messages to bytes, as a subscription over the middleware gets them."""

from typing import Any

from rclpy.serialization import serialize_message

from sojourn_bags.layout import layout_of
from sojourn_contract.topic_types import Topic

JOINT_STATE = "sensor_msgs/JointState"


class Encoder:
    """Keeps the lengths that it has found: of a topic's messages few differ."""

    def __init__(self) -> None:
        self._lengths: dict[tuple[str, int, tuple[str, ...]], int] = {}

    def encoded(self, row: Topic, message: Any) -> bytes:
        """CDR of a message, cut to its exact length.

        The ROS library leaves room for the alignment of numbers of 8 bytes behind the length of an array, even where
        the array is empty; what is sent ends with the length.
        """
        data: bytes = serialize_message(message)
        if row.type == JOINT_STATE and not len(message.effort):
            key = (row.name, len(data), tuple(message.name))
            if key not in self._lengths:
                self._lengths[key] = _length(row, data)
            return data[: self._lengths[key]]
        return data[: _length(row, data)] if row.is_event else data


def _length(row: Topic, data: bytes) -> int:
    package, _, name = row.type.partition("/")
    return layout_of(f"{package}/msg/{name}", data).size
