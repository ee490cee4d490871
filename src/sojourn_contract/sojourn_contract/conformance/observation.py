"""One message as the judge sees it."""

from dataclasses import dataclass
from typing import Any, Protocol

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.topic_types import Topic


@dataclass(frozen=True, slots=True)
class Observation:
    """One message.

    Args:
        row: its topic. message: as rclpy or a type store gives it; only the attributes count.
        stamp: of its header [ns]. logged: simulation time at which it was filed [ns], None where nobody filed it.
        clock: newest stamp of /clock that came before it [ns], zero for none.
    """

    row: Topic
    message: Any
    stamp: int
    logged: int | None
    clock: int


class Rule(Protocol):
    """Judges every message of one topic. May keep what it needs from one message to the next."""

    name: str

    def judge(self, seen: Observation) -> "tuple[Finding, ...] | list[Finding]":
        """What is wrong with this message; empty if nothing is."""
