"""The two bodies of an articulated machine, from its URDF: what `articulated` needs.

What hangs on the steering joint is the rear body, all else the front one; each with its wheels, held stiff. Masses,
centres of mass and yaw inertias are those at zero articulation. The steering servo holds the joint as a spring and a
damper: its gains at the output.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_analysis.vehicle.articulated import Joint, VehicleUnit
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_machine.drives import geared_motor_of
from sojourn_machine.errors import InvalidValueError


class TwoBodies(NamedTuple):
    """Front and rear body, without axle stiffness (1 N/rad), the joint, and its largest angle to both sides [rad]."""

    front: VehicleUnit
    rear: VehicleUnit
    joint: Joint
    largest_angle: float


def two_bodies(machine: StandingMachine, joint: str, angles: Mapping[str, float] | None = None) -> TwoBodies:
    """The halves before and behind a joint, standing on flat ground.

    Args:
        joint: that steers. angles: of other joints, as of a stowed arm [rad].

    Raises:
        InvalidValueError: a joint that is not between two bodies with wheels.
    """
    model, data = machine.model, machine.data
    if not model.existJointName(joint):
        raise InvalidValueError("joint", joint, "one of " + ", ".join(list(model.names)[2:]))
    servo = geared_motor_of(machine.machine.drives, joint).servo
    stance = machine.stand(lambda x, y: 0.0, angles=angles)
    pin.forwardKinematics(model, data, stance.configuration)
    number = model.getJointId(joint)
    place = float(data.oMi[number].translation[0])
    behind = set(model.subtrees[number])
    ahead = set(range(1, model.njoints)) - behind
    bodies = []
    for links, sign in ((ahead, 1.0), (behind, -1.0)):
        wheels = [stance.contacts[k, 0] for k, wheel in enumerate(machine.wheels) if wheel in links]
        if not wheels:
            raise InvalidValueError("joint", joint, "one with wheels before and behind it")
        total = pin.Inertia.Zero()
        for link in links:
            total += model.inertias[link].se3Action(data.oMi[link])
        bodies.append(
            VehicleUnit(
                float(total.mass),
                float(total.inertia[2, 2]),
                sign * (float(total.lever[0]) - place),
                sign * (float(np.mean(wheels)) - place),
                1.0,
            )
        )
    at = model.joints[number].idx_q
    largest = min(abs(model.lowerPositionLimit[at]), abs(model.upperPositionLimit[at]))
    return TwoBodies(bodies[0], bodies[1], Joint(servo.proportional, servo.derivative), float(largest))
