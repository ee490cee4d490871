"""Words of statuses that a condition compares with: a slip of the pen is found before a step waits for it for good."""

from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.heartbeat import ENDED, READY, RUNNING, STALLED, WAITING_TO_MATCH
from sojourn_contract.named_fields import FieldValue, NamedField
from sojourn_machine.names import names_text
from sojourn_machine.status_keys import GOAL_STATES, keys_meant

STATES: dict[str, tuple[str, ...]] = {
    "/drive/status.state": GOAL_STATES,
    "/arm/status.state": GOAL_STATES,
    "/diagnostics.state": (WAITING_TO_MATCH, READY, RUNNING, STALLED, ENDED),
}
"""What the contract allows a state to be, by its field."""


def check_words(field: NamedField, value: FieldValue) -> None:
    """Raises UnknownFieldNameError for a key that nearly is one of ours, and for a state that there is not."""
    topic = field.row.name
    near = [f"{topic}.{key}" for key in keys_meant(topic, field.path)]
    if near:
        raise UnknownFieldNameError(field.name, f"{topic} has no such key", near)
    states = STATES.get(f"{topic}.{field.path}", ())
    if states and value not in states:
        raise UnknownFieldNameError(f"{field.name} {value}", f"no such state: {names_text(str(value), states)}", ())
