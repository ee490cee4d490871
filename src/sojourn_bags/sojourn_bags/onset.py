"""Where in its run a record begins: at its start, or at a checkpoint from which it went on."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.stamps import CONTROL_PERIOD_NS

RESUMED = "resumed_at_ns"
"""In what a bag that begins at a checkpoint says of its run: stamp of the last period that is not in it [ns]."""


@dataclass(frozen=True)
class Onset:
    """Where a record begins.

    Args:
        period: the first control period of the record. before: messages of each topic that belong to those before it.
        leaps: of the clock before it, and the one that lands in it.
    """

    period: int = 1
    before: Mapping[str, int] = field(default_factory=dict)
    leaps: Leaps = NO_LEAPS

    @property
    def last(self) -> int:
        """The control period before the first of the record; 0 for a whole run."""
        return self.leaps.before(self.period)

    @property
    def resumed_at(self) -> int:
        """Stamp of the last period that is not in the record [ns]; 0 for a whole run."""
        return self.last * CONTROL_PERIOD_NS


WHOLE = Onset()
"""A record of a run from its start."""
