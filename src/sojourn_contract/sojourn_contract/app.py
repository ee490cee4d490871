"""A role without ROS: what it remembers is a value, and a step makes the next one of it.

An app holds what does not change in a run (models, parameters, tables). All that a role remembers is in its state, so
that a run can be saved, restored and branched; a node is the shell that gives it messages and sends its answers (see
`app_node`).
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, Self, TypeAlias, TypeVar

from sojourn_config.flight import FlightScenario
from sojourn_config.known_machine import KnownMachine
from sojourn_config.scenario import LoadedScenario, load_flight, load_scenario
from sojourn_contract.kept_data import Kept
from sojourn_contract.topic_types import Topic

State = TypeVar("State")
Refusal: TypeAlias = tuple[str, str]
"""Topic of a message that cannot be used, and why, in words: an error that is kept holds on to the whole period in
which it was raised."""


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
    wanted: Collection[str] = frozenset()
    """Topics on demand to which somebody outside of the run listens."""


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
    landing: int = 0
    """Of who makes the time: the clock leaps, and the next period has this stamp [ns]; 0: it is the next one."""


NOTHING = Answer()


class App(Generic[State]):
    """Base of every role's app; those that would fly stand on `FlightApp`.

    Args:
        scenario: in truth, and what is believed of it.
    """

    role: ClassVar[str]
    """Row of the process table."""
    acts_in_silence: ClassVar[bool] = False
    """Whether it acts once a second where its trigger stays away in real time, to say so in its status."""

    def __init__(self, scenario: LoadedScenario) -> None:
        raise NotImplementedError

    @staticmethod
    def read(name: str, overrides: Sequence[str]) -> KnownMachine:
        """The scenario that it is made of. Raises ConfigError."""
        return load_scenario(name, overrides)

    @classmethod
    def of(cls, scenario: LoadedScenario) -> Self:
        """For a scenario that has been loaded already."""
        return cls(scenario)

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

    def to_keep(self, state: State) -> Mapping[str, Any] | None:
        """What must not be lost when its process ends, as JSON has it; None for nothing."""
        return None

    def started_again(self, state: State, stamp: int, kept: Kept | None) -> State:
        """The first state of a process that is not the run's first of its role, which acts at a stamp [ns].

        Args:
            kept: by the process before; None where nothing is known of it.
        """
        return state

    def heartbeat_values(self, state: State, stamp: int) -> dict[str, str]:
        """What it adds to the role's heartbeat at a stamp [ns]; must not depend on wall time in lock-step."""
        return {}


class FlightApp(App[State]):
    """Base of the apps that would fly.

    Args:
        known: all that they are told of the machine and its mission; nothing of it is the plant's truth.
    """

    def __init__(self, known: FlightScenario) -> None:
        raise NotImplementedError

    @staticmethod
    def read(name: str, overrides: Sequence[str]) -> KnownMachine:
        """See App."""
        return load_flight(name, overrides)

    @classmethod
    def of(cls, scenario: LoadedScenario) -> Self:
        """See App."""
        return cls(scenario.as_believed())
