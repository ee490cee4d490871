"""A role without ROS: what it remembers is a value, and a step makes the next one of it.

An app holds what does not change in a run (models, parameters, tables). All that a role remembers is in its state, so
that a run can be saved, restored and branched; a node is the shell that gives it messages and sends its answers (see
`app_node`).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeAlias, TypeVar

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.topic_types import Topic

State = TypeVar("State")
Refusal: TypeAlias = tuple[str, Exception]
"""Topic of a message that cannot be used, and why."""


@dataclass(frozen=True, slots=True)
class Period:
    """What a role is given to act on."""

    stamp: int
    """Simulation time [ns]; every output carries it, but for the plant's truth, which is that of the next period."""
    inputs: Mapping[str, Any]
    """Messages by topic: those due at this stamp (lock-step), or the latest of every periodic input (real time). None
    where a message came but was refused; in real time also where none has come, or none that is young enough."""
    goals: Sequence[tuple[str, Any]] = ()
    """(topic, message) that take effect now."""
    last_refusal: str = ""
    """Why the last message was refused that was, in words."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What a role answers to a period."""

    messages: Iterable[tuple[str, Any]] = ()
    """(topic, message), in the order in which they are sent; those that a run does not have are left out. They may be
    made while they are sent."""
    refusals: Sequence[Refusal] = ()
    errors: Sequence[str] = ()
    """For the log."""
    finished: bool = False
    """Whether the run ends with it."""


NOTHING = Answer()


class App(Generic[State]):
    """Base of every role's app.

    Args:
        scenario: with what the role knows of the machine.
    """

    role: ClassVar[str]
    """Row of the process table."""
    acts_in_silence: ClassVar[bool] = False
    """Whether it acts once a second where its trigger stays away in real time, to say so in its status."""

    def __init__(self, scenario: LoadedScenario) -> None:
        raise NotImplementedError

    def warm_up(self) -> None:
        """Have every compiled kernel loaded, so that no period waits for one; changes nothing. It is called before the
        first period.
        """

    def initial_state(self) -> State:
        """Before the first period."""
        raise NotImplementedError

    def step(self, state: State, period: Period) -> tuple[State, Answer]:
        """Act on one period; `state` is not changed."""
        raise NotImplementedError

    def first_messages(self, state: State, stamp: int) -> Iterable[tuple[str, Any]]:
        """With which a run begins, at a stamp [ns]: of the plant alone."""
        return ()

    def check(self, row: Topic, message: Any) -> None:
        """Checks of its own, besides the contract's: raise RefusedMessageError."""

    def on_new_time(self, state: State) -> State:
        """In real time the clock was wrong and has been set anew: forget what was measured by the old one."""
        return state

    def heartbeat_values(self, state: State, stamp: int) -> dict[str, str]:
        """What it adds to the role's heartbeat at a stamp [ns]; must not depend on wall time in lock-step."""
        return {}
