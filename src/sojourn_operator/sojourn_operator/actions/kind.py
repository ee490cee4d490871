"""What an action is to the adapter: whose goals it brings, and what is told of them in its own words."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from sojourn_contract.values import Message
from sojourn_operator.actions.watch import Ending


@dataclass(frozen=True)
class LastHeard:
    """What the adapter has heard last.

    Args:
        now: simulation time [ns]. begun: stamp of the goal [ns]. status: fields of the role's status.
        messages: by topic, of those that the kind wants.
    """

    now: int
    begun: int
    status: Mapping[str, str]
    messages: Mapping[str, Message]


class Pursuit(Protocol):
    """One goal that has been asked for.

    `goal` goes out on `topic` of the kind.
    """

    @property
    def goal(self) -> Message:
        """As the contract has it, its stamp zero."""
        ...

    def feedback(self, heard: LastHeard) -> Any:
        """Feedback of the action."""
        ...

    def breach(self, heard: LastHeard) -> str:
        """Why it has to be stopped on its way, in words; empty: it has not."""
        ...

    def final(self, ending: Ending, heard: LastHeard) -> Ending:
        """How it ended, by what the action asks for besides what the role does."""
        ...

    def result(self, ending: Ending) -> Any:
        """Result of the action."""
        ...


class ActionKind(Protocol):
    """An action that is served.

    `package` has to be installed; `role` carries it out.
    """

    name: str
    """As in the package, without it."""
    package: str
    role: str
    topic: str
    hears: tuple[str, ...]
    """Topics besides the role's status."""

    def begin(self, request: Any) -> Pursuit:
        """Of a goal of the action. Raises RefusedMessageError for one that cannot be had."""
        ...


def action_type(kind: ActionKind) -> Any:
    """Its class. Raises ImportError where the package is not installed or has it not."""
    from importlib import import_module

    module = import_module(f"{kind.package}.action")
    if not hasattr(module, kind.name):
        raise ImportError(f"{kind.package} has no {kind.name}")
    return getattr(module, kind.name)
