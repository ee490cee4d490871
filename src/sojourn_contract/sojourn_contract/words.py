"""What is said in a run in lock-step, as far as somebody still waits for it."""

from collections.abc import Collection, Iterable, Mapping

from sojourn_contract.arrival import check_input, refusal_of
from sojourn_contract.barrier import awaited_inputs, oldest_age
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.role_state import Heard
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message

Kept = dict[str, Mapping[int, Heard]]
"""Messages by topic and stamp [ns], with why the contract refuses them."""


def kept_for(row: Topic) -> int:
    """How long a message of a row is waited for after its stamp [ns]."""
    return (row.lag if row.delivery is None else oldest_age(row) + row.pace) * CONTROL_PERIOD_NS


def lasting(participants: Collection[str], table: TopicTable) -> dict[str, int]:
    """The same for all that the roles of a run wait for, by topic; the recorder's is no state of a run."""
    present = [role for role in participants if role != "recorder"]
    awaited = [row for role in present for row in awaited_inputs(role, present, table)]
    return {row.name: kept_for(row) for row in awaited}


def keep(messages: Kept, row: Topic, message: Message, lasts: int, leaps: Leaps) -> None:
    """Keep a message that somebody waits for, for so long [ns], and let go of older ones of its topic."""
    stamp, earlier = message.stamp, messages.get(row.name, {})
    if stamp in earlier and _repeats(row, stamp):
        return
    heard: dict[int, Heard] = {}
    if lasts:
        oldest = stamp - lasts
        if leaps.gaps:
            oldest = leaps.newest(oldest // CONTROL_PERIOD_NS, row.every) * CONTROL_PERIOD_NS
        heard = {at: older for at, older in earlier.items() if at >= oldest}
    heard[stamp] = (message, refusal_of(check_input, row, message))
    messages[row.name] = heard


class Words:
    """Hears what is said, in its order, as a run without middleware keeps it.

    Args:
        lasts: how long a message is waited for after its stamp [ns], by topic; those of others are not kept.
        messages, ahead: that were kept where the run goes on from, and that had been said of periods to come.

    Attributes:
        messages: kept. ahead: said of periods to come. leaps: of the clock, so far.
    """

    def __init__(
        self,
        lasts: Mapping[str, int],
        messages: Mapping[str, Mapping[int, Heard]] | None = None,
        ahead: Iterable[tuple[Topic, Message]] = (),
        leaps: Leaps = NO_LEAPS,
    ) -> None:
        self._lasts = lasts
        self.messages: Kept = dict(messages or {})
        self.ahead = list(ahead)
        self.leaps = leaps

    def hear(self, row: Topic, message: Message) -> None:
        """What somebody says."""
        if row.name in self._lasts:
            keep(self.messages, row, message, self._lasts[row.name], self.leaps)
        self.ahead.append((row, message))

    def end(self, stamp: int) -> None:
        """A period is over [ns]: only what belongs to a later one is ahead."""
        self.ahead = [(row, message) for row, message in self.ahead if row.heard_at(message.stamp) > stamp]

    def named_ahead(self) -> tuple[tuple[str, Message], ...]:
        """What is ahead, by topic."""
        return tuple((row.name, message) for row, message in self.ahead)


def _repeats(row: Topic, stamp: int) -> bool:
    """Whether messages of a row bear a stamp [ns] again and again, for their sender's clock has stopped."""
    return row.delivery is not None and row.delivery.stands_at * CONTROL_PERIOD_NS == stamp
