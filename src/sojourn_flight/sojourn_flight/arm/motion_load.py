"""What a motion asks of the arm's drives: torque of each joint, and power from the bus, at every sample of it.

Rigid-body torque T of the reference (Newton-Euler, gravity as the IMU sees it), and what friction makes of it at the
motor over its gear, with the law of the plant's drives:

    tau = T + F_0 s + b qd,   s = sign(qd)
    tau_m = tau/n where the motor drives (tau s > 0), tau/(2 - n) where it is driven
    P = sum over joints of max(0, tau_m qd + w tau_m^2)

F_0, b: friction; n: efficiency of the gear; w: winding loss R/(N k)^2. What a driven motor gives back is lost. A joint
at rest is held by tau = T: the friction that would help is not counted on. Limits: the joint's effort (URDF), the
motor's torque (current and servo), the power that the arm may draw.

A motion that asks for too much is planned anew, slower (planning.py): inertia and power fall, what gravity and friction
ask for does not. Assumptions: as `feedforward`; looked at every `SAMPLE_TIME`, between which torques of a jerk-limited
motion change little.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import ArmDriveParams
from sojourn_flight.arm.trajectory import JointReference
from sojourn_machine.params import FloatArray

SAMPLE_TIME = 0.04
"""Between two looks at a motion [s]."""
MOST_SAMPLES = 400
_AT_REST = 1e-9
_BISECTIONS = 10
_MARGIN = 0.97
"""Share of the limits that a slowed motion may take: changing its rate takes some, too."""


@dataclass(frozen=True, slots=True)
class LoadPeak:
    """The largest share of a limit that a motion asks for, and what that is, in words."""

    share: float
    text: str


def motor_efforts(params: ArmDriveParams, rigid: FloatArray, velocities: FloatArray) -> FloatArray:
    """tau_m (k, n) [N m or N] for rigid-body efforts and velocities, (k, n) each."""
    sense = np.where(np.abs(velocities) > _AT_REST, np.sign(velocities), 0.0)
    asked = rigid.copy()
    if params.coulomb_friction:
        asked += np.array(params.coulomb_friction) * sense
    if params.viscous_friction:
        asked += np.array(params.viscous_friction) * velocities
    if not params.gear_efficiency:
        return asked
    efficiency = np.array(params.gear_efficiency)
    return np.where(asked * sense > 0.0, asked / efficiency, np.where(sense == 0.0, asked, asked / (2.0 - efficiency)))


def power_drawn(params: ArmDriveParams, motor: FloatArray, velocities: FloatArray) -> FloatArray:
    """P (k,) [W]."""
    loss = np.array(params.winding_loss) if params.winding_loss else 0.0
    return np.asarray(np.sum(np.maximum(motor * velocities + loss * motor**2, 0.0), axis=1))


def peak(params: ArmDriveParams, model: ArmModel, path: JointPath, gravity: FloatArray) -> LoadPeak:
    """The sample of a motion that comes nearest to a limit, or goes beyond it.

    Args:
        gravity: in base_link (3,), pointing down [m/s2].
    """
    count = int(min(max(np.ceil(path.duration / SAMPLE_TIME), 2), MOST_SAMPLES)) + 1
    times = np.linspace(0.0, path.duration, count)
    q, qd, qdd = (np.array(column) for column in zip(*(path.sample(t) for t in times), strict=True))
    rigid = np.array([rigid_effort(model, *row, gravity) for row in zip(q, qd, qdd, strict=True)])
    return _largest(params, model, rigid, qd)


def _largest(params: ArmDriveParams, model: ArmModel, rigid: FloatArray, velocities: FloatArray) -> LoadPeak:
    """The largest share of a limit among samples of rigid-body efforts and velocities, (k, n) each."""
    motor = motor_efforts(params, rigid, velocities)
    joints = np.abs(rigid) / model.max_effort
    if params.motor_effort:
        joints = np.maximum(joints, np.abs(motor) / np.array(params.motor_effort))
    k, i = np.unravel_index(int(np.argmax(joints)), joints.shape)
    worst = LoadPeak(
        float(joints[k, i]),
        f"{model.joint_names[i]} would need {abs(motor[k, i]):.1f} {model.effort_unit(int(i))}, "
        f"{joints[k, i]:.2f} of what it can give",
    )
    drawn = power_drawn(params, motor, velocities)
    largest = float(drawn.max())
    if params.power_limit is not None and largest / params.power_limit > worst.share:
        text = f"the arm would draw {largest:.1f} W, its limit is {params.power_limit:.1f} W"
        return LoadPeak(largest / params.power_limit, text)
    return worst


def rate_within(
    params: ArmDriveParams, model: ArmModel, path: JointPath, start: float, gravity: FloatArray
) -> tuple[float, LoadPeak]:
    """How fast the rest of a path may be run within the motors' torques and the power that the parameters allow.

    At the rate r (path_clock.py) velocities are r times, inertial efforts r^2 times those of the plan; what gravity
    asks for stays.

    Args:
        start: from this time on the path [s].

    Returns:
        the rate, 0 to 1 (0: holding alone asks for more), and what holding asks for.
    """
    count = int(min(max(np.ceil((path.duration - start) / SAMPLE_TIME), 2), MOST_SAMPLES)) + 1
    q, qd, qdd = (
        np.array(column)
        for column in zip(*(path.sample(t) for t in np.linspace(start, path.duration, count)), strict=True)
    )
    zero = np.zeros(model.joint_count)
    held = np.array([rigid_effort(model, row, zero, zero, gravity) for row in q])
    moving = np.array([rigid_effort(model, *row, gravity) for row in zip(q, qd, qdd, strict=True)]) - held

    def asked(rate: float) -> LoadPeak:
        return _largest(params, model, held + rate**2 * moving, rate * qd)

    holding = asked(0.0)
    if asked(1.0).share <= 1.0:
        return 1.0, holding
    return _largest_within(asked), holding


def share_within(
    params: ArmDriveParams,
    model: ArmModel,
    positions: FloatArray,
    rates: FloatArray,
    contact: FloatArray,
    gravity: FloatArray,
) -> tuple[float, str]:
    """How much of joint rates (n,) may be run now within the motors' torques and the power that the parameters allow.

    Inertia is left out: for motions that change their speed slowly.

    Args:
        contact: efforts (n,) with which the joints press against a contact [N m or N].
        gravity: in base_link (3,), pointing down [m/s2].

    Returns:
        the share, 0 to 1 (0: holding alone asks for more), and what is asked for, in words; empty at 1.
    """
    zero = np.zeros(model.joint_count)
    held = (rigid_effort(model, positions, zero, zero, gravity) + contact)[None, :]

    def asked(share: float) -> LoadPeak:
        return _largest(params, model, held, share * rates[None, :])

    whole = asked(1.0)
    if whole.share <= 1.0:
        return 1.0, ""
    slow = _largest_within(asked)
    return slow, whole.text if slow > 0.0 else asked(0.0).text


def slower(model: ArmModel, factor: float, start: JointReference) -> ArmModel:
    """The arm with limits of a motion that takes 1/factor of the time; never below what `start` has already."""
    return replace(
        model,
        max_velocity=np.maximum(factor * model.max_velocity, np.abs(start.velocity)),
        max_acceleration=np.maximum(factor**2 * model.max_acceleration, np.abs(start.acceleration)),
        max_jerk=model.max_jerk if np.any(start.velocity) else factor**3 * model.max_jerk,
    )


def _largest_within(asked: Callable[[float], LoadPeak]) -> float:
    """Largest share of a speed, 0 to 1, whose load is within the limits, by halving; 0 where none is."""
    slow, fast = 0.0, 1.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (slow + fast)
        if asked(middle).share <= _MARGIN:
            slow = middle
        else:
            fast = middle
    return slow
