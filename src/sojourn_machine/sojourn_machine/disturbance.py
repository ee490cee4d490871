"""What happens to messages on their way between the nodes of a run, and to the nodes themselves, from when to when.

Whoever waits for messages in lock-step has to know it beforehand, so that it is a plain value of the run and not news:
which messages it meets, what becomes of them, from which stamp on.
"""

from typing import Literal, NamedTuple, TypeAlias

from sojourn_machine.chance import chance
from sojourn_machine.timing import CONTROL_PERIOD_NS

Effect: TypeAlias = Literal["lost", "late", "twice", "corrupted", "shifted", "restarted", "killed"]
FOR_EVER = 2**62
"""End of what stays [ns]."""


class Disturbance(NamedTuple):
    """One of them."""

    effect: Effect
    topic: str
    """Whose messages; empty: all of the role."""
    role: str
    """Whose messages, or the one that is restarted or killed; empty: that of the topic."""
    begin: int
    """Stamp of the first message that it may meet [ns]."""
    end: int = FOR_EVER
    """Stamp of the first one after it [ns]."""
    probability: float = 1.0
    """That it meets a message."""
    delay: int = 0
    """Of late ones [ns]."""
    shift: int = 0
    """By which stamps are ahead, where clocks are off [ns]."""
    stream: int = 0
    """Of its random numbers."""

    @property
    def begins_anew(self) -> int | None:
        """Stamp from which on its node is another one [ns]; None where it never is, or is not killed at all."""
        if self.effect == "restarted":
            return self.begin
        return self.end if self.effect == "killed" and self.begin < self.end < FOR_EVER else None

    def meets(self, stamp: int) -> bool:
        """Whether it meets the message of a stamp [ns]."""
        if not self.begin <= stamp < self.end:
            return False
        return self.probability >= 1.0 or chance(self.stream, 0, stamp // CONTROL_PERIOD_NS) < self.probability
