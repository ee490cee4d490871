"""Law 7, rigid wheel on soil by Bekker's closed forms: sinkage, thrust and motion resistances one by one.

    load         W = b k sqrt(D) z^(n + 1/2) (3 - n)/3                            (Bekker 1969, sec. 2.7)
    contact      L = (D/2) acos(1 - 2 z/D), A = b L
    thrust       H = (A c + W tan φ) [1 - (1 - e^-j)/j],  j² = (s L/K_x)² + (s_y L/K_y)², along (s/K_x, s_y/K_y)
                 (Janosi & Hanamoto 1961, displacement growing evenly over the contact)
    resistances  R_c = b k z^(n + 1)/(n + 1) by compaction, R_b by bulldozing (`passive_pressure`)
    drawbar      F_x = H - R_c - R_b,  torque T = r H

The textbook model that vehicles such as the lunar rover were designed with. With the memory of the direction of
travel D (`shear_memory`): a wheel that has not rolled shears all of its contact by the same displacement
(1 - e^-j), blended linearly in |D|; the resistances oppose the motion of the centre (`resistance_memory`).

Assumptions: those of `soil.pressure_sinkage`: stress under the rim as under a plate, arc by a parabola; friction
over an even pressure. Range: z below D/6, n up to 1.3, wheels larger than 0.5 m.
"""

import math
from typing import ClassVar, Literal

from pydantic import Field

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import (
    ContactModel,
    MotionColumn,
    OutColumn,
    StateColumn,
    WheelColumn,
    tell_slip,
)
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.passive_pressure import wheel_bulldozing
from sojourn_physics.contact.resistance_memory import advance_headway
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, advance_rolling, clip
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn

MIN_CONTACT_LENGTH = 0.04
"""Least contact length, as a fraction of the radius."""
MIN_LOAD_FACTOR = 0.05
"""Least value of (3 - n)/3."""


class BekkerWheelParams(ContactLawParams):
    """Law 7: nothing beside the wheel's shape and the soil."""

    number: ClassVar[ContactModel] = ContactModel.BEKKER_WHEEL_ON_SOIL
    model: Literal["bekker_wheel_on_soil"] = Field(description="contact model")


@kernel
def wheel_load(radius: float, width: float, sinkage: float, soil: FloatArray) -> float:
    """W [N] of a wheel sunk by `sinkage` [m]."""
    n = soil[SoilColumn.N]
    factor = max((3.0 - n) / 3.0, MIN_LOAD_FACTOR)
    return float(width * pressure_modulus(soil, width) * math.sqrt(2.0 * radius) * sinkage ** (n + 0.5) * factor)


@kernel
def mean_shear(j: float, rolling: float) -> float:
    """Part of the soil's strength that is mobilised, over j: growing evenly (rolling = 1), or all the same (0)."""
    if j < 1e-4:
        return rolling * (0.5 - j / 6.0) + (1.0 - rolling) * (1.0 - 0.5 * j)
    same = -math.expm1(-j)
    return (rolling * (1.0 - same / j) + (1.0 - rolling) * same) / j


@kernel
def bekker_wheel(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`."""
    radius, width, sinkage = (
        float(wheel[WheelColumn.RADIUS]),
        float(wheel[WheelColumn.WIDTH]),
        float(motion[MotionColumn.PENETRATION]),
    )
    contact = radius * math.acos(clip(1.0 - sinkage / radius, -1.0, 1.0))
    length = max(contact, MIN_CONTACT_LENGTH * radius)
    shear_x, shear_y = advance_rolling(motion, length, dt, state)
    headway = advance_headway(motion[MotionColumn.V_ALONG], length, dt, state)
    load = wheel_load(radius, width, sinkage, soil)
    load *= clip(1.0 - soil[SoilColumn.CONTACT_DAMPING] * motion[MotionColumn.V_NORMAL], 0.0, MAX_DAMPING_GAIN)

    j_x = clip(shear_x, -length, length) / soil[SoilColumn.SHEAR_MODULUS]
    j_y = clip(shear_y, -length, length) / soil[SoilColumn.SHEAR_MODULUS_LATERAL]
    j = math.sqrt(j_x * j_x + j_y * j_y)
    strength = width * contact * soil[SoilColumn.COHESION] + load * soil[SoilColumn.TAN_PHI]
    shear = strength * mean_shear(j, abs(state[StateColumn.TRAVEL]))
    thrust = shear * j_x
    n = soil[SoilColumn.N]
    compaction = width * pressure_modulus(soil, width) * sinkage ** (n + 1.0) / (n + 1.0)
    unit_weight = soil[SoilColumn.DENSITY] * wheel[WheelColumn.GRAVITY]
    wall_cohesion, wall_tan_phi = soil[SoilColumn.BULLDOZING_COHESION], soil[SoilColumn.BULLDOZING_TAN_PHI]
    bulldozing = wheel_bulldozing(sinkage, radius, width, wall_cohesion, wall_tan_phi, unit_weight)
    cos_camber = math.sqrt(max(1.0 - motion[MotionColumn.CAMBER] ** 2, 0.0))
    out[OutColumn.FORCE_X] = thrust - (compaction + bulldozing) * headway
    out[OutColumn.FORCE_Y] = shear * j_y
    out[OutColumn.FORCE_Z] = load
    out[OutColumn.MOMENT_X] = radius * (motion[MotionColumn.CAMBER] * load + cos_camber * out[OutColumn.FORCE_Y])
    out[OutColumn.TORQUE] = radius * thrust
    out[OutColumn.SINKAGE] = sinkage
    out[OutColumn.COMPACTION_RESISTANCE] = compaction * abs(headway)
    out[OutColumn.BULLDOZING_RESISTANCE] = bulldozing * abs(headway)
    tell_slip(motion, motion[MotionColumn.RIM_SPEED], out)
