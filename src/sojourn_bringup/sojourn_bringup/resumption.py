"""Nodes that go on where a run stood, before the first of them acts.

Each gets the state of its role and what it still waits for of that which had been said. What the plant had said of the
period to come it says when all are ready, for with that the run begins; the recorder hears what else belongs to periods
to come, as the record begins there.
"""

from collections.abc import Mapping
from typing import Any

from sojourn_bags.onset import RecordBeginning
from sojourn_bags.recording import RECORDER
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.role_state import RoleAtCheckpoint
from sojourn_contract.run_table import table_of
from sojourn_contract.topic_table import TopicTable
from sojourn_stack.errors import MisfitError
from sojourn_stack.recorder import onset_of
from sojourn_stack.stack import StackState


def go_on(nodes: Mapping[str, Any], state: StackState) -> None:
    """Put nodes of this process where a run stood; the recorder has got its `beginning` when it was made.

    Args:
        nodes: of all roles, by role; none has acted. state: of the run.

    Raises:
        MisfitError: it is of other roles.
    """
    ours = {role: node for role, node in nodes.items() if role != RECORDER}
    check_roles(state, ours)
    for role, node in ours.items():
        node.go_on(handed_back(role, state, node.table))


def check_roles(state: StackState, roles: Mapping[str, Any]) -> None:
    """Raise MisfitError for a state of other roles."""
    if set(roles) != set(state.roles):
        raise MisfitError("roles", f"the checkpoint has {', '.join(state.roles)}, this run {', '.join(roles)}")


def handed_back(role: str, state: StackState, table: TopicTable) -> RoleAtCheckpoint:
    """What a role is to know where a run goes on."""
    hears = {row.name for row in table if row.publisher == role or role in row.subscribers}
    said = {row.name for row in table if row.publisher == role}
    messages = {name: each for name, each in state.messages.items() if name in hears}
    ahead = tuple((name, message) for name, message in state.ahead if name in said)
    return RoleAtCheckpoint(state.roles[role], state.period, messages, ahead, state.leaps)


def beginning(state: StackState, scenario: LoadedScenario) -> RecordBeginning:
    """Of a record that begins where a run stands."""
    plants = {row.name for row in table_of(scenario) if row.publisher == "plant"}
    return RecordBeginning(onset_of(state, scenario), tuple(one for one in state.ahead if one[0] not in plants))
