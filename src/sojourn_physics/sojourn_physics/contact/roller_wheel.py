"""Law 11, wheels with rollers on their rim: omni-directional and Mecanum wheels on firm ground.

The rollers' axes lie at an angle η to the wheel's axle, seen from above: e = (sin η, cos η) along the axis,
f = (cos η, -sin η) the free direction, both in (along, side). With the slip velocity w of the lowest point

    F = F_e e + F_f f,   F_e: friction of `bristle_friction` on w·e,   F_f = μ_r N H(w·f)

(Muir & Neuman 1987, J. Robotic Systems 4:281: a roller carries force along its axis only). μ_r is the
friction of the roller's own bearing, with a memory of its sense. η = 90 degrees is the omni wheel, which
is free to the side; 45 or -45 degrees the Mecanum wheel (Ilon 1972); near 0 the wheel would have no traction.
The rollers' rims together are the circle of the wheel.

    no slip along the roller's axis:   r ω sin η = v_x sin η + v_y cos η

Assumptions: the contact stays under the middle of the wheel as one roller follows the other; the rollers have no
inertia. Range: firm ground, where rollers turn.
"""

import math
from enum import IntEnum
from typing import Any, Literal

from pydantic import Field, field_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.bristle_friction import Bristles, Sliding, bristle_forces
from sojourn_physics.contact.contact_law import MotionColumn, StateColumn, WheelColumn
from sojourn_physics.contact.firm_wheel import (
    CompliantWheelParams,
    FirmColumn,
    Shear,
    finish_firm,
    firm_load,
    firm_slip,
    friction_of,
    half_length,
)

MIN_ROLLER_ANGLE_DEG = 5.0


class RollerColumn(IntEnum):
    """Own parameters after `FirmColumn`."""

    SIN_ANGLE = FirmColumn.NEXT
    COS_ANGLE = FirmColumn.NEXT + 1
    ROLLER_FRICTION = FirmColumn.NEXT + 2


class RollerWheelParams(CompliantWheelParams):
    """Law 11."""

    model: Literal["roller_wheel"] = Field(description="contact model")
    stiffness: float = Field(default=1e6, gt=0.0, le=1e8, description="of the wheel and its rollers [N/m]")
    break_away: float = Field(default=1e-3, ge=1e-5, le=0.1, description="displacement before full sliding [m]")
    roller_angle_deg: float = Field(
        ge=-90.0,
        le=90.0,
        description="from the axle to the roller's axis, towards ahead; omni 90, Mecanum 45 or -45 [degree]",
    )
    roller_friction: float = Field(default=0.01, ge=0.0, le=1.0, description="of a turning roller, over the load [-]")

    @field_validator("roller_angle_deg")
    @classmethod
    def _rollers_are_not_along_the_axle(cls, angle_deg: float) -> float:
        _checked(math.radians(angle_deg))
        return angle_deg

    def rollers_deg(self) -> float:
        """See ContactChoice."""
        return self.roller_angle_deg

    def fill(self, row: FloatArray) -> None:
        """The columns of this set."""
        super().fill(row)
        angle = math.radians(self.roller_angle_deg)
        row[RollerColumn.SIN_ANGLE] = math.sin(angle)
        row[RollerColumn.COS_ANGLE] = math.cos(angle)
        row[RollerColumn.ROLLER_FRICTION] = self.roller_friction

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return roller_wheel


def _checked(angle: float) -> float:
    if not MIN_ROLLER_ANGLE_DEG <= abs(math.degrees(angle)) <= 90.0 + 1e-9:
        allowed = f"{MIN_ROLLER_ANGLE_DEG:g} to 90 degrees to either side"
        raise InvalidValueError("roller_angle_deg", math.degrees(angle), allowed)
    return angle


@kernel
def roller_wheel(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`. The state's TRAVEL is here the sense in which the roller turns."""
    load = firm_load(wheel, soil, motion, out)
    slip = firm_slip(wheel, motion, out)
    length = 2.0 * half_length(wheel[WheelColumn.RADIUS], motion[MotionColumn.PENETRATION])
    sine, cosine = wheel[RollerColumn.SIN_ANGLE], wheel[RollerColumn.COS_ANGLE]
    along_axis = sine * slip.along + cosine * slip.side
    free = cosine * slip.along - sine * slip.side
    limit = friction_of(wheel, soil) * load
    stiffness = 3.0 * limit / wheel[FirmColumn.BREAK_AWAY]
    # both the wheel's rotation and the roller's bring fresh ground into contact
    renewed = max(abs(slip.rim_speed), abs(free))
    bristles = Bristles(stiffness, stiffness, 0.0, limit, length, length)
    axial, _, _, _ = bristle_forces(Sliding(along_axis, 0.0, 0.0, renewed), bristles, dt, state)
    moved = dt * free / length
    state[StateColumn.TRAVEL] = min(max((state[StateColumn.TRAVEL] + moved) / (1.0 + abs(moved)), -1.0), 1.0)
    bearing = min(wheel[RollerColumn.ROLLER_FRICTION] * load, limit) * state[StateColumn.TRAVEL]
    force_x = axial * sine + bearing * cosine
    force_y = axial * cosine - bearing * sine
    finish_firm(wheel, motion, slip, Shear(force_x, force_y, 0.0), length, dt, state, out)
