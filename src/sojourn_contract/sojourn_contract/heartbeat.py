"""The heartbeat on /diagnostics: one a second from every node, and what it tells the others.

Before the run (stamp zero) it says whether the node's endpoints are matched; during the run it carries the
counters from which the recorder proves its completeness; if a node waits too long in lock-step it says for
whom.
"""

from dataclasses import dataclass, field

from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus

WAITING_TO_MATCH = "waiting for other nodes"
READY = "ready"
RUNNING = "running"
STALLED = "stalled"
ENDED = "ended"
HEARTBEAT_PERIODS = 50
"""Control periods between two."""
MOST_DIGITS = 18
"""Of a count: more are refused before Python, which takes long over them, sees them."""
WAITING_FOR = "waiting for role"
"""Key of a heartbeat: the role whose message the node waits for in lock-step, before and during the run."""
MATCHED = "matched"
"""Key of a heartbeat of a node that is stalled in real time: it is connected with all others, and could begin."""


@dataclass
class Counters:
    """What a node has done so far, by topic."""

    published: dict[str, int] = field(default_factory=dict)
    refused: dict[str, int] = field(default_factory=dict)
    last_refusal: str = ""

    def count_published(self, topic: str) -> None:
        """One more message sent on `topic`."""
        self.published[topic] = self.published.get(topic, 0) + 1

    def count_refused(self, topic: str, reason: str) -> None:
        """One more message on `topic` refused, for `reason`."""
        self.refused[topic] = self.refused.get(topic, 0) + 1
        self.last_refusal = reason


@dataclass(frozen=True)
class Heartbeat:
    """A heartbeat as read from /diagnostics.

    Args:
        role: who sent it. state: one of the words above. detail: reason in plain words.
        stamp: simulation time [ns], zero before the run. published, refused: counters by topic.
    """

    role: str
    state: str
    detail: str
    stamp: int
    published: dict[str, int]
    refused: dict[str, int]
    values: dict[str, str]


def status_message(stamp: int, name: str, values: dict[str, str], message: str = "", level: int = 0) -> DiagnosticArray:
    """One DiagnosticStatus in an array, stamped: the form of every status topic and of the heartbeat.

    Args:
        stamp: simulation time [ns]. level: 0 good, 1 warning, 2 error, 3 stale.
    """
    return DiagnosticArray(stamp, (DiagnosticStatus(name, tuple(values.items()), message, level),))


def status_values(array: DiagnosticArray) -> dict[str, str]:
    """Keys and values of the first status of an array, as `status_message` writes them."""
    return dict(array.status[0].values) if array.status else {}


def heartbeat_message(
    role: str,
    state: str,
    stamp: int,
    counters: Counters,
    detail: str = "",
    extra: dict[str, str] | None = None,
) -> DiagnosticArray:
    """Heartbeat of a node.

    Its level is a warning where messages have been refused, and an error while it is stalled.
    """
    values = {"state": state, **(extra or {})}
    values |= {f"published {topic}": str(count) for topic, count in sorted(counters.published.items())}
    values |= {f"refused {topic}": str(count) for topic, count in sorted(counters.refused.items())}
    if counters.last_refusal:
        values["last refusal"] = counters.last_refusal
    level = 2 if state == STALLED else 1 if counters.refused else 0
    return status_message(stamp, role, values, detail or state, level)


def beats(before: int, stamp: int) -> bool:
    """Whether a heartbeat is due in a period stamped `stamp` [ns], after one stamped `before`."""
    beat = HEARTBEAT_PERIODS * CONTROL_PERIOD_NS
    return stamp // beat != before // beat


def is_count(text: str) -> bool:
    """Whether a text is a count of messages: digits, and no more of them than a run could fill."""
    return text.isdecimal() and len(text) <= MOST_DIGITS


def read_heartbeats(array: DiagnosticArray) -> list[Heartbeat]:
    """Heartbeats in a message; statuses without a state (other people's diagnostics) are passed over."""
    found = []
    for status in array.status:
        values = dict(status.values)
        if "state" not in values:
            continue
        counts: dict[str, dict[str, int]] = {"published": {}, "refused": {}}
        for key, value in values.items():
            word, _, name = key.partition(" ")
            if word in counts and name and is_count(value):
                counts[word][name] = int(value)
        found.append(
            Heartbeat(
                role=status.name,
                state=values["state"],
                detail=status.message,
                stamp=array.stamp,
                values=values,
                **counts,
            )
        )
    return found
