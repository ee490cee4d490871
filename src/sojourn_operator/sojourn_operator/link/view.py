"""What people on Earth hear over a link: the state of their commands, and telemetry. For programs beside a stack."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from sojourn_contract.heartbeat import status_values
from sojourn_contract.link_topics import LINK_STATUS, on_earth
from sojourn_contract.topics import topic
from sojourn_contract.values import DiagnosticArray
from sojourn_operator.desk import Desk
from sojourn_operator.link.commands import EXECUTED, OVER, QUEUED, RECEIVED, SENT

ORDER = (QUEUED, SENT, RECEIVED, EXECUTED)


class LinkView:
    """Listens at a desk.

    Args:
        desk: that it sits at. statuses: topic of each role that tells of itself.
    """

    def __init__(self, desk: Desk, statuses: Mapping[str, str]) -> None:
        self.telemetry: dict[str, DiagnosticArray] = {}
        """Last status of each role that has come down."""
        self._status: DiagnosticArray | None = None
        self._reader: Any = desk.listen(LINK_STATUS, self._keep)
        self._readers = [desk.listen(on_earth(topic(name)), self._keep_of(who)) for who, name in statuses.items()]

    @property
    def is_there(self) -> bool:
        """Whether the run has a link."""
        return bool(self._reader.get_publisher_count())

    @property
    def state(self) -> dict[str, str]:
        """Of the link, empty before it has told it."""
        return {} if self._status is None else status_values(self._status)

    def commands(self) -> Iterator[tuple[str, dict[str, str]]]:
        """The last ones: number, and what the Earth knows of each."""
        for status in () if self._status is None else self._status.status[1:]:
            yield status.name.removeprefix("command "), dict(status.values)

    def command(self, name: str, stamp: int) -> dict[str, str]:
        """What the Earth knows of the command on a topic with a stamp [ns]; empty: nothing yet."""
        wanted = (name, str(stamp))
        found = [
            values | {"number": number}
            for number, values in self.commands()
            if (values.get("topic"), values.get("goal_stamp")) == wanted
        ]
        return found[-1] if found else {}

    def _keep(self, message: DiagnosticArray) -> None:
        self._status = message

    def _keep_of(self, who: str) -> Callable[[DiagnosticArray], None]:
        def keep(message: DiagnosticArray) -> None:
            self.telemetry[who] = message

        return keep


class CommandLines:
    """The way of a command in lines, each once."""

    def __init__(self) -> None:
        self._told: set[str] = set()

    def new(self, values: Mapping[str, str], link: Mapping[str, str]) -> Iterator[str]:
        """What is new. values: of the command; link: of the link."""
        state = values.get("state", "")
        for word in ORDER:
            at = values.get(f"{word}_s", "")
            if at and word not in self._told:
                self._told.add(word)
                yield f"{float(at):9.2f} s  {word}{_aside(word, values, link)}"
        if state in OVER and state not in self._told:
            self._told.add(state)
            yield f"{float(values.get('known_s', 'nan')):9.2f} s  {state}"


def _aside(word: str, values: Mapping[str, str], link: Mapping[str, str]) -> str:
    if word == QUEUED:
        window, light = link.get("window", "?"), link.get("light_time_s", "?")
        return f" (command {values.get('number', '?')}; window {window}, light takes {light} s)"
    known = values.get("known_s", "")
    return f", as is known on Earth since {known} s" if word == values.get("state") and word != SENT else ""
