"""Errors of the stack."""


class StackError(Exception):
    """Base of all errors of this package."""


class WaitingError(StackError):
    """A role waits for a message that nobody sends.

    Args:
        role: that waits. topic: of the message. stamp_s: simulation time [s].
    """

    def __init__(self, role: str, topic: str, stamp_s: float) -> None:
        super().__init__(f"{role} waits for {topic} stamped {stamp_s:.2f} s, which nobody sends")
        self.role, self.topic, self.stamp_s = role, topic, stamp_s
