"""Laws 5 and 8, compliant wheel on soil: pressed flat where the soil could press harder than its carcass bears.

Penetration h of the undeformed rim is sinkage z and deflection δ. Where the soil under a rigid rim would
reach the carcass pressure, k h^n > p_c, the wheel flattens until

    k z^n = p_c(δ) = p_0 + p_1 δ + p_s max(δ - δ_s, 0),   h = z + δ   (flat part; Bekker 1960, Off-the-Road Locomotion)

with a bump stop at δ_s: an inner frame or rim that bears where the carcass is pressed in so far.
Else it is a rigid wheel, δ = 0, z = h. The rim meets the soil at θ1 = acos(1 - h/r) and is flat from
θ_c = acos(1 - δ/r) on, over the length 2 r sin θ_c:

    front arc   σ = k [r (cos θ - cos θ1)]^n,  θ_c <= θ <= θ1,   pressed by z at θ_c, where σ = p_c
    flat part   σ = p_c(δ)
    load        b ∫ σ r cos θ dθ + b p_c 2 r sin θ_c + vertical part of the shear
    compaction  b ∫ σ r sin θ dθ = b k z^(n + 1)/(n + 1)
    shear       τ = t (c + σ tan φ)(1 - e^-J) over arc and flat part, J as in `wheel_on_soil` on the arc; on the flat
                part it goes on growing by s along and s_y across for each length. t is the strength of the tread: 1
                where soil shears on soil, 0.5 to 0.8 where it slides on metal (Potyondy 1961, Géotechnique 11(4):339)
    torque      r_e b ∫ τ_x, r_e = r - δ/3

(Wong 2008, Theory of Ground Vehicles, secs. 2.5.1-2.5.2 and 2.6; Janosi & Hanamoto 1961.) No soil stands behind
the wheel (exit at the end of the flat part), and the greatest stress is under the axle: the angle of greatest
stress of law 3 is not in this model. With the memory D of the direction of travel (`shear_memory`): at D = 0 the
wheel has been pressed straight down, there is an arc behind as in front, and all of the contact is sheared by the same
displacement; blended linearly in |D|. Bulldozing after Hegedus (`passive_pressure`) opposes the centre's motion; it is
at most what an obstacle as high as the wheel is sunk would be: a wheel rides up on a crust that it cannot push away.

Range of validity: δ below r/4, z below r/3. p_c of a wire-mesh or pneumatic wheel comes from its load on rigid
ground over its footprint there.
"""

import math
from enum import IntEnum
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
from sojourn_physics.contact.passive_pressure import obstacle_resistance, wheel_bulldozing
from sojourn_physics.contact.resistance_memory import advance_headway
from sojourn_physics.contact.rigid_rim import Quadrature, RimContact
from sojourn_physics.contact.series_compliance import Carcass, sinkage_in_series
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, advance_rolling, clip
from sojourn_physics.contact.wheel_on_soil import MAX_ENTRY_ANGLE, QUADRATURE, pressure_modulus
from sojourn_physics.soil.params import SoilColumn

MIN_CONTACT_LENGTH = 0.04
"""Least contact length, as a fraction of the radius."""


class CompliantOnSoilColumn(IntEnum):
    """Own parameters."""

    CARCASS_PRESSURE = WheelColumn.OWN
    CARCASS_PRESSURE_SLOPE = WheelColumn.OWN + 1
    TREAD_STRENGTH = WheelColumn.OWN + 2
    BUMP_STOP = WheelColumn.OWN + 3
    BUMP_STOP_SLOPE = WheelColumn.OWN + 4


class CompliantWheelOnSoilParams(ContactLawParams):
    """Laws 5 and 8."""

    number: ClassVar[ContactModel] = ContactModel.COMPLIANT_WHEEL_ON_SOIL
    columns: ClassVar[type[IntEnum]] = CompliantOnSoilColumn
    model: Literal["compliant_wheel_on_soil"] = Field(description="contact model")
    carcass_pressure: float = Field(
        gt=0.0, le=1e7, description="pressure of the flat part, inflation included, at no deflection [Pa]"
    )
    carcass_pressure_slope: float = Field(
        default=0.0, ge=0.0, le=1e9, description="growth of that pressure with the deflection [Pa/m]"
    )
    tread_strength: float = Field(
        default=1.0,
        gt=0.0,
        le=1.0,
        description="what the soil bears in shear on the tread, over what it bears in itself [-]",
    )
    bump_stop: float = Field(
        default=1e3,
        gt=0.0,
        le=1e3,
        description="deflection at which an inner frame bears, too; 1e3: none does [m]",
    )
    bump_stop_slope: float = Field(
        default=0.0, ge=0.0, le=1e9, description="growth of the pressure with the deflection beyond it [Pa/m]"
    )


@kernel
def flattening(wheel: FloatArray, soil: FloatArray, penetration: float) -> tuple[float, float, float]:
    """Sinkage [m], deflection [m] and greatest pressure [Pa] at a penetration [m]."""
    modulus = pressure_modulus(soil, wheel[WheelColumn.WIDTH])
    carcass = Carcass(
        wheel[CompliantOnSoilColumn.CARCASS_PRESSURE],
        wheel[CompliantOnSoilColumn.CARCASS_PRESSURE_SLOPE],
        0.0,
        wheel[CompliantOnSoilColumn.BUMP_STOP],
        wheel[CompliantOnSoilColumn.BUMP_STOP_SLOPE],
    )
    sinkage = sinkage_in_series(modulus, soil[SoilColumn.N], penetration, carcass)
    return sinkage, penetration - sinkage, modulus * sinkage ** soil[SoilColumn.N]


@kernel
def _shear(
    rolled: float, across: float, pressed: float, slip: float, side_slip: float, rolling: float, soil: FloatArray
) -> tuple[float, float]:
    """(J_x, J_y)/|J| (1 - e^-J) at a point of the contact, [-]."""
    j_x = (rolling * rolled + (1.0 - rolling) * slip * pressed) / soil[SoilColumn.SHEAR_MODULUS]
    j_y = side_slip * (rolling * across + (1.0 - rolling) * pressed) / soil[SoilColumn.SHEAR_MODULUS_LATERAL]
    j = math.sqrt(j_x * j_x + j_y * j_y)
    gain = -math.expm1(-j) / j if j > 1e-9 else 1.0
    return gain * j_x, gain * j_y


@kernel
def soft_rim_forces(
    wheel: FloatArray, soil: FloatArray, contact: RimContact, quadrature: Quadrature
) -> tuple[float, float, float, float, float, float]:
    """Forces of the ground on one wheel that travels towards +x.

    Returns:
        F_x, F_y, F_z [N], sum of the shear along the rim [N], sinkage and deflection [m].
    """
    penetration, slip, side_slip, rolling = contact.depth, contact.slip, contact.lateral_slip, contact.rolling
    nodes, weights = quadrature.nodes, quadrature.weights
    radius, width, n = float(wheel[WheelColumn.RADIUS]), float(wheel[WheelColumn.WIDTH]), soil[SoilColumn.N]
    deepest = radius * (1.0 - math.cos(MAX_ENTRY_ANGLE))
    reach = min(penetration, deepest)
    excess = max(penetration / deepest, 1.0)  # beyond the last entry angle the pressure goes on with the penetration
    _, deflection, greatest = flattening(wheel, soil, reach)
    entry = math.acos(min(max(1.0 - reach / radius, -1.0), 1.0))
    flat_angle = math.acos(min(max(1.0 - deflection / radius, -1.0), 1.0))
    modulus = pressure_modulus(soil, width)
    cohesion, tan_phi = (
        wheel[CompliantOnSoilColumn.TREAD_STRENGTH] * soil[SoilColumn.COHESION],
        wheel[CompliantOnSoilColumn.TREAD_STRENGTH] * soil[SoilColumn.TAN_PHI],
    )
    sin_entry, cos_entry, sin_flat = math.sin(entry), math.cos(entry), math.sin(flat_angle)
    drive, brake = max(slip, 0.0), min(slip, 0.0)
    pressed = 2.0 * radius * sin_entry
    behind = 1.0 - rolling
    force_x = force_y = force_z = along = 0.0
    span = entry - flat_angle
    for i in range(nodes.shape[0]):
        part = nodes[i] * nodes[i]  # the root of the pressure at the free edge keeps the order
        area = 2.0 * nodes[i] * weights[i] * span * radius * width
        theta = entry - part * span
        depth = max(radius * (math.cos(theta) - cos_entry), 0.0)
        sigma = modulus * (depth if n == 1.0 else depth**n)
        arc, chord = entry - theta, sin_entry - math.sin(theta)
        rolled = radius * (arc - chord + drive * chord + brake * arc)
        x, y = _shear(rolled, radius * arc, pressed, slip, side_slip, rolling, soil)
        limit = (cohesion + sigma * tan_phi) * area
        cosine, sine = math.cos(theta), math.sin(theta)
        # an arc behind as in front, as far as the wheel has not rolled
        both = 1.0 + behind
        force_x += both * limit * x * cosine - rolling * sigma * area * sine
        force_y += both * limit * y
        force_z += both * sigma * area * cosine + rolling * limit * x * sine
        along += both * limit * x
    arc, chord = entry - flat_angle, sin_entry - sin_flat
    rolled_before = radius * (arc - chord + drive * chord + brake * arc)
    flat = 2.0 * radius * sin_flat
    limit = (cohesion + greatest * tan_phi) * width * flat
    for i in range(nodes.shape[0]):
        passed = nodes[i] * nodes[i] * flat  # closer where the shear begins
        share = 2.0 * nodes[i] * weights[i]
        x, y = _shear(rolled_before + slip * passed, radius * arc + passed, pressed, slip, side_slip, rolling, soil)
        force_x += share * limit * x
        force_y += share * limit * y
        along += share * limit * x
    force_z = max(force_z + greatest * width * flat, 0.0)
    return force_x * excess, force_y * excess, force_z * excess, along * excess, penetration - deflection, deflection


@kernel
def compliant_wheel_on_soil(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`."""
    radius, width, penetration = (
        float(wheel[WheelColumn.RADIUS]),
        float(wheel[WheelColumn.WIDTH]),
        float(motion[MotionColumn.PENETRATION]),
    )
    _, deflection, greatest = flattening(wheel, soil, penetration)
    rolling_radius = radius - min(deflection, radius) / 3.0
    rim_speed = motion[MotionColumn.RIM_SPEED] * rolling_radius / radius
    entry = math.acos(clip(1.0 - penetration / radius, 0.0, 1.0))
    flat_angle = math.acos(clip(1.0 - deflection / radius, 0.0, 1.0))
    behind = 1.0 - abs(state[StateColumn.TRAVEL])
    length = radius * ((1.0 + behind) * math.sin(entry) + (1.0 - behind) * math.sin(flat_angle))
    length = max(length, MIN_CONTACT_LENGTH * radius)
    shear_x, shear_y = advance_rolling(motion, length, dt, state)
    headway = advance_headway(motion[MotionColumn.V_ALONG], length, dt, state)
    sense = 1.0 if state[StateColumn.TRAVEL] >= 0.0 else -1.0
    slip = clip(sense * shear_x / length, -1.0, 1.0)
    side_slip = clip(shear_y / length, -1.0, 1.0)
    contact = RimContact(penetration, slip, side_slip, abs(state[StateColumn.TRAVEL]))
    force_x, force_y, force_z, along, sinkage, deflection = soft_rim_forces(wheel, soil, contact, QUADRATURE)
    force_z *= clip(1.0 - soil[SoilColumn.CONTACT_DAMPING] * motion[MotionColumn.V_NORMAL], 0.0, MAX_DAMPING_GAIN)
    unit_weight = soil[SoilColumn.DENSITY] * wheel[WheelColumn.GRAVITY]
    wall_cohesion, wall_tan_phi = soil[SoilColumn.BULLDOZING_COHESION], soil[SoilColumn.BULLDOZING_TAN_PHI]
    pushed = wheel_bulldozing(sinkage, radius, width, wall_cohesion, wall_tan_phi, unit_weight)
    bulldozing = min(pushed, obstacle_resistance(sinkage, radius, force_z))
    cos_camber = math.sqrt(max(1.0 - motion[MotionColumn.CAMBER] ** 2, 0.0))
    out[OutColumn.FORCE_X] = sense * force_x - bulldozing * headway
    out[OutColumn.FORCE_Y] = force_y
    out[OutColumn.FORCE_Z] = force_z
    out[OutColumn.MOMENT_X] = (
        radius * motion[MotionColumn.CAMBER] * force_z + (radius - min(deflection, radius)) * cos_camber * force_y
    )
    out[OutColumn.TORQUE] = sense * rolling_radius * along
    out[OutColumn.SINKAGE] = sinkage
    out[OutColumn.DEFLECTION] = deflection
    out[OutColumn.COMPACTION_RESISTANCE] = (
        width * greatest * sinkage / (soil[SoilColumn.N] + 1.0) * abs(state[StateColumn.TRAVEL])
    )
    out[OutColumn.BULLDOZING_RESISTANCE] = bulldozing * abs(headway)
    tell_slip(motion, rim_speed, out)
