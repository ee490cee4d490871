"""What a codec is: a message's value to the bytes that go over the wire, and back."""

from typing import Any, Protocol


class Codec(Protocol):
    """Of one type of message."""

    def encode(self, value: Any) -> bytes:
        """CDR of a value. Raises ValueError, TypeError, struct.error for what the type cannot hold."""
        ...

    def decode(self, data: bytes) -> Any:
        """The value in these bytes; what stands behind it is passed over. Raises CdrError, struct.error."""
        ...
