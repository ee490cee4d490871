"""Which roles are heard no more: told by how often others have beaten since.

Counted are seconds of simulation in which another role has beaten. Where the clock leaps there is one a leap: by their
age alone, all roles but the first to beat after it would be silent.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sojourn_contract.heartbeat import Heartbeat
from sojourn_contract.stamps import NANOSECONDS, seconds
from sojourn_contract.topic_types import ROLES


@dataclass(frozen=True)
class Beats:
    """Of the roles of a run that have been heard.

    Args:
        stamps: of the newest beat of each [ns]. missed: in how many seconds others have beaten since.
    """

    stamps: Mapping[str, int] = field(default_factory=dict)
    missed: Mapping[str, int] = field(default_factory=dict)

    def after(self, beat: Heartbeat) -> "Beats":
        """With one more; one of somebody's driver, by whatever clock, counts for nothing."""
        if beat.role not in ROLES:
            return self
        more = beat.stamp // NANOSECONDS > self._newest // NANOSECONDS
        missed = {role: count + more for role, count in self.missed.items()}
        return Beats({**self.stamps, beat.role: beat.stamp}, {**missed, beat.role: 0})

    def silent(self, most: int) -> dict[str, float]:
        """Roles that have missed so many, and for how long nothing has been heard of them [s of simulation]."""
        return {
            role: seconds(self._newest - self.stamps[role]) for role, missed in self.missed.items() if missed >= most
        }

    @property
    def _newest(self) -> int:
        return max(self.stamps.values(), default=0)
