"""What a rehearsal of a drive has found."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class RehearsedDrive:
    """What a rehearsal has found so far.

    Args:
        state, reason: of the drive's goal. time_s: since it began. length_m: driven. energy_wh: that the drive counts.
        charge: by the power manager, 0 to 1. tilt_deg: the steepest. slip: the worst of a wheel that bears, 0 to 1.
        mode: of the power manager. is_over: nothing more comes.
    """

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
