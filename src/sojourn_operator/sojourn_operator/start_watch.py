"""What a stack that has not begun yet is waiting for, as its heartbeats tell, and before them who holds its roles."""

import re
import time
from collections.abc import Callable, Collection

from sojourn_config.command_line import say
from sojourn_contract.heartbeat import READY, WAITING_TO_MATCH, Heartbeat, read_heartbeats
from sojourn_contract.topics import ROLES
from sojourn_contract.values import DiagnosticArray

LIFE_S = 3.0
"""Wall time after which a node that has said nothing more is not starting any more; they say so some times a second."""
GRACE_S = 2.0
"""Wall time in which a stack that runs is heard, for whoever has just come: before that nothing is said of one of which
nothing but its processes is known."""
_ROLE = re.compile(rf"(?<![/\w])({'|'.join(ROLES)})(?![/\w])")
"""A role by its name in what a node says; a topic that begins with it is none."""


class StartWatch:
    """Hears heartbeats, and says in a line what a stack waits for, once each time that it is something else.

    Args:
        held: the roles that processes of this machine hold. say: called with the line. clock: wall time [s].
    """

    def __init__(
        self,
        held: Callable[[], Collection[str]],
        say: Callable[[str], None] = say,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._held, self._say, self._clock = held, say, clock
        self._has_begun, self._since = False, clock()
        self._heard: dict[str, tuple[float, Heartbeat]] = {}
        """By role when it was heard last, and what it said."""
        self._told = ""

    def hear(self, message: DiagnosticArray) -> None:
        """A message of /diagnostics."""
        for beat in read_heartbeats(message):
            if beat.stamp == 0 and beat.state in (READY, WAITING_TO_MATCH):
                self._heard[beat.role] = self._clock(), beat
            elif beat.role in ROLES:
                self._heard.pop(beat.role, None)
                self._has_begun = True

    def is_starting(self) -> bool:
        """Whether some node of a stack gets ready; if so it is said for whom it waits."""
        now = self._clock()
        self._heard = {role: heard for role, heard in self._heard.items() if now - heard[0] < LIFE_S}
        beats = [beat for _, beat in self._heard.values()]
        held = set() if beats or self._has_begun else set(self._held())
        ready = {beat.role for beat in beats if beat.state == READY}
        asked_for = {role for beat in beats if beat.role not in ready for role in _ROLE.findall(beat.detail)}
        waiting = asked_for - ready or {beat.role for beat in beats} - ready or held or {"plant"}
        words = f"the stack is starting: waiting for {', '.join(sorted(waiting))}"
        if (beats or (held and now - self._since > GRACE_S)) and words != self._told:
            self._told = words
            self._say(words)
        return bool(beats or held)
