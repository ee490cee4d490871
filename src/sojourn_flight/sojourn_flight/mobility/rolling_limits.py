"""How fast a rolling machine, its wheels and its steering may go."""

from typing import NamedTuple

from sojourn_flight.mobility.motion_limits import MotionLimits
from sojourn_flight.mobility.rolling_params import RollingParams


class RollingLimits(NamedTuple):
    """The limits of the machine, and those of its wheels and steering; units as in their parameters."""

    max_speed: float
    max_yaw_rate: float
    max_acceleration: float
    max_deceleration: float
    max_wheel_rate: float
    max_steer_rate: float
    max_steer_acceleration: float

    @classmethod
    def of(cls, machine: MotionLimits, wheels: RollingParams) -> "RollingLimits":
        """From both parameter sets."""
        return cls(
            machine.max_speed,
            machine.max_yaw_rate,
            machine.max_acceleration,
            machine.max_deceleration,
            wheels.max_wheel_rate,
            wheels.max_steer_rate,
            wheels.max_steer_acceleration,
        )
