"""Rows of the topics by which a running stack keeps its state, and goes on from it.

A run that keeps checkpoints has them, or one that goes on, and no other one: they are no part of the table of every
run, oblige no node, and are not in the bag, so that a run is the same whether or not it is kept.

A state goes as text, in parts, each of which is a heartbeat of its role with three more keys: `part`, `of`, `data`.
"""

import base64
import binascii
from collections.abc import Iterator

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import Counters, Heartbeat, heartbeat_message, is_count
from sojourn_contract.topic_types import ROLES, Topic
from sojourn_contract.values import DiagnosticArray

CHECKPOINT = Topic(
    "/checkpoint",
    "std_msgs/Header",
    "operator",
    ("plant",),
    0,
    10.0,
    "keep the state of the run in the next period at which all roles act; the answer comes on /checkpoint/kept",
    logged=False,
    needs_listener=False,
)
KEPT = Topic(
    "/checkpoint/kept",
    "std_msgs/Header",
    "plant",
    ("operator",),
    0,
    10.0,
    "what has become of a request: the state of the period stamped so is kept; with a frame_id, the request stamped so "
    "is refused, and why",
    logged=False,
    needs_listener=False,
)
TAKE = Topic(
    "/checkpoint/take",
    "std_msgs/Header",
    "plant",
    tuple(role for role in ROLES if role not in ("plant", "recorder")),
    0,
    10.0,
    "hand over your state after the period stamped so, on /checkpoint/state; frame_id: `operator` where it alone is "
    "asked, else how many goals it has sent, as on /operator/tick: first all of them are to have come",
    logged=False,
    needs_listener=False,
)
STATE = Topic(
    "/checkpoint/state",
    "diagnostic_msgs/DiagnosticArray",
    "all",
    ("plant",),
    0,
    10.0,
    "the state of a role after the period stamped so, in parts: handed over by the role, or handed back to it where "
    "its parameter resumed_at has that stamp",
    logged=False,
    needs_listener=False,
)
FILED = Topic(
    "/checkpoint/filed",
    "std_msgs/Header",
    "operator",
    ("plant",),
    0,
    10.0,
    "from whoever writes the files: the states of the period stamped so are in one, or never will be. The plant asks "
    "for no others before, so that states come no faster than they are written; where nobody writes it does not wait",
    logged=False,
    needs_listener=False,
)
RESUMED = "resumed"
"""Key of a heartbeat before a run that goes on: stamp of the state from which its node does [ns]."""
ONLY_OPERATOR = "operator"
HANDED = "checkpoint"
"""State of who hands one over, in its message."""
PART, OF, DATA = "part", "of", "data"
PART_CHARACTERS = 1 << 17
MOST_PARTS = 4096
"""Of one state: more are refused."""


def state_messages(
    role: str, stamp: int, counters: Counters, text: str, extra: dict[str, str] | None = None
) -> Iterator[DiagnosticArray]:
    """A role's state after a period [ns], as messages on STATE, at least one."""
    count = max(1, -(-len(text) // PART_CHARACTERS))
    for number in range(count):
        data = text[number * PART_CHARACTERS : (number + 1) * PART_CHARACTERS]
        values = {**(extra or {}), PART: str(number + 1), OF: str(count), DATA: data}
        yield heartbeat_message(role, HANDED, stamp, counters, extra=values)


class StateParts:
    """Puts states together again, whatever the order in which their parts come."""

    def __init__(self) -> None:
        self._parts: dict[tuple[str, int], dict[int, str]] = {}

    def take(self, beat: Heartbeat) -> str | None:
        """A part; the text of the state once it is whole. Raises RefusedMessageError for what is no part."""
        number, count = (beat.values.get(key, "") for key in (PART, OF))
        if not (is_count(number) and is_count(count) and 1 <= int(number) <= int(count) <= MOST_PARTS):
            allowed = f"one of at most {MOST_PARTS} parts: {PART} from 1 to {OF}"
            raise RefusedMessageError(STATE.name, f"status.values.{PART}", f"{number[:20]} of {count[:20]}", allowed)
        key = (beat.role, beat.stamp)
        for other in [other for other in self._parts if other[0] == beat.role and other != key]:
            del self._parts[other]
        parts = self._parts.setdefault(key, {})
        parts[int(number)] = beat.values.get(DATA, "")
        if len(parts) < int(count):
            return None
        del self._parts[key]
        return "".join(parts[place] for place in sorted(parts))


def as_text(data: bytes) -> str:
    """Bytes of a state as it goes on STATE."""
    return base64.b64encode(data).decode()


def as_bytes(text: str) -> bytes:
    """The reverse. Raises RefusedMessageError."""
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise RefusedMessageError(STATE.name, f"status.values.{DATA}", f"{text[:40]}", "base64") from error
