"""Law 3, rigid wheel on soil: the stresses of `wheel_on_soil` at the slip that the contact remembers.

Normal damping is of Hunt and Crossley's form, F_n (1 + d dz/dt), never below zero (Hunt & Crossley 1975, J.
Appl. Mech. 42:440). The normal force acts at the lowest point of the rim: a tilted wheel is turned upright or
over by it, and the pressure does no net work on a closed path.

Assumptions and range of validity: those of `wheel_on_soil` and `shear_memory`.
"""

import math
from typing import Any, Literal

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
from sojourn_physics.contact.law_params import ContactLawParams
from sojourn_physics.contact.rigid_rim import RigidRim, RimContact
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, advance_rolling, clip
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, wheel_forces
from sojourn_physics.soil.params import SoilColumn

MIN_CONTACT_LENGTH = 0.04
"""Least contact length, as a fraction of the radius."""


class RigidWheelOnSoilParams(ContactLawParams):
    """Rigid wheel on soil: nothing beside the wheel's shape and the soil."""

    model: Literal["rigid_wheel_on_soil"] = Field(default="rigid_wheel_on_soil", description="contact model")

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return rigid_wheel_on_soil


@kernel
def contact_length(radius: float, sinkage: float, soil: FloatArray, travel: float) -> float:
    """Length of the wheel's contact along the ground [m], from entry to exit, for the relaxation."""
    entry = math.acos(clip(1.0 - sinkage / radius, -0.8, 1.0))
    exit_ratio = max(soil[SoilColumn.EXIT_LAMBDA], 0.0)
    rolling_exit = math.acos(clip(1.0 - exit_ratio * sinkage / radius, -0.8, 1.0))
    rolling = abs(travel)
    behind = rolling * math.sin(rolling_exit) + (1.0 - rolling) * math.sin(entry)
    return radius * (math.sin(entry) + behind)


@kernel
def rigid_wheel_on_soil(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`."""
    radius, sinkage = float(wheel[WheelColumn.RADIUS]), float(motion[MotionColumn.PENETRATION])
    length = max(contact_length(radius, sinkage, soil, state[StateColumn.TRAVEL]), MIN_CONTACT_LENGTH * radius)
    shear_x, shear_y = advance_rolling(motion, length, dt, state)
    sense = 1.0 if state[StateColumn.TRAVEL] >= 0.0 else -1.0
    slip = clip(sense * shear_x / length, -1.0, 1.0)
    side_slip = clip(shear_y / length, -1.0, 1.0)
    rim = RigidRim(
        radius, wheel[WheelColumn.SHEAR_RADIUS], wheel[WheelColumn.WIDTH], wheel[WheelColumn.GROUSER_COUNT], 0.0
    )
    contact = RimContact(sinkage, slip, side_slip, abs(state[StateColumn.TRAVEL]))
    force_x, force_y, force_z, torque, moment_x, moment_z, _, compaction, bulldozing = wheel_forces(
        rim, wheel[WheelColumn.GRAVITY], contact, soil, QUADRATURE
    )
    force_z *= clip(1.0 - soil[SoilColumn.CONTACT_DAMPING] * motion[MotionColumn.V_NORMAL], 0.0, MAX_DAMPING_GAIN)
    out[OutColumn.FORCE_X] = sense * force_x
    out[OutColumn.FORCE_Y] = force_y
    out[OutColumn.FORCE_Z] = force_z
    out[OutColumn.MOMENT_X] = moment_x + radius * force_z * motion[MotionColumn.CAMBER]
    out[OutColumn.MOMENT_Z] = sense * moment_z  # turns about the normal with the sense of travel
    out[OutColumn.TORQUE] = sense * torque
    out[OutColumn.SINKAGE] = sinkage
    out[OutColumn.COMPACTION_RESISTANCE] = compaction
    out[OutColumn.BULLDOZING_RESISTANCE] = bulldozing
    tell_slip(motion, motion[MotionColumn.RIM_SPEED], out)
