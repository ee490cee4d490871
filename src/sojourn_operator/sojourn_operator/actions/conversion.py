"""Messages of ROS to values of the contract, and back, by their bytes: one reader and one writer for both."""

from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from sojourn_contract.checks import check_message
from sojourn_contract.codecs import decode, encode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Message


def value_of(row: Topic, message: Any) -> Message:
    """The value of a row's type. Raises RefusedMessageError for one that no node may take, or a frame that the row does
    not have.
    """
    value = decode(row, serialize_message(message))
    check_message(row.name, value)
    frame = getattr(value, "frame", "")
    if row.frames and frame not in row.frames:
        raise RefusedMessageError(row.name, "header.frame_id", repr(frame), "one of " + ", ".join(row.frames))
    return value


def ros_message(row: Topic, value: Message) -> Any:
    """The message of ROS with a value of a row's type."""
    return deserialize_message(encode(row, value), message_class(row.type))


def duration(message: Any, nanoseconds: int) -> None:
    """Set a builtin_interfaces/Duration; not below zero."""
    message.sec, message.nanosec = divmod(max(nanoseconds, 0), 1_000_000_000)
