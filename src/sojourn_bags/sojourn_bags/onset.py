"""Where in its run a record begins: at its start, or at a checkpoint from which it went on."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field

from sojourn_contract.heartbeat import HEARTBEAT_PERIODS, Counters
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import topic
from sojourn_contract.values import Message

TICK, HEARTBEATS = "/recorder/tick", "/diagnostics"
TICK_PERIODS = topic(TICK).every

RESUMED = "resumed_at_ns"
"""In what a bag that begins at a checkpoint says of its run: stamp of the last period that is not in it [ns]."""
FAULTS = "faults_before"
"""The same: faults that had come by then, as JSON, see `faults_before`."""
Span = tuple[float, float | None]
"""When something came and went [s]; None: it has not gone."""


@dataclass(frozen=True)
class Onset:
    """Where a record begins.

    Args:
        period: the first control period of the record. before: messages of each topic that belong to those before it.
        leaps: of the clock before it, and the one that lands in it. faults: that had come before it, by their names.
    """

    period: int = 1
    before: Mapping[str, int] = field(default_factory=dict)
    leaps: Leaps = NO_LEAPS
    faults: Mapping[str, Span] = field(default_factory=dict)

    @property
    def last(self) -> int:
        """The control period before the first of the record; 0 for a whole run."""
        return self.leaps.before(self.period)

    @property
    def resumed_at(self) -> int:
        """Stamp of the last period that is not in the record [ns]; 0 for a whole run."""
        return self.last * CONTROL_PERIOD_NS

    def record(self) -> dict[str, str]:
        """As the bag has it; nothing for a whole run."""
        if not self.resumed_at:
            return {}
        return {RESUMED: str(self.resumed_at), **({FAULTS: json.dumps(self.faults)} if self.faults else {})}


def faults_before(record: Mapping[str, str]) -> dict[str, Span]:
    """Faults that had come before a bag began, by their names, from what it says of its run; none where that cannot be
    read.
    """
    try:
        found = json.loads(record.get(FAULTS, "{}"))
        return {str(name): (float(begin), None if end is None else float(end)) for name, (begin, end) in found.items()}
    except (ValueError, TypeError, AttributeError, RecursionError):
        return {}


def counted_by(period: int, leaps: Leaps = NO_LEAPS) -> Counters:
    """What the recorder of a run has said of its own by the end of a control period."""
    said = {HEARTBEATS: leaps.count(period, HEARTBEAT_PERIODS), TICK: leaps.count(period, TICK_PERIODS)}
    return Counters({name: count for name, count in said.items() if count})


WHOLE = Onset()
"""A record of a run from its start."""


@dataclass(frozen=True)
class RecordBeginning:
    """What the node of a recorder begins with.

    Args:
        onset: where in the run its record begins. ahead: (topic, message) that others than the plant had said before,
            and that belong to the record.
    """

    onset: Onset = WHOLE
    ahead: tuple[tuple[str, Message], ...] = ()
