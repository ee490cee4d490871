"""What slip means for a goal: slower, another way, the end.

From `slow` on the rover drives slower, down to a part of its speed at `another_way`: wheels that slip dig, and the
slower the more is seen of it in time. There the ground ahead is taken for loose and closed on the map, the rover goes
back over its own track, and a detour is planned as round any obstacle. Beyond `stuck_slip` of the slip estimate the
goal ends (`drive_slip`); so it does where there is no camera and so no map to find another way on. An operator's
velocities are his own.

Slip comes and goes with the bumps: what counts is its mean over `time`. While the rover goes back it does not count,
nor below `least_pace`: of wheels that come to a stop the body's rocking makes any slip.

Sources: Helmick, Angelova & Matthies (2009), J. Field Robotics 26(4):391 (slip as a part of what can be passed);
Maimone, Cheng & Matthies (2007), J. Field Robotics 24(3):169 (drives ended by a limit on slip, on Mars); Heverly et al.
(2013), J. Field Robotics 30(6):835 (limits of some tens of percent for Curiosity).
"""

from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params


class SlipPolicyParams(Params):
    """Slip is 1 - speed over ground / speed of the wheels, of the machine as a whole."""

    slow: float = Field(..., gt=0.0, lt=1.0, description="slip from which the rover drives slower [-]")
    slow_speed: float = Field(..., gt=0.0, le=1.0, description="part of its speed that is left at another_way [-]")
    another_way: float = Field(..., gt=0.0, lt=1.0, description="slip at which it looks for another way [-]")
    time: float = Field(..., gt=0.0, le=60.0, description="over which slip is averaged [s]")
    least_pace: float = Field(..., gt=0.0, le=10.0, description="speed of wheels below which slip does not count [m/s]")
    loose_radius: float = Field(..., gt=0.0, le=10.0, description="ground ahead that is taken for loose then [m]")
    back: float = Field(..., gt=0.0, le=10.0, description="way back before another is planned [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.slow < self.another_way:
            raise ValueError(f"slow = {self.slow}: allowed is less than another_way = {self.another_way}")
        return self


def mean_slip(params: SlipPolicyParams, before: float, slip: float | None, dt: float) -> float:
    """The averaged slip after a period of `dt` [s] with a slip, None where it does not count [-]."""
    if slip is None:
        return before
    return before + dt / (params.time + dt) * (slip - before)


def speed_part(params: SlipPolicyParams, slip: float) -> float:
    """Part of the speed that an averaged slip leaves [-]."""
    share = min(max((slip - params.slow) / (params.another_way - params.slow), 0.0), 1.0)
    return 1.0 - share * (1.0 - params.slow_speed)
