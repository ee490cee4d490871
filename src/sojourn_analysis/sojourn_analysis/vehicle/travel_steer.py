"""Kinematic errors of a suspension: how its travel steers, leans and shifts the wheels.

Of a wheel in the frame of the chassis, with its axle a (unit vector, to the left at rest) and its centre p:

    heading  t = atan2(-a_x, a_y),   camber  g = asin(a_z),   travel  dz = dp_z, up

The passive joints q between chassis and wheel (rockers, bogies, arms of a suspension) move. Of all ways to lift the
wheel by dz the one along the gradient is taken, dq = J_z^T/(J_z J_z^T) dz; where there is one joint it is the only one:

    toe by travel  dt/dz,   camber by travel  dg/dz,   shift of track  dp_y/dz,   of wheelbase  dp_x/dz
    roll steer     a body that rolls by f (left side up) on flat ground lets the left wheel down by y f and lifts the
                   right one: the axle steers by  e f,  e = -[y_l (dt/dz)_l + y_r (dt/dz)_r]/2

The steering error of a large travel is what is left of the heading asked for: with the steering axis tilted by an angle
c in the wheel's pitch, tan t = tan d cos c. (Dixon 2009, Suspension Geometry and Computation, ch. 6 and 8; Gillespie
1992, ch. 6.) Assumptions: rigid links; joints of the steering stay where they are. Range: any tree of joints.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

STEP = 1e-5
"""Of the joints, for central differences [rad], [m]."""


class TravelRates(NamedTuple):
    """What a metre of upward travel does: heading, camber [rad/m], shift ahead and to the left [m/m]."""

    toe: float
    camber: float
    ahead: float
    left: float


def wheel_pose(machine: StandingMachine, wheel: int, angles: Mapping[str, float]) -> FloatArray:
    """Heading, camber [rad] and x, y, z [m] of a wheel in base_link, joints at angles or at 0; (5,)."""
    configuration = pin.neutral(machine.model)
    for name, angle in angles.items():
        if not machine.model.existJointName(name):
            raise InvalidValueError("joint", name, "one of " + ", ".join(list(machine.model.names)[2:]))
        joint = machine.model.joints[machine.model.getJointId(name)]
        if joint.nq == 2:
            configuration[joint.idx_q : joint.idx_q + 2] = np.cos(angle), np.sin(angle)
        else:
            configuration[joint.idx_q] = angle
    pin.forwardKinematics(machine.model, machine.data, configuration)
    place = machine.data.oMi[machine.wheels[wheel]]
    axle = place.rotation[:, 1]
    return np.array([np.arctan2(-axle[0], axle[1]), np.arcsin(np.clip(axle[2], -1.0, 1.0)), *place.translation])


def suspension_joints(machine: StandingMachine, wheel: int) -> tuple[str, ...]:
    """Passive and sprung joints between the chassis and a wheel."""
    support = list(machine.model.supports[machine.wheels[wheel]])
    return tuple(name for name in (*machine.passive, *machine.sprung) if machine.model.getJointId(name) in support)


def travel_rates(machine: StandingMachine, wheel: int, angles: Mapping[str, float] | None = None) -> TravelRates | None:
    """Rates of a wheel about a posture; None where nothing lets it travel up and down.

    Args:
        wheel: number of the wheel. angles: of joints by name, such as of the steering; the others are at 0 [rad].
    """
    posture = dict(angles or {})
    joints = suspension_joints(machine, wheel)
    columns = []
    for name in joints:
        ends = [
            wheel_pose(machine, wheel, {**posture, name: posture.get(name, 0.0) + sign * STEP}) for sign in (1.0, -1.0)
        ]
        columns.append((ends[0] - ends[1]) / (2.0 * STEP))
    jacobian = np.array(columns).reshape(len(joints), 5).T
    lift = jacobian[4]
    square = float(lift @ lift)
    if square < 1e-12:
        return None
    toe, camber, ahead, left, _ = jacobian @ (lift / square)
    return TravelRates(float(toe), float(camber), float(ahead), float(left))


def contact_shift(machine: StandingMachine, wheel: int) -> float | None:
    """dx/dz of the lowest point of a wheel whose motor or brake holds it to its carrier; None where it cannot travel.

    The way of that point leads at right angles to the line to the instant centre of the suspension, which rises so by
    this much over its run backward, and by minus this much over its run forward.
    """
    joints = suspension_joints(machine, wheel)
    radius = machine.machine.wheels[wheel].radius
    ways = []
    for name in joints:
        ends = [_lowest_point(machine, wheel, radius, {name: sign * STEP}) for sign in (1.0, -1.0)]
        ways.append((ends[0] - ends[1]) / (2.0 * STEP))
    jacobian = np.array(ways).reshape(len(joints), 2)
    lift = jacobian[:, 1]
    square = float(lift @ lift)
    return float(jacobian[:, 0] @ lift / square) if square > 1e-12 else None


def _lowest_point(machine: StandingMachine, wheel: int, radius: float, angles: Mapping[str, float]) -> FloatArray:
    """x, z [m] of the point of the carrier that is lowest at the joints' zero; (2,)."""
    pose = wheel_pose(machine, wheel, angles)
    down = machine.data.oMi[machine.wheels[wheel]].rotation[:, 2]
    return np.array([pose[2] - radius * down[0], pose[4] - radius * down[2]])


def roll_steer(machine: StandingMachine, wheels: tuple[int, int], angles: Mapping[str, float] | None = None) -> float:
    """e of an axle: its steering over the roll of the body [rad/rad]; 0 where its wheels do not travel.

    Args:
        wheels: numbers of its two wheels.
    """
    total = 0.0
    for wheel in wheels:
        rates = travel_rates(machine, wheel, angles)
        if rates is not None:
            total -= 0.5 * rates.toe * float(wheel_pose(machine, wheel, angles or {})[3])
    return total


def steering_error(machine: StandingMachine, wheel: int, steer: float, travel: Mapping[str, float]) -> float:
    """Change of a wheel's heading [rad] when its suspension leaves the middle, steered by an angle [rad].

    Args:
        travel: angles or ways of suspension joints by name [rad], [m].
    """
    joint = machine.machine.wheels[wheel].steer_joint
    held = {} if joint is None else {joint: steer}
    change = wheel_pose(machine, wheel, {**held, **travel})[0] - wheel_pose(machine, wheel, held)[0]
    return float((change + np.pi) % (2.0 * np.pi) - np.pi)
