"""The state of a run whose roles are nodes: what they have said, as far as somebody still waits for it."""

from collections.abc import Mapping

from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message
from sojourn_stack.stack import PLANT, Heard, RoleState, Stack, StackState


class Gathering:
    """Hears all that is said, in its order, as a run without middleware keeps it.

    Args:
        stack: of the same apps and the same table. begin: where the run goes on from, None for its start. What the
            plant has said of the period to come it says again.
    """

    def __init__(self, stack: Stack, begin: StackState | None = None) -> None:
        self._stack = stack
        self._messages: dict[str, Mapping[int, Heard]] = {} if begin is None else dict(begin.messages)
        ahead = () if begin is None else begin.ahead
        self._ahead = [(stack.rows[name], message) for name, message in ahead if name not in stack.outputs[PLANT]]
        self.leaps: Leaps = NO_LEAPS if begin is None else begin.leaps
        """Of the clock, so far."""

    def hear(self, row: Topic, message: Message) -> None:
        """What somebody says."""
        if row.name in self._stack.kept_for:
            self._stack.keep(self._messages, row, message, self.leaps)
        if row.name in self._stack.rows:
            self._ahead.append((row, message))

    def end(self, period: int) -> None:
        """The plant has acted on a control period: only what belongs to a later one is ahead."""
        now = period * CONTROL_PERIOD_NS
        self._ahead = [(row, message) for row, message in self._ahead if row.heard_at(message.stamp) > now]

    def state(self, period: int, roles: Mapping[str, RoleState]) -> StackState:
        """Once all have acted on a control period of a run that goes on.

        Args:
            period: that is over. roles: after it.
        """
        ahead = tuple((row.name, message) for row, message in self._ahead)
        ordered = {role: roles[role] for role in self._stack.apps}
        return StackState(self.leaps.after(period), ordered, dict(self._messages), ahead=ahead, leaps=self.leaps)
