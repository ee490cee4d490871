"""What is said to a run with a link to Earth, over the link or round it, and what the Earth knows of it.

Over the link a goal, a stop, a pause goes to the operator's role on Earth, as from `scripts/goal`; questions and
sequences go round it, and all that is shown but the link itself is the machine as it is.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from sojourn_console.errors import GoalError
from sojourn_console.feed import Feed, FeedMessage
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import status_values
from sojourn_contract.link_topics import CANCEL, COMMANDS, EARTH, LINK_STATUS
from sojourn_contract.linked_table import telemetry
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.values import DiagnosticArray, Header, Message
from sojourn_operator.goal_messages import QUESTION
from sojourn_operator.link.commands import KEPT, MOVES, QUEUED, RECEIVED, ROLE_OF, SENT
from sojourn_physics.link.params import LinkParams

NUMBER = "command "
"""Before the number of a command in /link/status."""
TIMES = ("queued_s", "sent_s", "received_s")
"""Of a command there [s]; empty for what has not been."""


class LinkMoment(NamedTuple):
    """Of a link, as far as the page has been told.

    Args:
        light_s: time that light takes [s]. is_open: the window. expires_s: of a command that waits, None for never.
    """

    light_s: float
    is_open: bool
    expires_s: float | None


class Uplink:
    """Of one run.

    Args:
        feed: to the run. link: of its scenario, None where it has none. table: its topics.

    Attributes:
        is_used: whether goals and stops go over the link.
    """

    def __init__(self, feed: Feed, link: LinkParams | None, table: TopicTable) -> None:
        self._feed = feed
        self.is_there = self.is_used = link is not None
        self._expires_s = None if link is None else link.expires_s
        carried = [] if link is None else [row.name for row, _ in telemetry(table, link)]
        self.telemetry = tuple(EARTH + name for name in carried)
        """Topics of what the Earth receives."""
        self._status: DiagnosticArray | None = None
        self._received: dict[str, FeedMessage] = {}
        self._said: dict[tuple[str, int], None] = {}
        """Goals of which the Earth has not told yet, by topic and stamp [ns]."""
        self._names: dict[tuple[str, str], str] = {}

    @property
    def now(self) -> int:
        """Simulation time [ns]."""
        return self._feed.now

    @property
    def topics(self) -> frozenset[str]:
        """That it goes by."""
        return frozenset((LINK_STATUS.name, *self.telemetry)) if self.is_there else frozenset()

    @property
    def state(self) -> Mapping[str, str]:
        """Of the link, empty before it has been told."""
        return {} if self._status is None else status_values(self._status)

    def moment(self) -> LinkMoment:
        """How it is now."""
        light = float(self.state.get("light_time_s", "nan"))
        return LinkMoment(light, self.state.get("window") == "open", self._expires_s)

    def send(self, name: str, message: Message) -> None:
        """Say something on a topic of the operator. Raises GoalError."""
        over = self.is_used and name in COMMANDS and name != QUESTION
        self._feed.send(EARTH + name if over else name, message)
        if over and name in MOVES:
            self._said[name, message.stamp] = None

    def waiting(self) -> tuple[str, ...]:
        """Numbers of the commands that have not left the Earth."""
        return tuple(number for number, values in self.commands() if values.get("state") == QUEUED)

    def take_back(self, numbers: Sequence[str]) -> str:
        """Take back commands that wait on Earth. Returns which, in words. Raises GoalError."""
        gone = set(numbers) - set(self.waiting())
        if gone or not numbers:
            what = f"{NUMBER}{', '.join(sorted(gone))}" if gone else "take back"
            raise GoalError(what, "nothing of that waits on Earth: what has left it can be stopped alone")
        for number in numbers:  # each by itself: all would be the stop, too, that comes behind
            self._feed.send(CANCEL.name, Header(self.now, number))
        return f"{NUMBER}{', '.join(numbers)} is taken back"

    def hear(self, heard: Sequence[FeedMessage]) -> None:
        """Messages that have come."""
        for one in heard:
            if one.row.name in self.telemetry:
                self._received[one.row.name] = one
            if one.row.name == LINK_STATUS.name:
                try:
                    self._status = _checked(decode(one.row, one.data))
                except (RefusedMessageError, KeyError, ValueError):
                    continue  # the scene counts it; a stranger's has not the numbers
                for _, values in self.commands():
                    self._said.pop((values.get("topic", ""), int(values.get("goal_stamp", "0"))), None)

    def commands(self) -> Iterator[tuple[str, dict[str, str]]]:
        """The last ones: number, and what the Earth knows of each."""
        for status in () if self._status is None else self._status.status[1:]:
            yield status.name.removeprefix(NUMBER), dict(status.values)

    def name(self, topic: str, stamp: int, words: str) -> None:
        """Remember what a goal that was sent from here is called. stamp: of it [ns]."""
        self._names[topic, str(stamp)] = words
        for old in list(self._names)[:-KEPT]:
            del self._names[old]

    def name_of(self, values: Mapping[str, str]) -> str:
        """What a command is called, its topic where it is not from here. values: of it in /link/status."""
        topic = values.get("topic", "?")
        return self._names.get((topic, values.get("goal_stamp", "")), topic)

    def command(self, name: str, stamp: int) -> dict[str, str]:
        """What the Earth knows of a command on a topic with a stamp [ns]; empty: nothing yet."""
        wanted = (name, str(stamp))
        found = (
            values | {"number": number}
            for number, values in self.commands()
            if (values.get("topic"), values.get("goal_stamp")) == wanted
        )
        return next(found, {})

    def machine_stamp(self, name: str, stamp: int) -> str:
        """Stamp by which the machine tells of a goal that was sent with a stamp [ns]: that of the receiver where it has
        gone over the link, "0" as long as the Earth does not know it.
        """
        return self.command(name, stamp).get("machine_stamp", str(stamp))

    def moves(self) -> frozenset[str]:
        """Roles for which a goal has left the Earth of whose end it does not know."""
        left = {
            values["topic"]
            for _, values in self.commands()
            if values.get("state") in (SENT, RECEIVED) and values.get("topic") in MOVES
        }
        return frozenset(ROLE_OF[name] for name in (*left, *(name for name, _ in self._said)))

    def newest(self) -> FeedMessage | None:
        """Of telemetry, by its stamp on the machine."""
        return max(self._received.values(), key=lambda one: one.time, default=None)

    def received(self, name: str) -> tuple[Mapping[str, str], int] | None:
        """Last status of a topic that the Earth has, and its stamp on the machine [ns]."""
        one = self._received.get(EARTH + name)
        if one is None:
            return None
        try:
            return status_values(decode(one.row, one.data)), one.time
        except RefusedMessageError:
            return None

    def aside(self) -> str:
        """How what is sent now goes, in words; nothing where it goes at once."""
        if not self.is_used:
            return ""
        if not self.state:
            return "over the link"
        link = self.moment()
        waits = "" if link.is_open else ", which is closed: it waits on Earth"
        return f"over the link{waits}; light takes {link.light_s:.1f} s"

    def clear(self) -> None:
        """Time has jumped."""
        self._status = None
        self._received.clear()
        self._said.clear()


def _checked(status: DiagnosticArray) -> DiagnosticArray:
    """The same, if its numbers can be read. Raises KeyError, ValueError."""
    link = status_values(status)
    float(link["light_time_s"])
    for way in ("up", "down"):
        int(link[f"{way}_waiting"]), float(link[f"{way}_waiting_bits"])
    for command in status.status[1:]:
        values = dict(command.values)
        int(values.get("goal_stamp", "0"))
        for name in TIMES:
            float(values.get(name) or "0")
    return status
