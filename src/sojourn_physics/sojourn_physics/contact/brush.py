"""Law 6, brush model of an elastic wheel on firm ground: along, across and both, with aligning moment.

    σ_x = (r_e ω - v_x)/|r_e ω|,  σ_y = -v_y/|r_e ω|,  x = sqrt((C_κ σ_x)² + (C_α σ_y)²)/(3 μ N)
    F = μ N (3 x - 3 x² + x³)  along (C_κ σ_x, C_α σ_y),  full sliding from x = 1
    pneumatic trail  t = (a/3) (1 - x)³/(1 - x + x²/3),   M_z = -t F_y in the sense of travel

(Fromm 1941, Julien; Pacejka 2012, Tire and Vehicle Dynamics, sec. 3.2, eqs. 3.11-3.14 and 3.34 for equal
stiffness; parabolic pressure over the contact's length 2 a.) With σ from the bristles of `bristle_friction`,
so that it is delayed by the relaxation length λ (Pacejka 2012, sec. 7.2) and a parked wheel stays parked.

The lateral force acts a trail t behind the centre, and its slip is that of the point where it acts: so a
turning wheel takes nothing out of the ground either.

Range of validity: slip of any size; loads for which C_κ, C_α, λ are those given. Slip stiffness does not
change with the load here.
"""

from enum import IntEnum
from typing import Any, ClassVar, Literal

from pydantic import Field

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
from sojourn_physics.contact.firm_wheel_laws import ARM_PER_WIDTH


class BrushColumn(IntEnum):
    """Own parameters after `FirmColumn`."""

    LONGITUDINAL_STIFFNESS = FirmColumn.NEXT
    CORNERING_STIFFNESS = FirmColumn.NEXT + 1
    RELAXATION_LENGTH = FirmColumn.NEXT + 2


class BrushParams(CompliantWheelParams):
    """Law 6."""

    columns: ClassVar[type[IntEnum]] = BrushColumn
    model: Literal["brush"] = Field(description="contact model")
    longitudinal_stiffness: float = Field(gt=0.0, le=1e7, description="C_kappa, force over slip [N]")
    cornering_stiffness: float = Field(gt=0.0, le=1e7, description="C_alpha, force over slip angle [N/rad]")
    relaxation_length: float = Field(
        default=0.0, ge=0.0, le=5.0, description="lambda; 0: half the length of the contact [m]"
    )

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return brush


@kernel
def pneumatic_trail(x: float, half: float) -> float:
    """Trail [m] at a part x (0..1) of full sliding, of a contact of half length `half` [m]."""
    rest = 1.0 - x
    return half / 3.0 * rest**3 / (rest + x * x / 3.0)


@kernel
def brush(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`."""
    load = firm_load(wheel, soil, motion, out)
    slip = firm_slip(wheel, motion, out)
    half = half_length(wheel[WheelColumn.RADIUS], motion[MotionColumn.PENETRATION])
    limit = friction_of(wheel, soil) * load
    relaxation = wheel[BrushColumn.RELAXATION_LENGTH] if wheel[BrushColumn.RELAXATION_LENGTH] > 0.0 else half
    stiffness_x, stiffness_y = (
        wheel[BrushColumn.LONGITUDINAL_STIFFNESS] / relaxation,
        wheel[BrushColumn.CORNERING_STIFFNESS] / relaxation,
    )
    # the sense of travel turns over as the contact is renewed
    moved = dt * slip.rim_speed / (2.0 * half)
    state[StateColumn.TRAVEL] = (state[StateColumn.TRAVEL] + moved) / (1.0 + abs(moved))
    trail = 0.0
    if limit > 0.0:
        bent = (stiffness_x * state[StateColumn.SHEAR_ALONG]) ** 2 + (stiffness_y * state[StateColumn.SHEAR_SIDE]) ** 2
        trail = state[StateColumn.TRAVEL] * pneumatic_trail(min(bent**0.5 / (3.0 * limit), 1.0), half)
    yaw_rate = motion[MotionColumn.YAW_RATE]
    sliding = Sliding(slip.along, slip.side + trail * yaw_rate, yaw_rate, slip.rim_speed)
    bristles = Bristles(
        stiffness_x, stiffness_y, ARM_PER_WIDTH * wheel[WheelColumn.WIDTH], limit, relaxation, relaxation
    )
    force_x, force_y, moment_z, _ = bristle_forces(sliding, bristles, dt, state)
    shear = Shear(force_x, force_y, moment_z - trail * force_y)
    finish_firm(wheel, motion, slip, shear, 2.0 * half, dt, state, out)
