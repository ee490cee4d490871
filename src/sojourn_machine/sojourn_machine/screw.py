"""From rotation to translation: power screws and ball screws.

Screw with lead l on the mean diameter d, friction m on the flanks of half angle g (0 for a square thread), r =
atan(m/cos g), lead angle e = atan(l/(pi d)):

    raising  T = F (d/2) tan(e + r),  n_f = tan e / tan(e + r)
    lowering T = F (d/2) tan(r - e): more than 0 where it locks itself, e <= r;  n_b = tan(e - r)/tan e
(Shigley, Mechanical Engineering Design, ch. 8.)
Assumptions: collar friction left out, friction independent of speed. Range: e + r below a right angle.
"""

import math
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params


class ScrewParams(Params):
    """A screw behind a gear: it makes the turning of the gear's output the sliding of the joint."""

    lead: float = Field(gt=0.0, le=1.0, description="way of one turn [m]")
    diameter: float = Field(gt=0.0, le=1.0, description="mean diameter of the thread [m]")
    friction: float = Field(ge=0.0, le=1.0, description="of the flanks, of a ball screw some 0.01 [-]")
    flank_deg: float = Field(default=0.0, ge=0.0, le=45.0, description="half angle of the flanks, 0: square [degree]")

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if self.lead_angle + self.friction_angle >= 0.5 * math.pi:
            raise ValueError("lead, friction: allowed are lead and friction angle below a right angle together")
        return self

    @property
    def lead_angle(self) -> float:
        """[rad]"""
        return math.atan(self.lead / (math.pi * self.diameter))

    @property
    def friction_angle(self) -> float:
        """[rad]"""
        return math.atan(self.friction / math.cos(math.radians(self.flank_deg)))

    @property
    def turns(self) -> float:
        """Angle of the screw for a way of the joint [rad/m]."""
        return 2.0 * math.pi / self.lead

    @property
    def raising_efficiency(self) -> float:
        """Work on the force over work of the torque [-]."""
        return math.tan(self.lead_angle) / math.tan(self.lead_angle + self.friction_angle)

    @property
    def back_driving_efficiency(self) -> float:
        """Work of the torque over work of the force that drives it [-]; 0 where the screw locks itself."""
        return max(math.tan(self.lead_angle - self.friction_angle) / math.tan(self.lead_angle), 0.0)

    @property
    def locks_itself(self) -> bool:
        """Whether a force cannot turn the screw."""
        return self.lead_angle <= self.friction_angle
