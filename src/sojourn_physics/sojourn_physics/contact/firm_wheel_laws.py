"""Laws 1, 2 and 4: wheels with Coulomb friction on firm ground; they differ in what gives way.

    1  rigid wheel on rigid ground           the ground alone, as stiff as its parameters say
    2  wheel and ground in series            a linear spring in the wheel as well
    4  compliant wheel on rigid ground       load against deflection as measured, to the bump stop and beyond

Friction is that of `bristle_friction` with the bristles of a dry contact: full sliding after a displacement
`break_away`, k = 3 μ N/break_away; the contact's length is the relaxation length. A wheel is b wide, so that
its resistance to a turn on the spot is μ N b/4 (a line of even pressure).

Range of validity: hard, dry, clean contact; no hydrodynamics, no wear; speeds of rovers.
"""

from typing import Any, Literal

from pydantic import Field

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.bristle_friction import Bristles, Sliding, bristle_forces
from sojourn_physics.contact.contact_law import MotionColumn, WheelColumn
from sojourn_physics.contact.firm_wheel import (
    CompliantWheelParams,
    FirmColumn,
    FirmWheelParams,
    Shear,
    finish_firm,
    firm_load,
    firm_slip,
    friction_of,
    half_length,
)

ARM_PER_WIDTH = 0.25
"""Arm of the friction moment of a turn on the spot, over the width."""


class RigidWheelOnRigidGroundParams(FirmWheelParams):
    """Law 1."""

    model: Literal["rigid_wheel_on_rigid_ground"] = Field(description="contact model")
    break_away: float = Field(default=1e-3, ge=1e-5, le=0.1, description="displacement before full sliding [m]")

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return coulomb_wheel


class WheelAndGroundInSeriesParams(FirmWheelParams):
    """Law 2."""

    model: Literal["wheel_and_ground_in_series"] = Field(description="contact model")
    stiffness: float = Field(gt=0.0, le=1e8, description="of the wheel [N/m]")
    damping: float = Field(default=1.0, ge=0.0, le=100.0, description="Hunt-Crossley damping of the wheel [s/m]")
    break_away: float = Field(default=1e-3, ge=1e-5, le=0.1, description="displacement before full sliding [m]")

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return coulomb_wheel


class CompliantWheelOnRigidGroundParams(CompliantWheelParams):
    """Law 4."""

    model: Literal["compliant_wheel_on_rigid_ground"] = Field(description="contact model")
    break_away: float = Field(default=5e-3, ge=1e-5, le=0.1, description="displacement before full sliding [m]")

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return coulomb_wheel


@kernel
def coulomb_wheel(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The three laws; arguments as in `contact_law`."""
    load = firm_load(wheel, soil, motion, out)
    slip = firm_slip(wheel, motion, out)
    length = 2.0 * half_length(wheel[WheelColumn.RADIUS], motion[MotionColumn.PENETRATION])
    limit = friction_of(wheel, soil) * load
    stiffness = 3.0 * limit / wheel[FirmColumn.BREAK_AWAY]
    sliding = Sliding(slip.along, slip.side, motion[MotionColumn.YAW_RATE], slip.rim_speed)
    bristles = Bristles(stiffness, stiffness, ARM_PER_WIDTH * wheel[WheelColumn.WIDTH], limit, length, length)
    force_x, force_y, moment_z, _ = bristle_forces(sliding, bristles, dt, state)
    finish_firm(wheel, motion, slip, Shear(force_x, force_y, moment_z), length, dt, state, out)
