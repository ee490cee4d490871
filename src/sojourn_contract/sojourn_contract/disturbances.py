"""Which messages of a run its disturbances meet, and what no run can have."""

from collections.abc import Iterable

from sojourn_contract.errors import DisturbanceError
from sojourn_contract.topic_types import Topic
from sojourn_machine.disturbance import Disturbance
from sojourn_machine.names import names_text
from sojourn_machine.transport_fault import ON_BOARD, TIMING_TOPICS

LISTENERS = ("plant", *ON_BOARD)
"""Roles that do not hear all that is said: an operator's script is the run's own."""
TRUTHFUL = ("plant", "recorder")
"""Roles whose messages go over no wire of the machine."""


def concerns(disturbance: Disturbance, row: Topic) -> bool:
    """Whether it meets messages of a row."""
    if disturbance.effect == "restarted":
        return False
    return disturbance.topic == row.name if disturbance.topic else disturbance.role == row.publisher


def check_disturbances(disturbances: Iterable[Disturbance], rows: Iterable[Topic]) -> None:
    """Raise DisturbanceError for one of a topic or a node that a run of these rows does not have."""
    rows = tuple(rows)
    heard = [row.name for row in rows if row.publisher not in TRUTHFUL and set(row.subscribers) & {*LISTENERS}]
    heard = [name for name in heard if name not in TIMING_TOPICS]
    speaking = {row.publisher for row in rows}
    for each in disturbances:
        if each.topic and each.topic not in heard:
            allowed = names_text(each.topic, heard).removeprefix("allowed is ")
            raise DisturbanceError(f"topic {each.topic} is none that a node on board acts on in this run", allowed)
        if each.role and each.role not in speaking:
            raise DisturbanceError(f"node {each.role} says nothing in this run", "another one")
