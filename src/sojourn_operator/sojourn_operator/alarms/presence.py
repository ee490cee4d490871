"""Whether a run that is watched goes on, by what is heard of it.

It is over only where whoever keeps its time has said so: at a regular end every node says "ended". A run that stands
is silent, too, for a while or for good, and is told and waited for before it counts as lost.
"""

import time

from sojourn_contract.heartbeat import ENDED, read_heartbeats
from sojourn_contract.values import Clock, Message
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.narrator import HEARTBEATS, NODE
from sojourn_operator.alarms.params import Severity
from sojourn_operator.clock_watch import ClockWatch

RUN = "run"
SILENT_S = 5.0
"""Wall time without a message after which a run is told to be silent."""
LAST_WORDS_S = 5.0
"""Wall time, once the run has ended, within which its other nodes say that they have, too."""


class Presence:
    """Of one run.

    Args:
        keeper: role that keeps its time.

    Attributes:
        is_heard: whether anything has been. is_silent: whether it is now. is_over: whether it has come to its end.
        lost: why nothing more is waited for, in words; "" as long as something is.
    """

    def __init__(self, keeper: str) -> None:
        self._keeper = keeper
        self._time, self._heard_at = 0, 0.0
        self._ended_at: float | None = None
        self._states: dict[str, str] = {}
        self._watch = ClockWatch(0)
        self.is_heard = self.is_silent = self.is_over = False
        self.lost = ""

    def hear_time(self, message: Clock) -> None:
        """A word of the clock that has just come."""
        self.is_heard, self._heard_at, self._time = True, time.monotonic(), message.stamp
        if self._ended_at is None:  # another run after its end is nobody's concern
            self.lost = self.lost or self._watch.look(self._time)

    def hear(self, topic: str, message: Message) -> None:
        """Any other message that has just come."""
        self.is_heard, self._heard_at = True, time.monotonic()
        self._watch = ClockWatch(self._time)  # whoever says why it stands is there: it may go on
        if topic == HEARTBEATS:
            self._states |= {beat.role: beat.state for beat in read_heartbeats(message)}
        if self._ended_at is None and self._states.get(self._keeper) == ENDED:
            self._ended_at = self._heard_at

    def look(self, stamp: int) -> list[Event]:
        """What is to be told now, at a simulation time [ns]."""
        now = time.monotonic()
        if self._ended_at is not None:
            self.is_silent = False
            have_ended = all(state == ENDED for state in self._states.values())
            self.is_over = have_ended or now > self._ended_at + LAST_WORDS_S
            return []
        if not self.is_heard:
            return []
        is_silent, before = now > self._heard_at + SILENT_S, self.is_silent
        self.is_silent, self.lost = is_silent, self.lost or self._watch.look(self._time)
        events = []
        if is_silent and not before:
            text = f"nothing has been heard of it for {SILENT_S:g} s: it stands, or has ended without a word"
            events.append(Event(stamp, RUN, NODE, Severity.CRITICAL, text))
        if before and not is_silent:
            events.append(Event(stamp, RUN, NODE, Severity.NONE, "is heard again"))
        if self.lost:
            events.append(Event(stamp, RUN, NODE, Severity.CRITICAL, self.lost))
        return events
