"""Bytes to messages. Whatever a library or a check makes of bytes that are no such message, it is one refusal here, the
same for every listener: nodes, recorder, supervisor and tools.
"""

from collections.abc import Callable
from types import TracebackType
from typing import Any

from rclpy.serialization import deserialize_message

from sojourn_contract import stamps
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError, unreadable
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Message

STAMP_BYTES = 12
"""Encapsulation header, seconds and nanoseconds: every message of the contract begins with them."""


class refusing:
    """Within it every error is a RefusedMessageError of `topic`: `what` was to be made of the message, and could not.

    For the reading of what others have sent, and for nothing else: an error of our own must not look like theirs. It is
    a class, as an error that leaves a generator holds on to itself: what was refused would stay for the garbage
    collector, which comes seldom.
    """

    __slots__ = ("_data", "_topic", "_what")

    def __init__(self, topic: str, what: str, data: bytes | None = None) -> None:
        self._topic, self._what, self._data = topic, what, data

    def __enter__(self) -> None:
        """See the class."""

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Raises RefusedMessageError for any error of another kind."""
        if isinstance(error, Exception) and not isinstance(error, RefusedMessageError):
            raise unreadable(self._topic, self._what, error, self._data) from error


def stamp_of(topic: str, data: bytes) -> int:
    """Stamp [ns] of a serialised message. Raises RefusedMessageError for bytes that are too few to hold one."""
    if len(data) < STAMP_BYTES:
        raise RefusedMessageError(topic, "message", f"{len(data)} bytes", f"at least {STAMP_BYTES}, to hold a stamp")
    return stamps.from_cdr(data)


def decoded(topic: str, kind: str, data: bytes) -> Any:
    """The message of type "package/Name" in these bytes, as the ROS library reads it: for the judge, who does not lean
    on our own codecs. Raises RefusedMessageError where they hold none.
    """
    with refusing(topic, f"a serialised {kind}", data):
        return deserialize_message(data, message_class(kind))


def hearing(row: Topic, take: Callable[[Message], None], refuse: Callable[[RefusedMessageError], None]) -> Any:
    """Callback of a raw subscription of a row that gives each value to `take`; what is none, or what `take` cannot
    read, is given to `refuse`.
    """

    def hear(data: bytes) -> None:
        try:
            message = decode(row, data)
            with refusing(row.name, f"a {row.type} that can be read"):
                take(message)
        except RefusedMessageError as refusal:
            refuse(refusal)

    return hear
