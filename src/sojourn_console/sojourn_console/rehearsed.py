"""What a rehearsal of a drive has found."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

RECKONED, SIMULATED = "reckoned", "simulated"
"""By the drive's laws on the map and measured costs; by all apps."""


@dataclass(frozen=True)
class RehearsedDrive:
    """What a rehearsal has found so far.

    Args:
        means: how it was found: RECKONED or SIMULATED. state, reason: of the drive's goal. time_s: since it began.
        length_m: driven. energy_wh: as the drive counts it. tilt_deg: the steepest. is_over: nothing more comes.
        charge: by the power manager, 0 to 1; mode: of it; slip: the worst of a wheel that bears, 0 to 1. What is
            reckoned does not know these. look: of what is reckoned several times, which.
    """

    means: str = SIMULATED
    state: str = "begins"
    reason: str = ""
    time_s: float = 0.0
    length_m: float = 0.0
    energy_wh: float = 0.0
    charge: float = math.nan
    tilt_deg: float = 0.0
    slip: float = 0.0
    mode: str = ""
    is_over: bool = False
    look: int = 0


def ends(looks: Sequence[RehearsedDrive]) -> list[tuple[str, int]]:
    """As what they end, and how many do, that of the most first."""
    return Counter(found.state for found in looks).most_common()


def alike(looks: Sequence[RehearsedDrive]) -> list[RehearsedDrive]:
    """Those that end as most do, the quickest first."""
    end, _ = ends(looks)[0]
    return sorted((found for found in looks if found.state == end), key=lambda found: found.time_s)


def middle(looks: Sequence[RehearsedDrive]) -> RehearsedDrive:
    """The one that is neither quick nor slow among those that end as most do; of two the slower."""
    found = alike(looks)
    return found[len(found) // 2]
