"""Where the messages of a run come from: a stack that runs, or a bag."""

from collections.abc import Collection
from typing import NamedTuple, Protocol

from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message


class FeedMessage(NamedTuple):
    """A message as it came."""

    row: Topic
    data: bytes
    time: int
    """When it was said [ns of simulation]; of a live message its stamp."""


class Mouth(Protocol):
    """Says something to a run."""

    @property
    def now(self) -> int:
        """Simulation time [ns], 0 as long as it is not known."""
        ...

    def send(self, name: str, message: Message) -> None:
        """Say something on a topic of the operator. Raises GoalError."""
        ...

    def machine_stamp(self, name: str, stamp: int) -> str:
        """Stamp by which the machine tells of a goal that was sent on a topic with a stamp [ns]; "0": none yet."""
        ...


class Feed(Protocol):
    """A source of messages. What is shown needs the newest of each topic; what is plotted needs all of some."""

    now: int
    """Simulation time [ns], 0 as long as it is not known."""

    def poll(self) -> list[FeedMessage]:
        """What has come since the last time, in the order in which it came: of each topic the newest, of those that
        are wanted in full all.
        """
        ...

    def want(self, looked_at: Collection[str], in_full: Collection[str]) -> None:
        """Which topics are looked at, and of which of them every message counts."""
        ...

    def has_jumped(self) -> bool:
        """Whether time has jumped since the last time that this was asked, so that nothing of before holds."""
        ...

    def silence(self) -> str:
        """That nothing is heard any more of a run that was heard, in words; empty where it is."""
        ...

    def refusal(self) -> str:
        """Why nothing can be commanded here, in words; empty where it can."""
        ...

    def send(self, name: str, message: Message) -> None:
        """Say something on a topic of the operator. Raises GoalError."""
        ...

    def close(self) -> None:
        """End it."""
        ...
