"""What has happened, when, and who says so: entries of the one log of a run."""

from dataclasses import dataclass
from typing import Any

from sojourn_contract.stamps import seconds
from sojourn_operator.alarms.params import Severity


@dataclass(frozen=True)
class Event:
    """An entry.

    Args:
        stamp: simulation time [ns]. who: alarm, role or operator. kind: alarm, goal, node, contract, operator.
        severity: of an alarm that rises. text: in words.
    """

    stamp: int
    who: str
    kind: str
    severity: Severity
    text: str

    def line(self) -> str:
        """As a line of the log."""
        level = self.severity.word.upper() if self.severity else self.kind
        return f"{seconds(self.stamp):9.2f} s  {level:8}  {self.who}: {self.text}"

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "time_s": seconds(self.stamp),
            "who": self.who,
            "kind": self.kind,
            "severity": self.severity.word,
            "text": self.text,
        }
