"""An action server whose goals the adapter carries out in its own loop, one at a time: a new one takes the place of the
one before.
"""

from collections.abc import Callable
from typing import Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node

from sojourn_contract.errors import ContractError
from sojourn_operator.actions.kind import ActionKind, action_type
from sojourn_operator.actions.watch import ABORTED, CANCELED, SUCCEEDED, Ending


class _HeldServer(ActionServer):
    """Does not run a callback for each goal: rclpy's executor of events asks one that waits again and again, without a
    pause. Who holds a goal says by `end` that it is over.
    """

    def notify_execute(self, goal_handle: Any, execute_callback: Any) -> None:
        """A goal begins: nothing is to be run."""

    def end(self, goal: Any, result: Any) -> None:
        """Give a goal that is over its result."""
        super().notify_execute(goal, lambda _goal: result)


class GoalServer:
    """Of one action.

    Args:
        node: that it is of. kind: of the action. name: under which it is found. say: takes what is refused, in words.

    Raises ImportError where the action's package is not installed.
    """

    def __init__(self, node: Node, kind: ActionKind, name: str, say: Callable[[str], None]) -> None:
        self.kind, self.name, self._say = kind, name, say
        self._taken: list[Any] = []
        self._server = _HeldServer(
            node,
            action_type(kind),
            name,
            lambda _goal: None,
            goal_callback=self._asked,
            handle_accepted_callback=self._accepted,
            cancel_callback=lambda _goal: CancelResponse.ACCEPT,
        )

    def taken(self) -> list[Any]:
        """Goals that have come since it was asked last, the oldest first."""
        taken, self._taken = self._taken, []
        return taken

    def end(self, goal: Any, ending: Ending, result: Any) -> None:
        """Tell how a goal has ended."""
        {SUCCEEDED: goal.succeed, ABORTED: goal.abort, CANCELED: goal.canceled}[ending.word]()
        self._server.end(goal, result)

    def destroy(self) -> None:
        """At the end."""
        self._server.destroy()

    def _asked(self, request: Any) -> GoalResponse:
        try:
            self.kind.begin(request)
        except ContractError as refusal:
            self._say(f"{self.name}: rejected: {refusal}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _accepted(self, goal: Any) -> None:
        goal.execute()
        self._taken.append(goal)
