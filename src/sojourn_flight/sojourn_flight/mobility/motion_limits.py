"""How fast a machine may be asked to move, whatever it moves on."""

from pydantic import Field

from sojourn_machine.params import Params


class MotionLimits(Params):
    """What the machine may be asked to do."""

    max_speed: float = Field(..., gt=0.0, le=10.0, description="fastest speed over ground [m/s]")
    max_yaw_rate: float = Field(..., gt=0.0, le=5.0, description="fastest turn [rad/s]")
    max_acceleration: float = Field(
        ..., gt=0.0, le=20.0, description="speeding up, of a wheel at its rim, of a track's belt [m/s^2]"
    )
    max_deceleration: float = Field(..., gt=0.0, le=20.0, description="slowing down, likewise [m/s^2]")
