"""The interface that all contact laws share: what goes in, what comes out, where each number stands.

    law(wheel, soil, motion, dt, state, out)

    wheel   row of `WheelColumn`, then the law's own parameters      fixed
    soil    row of `SoilColumn`, of the ground under this contact     given at each step
    motion  row of `MotionColumn`                                     given at each step
    dt      step [s]
    state   row of `StateColumn`, advanced in place; a law uses as much of it as it needs. All zero is a contact that
            has just been made; `contact_set` clears it where a contact ends
    out     row of `OutColumn`, zero on entry, written

Contact frame: x along the ground in the wheel's plane, y to the side (the axle's direction along the ground),
z the normal of the ground, out of it. Forces act from the ground on the wheel; moments are taken about the
wheel's centre, without the moment about the axle, which is `TORQUE`: the torque that the motor has to supply.
The moment of the ground on the wheel is so  M_x x + M_y y + M_z z - T a,  a the unit vector of the axle,
a = cos γ y + sin γ z with the camber γ.

A force F at the wheel's lowest point, a distance R from the centre, has
M_x = R (sin γ F_z + cos γ F_y), M_y = M_z = 0, T = R F_x.

Every law is finite for every finite input, takes energy out of steady motion and never gives any, and is
continuous through zero speed. Tracks and feet use the same rows; what a column means there is told in their
modules.
"""

import math
from enum import IntEnum

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray


class WheelColumn(IntEnum):
    """Columns of a wheel's row that every law knows. A law's own parameters start at OWN."""

    RADIUS = 0
    """Of the rim, not pressed flat; radius of a pad [m]."""
    SHEAR_RADIUS = 1
    """Of the circle on which the soil shears, through the tips of the grousers [m]."""
    WIDTH = 2
    GROUSER_HEIGHT = 3
    GROUSER_COUNT = 4
    GRAVITY = 5
    """Where the wheel is: weight of the soil that it pushes [m/s^2]."""
    LAW = 6
    """Which law: see `law_call`."""
    OWN = 7


OWN_COLUMNS = 56
"""Room for a law's own parameters."""
WHEEL_COLUMNS = WheelColumn.OWN + OWN_COLUMNS


class MotionColumn(IntEnum):
    """How the wheel stands and moves against the ground, in the contact frame."""

    PENETRATION = 0
    """Of the undeformed rim's lowest point below the ground [m]; more than 0."""
    V_ALONG = 1
    """Velocity of the wheel's centre [m/s]."""
    V_SIDE = 2
    V_NORMAL = 3
    RIM_SPEED = 4
    """Radius times rate of rotation about the axle [m/s]."""
    YAW_RATE = 5
    """Rate of turn of the whole wheel about the normal [rad/s]."""
    CAMBER = 6
    """Sine of the angle γ between the axle and the ground; cos γ > 0."""
    ROLL_RATE = 7
    """Rate of turn of the whole wheel about x [rad/s]."""


MOTION_COLUMNS = len(MotionColumn)


class StateColumn(IntEnum):
    """Memory of a contact. The names are those of the rolling laws (see `shear_memory`)."""

    SHEAR_ALONG = 0
    """u_x [m]; displacement in map of a pad on a body, three columns, then what `pad_on_soil` keeps of a tool."""
    SHEAR_SIDE = 1
    """u_y [m]."""
    TRAVEL = 2
    """D in -1..1, memory of the sense of travel [-]."""
    TWIST = 3
    """Angle by which the contact is twisted about the normal [rad]."""
    HEADWAY = 4
    """In -1..1, memory of the sense in which a resistance acts (see `resistance_memory`) [-]."""
    LARGEST_SHEAR = 5
    """Largest shear displacement that the soil in this contact has seen [m]."""


SLIDERS = 4
"""Elements of the hysteresis of soil, each with three columns of its own after the others (see `hysteresis`) [m]."""
STATE_NAMES = (
    *(column.name.lower() for column in StateColumn),
    *(f"slider_{number}_{axis}" for number in range(1, SLIDERS + 1) for axis in ("along", "side", "twist")),
)
"""Of all columns of a contact's state."""
STATE_COLUMNS = len(STATE_NAMES)


class OutColumn(IntEnum):
    """What a law gives."""

    FORCE_X = 0
    FORCE_Y = 1
    FORCE_Z = 2
    MOMENT_X = 3
    MOMENT_Y = 4
    MOMENT_Z = 5
    TORQUE = 6
    SINKAGE = 7
    """Of the ground [m]."""
    DEFLECTION = 8
    """Of the wheel [m]."""
    SLIP_RATIO = 9
    """(r ω - v)/max(|r ω|, |v|) in the sense of travel, -1..1; 0 at rest."""
    SLIP_ANGLE = 10
    """[rad]"""
    ROLLING_RESISTANCE = 11
    """[N], at least 0."""
    COMPACTION_RESISTANCE = 12
    BULLDOZING_RESISTANCE = 13
    POWER = 14
    """That the wheel gives to the contact [W], written by `contact_set`; in steady motion all of it is lost."""


OUT_COLUMNS = len(OutColumn)

REST_SPEED = 1e-4
"""Below this speed no slip is told [m/s]."""


@kernel
def tell_slip(motion: FloatArray, rim_speed: float, out: FloatArray) -> None:
    """Write slip ratio and slip angle as they are defined for steady rolling.

    Args:
        rim_speed: rate of rotation times the radius on which the wheel rolls freely [m/s].
    """
    v_along, v_side = motion[MotionColumn.V_ALONG], motion[MotionColumn.V_SIDE]
    if max(abs(rim_speed), math.sqrt(v_along * v_along + v_side * v_side)) >= REST_SPEED:
        ratio = (rim_speed - v_along) / max(abs(rim_speed), abs(v_along), REST_SPEED)
        ahead = 0.5 * (v_along + rim_speed) >= 0.0
        out[OutColumn.SLIP_RATIO] = min(max(ratio if ahead else -ratio, -1.0), 1.0)
        out[OutColumn.SLIP_ANGLE] = math.atan2(v_side, abs(v_along))
