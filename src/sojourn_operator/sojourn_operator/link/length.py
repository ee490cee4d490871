"""How long a message is on the way to the Earth and back.

The sum of its fields as ROS has them, without padding: 8 bytes a number and a stamp, 4 bytes before a text, an array or
a list, 1 byte a flag. So a double counts as it is sent, and a field of 32 bits twice.
"""

from collections.abc import Sequence

import numpy as np

from sojourn_contract.values import Message

_NUMBER, _COUNT = 8, 4


def bits(message: Message) -> int:
    """Length of a message [bit]."""
    return 8 * _bytes(message)


def _bytes(value: object) -> int:
    if isinstance(value, np.ndarray):
        return int(value.nbytes)
    if isinstance(value, bytes):
        return _COUNT + len(value)
    if isinstance(value, str):
        return _COUNT + len(value.encode()) + 1
    if isinstance(value, bool):
        return 1
    if hasattr(value, "_fields"):  # a message, or one within it
        return sum(map(_bytes, value))  # type: ignore[call-overload]
    if isinstance(value, Sequence):
        return _COUNT + sum(map(_bytes, value))
    return _NUMBER
