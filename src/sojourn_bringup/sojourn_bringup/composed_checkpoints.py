"""Checkpoints of nodes in one process: the same file as that of a run without middleware.

At a period's end of which a checkpoint is wanted the plant waits until all others have acted on that period and what
the operator has said is with those whom it is for; then nothing of the run is on its way, and its state is what the
nodes hold and what they have said to each other.
"""

from collections.abc import Mapping
from typing import Any

from sojourn_bags.recording import RECORDER
from sojourn_bringup.checkpoints import CheckpointKeeper
from sojourn_contract.app_node import AppNode
from sojourn_contract.checkpoint_times import common_grid
from sojourn_contract.neighbours import Neighbours
from sojourn_contract.role_state import RoleState
from sojourn_contract.stamps import CONTROL_PERIOD_NS, seconds
from sojourn_contract.topic_types import ROLES, Topic
from sojourn_contract.values import Message
from sojourn_contract.words import Words, lasting
from sojourn_stack.stack import PLANT, StackState


class OverheardNeighbours(Neighbours):
    """Neighbours whose words are kept as far as somebody still waits for them.

    Args:
        nodes: of this process and this run. words: that hear them, all but the recorder, which keeps no state.
    """

    def __init__(self, nodes: Any, words: Words) -> None:
        super().__init__(nodes)
        self._words = words

    def say(self, row: Topic, message: Message) -> None:
        """See Neighbours."""
        if row.publisher != RECORDER:
            self._words.hear(row, message)
        super().say(row, message)


class ComposedKeeper:
    """Keeps the state of nodes in one process; the plant asks it, see `PacingNode`.

    Args:
        nodes: of all roles, by role; the recorder's state is no part of a run's. keeper: writes the file.
        begin: where the run goes on from, None for its start.
    """

    def __init__(self, nodes: Mapping[str, Any], keeper: CheckpointKeeper, begin: StackState | None = None) -> None:
        self._nodes: dict[str, AppNode] = {role: node for role, node in nodes.items() if isinstance(node, AppNode)}
        self._plant = self._nodes[PLANT]
        self._keeper = keeper
        table = self._plant.table
        lasts = lasting(self._plant.participants, table)
        if begin is None:
            self.words = Words(lasts)
        else:
            ahead = [(table.topic(name), message) for name, message in begin.ahead]
            # what the plant has said of the period to come it says again
            others = [(row, message) for row, message in ahead if row.publisher != PLANT]
            self.words = Words(lasts, begin.messages, others, begin.leaps)
        self._grid = common_grid(self._plant.participants, table)
        self._roles: dict[str, RoleState] | None = None
        """Of all but the plant, which is about to act on the period of a checkpoint."""
        self._is_asked = False
        self.answered = 0
        """See `Keeper` of the plant."""

    def ask(self) -> None:
        """Keep the state at the next period that can be."""
        self._is_asked = True

    def may_act(self, stamp: int) -> bool:
        """Before the plant acts on a period [ns]."""
        self._roles = None
        if not self._is_wanted(stamp):
            return True
        others = [node for node in self._nodes.values() if node is not self._plant and node.awaited]
        if any(node.now < stamp for node in others) or not self._goals_are_there():
            return False
        self._roles = {node.role: node.role_state() for node in self._nodes.values() if node is not self._plant}
        return True

    def acted(self, stamp: int) -> None:
        """After it has.

        Raises:
            OSError: a checkpoint cannot be written. CheckpointError: the state holds what cannot be kept.
        """
        period = stamp // CONTROL_PERIOD_NS
        words, leaps = self.words, self._plant.barrier.leaps
        words.leaps = leaps
        words.end(stamp)
        if self._roles is not None and not self._plant.finished:
            found = {**self._roles, PLANT: self._plant.role_state()}
            roles = {role: found[role] for role in ROLES if role in found}
            following = leaps.after(period)
            self._keeper.keep(
                StackState(following, roles, dict(words.messages), ahead=words.named_ahead(), leaps=leaps)
            )
            if self._is_asked:
                self._is_asked, self.answered = False, stamp

    def _is_wanted(self, stamp: int) -> bool:
        """At a period in which every role acts."""
        is_common = stamp // CONTROL_PERIOD_NS % self._grid == 0
        return is_common and (self._is_asked or self._keeper.is_due(seconds(stamp)))

    def _goals_are_there(self) -> bool:
        """Whether what the operator has said is with those whom it is for."""
        operator = self._nodes.get("operator")
        said: Mapping[str, int] = {} if operator is None else operator.counters.published
        return all(
            node.events.has_received({row.name: said.get(row.name, 0) for row in node.endpoints.inputs if row.is_event})
            for node in self._nodes.values()
            if node is not operator
        )
