"""Law 13, foot pad: sinkage, bearing and shear under the foot of a leg.

    pressure   p_b = k z^n (Bekker, b = a in k) until the soil fails under the foot at Terzaghi's
               p_u = 1.3 c N_c + γ z N_q + 0.6 γ a N_γ:   1/p^m = 1/p_b^m + 1/p_u^m, m = 4, for a pad of radius a
    load       W = π a² p (1 - d dz/dt), Hunt and Crossley's damping
    shear      the pad slides as a whole: displacement (u_x, u_y, r ψ) with r = 2 a/3, the arm of friction under even
               pressure; T = (π a² c + W tan φ)(1 - e^(-|u|/K)), moment r T_ψ
    wall       of the soil that a sunk pad shoves aside, 2 a (c z K_c + γ z² K_γ/2), with the same 1 - e^(-|u|/K)

(Bekker 1969; Terzaghi 1943; Janosi & Hanamoto 1961.) In the rows: RADIUS is that of the pad, PENETRATION its depth;
a pad has no axle. A pad that slides forgets where it stood over MEMORY shear moduli, as `pad_on_soil` does
for bodies that lie on the ground.

Range of validity: flat round pads, z up to their radius.
"""

import math
from typing import Any, Literal

from pydantic import Field

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import MotionColumn, OutColumn, StateColumn, WheelColumn
from sojourn_physics.contact.hysteresis import effective_shear
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.passive_pressure import round_bearing_capacity, wall_resistance
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, clip, shear_lead
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn

MEMORY = 4.0
"""Displacement that is kept in steady sliding, in shear moduli."""
FRICTION_ARM = 2.0 / 3.0
"""Arm of the friction of a turning pad over its radius."""
SHARPNESS = 4.0
"""m of the passage from sinkage to failure."""


class FootPadParams(ContactLawParams):
    """Law 13: nothing beside the pad's radius and the soil."""

    model: Literal["foot_pad"] = Field(description="contact model")

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return foot_pad


@kernel
def pad_pressure(radius: float, sinkage: float, soil: FloatArray, unit_weight: float) -> float:
    """Mean pressure under a pad at a depth [Pa]."""
    bekker = pressure_modulus(soil, radius) * sinkage ** soil[SoilColumn.N]
    cohesion, tan_phi = soil[SoilColumn.BULLDOZING_COHESION], soil[SoilColumn.BULLDOZING_TAN_PHI]
    capacity = round_bearing_capacity(sinkage, radius, cohesion, tan_phi, unit_weight)
    low, high = min(bekker, capacity), max(bekker, capacity)
    if low <= 0.0:
        return 0.0
    return float(low / (1.0 + (low / high) ** SHARPNESS) ** (1.0 / SHARPNESS))


@kernel
def foot_pad(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`."""
    radius, sinkage, modulus = (
        float(wheel[WheelColumn.RADIUS]),
        float(motion[MotionColumn.PENETRATION]),
        soil[SoilColumn.SHEAR_MODULUS],
    )
    v_along, v_side, yaw_rate = motion[MotionColumn.V_ALONG], motion[MotionColumn.V_SIDE], motion[MotionColumn.YAW_RATE]
    arm = FRICTION_ARM * radius
    speed = math.sqrt(v_along * v_along + v_side * v_side + (arm * yaw_rate) ** 2)
    kept = 1.0 / (1.0 + dt * speed / (MEMORY * modulus))
    state[StateColumn.SHEAR_ALONG] = (state[StateColumn.SHEAR_ALONG] - dt * v_along) * kept
    state[StateColumn.SHEAR_SIDE] = (state[StateColumn.SHEAR_SIDE] - dt * v_side) * kept
    state[StateColumn.TWIST] = (state[StateColumn.TWIST] - dt * yaw_rate) * kept
    displacement = math.sqrt(
        state[StateColumn.SHEAR_ALONG] ** 2 + state[StateColumn.SHEAR_SIDE] ** 2 + (arm * state[StateColumn.TWIST]) ** 2
    )
    shear_x, shear_y, shear_z = effective_shear(
        -dt * v_along, -dt * v_side, -dt * arm * yaw_rate, kept, displacement, state
    )

    area = math.pi * radius * radius
    unit_weight = soil[SoilColumn.DENSITY] * wheel[WheelColumn.GRAVITY]
    load = area * pad_pressure(radius, sinkage, soil, unit_weight)
    load *= clip(1.0 - soil[SoilColumn.CONTACT_DAMPING] * motion[MotionColumn.V_NORMAL], 0.0, MAX_DAMPING_GAIN)
    lead = shear_lead(speed)
    u_x, u_y = shear_x - lead * v_along, shear_y - lead * v_side
    turned = shear_z - lead * arm * yaw_rate
    slide = math.sqrt(u_x * u_x + u_y * u_y)
    displacement = math.sqrt(slide * slide + turned * turned)
    gain = -math.expm1(-displacement / modulus) / displacement if displacement > 1e-12 else 1.0 / modulus
    friction = (area * soil[SoilColumn.COHESION] + load * soil[SoilColumn.TAN_PHI]) * gain
    wall_gain = -math.expm1(-slide / modulus) / slide if slide > 1e-12 else 1.0 / modulus
    wall = (
        2.0
        * radius
        * wall_resistance(
            sinkage, soil[SoilColumn.BULLDOZING_COHESION], soil[SoilColumn.BULLDOZING_TAN_PHI], unit_weight
        )
        * wall_gain
    )
    out[OutColumn.FORCE_X] = (friction + wall) * u_x
    out[OutColumn.FORCE_Y] = (friction + wall) * u_y
    out[OutColumn.FORCE_Z] = load
    out[OutColumn.MOMENT_Z] = friction * turned * arm
    out[OutColumn.SINKAGE] = sinkage
    out[OutColumn.BULLDOZING_RESISTANCE] = wall * slide
