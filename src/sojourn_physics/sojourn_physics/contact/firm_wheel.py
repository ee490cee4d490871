"""What the laws of wheels on firm ground share: load, radii, slip of the lowest point, rolling resistance.

    load      wheel and ground in series (`series_compliance`), times 1 - d dh/dt of Hunt and Crossley (1975), where d
              is the ground's damping weighted with its part of the penetration, and the wheel's with its own
    contact   half its length a = sqrt(2 r h - h²), the chord of the undeformed circle
    radii     rolling r_e = r - δ/3, loaded r - δ (Wong 2008, Theory of Ground Vehicles, sec. 1.2; Jazar 2008,
              Vehicle Dynamics, sec. 3.3: the effective radius of a pressed circle is about r - δ/3)
    slip      w_x = r_e ω - v_x,  w_y = -(v_y + (r - δ) cos γ ω_x): of the lowest point, which turns with the wheel
    rolling   moment (f_0 + K V²) N r_e, V = |r_e ω|, against the rotation (Wong 2008, sec. 1.2.1), with a memory of
              its sense (`resistance_memory`)

The axle feels F_x at the rolling radius: then motor, ground and motion agree on the work. The load acts at
the lowest point, so that a tilted wheel is turned over by it as its height says, and does no work in a closed
path.
"""

import math
from enum import IntEnum
from typing import ClassVar, NamedTuple

from pydantic import Field

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import MotionColumn, OutColumn, WheelColumn, tell_slip
from sojourn_physics.contact.law_params import FIRM_GROUND, ContactLawParams
from sojourn_physics.contact.resistance_memory import advance_headway
from sojourn_physics.contact.series_compliance import Carcass, round_rim_on_ground, sinkage_in_series
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, clip
from sojourn_physics.soil.params import SoilColumn

MIN_HALF_LENGTH = 0.02
"""Least half length of a contact, as a fraction of the radius."""


class FirmSlip(NamedTuple):
    """How a wheel rolls and slips on firm ground."""

    along: float
    """w_x, velocity of the rim over the ground [m/s]."""
    side: float
    """w_y [m/s]."""
    rim_speed: float
    """r_e ω [m/s]."""
    rolling_radius: float
    """r_e [m]."""
    loaded_radius: float
    """Of the axle over the ground [m]."""


class Shear(NamedTuple):
    """What the ground gives to a wheel in its own plane."""

    force_x: float
    """[N]"""
    force_y: float
    """[N]"""
    moment_z: float
    """[N m]"""


class FirmColumn(IntEnum):
    """Own parameters of every law of wheels on firm ground; a law's further ones start at NEXT."""

    STIFFNESS = WheelColumn.OWN
    PROGRESSIVE_STIFFNESS = WheelColumn.OWN + 1
    STOP_DEFLECTION = WheelColumn.OWN + 2
    STOP_STIFFNESS = WheelColumn.OWN + 3
    DAMPING = WheelColumn.OWN + 4
    FRICTION = WheelColumn.OWN + 5
    ROLLING_RESISTANCE = WheelColumn.OWN + 6
    ROLLING_RESISTANCE_PER_SPEED_SQUARED = WheelColumn.OWN + 7
    BREAK_AWAY = WheelColumn.OWN + 8
    NEXT = WheelColumn.OWN + 9


class FirmWheelParams(ContactLawParams):
    """Friction and rolling resistance of a wheel on firm ground."""

    needs: ClassVar[tuple[str, ...]] = FIRM_GROUND
    friction: float = Field(
        default=0.0, ge=0.0, le=3.0, description="coefficient of friction; 0: tan of the ground's friction angle [-]"
    )
    rolling_resistance: float = Field(default=0.01, ge=0.0, le=1.0, description="f0 of f = f0 + K V^2 [-]")
    rolling_resistance_per_speed_squared: float = Field(
        default=0.0, ge=0.0, le=0.1, description="K of f = f0 + K V^2 [s2/m2]"
    )

    def fill(self, row: FloatArray) -> None:
        """The columns of this set, by name."""
        for column in (*FirmColumn, *(self.columns or ())):
            name = column.name.lower()
            if name in type(self).model_fields:
                row[column] = getattr(self, name)


class CompliantWheelParams(FirmWheelParams):
    """A wheel that gives way: its load against its deflection, measured on rigid ground."""

    stiffness: float = Field(gt=0.0, le=1e8, description="load over deflection, for small deflection [N/m]")
    progressive_stiffness: float = Field(default=0.0, ge=0.0, le=1e10, description="growth of the load, c2 d^2 [N/m2]")
    stop_deflection: float = Field(default=5.0, gt=0.0, le=5.0, description="deflection at the bump stop [m]")
    stop_stiffness: float = Field(default=0.0, ge=0.0, le=1e8, description="of the bump stop, beside the wheel's [N/m]")
    damping: float = Field(default=1.0, ge=0.0, le=100.0, description="Hunt-Crossley damping of the wheel [s/m]")


@kernel
def firm_load(wheel: FloatArray, soil: FloatArray, motion: FloatArray, out: FloatArray) -> float:
    """Load of the contact [N], also written to `out` with sinkage and deflection."""
    radius, penetration = float(wheel[WheelColumn.RADIUS]), float(motion[MotionColumn.PENETRATION])
    amount, exponent = round_rim_on_ground(radius, wheel[WheelColumn.WIDTH], soil)
    carcass = Carcass(
        0.0,
        wheel[FirmColumn.STIFFNESS],
        wheel[FirmColumn.PROGRESSIVE_STIFFNESS],
        wheel[FirmColumn.STOP_DEFLECTION],
        wheel[FirmColumn.STOP_STIFFNESS],
    )
    sinkage = sinkage_in_series(amount, exponent, penetration, carcass)
    deflection = penetration - sinkage
    part = sinkage / penetration
    damping = part * soil[SoilColumn.CONTACT_DAMPING] + (1.0 - part) * wheel[FirmColumn.DAMPING]
    rising = motion[MotionColumn.V_NORMAL] + radius * motion[MotionColumn.CAMBER] * motion[MotionColumn.ROLL_RATE]
    load = amount * sinkage**exponent * clip(1.0 - damping * rising, 0.0, MAX_DAMPING_GAIN)
    out[OutColumn.FORCE_Z] = load
    out[OutColumn.SINKAGE] = sinkage
    out[OutColumn.DEFLECTION] = deflection
    return float(load)


@kernel
def half_length(radius: float, penetration: float) -> float:
    """Half the length of the contact [m]."""
    depth = min(penetration, radius)
    return max(math.sqrt(depth * (2.0 * radius - depth)), MIN_HALF_LENGTH * radius)


@kernel
def friction_of(wheel: FloatArray, soil: FloatArray) -> float:
    """Coefficient of friction [-]."""
    return float(wheel[FirmColumn.FRICTION]) if wheel[FirmColumn.FRICTION] > 0.0 else float(soil[SoilColumn.TAN_PHI])


@kernel
def firm_slip(wheel: FloatArray, motion: FloatArray, out: FloatArray) -> FirmSlip:
    """How the wheel rolls; after `firm_load`."""
    radius = float(wheel[WheelColumn.RADIUS])
    deflection = min(out[OutColumn.DEFLECTION], radius)
    rolling, loaded = radius - deflection / 3.0, radius - deflection
    rim_speed = motion[MotionColumn.RIM_SPEED] * (rolling / radius)
    cos_camber = math.sqrt(max(1.0 - motion[MotionColumn.CAMBER] ** 2, 0.0))
    slip_y = -(motion[MotionColumn.V_SIDE] + loaded * cos_camber * motion[MotionColumn.ROLL_RATE])
    return FirmSlip(rim_speed - motion[MotionColumn.V_ALONG], slip_y, rim_speed, rolling, loaded)


@kernel
def finish_firm(
    wheel: FloatArray,
    motion: FloatArray,
    slip: FirmSlip,
    shear: Shear,
    length: float,
    dt: float,
    state: FloatArray,
    out: FloatArray,
) -> None:
    """Write forces and moments of a contact whose load is in `out`; adds the rolling resistance.

    Args:
        shear: of the ground on the wheel. length: of the contact [m]. dt: [s].
    """
    rim_speed = slip.rim_speed
    load = out[OutColumn.FORCE_Z]
    headway = advance_headway(rim_speed, length, dt, state)
    resistance = (
        wheel[FirmColumn.ROLLING_RESISTANCE]
        + wheel[FirmColumn.ROLLING_RESISTANCE_PER_SPEED_SQUARED] * rim_speed * rim_speed
    ) * load
    cos_camber = math.sqrt(max(1.0 - motion[MotionColumn.CAMBER] ** 2, 0.0))
    out[OutColumn.FORCE_X] = shear.force_x
    out[OutColumn.FORCE_Y] = shear.force_y
    # the load acts at the rim as it was, the shear at the rim as it is
    out[OutColumn.MOMENT_X] = (
        wheel[WheelColumn.RADIUS] * motion[MotionColumn.CAMBER] * load + slip.loaded_radius * cos_camber * shear.force_y
    )
    out[OutColumn.MOMENT_Z] = shear.moment_z
    out[OutColumn.TORQUE] = slip.rolling_radius * (shear.force_x + resistance * headway)
    out[OutColumn.ROLLING_RESISTANCE] = resistance * abs(headway)
    tell_slip(motion, rim_speed, out)
