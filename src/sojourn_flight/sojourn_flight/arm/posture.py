"""Everything that statics, kinematics and dynamics say of an arm in one posture and motion."""

from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.dynamics import coriolis_effort, gravity_effort, mass_matrix
from sojourn_flight.arm.friction import friction_effort
from sojourn_flight.arm.inverse_search import turn_into_limits
from sojourn_flight.arm.kinematics import TipPose, forward_kinematics
from sojourn_flight.arm.manipulability import (
    condition_number,
    largest_force,
    manipulability,
    smallest_singular_value,
)
from sojourn_flight.arm.orientation import Orientation, orientation_of
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Posture:
    """What is known of a posture; arrays (n,) unless another shape is given."""

    tip: TipPose
    orientation: Orientation
    mass_matrix: FloatArray  # (n, n), rotors included [kg m2, kg m, kg]
    coriolis_effort: FloatArray  # [N m or N]
    gravity_effort: FloatArray  # [N m or N]
    friction_effort: FloatArray  # [N m or N]
    inverse_dynamics: FloatArray  # M qdd + c + g [N m or N]
    drive_effort: FloatArray  # with friction [N m or N]
    manipulability: float
    smallest_singular_value: float  # of the scaled Jacobian [-]
    condition_number: float  # of the scaled Jacobian [-]
    beyond_limits: tuple[str, ...]  # joints out of their range, in words
    overloaded: tuple[str, ...]  # joints whose drive effort is above what they can give, in words
    largest_payload: float | None  # further mass at the tip that can be held at rest [kg]; None without weight


def posture(
    arm: SerialArm, positions: FloatArray, velocities: FloatArray, accelerations: FloatArray, gravity: FloatArray
) -> Posture:
    """Figures of an arm (with its payload, if any) at joint positions, velocities, accelerations (n,) each.

    Args:
        gravity: in the base (3,) [m/s2], pointing down.

    Raises:
        InvalidValueError: a wrong number of values, or one that is not finite.
    """
    count = arm.joint_count
    given = {"positions": (positions, count), "velocities": (velocities, count)}
    given |= {"accelerations": (accelerations, count), "gravity": (gravity, 3)}
    for name, (values, length) in given.items():
        if values.shape != (length,) or not np.all(np.isfinite(values)):
            raise InvalidValueError(name, values.tolist(), f"{length} finite numbers")
    tip = forward_kinematics(arm, positions)
    inertia, holding = mass_matrix(arm, positions), gravity_effort(arm, positions, gravity)
    turning, rubbing = coriolis_effort(arm, positions, velocities), friction_effort(arm.friction, velocities)
    rigid = inertia @ accelerations + turning + holding
    weight = float(np.linalg.norm(gravity))
    payload = largest_force(arm, tip.jacobian, holding, -gravity / weight) / weight if weight > 0.0 else None
    return Posture(
        tip=tip,
        orientation=orientation_of(tip.rotation),
        mass_matrix=inertia,
        coriolis_effort=turning,
        gravity_effort=holding,
        friction_effort=rubbing,
        inverse_dynamics=rigid,
        drive_effort=rigid + rubbing,
        manipulability=manipulability(tip.jacobian),
        smallest_singular_value=smallest_singular_value(arm, tip.jacobian),
        condition_number=condition_number(arm, tip.jacobian),
        beyond_limits=_beyond(arm, positions),
        overloaded=tuple(
            f"{arm.joint_names[i]} = {rigid[i] + rubbing[i]:.4g} (limit {arm.max_effort[i]:.4g})"
            for i in range(count)
            if abs(rigid[i] + rubbing[i]) > arm.max_effort[i]
        ),
        largest_payload=payload,
    )


def _beyond(arm: SerialArm, positions: FloatArray) -> tuple[str, ...]:
    turned = positions.copy()
    turn_into_limits(arm.chain, arm.lower, arm.upper, turned)
    texts = []
    for i, value in enumerate(positions):
        low, high = arm.lower[i], arm.upper[i]
        if low <= value <= high:
            continue
        hint = f"; {turned[i]:.4g} is the same posture" if low <= turned[i] <= high else ""
        unit = "rad" if arm.revolute[i] else "m"
        texts.append(f"{arm.joint_names[i]} = {value:.4g} {unit} (range {low:.4g} to {high:.4g}{hint})")
    return tuple(texts)
