"""An arm and a law in a loop as it is on a machine: encoders, sampling, delay, saturation; and what came of it.

Each sample time T the law reads encoders (positions rounded to their steps, speeds as differences of them), and its
efforts, cut to what the motors can give, act from `delay` samples later on for a time T. Between, the arm moves by its
own true dynamics, in steps that take friction linearly implicitly, because it is stiff near rest (Hairer & Wanner,
Solving Ordinary Differential Equations II, 1996, section IV.7):
    (M + h diag F'(v)) a = tau - c - g - F(v),   v += h a,   q += h v.

Margin: with the arm linearised at mid-course, efforts held over a sample and speeds by differences, the factor by which
all feedback gains may grow before an eigenvalue of the sampled loop leaves the unit circle.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from sojourn_flight.arm.control_laws import Gains, LawName, MeasuredJoints, Reference, effort_of, feedback_of, gains_for
from sojourn_flight.arm.dynamics import mass_matrix, rigid_effort
from sojourn_flight.arm.friction import friction_effort
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.profiles import TimedLine, TimedPath, joint_motion
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.params import FloatArray

_SLOPE_STEP = 1.0e-5
_LARGEST_FACTOR = 1.0e3
_LEAST_INERTIA = 1.0e-12
_ANY_SPEED = 1.0
"""Speed of a joint that has no limit [rad/s or m/s]."""


class ControlTestError(MachineError):
    """The arm cannot make the motion that laws are to be compared on."""


@dataclass(frozen=True, slots=True)
class LoopSettings:
    """The loop around a law."""

    bandwidth: float  # of the law [rad/s]
    sample_time: float  # [s]
    delay: int = 1  # samples from reading to acting
    encoder_bits: int = 18  # steps of a turn, or of the range of a joint that slides
    substeps: int = 4  # of the simulation in a sample time
    settle: float = 0.5  # time after the motion, in which it is watched on [s]


@dataclass(frozen=True, slots=True)
class LoopResult:
    """What came of a motion under a law."""

    tip_rms: float  # distance of the tip from where it should be [m]
    joint_rms: float  # over all joints [rad or m]
    largest_joint_error: float  # [rad or m]
    final_tip_error: float  # after settling [m]
    overshoot: float  # beyond the goal, largest over the joints, in shares of their way [-]
    energy: float  # mechanical work of the motors, none given back [J]
    saturated: float  # share of the samples in which an effort was cut [-]
    gain_margin: float  # factor on the feedback; inf: none needed
    unstable: bool  # the errors grew without bound


def settings_for(arm: SerialArm, posture: FloatArray) -> LoopSettings:
    """A bandwidth of 25 rad/s, or that at which an error of 10 mrad (mm) takes all the effort; ten samples a radian."""
    inertia = np.diag(mass_matrix(arm, posture))
    least = float(np.linalg.eigvalsh(mass_matrix(arm, posture))[0])
    if least < _LEAST_INERTIA * float(inertia.max()) or not inertia.max() > 0.0:
        without = [name for name, value in zip(arm.joint_names, inertia, strict=True) if value <= least * 1.001]
        raise ControlTestError(
            f"{arm.name}: no inertia is moved by {', '.join(without) or 'some joints'}: a motion needs masses"
        )
    bandwidth = float(min(25.0, np.min(np.sqrt(arm.max_effort / (0.01 * inertia)))))
    return LoopSettings(bandwidth, 0.1 / bandwidth, settle=12.5 / bandwidth)


def comparison_motion(arm: SerialArm, gravity: FloatArray, longest: float) -> TimedLine:
    """A quintic motion through the middle of every joint's range: 80 % of each speed, and at most 80 % of each effort.

    Args:
        longest: duration that a motion over 30 % of the ranges is made shorter for [s].

    Raises:
        ControlTestError: the arm cannot hold itself on the way.
    """
    span = np.minimum(arm.upper - arm.lower, 2.0 * np.pi)
    middle = 0.5 * (arm.upper + arm.lower)
    fastest = np.where(np.isfinite(arm.max_velocity), arm.max_velocity, _ANY_SPEED)
    share_of_span = min(0.3, longest / float(np.max(1.875 * span / (0.8 * fastest))))
    start, goal = middle - 0.5 * share_of_span * span, middle + 0.5 * share_of_span * span
    slower = 1.0
    for _ in range(20):
        speed = 0.8 * fastest / slower
        motion = joint_motion("quintic", start, goal, speed, speed / (0.3 * slower))
        times = np.linspace(0.0, motion.duration, 60)
        share = 0.0
        for time in times:
            q, qd, qdd = motion.sample(float(time))
            effort = rigid_effort(arm, q, qd, qdd, gravity) + friction_effort(arm.friction, qd)
            share = max(share, float(np.max(np.abs(effort) / arm.max_effort)))
        if share <= 0.8:
            return motion
        slower *= 1.3
    raise ControlTestError(f"{arm.name} has not the effort for a motion through its range under this gravity")


def run(
    law: LawName, arm: SerialArm, model: SerialArm, motion: TimedPath, gravity: FloatArray, settings: LoopSettings
) -> LoopResult:
    """A motion of `arm` under a law that knows `model`, from rest at its start.

    Raises:
        InvalidValueError: settings that make no loop.
    """
    if settings.delay < 0 or settings.substeps < 1 or not settings.sample_time > 0.0:
        raise InvalidValueError(
            "loop settings", settings, "delay at least 0, substeps at least 1, a sample time above 0"
        )
    middle = motion.sample(0.5 * motion.duration)[0]
    along = np.array([motion.sample(share * motion.duration)[0] for share in np.linspace(0.0, 1.0, 11)])
    gains = gains_for(model, along, settings.bandwidth)
    q, qd = motion.sample(0.0)[0].copy(), np.zeros(arm.joint_count)
    integral, before = np.zeros(arm.joint_count), _encoder(arm, settings, q)
    waiting = [np.clip(rigid_effort(model, q, qd, qd, gravity), -arm.max_effort, arm.max_effort)] * settings.delay
    samples = int(np.ceil((motion.duration + settings.settle) / settings.sample_time))
    errors, tips, goal = [], [], motion.sample(motion.duration)[0]
    way = goal - q
    overshoot, energy, cut, unstable = 0.0, 0.0, 0, False
    for k in range(samples):
        reference = Reference(*motion.sample(k * settings.sample_time))
        read = _encoder(arm, settings, q)
        speed, before = (read - before) / settings.sample_time, read
        asked = effort_of(law, model, gains, reference, MeasuredJoints(read, speed, integral), gravity)
        given = np.clip(asked, -arm.max_effort, arm.max_effort)
        free = given == asked
        integral = integral + np.where(free, (reference.position - read) * settings.sample_time, 0.0)
        cut += not np.all(free)
        waiting.append(given)
        effort = waiting.pop(0)
        q, qd, work = _move(arm, q, qd, effort, gravity, settings)
        if not np.all(np.isfinite(q)):
            unstable = True
            break
        energy += work
        wanted = motion.sample((k + 1) * settings.sample_time)[0]
        errors.append(wanted - q)
        tips.append(
            float(np.linalg.norm(forward_kinematics(arm, q).position - forward_kinematics(arm, wanted).position))
        )
        moving = np.abs(way) > 1e-9
        overshoot = max(overshoot, float(np.max(((q - goal) / np.where(moving, way, 1.0))[moving], initial=0.0)))
        if float(np.max(np.abs(errors[-1]))) > 10.0 * max(1.0, arm.reach):
            unstable = True
            break
    joint = np.array(errors)
    return LoopResult(
        tip_rms=float(np.sqrt(np.mean(np.square(tips)))),
        joint_rms=float(np.sqrt(np.mean(joint**2))),
        largest_joint_error=float(np.max(np.abs(joint))),
        final_tip_error=tips[-1],
        overshoot=overshoot,
        energy=energy,
        saturated=cut / max(len(errors), 1),
        gain_margin=gain_margin(law, arm, model, gains, middle, settings),
        unstable=unstable,
    )


def gain_margin(
    law: LawName, arm: SerialArm, model: SerialArm, gains: Gains, q: FloatArray, settings: LoopSettings
) -> float:
    """See the module header; 0 if the loop is unstable as it is, inf where nothing is fed back."""
    position, velocity = feedback_of(law, model, gains, q)
    if not np.any(position):
        return float("inf")
    low, high = 0.0, _LARGEST_FACTOR
    if _radius(arm, q, position, velocity, 1.0, settings) >= 1.0:
        return 0.0
    low = 1.0
    if _radius(arm, q, position, velocity, high, settings) < 1.0:
        return high
    for _ in range(40):
        middle = float(np.sqrt(low * high))
        if _radius(arm, q, position, velocity, middle, settings) < 1.0:
            low = middle
        else:
            high = middle
    return low


def _radius(
    arm: SerialArm, q: FloatArray, position: FloatArray, velocity: FloatArray, factor: float, settings: LoopSettings
) -> float:
    """Largest modulus of the eigenvalues of the sampled loop. State: q, qd, the last reading, the waiting efforts."""
    n, t, delay = arm.joint_count, settings.sample_time, settings.delay
    inverse = np.linalg.inv(mass_matrix(arm, q))
    motion = np.zeros((3 * n, 3 * n))
    motion[:n, n : 2 * n] = np.eye(n)
    motion[n : 2 * n, n : 2 * n] = -inverse @ np.diag(arm.friction.viscous)
    motion[n : 2 * n, 2 * n :] = inverse
    step = expm(motion * t)
    size = 3 * n + delay * n
    loop = np.zeros((size, size))
    law = np.zeros((n, size))  # effort = -factor (P q + V (q - last)/t)
    law[:, :n] = -factor * (position + velocity / t)
    law[:, 2 * n : 3 * n] = factor * velocity / t
    acting = law if delay == 0 else np.eye(size)[3 * n : 4 * n]
    loop[: 2 * n, : 2 * n] = step[: 2 * n, : 2 * n]
    loop[: 2 * n] += step[: 2 * n, 2 * n :] @ acting
    loop[2 * n : 3 * n, :n] = np.eye(n)
    for k in range(delay):
        rows = slice(3 * n + k * n, 4 * n + k * n)
        loop[rows] = law if k == delay - 1 else np.eye(size)[4 * n + k * n : 5 * n + k * n]
    return float(np.max(np.abs(np.linalg.eigvals(loop))))


def _move(
    arm: SerialArm, q: FloatArray, qd: FloatArray, effort: FloatArray, gravity: FloatArray, settings: LoopSettings
) -> tuple[FloatArray, FloatArray, float]:
    """Position, velocity, work of the motors after one sample time under a held effort."""
    h, work, zero = settings.sample_time / settings.substeps, 0.0, np.zeros(arm.joint_count)
    for _ in range(settings.substeps):
        rubbing = friction_effort(arm.friction, qd)
        slope = (friction_effort(arm.friction, qd + _SLOPE_STEP) - rubbing) / _SLOPE_STEP
        net = effort - rigid_effort(arm, q, qd, zero, gravity) - rubbing
        acceleration = np.linalg.solve(mass_matrix(arm, q) + h * np.diag(np.maximum(slope, 0.0)), net)
        qd = qd + h * acceleration
        q = q + h * qd
        work += h * float(np.sum(np.maximum(effort * qd, 0.0)))
    return q, qd, work


def _encoder(arm: SerialArm, settings: LoopSettings, q: FloatArray) -> FloatArray:
    """Positions as they are read."""
    span = np.where(arm.revolute, 2.0 * np.pi, arm.upper - arm.lower)
    step = span / 2.0**settings.encoder_bits
    return np.asarray(np.round(q / step) * step)
