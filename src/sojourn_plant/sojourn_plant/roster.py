"""Who takes part in the run, as far as the plant has heard: who is ready, and who waits for whom."""

import time
from collections.abc import Iterable

from sojourn_contract.checkpoint_topic import RESUMED
from sojourn_contract.errors import NotReadyError
from sojourn_contract.heartbeat import MATCHED, READY, STALLED, WAITING_FOR, WAITING_TO_MATCH, Heartbeat

RECORDER = "recorder"
"""It has no state from which it could go on."""
REPORT_LIFE = 0.75
"""Part of the time-out for which a node's word of whom it waits for counts; it repeats it every half of it."""


class Roster:
    """Heartbeats of the participants.

    Args:
        role: the plant's own. participants: all roles of the run. timeout_s: that of lock-step [s].
        resumed_at: stamp of the state from which all but the recorder are to go on [ns], 0 where the run begins.
    """

    def __init__(self, role: str, participants: Iterable[str], timeout_s: float, resumed_at: int = 0) -> None:
        self._role = role
        self._others = [other for other in participants if other != role]
        self._timeout_s = timeout_s
        self._resumed_at = resumed_at
        self._ready: set[str] = set()
        self._heard_at: dict[str, float] = {}
        self.heard: dict[str, Heartbeat] = {}
        """Last heartbeat of each role."""

    def hear(self, beats: Iterable[Heartbeat]) -> None:
        """Take heartbeats that have just come."""
        for beat in beats:
            self.heard[beat.role] = beat
            self._heard_at[beat.role] = time.monotonic()
            could_begin = beat.state == STALLED and MATCHED in beat.values  # a stranger has spoken before the run
            if (beat.state == READY or could_begin) and self._goes_on(beat):
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
        if missing and self.heard[missing[0]].state == READY:
            reason = f"it is not resumable: its heartbeat does not say {RESUMED} = {self._resumed_at}"
            return NotReadyError(missing[0], reason, waited_s)
        if missing:
            return NotReadyError(missing[0], self.heard[missing[0]].detail, waited_s)
        return NotReadyError(self._role, "; ".join(unmatched), waited_s)

    def _goes_on(self, beat: Heartbeat) -> bool:
        """Whether a node that is ready has got its state, where it is to go on from one."""
        told = not self._resumed_at or beat.values.get(RESUMED) == str(self._resumed_at)
        return told or beat.role == RECORDER

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
