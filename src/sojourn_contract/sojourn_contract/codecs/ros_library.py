"""Messages of types without a codec of ours: the ROS library makes their bytes, and these are the value.

So a sensor may say anything of common_interfaces that begins with a header. It costs what the library takes, some tens
of microseconds a message; a type that is said often deserves a codec of its own. The library is loaded with the first
such message: who reads a bag without one does not wait for it.
"""

from functools import cache
from typing import Any

from sojourn_contract import stamps
from sojourn_contract.types import message_class
from sojourn_contract.values import Serialised


class RosLibraryCodec:
    """Of one type "package/Name"."""

    def __init__(self, kind: str) -> None:
        self._kind = kind

    def encode(self, value: Serialised) -> bytes:
        """Its bytes. Raises TypeError for a value of another type."""
        if not isinstance(value, Serialised) or value.type != self._kind:
            raise TypeError(f"a {getattr(value, 'type', type(value).__name__)} is no {self._kind}")
        return value.cdr

    def decode(self, data: bytes) -> Serialised:
        """The value in these bytes. Raises whatever the library raises for what it cannot read."""
        from rclpy.serialization import deserialize_message

        deserialize_message(data, message_class(self._kind))
        return Serialised(stamps.from_cdr(data), self._kind, data)


@cache
def codec_of(kind: str) -> RosLibraryCodec:
    """Of a type by its name."""
    return RosLibraryCodec(kind)


def serialised(message: Any) -> Serialised:
    """The value of a message of the ROS library. Raises ValueError for a type without a header."""
    from rclpy.serialization import serialize_message

    kind = f"{type(message).__module__.partition('.')[0]}/{type(message).__name__}"
    first = next(iter(type(message).get_fields_and_field_types().values()), "")
    if first != "std_msgs/Header":
        raise ValueError(f"a {kind} has no header: it cannot be stamped")
    cdr = bytes(serialize_message(message))
    return Serialised(stamps.from_cdr(cdr), kind, cdr)


def stamped(message: Any, stamp: int, frame: str) -> Serialised:
    """The value of a message of the ROS library with a stamp [ns] and a frame. Raises ValueError as `serialised`."""
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, stamps.NANOSECONDS)
    message.header.frame_id = frame
    return serialised(message)


def message_of(value: Serialised) -> Any:
    """The message of the ROS library that a value is."""
    from rclpy.serialization import deserialize_message

    return deserialize_message(value.cdr, message_class(value.type))
