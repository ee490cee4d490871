"""Who takes part in the run, as far as the plant has heard: who is ready, and who waits for whom."""

import time
from collections.abc import Iterable

from sojourn_contract.errors import NotReadyError
from sojourn_contract.heartbeat import READY, WAITING_FOR, WAITING_TO_MATCH, Heartbeat

REPORT_LIFE = 0.75
"""Part of the time-out for which a node's word of whom it waits for counts; it repeats it every half of it."""


class Roster:
    """Heartbeats of the participants.

    Args:
        role: the plant's own. participants: all roles of the run. timeout_s: that of lock-step [s].
    """

    def __init__(self, role: str, participants: Iterable[str], timeout_s: float) -> None:
        self._role = role
        self._others = [other for other in participants if other != role]
        self._timeout_s = timeout_s
        self._ready: set[str] = set()
        self._heard_at: dict[str, float] = {}
        self.heard: dict[str, Heartbeat] = {}
        """Last heartbeat of each role."""

    def hear(self, beats: Iterable[Heartbeat]) -> None:
        """Take heartbeats that have just come."""
        for beat in beats:
            self.heard[beat.role] = beat
            self._heard_at[beat.role] = time.monotonic()
            if beat.state == READY:
                self._ready.add(beat.role)
            elif beat.state == WAITING_TO_MATCH:
                self._ready.discard(beat.role)

    def missing(self) -> list[str]:
        """Participants that are not ready."""
        return [role for role in self._others if role not in self._ready]

    def not_ready(self, unmatched: list[str], waited_s: float) -> NotReadyError:
        """Name a node that has not been heard at all before those that wait for it."""
        missing = self.missing()
        for role in missing:
            if role not in self.heard:
                return NotReadyError(role, "no heartbeat has come from it", waited_s)
        if missing:
            return NotReadyError(missing[0], self.heard[missing[0]].detail, waited_s)
        return NotReadyError(self._role, "; ".join(unmatched), waited_s)

    def waits_for(self, role: str) -> str:
        """Whom a node says that it waits for; empty where it says nothing, or has not said it again of late."""
        if time.monotonic() - self._heard_at.get(role, 0.0) > REPORT_LIFE * self._timeout_s:
            return ""
        return self.heard[role].values.get(WAITING_FOR, "")

    def root_of_silence(self, role: str) -> str:
        """Follow from a node that is silent to the one that does not say that it waits for another."""
        seen = {self._role}
        while (whom := self.waits_for(role)) and whom not in seen:
            seen.add(role)
            role = whom
        return role
