"""Bytes to messages. Whatever a library or a check makes of bytes that are no such message, it is one refusal here, the
same for every listener: nodes, recorder, supervisor and tools.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
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


@contextmanager
def refusing(topic: str, what: str, data: bytes | None = None) -> Iterator[None]:
    """Within it every error is a RefusedMessageError of `topic`: `what` was to be made of the message, and could not.

    For the reading of what others have sent, and for nothing else: an error of our own must not look like theirs.
    """
    try:
        yield
    except RefusedMessageError:
        raise
    except Exception as error:
        raise unreadable(topic, what, error, data) from error


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
