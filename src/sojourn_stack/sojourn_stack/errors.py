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


class MisfitError(StackError):
    """A state that a run cannot go on from.

    Args:
        place: where in the state. reason: in words.
    """

    def __init__(self, place: str, reason: str) -> None:
        super().__init__(f"the run cannot go on from this checkpoint: {place}: {reason}")
        self.place, self.reason = place, reason
