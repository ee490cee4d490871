"""Heartbeats of one role, out of a message on their topic."""

from sojourn_contract.codecs import decode
from sojourn_contract.decoding import refusing
from sojourn_contract.heartbeat import Heartbeat, read_heartbeats
from sojourn_contract.topic_types import Topic


def beats_of(role: str, row: Topic, data: bytes) -> list[Heartbeat]:
    """Those of a role in a message, CDR. Raises RefusedMessageError for one that cannot be read."""
    message = decode(row, data)
    with refusing(row.name, "heartbeats that can be read"):
        return [beat for beat in read_heartbeats(message) if beat.role == role]
