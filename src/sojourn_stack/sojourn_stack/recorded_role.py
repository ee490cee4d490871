"""A role that says again what a bag has of it, period by period, whatever it hears: the others of a replayed one."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from sojourn_bags.comparison import stamps_of
from sojourn_bags.errors import ReplayError
from sojourn_bags.messages import Messages
from sojourn_bags.replay_script import announced_in, ticks_of
from sojourn_contract.app import Answer, App, Period
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic

PLANT = "plant"
Saying = tuple[str, Any]
"""Topic and value."""


class RecordedRole(App[None]):
    """Its state is none: what it says follows from the stamp alone.

    Args:
        sayings: by the control period in which it says them; those of period zero begin the run. leaps: of the clock,
            of the plant alone.
    """

    def __init__(self, sayings: Mapping[int, Sequence[Saying]], leaps: Leaps = NO_LEAPS) -> None:
        self._sayings, self._landings = sayings, dict(leaps.gaps)

    def initial_state(self) -> None:
        """Nothing."""

    def first_messages(self, state: None, stamp: int) -> Iterable[Saying]:
        """The truth with which the run begins."""
        return self._sayings.get(0, ())

    def step(self, state: None, period: Period) -> tuple[None, Answer]:
        """What it said in the run."""
        now = period.stamp // CONTROL_PERIOD_NS
        return None, Answer(self._sayings.get(now, ()), landing=self._landings.get(now, 0) * CONTROL_PERIOD_NS)


def recorded_role(
    role: str, rows: Iterable[Topic], topics: Mapping[str, Messages], leaps: Leaps = NO_LEAPS
) -> RecordedRole:
    """A role of a bag.

    Args:
        rows: what it says in such a run; heartbeats are the run's own. topics: of the bag. leaps: of the run's clock.

    Raises:
        ReplayError: bytes that hold no message of their type.
    """
    ticks, tells_the_next = ticks_of(topics), role == PLANT
    entries = []
    for row in rows:
        messages = topics.get(row.name)
        if messages is None or row.publisher == "all" or (row.is_event and not row.subscribers):
            continue  # events for which no role acts are for people on Earth
        for index, stamp in enumerate(stamps_of(messages)):
            period = announced_in(row, stamp, ticks) if row.is_event else stamp // CONTROL_PERIOD_NS
            if row.is_event and not period:
                continue  # sent by hand: the script says when it took effect
            if tells_the_next and not row.is_event:
                period = leaps.before(period)
            try:
                said = decode(row, messages.data[index])
            except RefusedMessageError as error:
                raise ReplayError(f"{error}: such a bag is replayed over topics alone") from error
            entries.append((period, messages.places[index], row.name, said))
    sayings: dict[int, list[Saying]] = defaultdict(list)
    for period, _, name, said in sorted(entries, key=lambda entry: entry[:2]):
        sayings[period].append((name, said))
    return RecordedRole(sayings, leaps if tells_the_next else NO_LEAPS)
