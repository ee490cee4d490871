"""The alarms of a run and its one log, as a page has them: what is heard goes in, what is the matter comes out."""

from collections import deque

from sojourn_console.errors import AlarmError
from sojourn_console.feed import FeedMessage
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_operator.alarms.engine import Alarm
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.params import AlarmParams, Severity
from sojourn_operator.alarms.watch import Watch, WatchState

KEPT = 20_000
"""Entries of the log; of more the oldest are forgotten."""
MOST_AT_ONCE = 500
"""Messages that are judged at one look: after a jump in a bag the rest follows, and the page goes on meanwhile."""
JUDGE = "contract"


class AlarmBoard:
    """Of one run.

    Args:
        watch: by which it is watched. who: acknowledges.

    Attributes:
        log: what has happened, the latest last. topics: that it judges, every message of them.
    """

    def __init__(self, watch: Watch, who: str) -> None:
        self._watch, self._who = watch, who
        self._state: WatchState = watch.initial_state()
        self._waiting: deque[FeedMessage] = deque()
        self.log: deque[Event] = deque(maxlen=KEPT)
        self.topics = frozenset(watch.topics)

    @property
    def shown(self) -> list[Alarm]:
        """Alarms that are active or have not been acknowledged, the worst first."""
        return self._state.alarms.shown

    @property
    def open(self) -> list[Alarm]:
        """Those of them that nobody has acknowledged."""
        return [alarm for alarm in self.shown if not alarm.acknowledged]

    @property
    def behind(self) -> int:
        """Messages that are still to be judged."""
        return len(self._waiting)

    def limits(self, alarm: Alarm) -> AlarmParams:
        """By which an alarm is judged."""
        return self._watch.engine.limits[alarm.name]

    def hear(self, heard: list[FeedMessage]) -> Severity:
        """Judge messages, as many as fit into a look. Returns the worst that has risen."""
        self._waiting.extend(one for one in heard if one.row.name in self.topics)
        risen = Severity.NONE
        for _ in range(min(len(self._waiting), MOST_AT_ONCE)):
            events = self._judged(self._waiting.popleft())
            self.log += events
            risen = max((risen, *(event.severity for event in events)))
        return risen

    def acknowledge(self, key: str = "") -> str:
        """Somebody has seen an alarm, all where none is named. Returns what has been, in words. Raises AlarmError."""
        known = [alarm.key for alarm in self.open]
        if not known or (key and key not in known):
            raise AlarmError(key or "acknowledge", f"allowed is {' or '.join(known)}" if known else "there is no alarm")
        self._state, events = self._watch.acknowledge(self._state, self._who, [key] if key else [])
        self.log += events
        return f"{key or f'{len(known)} alarms'} acknowledged by {self._who}"

    def clear(self) -> None:
        """Time has jumped: nothing of before holds."""
        self._state = self._watch.initial_state()
        self._waiting.clear()
        self.log.clear()

    def _judged(self, heard: FeedMessage) -> list[Event]:
        try:
            message = decode(heard.row, heard.data)
        except RefusedMessageError as refusal:
            return [Event(heard.time, JUDGE, JUDGE, Severity.NONE, str(refusal))]
        self._state, events = self._watch.step(self._state, heard.row.name, message)
        return events
