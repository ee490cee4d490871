"""A wheel on a crust: a bed of springs under the rim (Winkler 1867), friction with break-away, rolling resistance.

N = 2/3 k b l z (1 - c dz/dt),   l = 2 sqrt(z (2 r - z)),   T = r (F_x + f N sign)
"""

import math
from enum import IntEnum
from typing import Any, ClassVar, Literal

from pydantic import Field

from sojourn_machine.kernels import kernel
from sojourn_physics.contact.bristle_friction import Bristles, Sliding, bristle_forces
from sojourn_physics.contact.contact_law import MotionColumn, OutColumn, WheelColumn, tell_slip
from sojourn_physics.contact.law_params import ContactLawParams

DAMPING = 3.0
"""c [s/m]."""


class CrustColumn(IntEnum):
    BED_STIFFNESS = WheelColumn.OWN
    FRICTION = WheelColumn.OWN + 1
    BREAK_AWAY = WheelColumn.OWN + 2
    RESISTANCE = WheelColumn.OWN + 3


class CrustParams(ContactLawParams):
    columns: ClassVar[type[IntEnum] | None] = CrustColumn
    needs: ClassVar[tuple[str, ...]] = ()
    model: Literal["crust"]
    bed_stiffness: float = Field(gt=0.0, description="k [N/m3]")
    friction: float = Field(gt=0.0, le=2.0, description="[-]")
    break_away: float = Field(gt=0.0, le=0.1, description="displacement before full sliding [m]")
    resistance: float = Field(ge=0.0, le=1.0, description="f [-]")

    @classmethod
    def law(cls) -> Any:
        return crust


@kernel
def crust(wheel, soil, motion, dt, state, out):
    radius, depth = wheel[WheelColumn.RADIUS], min(motion[MotionColumn.PENETRATION], wheel[WheelColumn.RADIUS])
    length = 2.0 * math.sqrt(depth * (2.0 * radius - depth))
    yielding = min(max(1.0 - DAMPING * motion[MotionColumn.V_NORMAL], 0.0), 2.0)
    load = 2.0 / 3.0 * wheel[CrustColumn.BED_STIFFNESS] * wheel[WheelColumn.WIDTH] * length * depth * yielding
    limit, rim = wheel[CrustColumn.FRICTION] * load, motion[MotionColumn.RIM_SPEED]
    sliding = Sliding(
        rim - motion[MotionColumn.V_ALONG], -motion[MotionColumn.V_SIDE], motion[MotionColumn.YAW_RATE], rim
    )
    stiffness = 3.0 * limit / wheel[CrustColumn.BREAK_AWAY]
    give = 0.5 * length + 1e-3
    force_x, force_y, moment, _ = bristle_forces(
        sliding, Bristles(stiffness, stiffness, 0.25 * length, limit, give, give), dt, state
    )
    resistance = wheel[CrustColumn.RESISTANCE] * load
    out[OutColumn.FORCE_X], out[OutColumn.FORCE_Y], out[OutColumn.FORCE_Z] = force_x, force_y, load
    out[OutColumn.MOMENT_X], out[OutColumn.MOMENT_Z] = radius * force_y, moment
    out[OutColumn.TORQUE] = radius * (force_x + resistance * math.tanh(rim / 0.01))
    out[OutColumn.SINKAGE], out[OutColumn.ROLLING_RESISTANCE] = depth, resistance
    tell_slip(motion, rim, out)
