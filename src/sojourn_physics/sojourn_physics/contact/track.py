"""Law 12, track on soil: pressure along it, sinkage, thrust, resistances and the moment that resists a turn.

A track of length l and width b lies flat; x runs along it, forwards, 0 in the middle; road wheels, N of them,
press harder than the links between:

    p(x) = p_m [1 - a cos(2π N (x/l + 1/2))],   a in 0..1 (0: even pressure)
    sinkage where the pressure is greatest: p_m (1 + a) = k z^n (least of b and l in k), load W = b l p_m
    slip of the ground under x:  σ = (s, s_y + x ψ),  j = |σ| (l/2 - x) after passing under the track
    τ = (c + p tan φ)(1 - e^(-j/K)) along σ;  thrust, side force and moment by integration over the length
    R_c = b k z^(n + 1)/(n + 1),  R_b = b (c z K_c + γ z² K_γ/2)

(Bekker 1969; Wong 2008, Theory of Ground Vehicles, secs. 2.4, 6.1-6.4; Janosi & Hanamoto 1961; shear against the
local slip: Wong & Chiang 2001, Proc. IMechE D 215:343.) On ground that slides all along the track
(K small) a turn on the spot meets μ W l/4 (Steeds 1950).

s, s_y and ψ are displacements remembered over the length (`shear_memory`, with a twist about the normal),
so that a standing track keeps its shear. In the rows: RIM_SPEED is the speed of the track around its
sprocket, RADIUS that sprocket's radius, to which the torque belongs, PENETRATION the sinkage of the middle.

Assumptions: rigid, level track, evenly loaded left to right; no grousers. Range: sinkage to a quarter of the width.
"""

import math
from enum import IntEnum
from typing import Any, ClassVar, Literal

from pydantic import Field

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import (
    MotionColumn,
    OutColumn,
    StateColumn,
    WheelColumn,
    tell_slip,
)
from sojourn_physics.contact.hysteresis import effective_shear
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.passive_pressure import wall_resistance
from sojourn_physics.contact.resistance_memory import advance_headway
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, clip, shear_lead
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn

POINTS = 48
"""Of the midpoint rule along the track: exact to 0.1 % for up to eight road wheels."""
TWIST_ARM = 1.0 / math.sqrt(12.0)
"""Root of the mean square of the places along a track, over its length: the arm at which a twist counts as shear."""


class LevelTrackColumn(IntEnum):
    """Own parameters."""

    LENGTH = WheelColumn.OWN
    ROAD_WHEELS = WheelColumn.OWN + 1
    PEAKEDNESS = WheelColumn.OWN + 2


class LevelTrackParams(ContactLawParams):
    """Law 12."""

    columns: ClassVar[type[IntEnum]] = LevelTrackColumn
    support: ClassVar[str] = "track"
    model: Literal["track"] = Field(description="contact model")
    length: float = Field(gt=0.0, le=10.0, description="of the track on the ground [m]")
    road_wheels: int = Field(default=1, ge=1, le=8, description="number of road wheels [-]")
    peakedness: float = Field(default=0.0, ge=0.0, le=1.0, description="a: pressure between 1 - a and 1 + a [-]")

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return track


@kernel
def track_shear(
    wheel: FloatArray,
    soil: FloatArray,
    mean_pressure: float,
    slip: float,
    side_slip: float,
    turn: float,
    rolling: float,
) -> tuple[float, float, float]:
    """Thrust, side force [N] and moment about the normal [N m] of a track that runs ahead.

    Args:
        mean_pressure: p_m [Pa]. slip, side_slip: s, s_y [-]. turn: ψ [1/m]. rolling: 0..1, where 0 shears all of the
            length by the same displacement.
    """
    length, width = wheel[LevelTrackColumn.LENGTH], wheel[WheelColumn.WIDTH]
    wave = 2.0 * math.pi * wheel[LevelTrackColumn.ROAD_WHEELS]
    step = length / POINTS
    force_x = force_y = moment = 0.0
    for i in range(POINTS):
        part = (i + 0.5) / POINTS
        x = (part - 0.5) * length
        pressure = mean_pressure * (1.0 - wheel[LevelTrackColumn.PEAKEDNESS] * math.cos(wave * part))
        passed = rolling * (1.0 - part) * length + (1.0 - rolling) * length
        j_x = slip * passed / soil[SoilColumn.SHEAR_MODULUS]
        j_y = (side_slip + turn * x) * passed / soil[SoilColumn.SHEAR_MODULUS_LATERAL]
        j = math.sqrt(j_x * j_x + j_y * j_y)
        gain = -math.expm1(-j) / j if j > 1e-9 else 1.0
        limit = (soil[SoilColumn.COHESION] + pressure * soil[SoilColumn.TAN_PHI]) * gain * width * step
        force_x += limit * j_x
        force_y += limit * j_y
        moment += limit * j_y * x
    return force_x, force_y, moment


@kernel
def track(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`."""
    length, width, sinkage = (
        float(wheel[LevelTrackColumn.LENGTH]),
        float(wheel[WheelColumn.WIDTH]),
        float(motion[MotionColumn.PENETRATION]),
    )
    v_along, v_side, track_speed = (
        motion[MotionColumn.V_ALONG],
        motion[MotionColumn.V_SIDE],
        motion[MotionColumn.RIM_SPEED],
    )
    yaw_rate, n = motion[MotionColumn.YAW_RATE], soil[SoilColumn.N]
    # the contact is renewed by the track's own motion, and by that of its ends over the ground
    swept = 0.5 * length * abs(yaw_rate)
    transport = max(abs(track_speed), math.sqrt(v_along * v_along + v_side * v_side), swept)
    kept = 1.0 / (1.0 + dt * transport / length)
    slip_speed = track_speed - v_along
    state[StateColumn.SHEAR_ALONG] = (state[StateColumn.SHEAR_ALONG] + dt * slip_speed) * kept
    state[StateColumn.SHEAR_SIDE] = (state[StateColumn.SHEAR_SIDE] - dt * v_side) * kept
    state[StateColumn.TWIST] = (state[StateColumn.TWIST] - dt * yaw_rate) * kept
    arm = TWIST_ARM * length
    displacement = math.sqrt(
        state[StateColumn.SHEAR_ALONG] ** 2 + state[StateColumn.SHEAR_SIDE] ** 2 + (arm * state[StateColumn.TWIST]) ** 2
    )
    shear_x, shear_y, shear_z = effective_shear(
        dt * slip_speed, -dt * v_side, -dt * arm * yaw_rate, kept, displacement, state
    )
    travel = dt * track_speed / length
    state[StateColumn.TRAVEL] = clip((state[StateColumn.TRAVEL] + travel) / (1.0 + abs(travel)), -1.0, 1.0)
    headway = advance_headway(v_along, length, dt, state)

    modulus = pressure_modulus(soil, min(width, length))
    greatest = modulus * sinkage**n
    load = width * length * greatest / (1.0 + wheel[LevelTrackColumn.PEAKEDNESS])
    load *= clip(1.0 - soil[SoilColumn.CONTACT_DAMPING] * motion[MotionColumn.V_NORMAL], 0.0, MAX_DAMPING_GAIN)
    lead = shear_lead(transport)
    slip = clip((shear_x + lead * slip_speed) / length, -1.0, 1.0)
    side_slip = clip((shear_y - lead * v_side) / length, -1.0, 1.0)
    turn = clip((shear_z / arm - lead * yaw_rate) / length, -2.0 / length, 2.0 / length)
    sense = 1.0 if state[StateColumn.TRAVEL] >= 0.0 else -1.0
    # a track that runs backwards is one that runs ahead, turned about
    force_x, force_y, moment = track_shear(
        wheel, soil, load / (width * length), sense * slip, side_slip, sense * turn, abs(state[StateColumn.TRAVEL])
    )
    thrust = sense * force_x
    compaction = width * greatest * sinkage / (n + 1.0)
    unit_weight = soil[SoilColumn.DENSITY] * wheel[WheelColumn.GRAVITY]
    wall_cohesion, wall_tan_phi = soil[SoilColumn.BULLDOZING_COHESION], soil[SoilColumn.BULLDOZING_TAN_PHI]
    bulldozing = width * wall_resistance(sinkage, wall_cohesion, wall_tan_phi, unit_weight)
    out[OutColumn.FORCE_X] = thrust - (compaction + bulldozing) * headway
    out[OutColumn.FORCE_Y] = force_y
    out[OutColumn.FORCE_Z] = load
    out[OutColumn.MOMENT_Z] = sense * moment
    out[OutColumn.TORQUE] = wheel[WheelColumn.RADIUS] * thrust
    out[OutColumn.SINKAGE] = sinkage
    out[OutColumn.COMPACTION_RESISTANCE] = compaction * abs(headway)
    out[OutColumn.BULLDOZING_RESISTANCE] = bulldozing * abs(headway)
    tell_slip(motion, track_speed, out)
