"""Nodes in one process that go on where a run stood, before the first of them acts.

Each gets the state of its role and what it still waits for of that which had been said. What the plant had said of the
period to come it says when all are ready, for with that the run begins; the recorder hears what else belongs to periods
to come, as the record begins there.
"""

from collections.abc import Mapping
from typing import Any

from sojourn_bags.recorded_run import ROLE as RECORDER
from sojourn_contract.app_node import AppNode
from sojourn_contract.barrier import is_due, stamp_due
from sojourn_contract.heartbeat import Counters
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.values import Header
from sojourn_stack.errors import MisfitError
from sojourn_stack.recorder import TICK, counted_by
from sojourn_stack.stack import PLANT, RoleState, StackState


def go_on(nodes: Mapping[str, Any], state: StackState) -> None:
    """Put nodes where a run stood.

    Args:
        nodes: of all roles, by role; none has acted. state: of the run.

    Raises:
        MisfitError: it is of other roles.
    """
    ours = {role: node for role, node in nodes.items() if role != RECORDER}
    if set(ours) != set(state.roles):
        raise MisfitError("roles", f"the checkpoint has {', '.join(state.roles)}, this run {', '.join(ours)}")
    plant = nodes[PLANT]
    for role, one in state.roles.items():
        _restore(ours[role], one, state)
    plant.first_words = [(name, message) for name, message in state.ahead if name in plant.endpoints.outputs]
    recorder = nodes.get(RECORDER)
    if recorder is None:
        return
    recorder.goes_on_from = state.now
    recorder.counters = counted_by(state.now // CONTROL_PERIOD_NS, state.leaps)
    heard = {row.name: row for row in recorder.endpoints.inputs}
    for name, message in state.ahead:
        if name in heard and name not in plant.endpoints.outputs:
            recorder.hear(heard[name], message)
    _announce_record(plant, state)


def _restore(node: AppNode, one: RoleState, state: StackState) -> None:
    node.state, node.events = one.app, one.goals
    node.counters = Counters(dict(one.published), dict(one.refused), one.last_refusal)
    node.hearing.took, node.goes_on_from = one.took, one.now
    barrier = node.barrier
    barrier.go_on(one.now // CONTROL_PERIOD_NS, state.leaps)
    for row in node.awaited:
        oldest = 0 if row.delivery is not None else stamp_due(row, barrier.period, state.leaps)
        for stamp, (message, refusal) in state.messages.get(row.name, {}).items():
            is_said_again = row.publisher == PLANT and stamp > state.now
            if stamp >= oldest and not is_said_again:
                barrier.offer(row, stamp, None if refusal else message)


def _announce_record(plant: AppNode, state: StackState) -> None:
    """Let the plant have the ticks of the record before, for which it still waits."""
    for row in plant.awaited:
        if row.name == TICK:
            periods = range(state.period, state.period + row.lag + 1)
            stamps = {stamp_due(row, period, state.leaps) for period in periods if is_due(row, period)}
            for stamp in sorted(stamps):
                if 0 < stamp <= state.now:
                    plant.barrier.offer(row, stamp, Header(stamp))
