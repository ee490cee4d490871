"""A candidate: what stands in for a node and is to be judged. A process, or a node in this one."""

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from rclpy.context import Context
from rclpy.experimental import EventsExecutor

from sojourn_contract.node import ContractNode


class Candidate(Protocol):
    """Started by the harness once everybody else is there, and ended by it whatever happens."""

    def start(self, context: Context, executor: EventsExecutor, parameters: Mapping[str, Any]) -> None:
        """Begin.

        Args:
            context, executor: those of the harness, for a node in the same process.
            parameters: ROS parameters of the role's node.
        """

    def poll(self) -> None:
        """Wall-clock chores, called some times a second."""

    def how_it_ended(self) -> str:
        """In words, or "" while it runs."""

    def stop(self) -> None:
        """End it and all that it has started."""


class NodeCandidate:
    """A node in this process, on the harness's executor.

    Args:
        factory: makes the node; it gets the keyword arguments of a ContractNode.
    """

    def __init__(self, factory: Callable[..., ContractNode], namespace: str | None = None) -> None:
        self._factory = factory
        self._namespace = namespace
        self._executor: EventsExecutor | None = None
        self.node: ContractNode | None = None

    def start(self, context: Context, executor: EventsExecutor, parameters: Mapping[str, Any]) -> None:
        """Make the node."""
        self.node = self._factory(context=context, overrides=dict(parameters), namespace=self._namespace)
        self._executor = executor
        executor.add_node(self.node)

    def poll(self) -> None:
        """The node's own chores."""
        if self.node is not None:
            self.node.poll()

    def how_it_ended(self) -> str:
        """A node in this process ends where it says that it has failed."""
        return self.node.failure if self.node is not None else ""

    def stop(self) -> None:
        """Destroy the node."""
        if self.node is not None and self._executor is not None:
            self._executor.remove_node(self.node)
            self.node.destroy_node()
            self.node = None
