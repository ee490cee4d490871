"""Watches a running stack, and takes the words of whoever sits at the terminal."""

import select
import sys
import time
from functools import partial

from sojourn_bringup.alarm_lines import alarm_lines
from sojourn_bringup.contract_live import NothingRunsError
from sojourn_config.command_line import say
from sojourn_contract.codecs import encode
from sojourn_contract.topic_table import CLOCK
from sojourn_contract.values import Message
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.presence import Presence
from sojourn_operator.alarms.watch import TOPIC, Watch, WatchState
from sojourn_operator.desk import Desk

FOUND_S = 20.0
"""Wall time within which a stack must be heard."""
SAY_S = 1.0
"""Between two messages on /alarms, if nothing happens."""
HELP = "a: acknowledge all, a NAME: one, l: list, q: end"


class AlarmDesk(Desk):
    """A context manager.

    Args:
        domain, namespace: where the stack is. watch: by which it is watched. who: acknowledges.
    """

    def __init__(self, domain: int, namespace: str, watch: Watch, who: str) -> None:
        super().__init__("alarms", domain, namespace)
        self.watch, self.who = watch, who
        self.state: WatchState = watch.initial_state()
        self.log: list[Event] = []
        self._presence = Presence(watch.keeper)
        self._ends = False

    def run(self, seconds: float | None, publish: bool) -> bool:
        """Watch for so long [s], or until the run is over or lost. Returns whether it was not silent at the end. Raises
        NothingRunsError if there is none.
        """
        presence = self._presence
        clock = self.listen(self.watch.table.topic(CLOCK), presence.hear_time, lockstep=False)
        readers = [
            self.listen(row, partial(self._take, row.name), role="recorder")
            for row in map(self.watch.table.topic, self.watch.topics)
        ]
        row = self.watch.table.topic(TOPIC)
        sender = self.sender(row) if publish else None
        begin, said, told = time.monotonic(), 0.0, 0
        somebody_types = True
        if sys.stdin is not None and sys.stdin.isatty():
            say(HELP)
        while not self.stop.is_set and not self._ends and (seconds is None or time.monotonic() - begin < seconds):
            self.spin(0.05)
            somebody_types = somebody_types and self._listen_to_person()
            now = time.monotonic()
            if sender is not None and (now - said > SAY_S or len(self.log) > told):
                sender.publish(encode(row, self.watch.message(self.state)))
                said, told = now, len(self.log)
            if not presence.is_heard and now - begin > FOUND_S:
                raise NothingRunsError(f"nothing was heard on {self.place} (start a stack with scripts/start.py)")
            self._tell(presence.look(self.state.now))
            if presence.lost:
                break
            if presence.is_over:
                say("the run is over")
                break
        del readers, clock
        return not (presence.is_silent or presence.lost)

    def _take(self, topic: str, message: Message) -> None:
        self._presence.hear(topic, message)
        self.state, events = self.watch.step(self.state, topic, message)
        self._tell(events)

    def _tell(self, events: list[Event]) -> None:
        self.log += events
        for event in events:
            say(event.line())

    def _listen_to_person(self) -> bool:
        """Obey what has been typed, if anything. False once nobody can type any more."""
        if sys.stdin is None:  # started with its input closed
            return False
        if not select.select([sys.stdin], [], [], 0.0)[0]:
            return True
        line = sys.stdin.readline()
        self.obey(line)
        return bool(line)

    def obey(self, line: str) -> None:
        """What somebody has typed."""
        word, _, key = line.strip().partition(" ")
        if word == "q":
            self._ends = True
        elif word == "l":
            say("\n".join(alarm_lines(self.watch, self.state)))
        elif word == "a":
            try:
                self.state, events = self.watch.acknowledge(self.state, self.who, [key] if key else [])
            except KeyError:
                say(f"{key!r}: allowed is one of " + (", ".join(one.key for one in self.state.alarms.shown) or "none"))
            else:
                self._tell(events)
        elif word:
            say(f"{word!r}: allowed is " + HELP)
