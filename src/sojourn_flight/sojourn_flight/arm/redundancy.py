"""What to do with joints to spare: move the arm at rest of its tip until a secondary measure is best.

With J the Jacobian and J# its damped pseudo-inverse, every motion  (I - J# J) z  leaves the tip where it is
(Liegeois, IEEE Trans. SMC 7(12), 1977). z is the gradient of the measure; each step is followed by a correction
J# e that takes out the drift of the tip, and is made only if it betters the measure. Joint limits are kept: a joint
at its limit takes no further part. J has the rows of the task: an arm of six joints has some to spare where only the
place of its tip is asked for, or the direction of its tool as well.

Measures to be made large: the joints' nearness to the middle of their range, Yoshikawa's manipulability, the
clearance of the arm's links (as lines between joint origins) from spheres. Any function of q will do; its gradient is
taken by central differences.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.chain import ChainArm
from sojourn_flight.arm.inverse import task_jacobian
from sojourn_flight.arm.inverse_search import POINTING, POSE, SearchSettings, TipTarget, search
from sojourn_flight.arm.kinematics import TipPose, forward_kinematics
from sojourn_flight.arm.manipulability import manipulability
from sojourn_flight.arm.secondary_task import SecondaryTask
from sojourn_machine.params import FloatArray

Measure = Callable[[FloatArray], float]
"""Of joint positions (n,); the larger the better."""
_DIFFERENCE = 1.0e-5
_SMALLEST_STEP = 1.0e-4
_FLAT = 1.0e-9


@dataclass(frozen=True, slots=True, eq=False)
class Sphere:
    """Something to keep away from, in the base."""

    centre: FloatArray  # (3,) [m]
    radius: float  # [m]


def joint_centring(arm: ChainArm) -> Measure:
    """Minus the mean square of the joints' distance from mid-range, in half ranges: 0 in the middle, -1 at limits."""
    middle, half = 0.5 * (arm.lower + arm.upper), 0.5 * (arm.upper - arm.lower)
    ranges = np.where(half > 0.0, half, 1.0)  # of a joint that does not move there is no middle to be off
    return lambda q: -float(np.mean(((q - middle) / ranges) ** 2))


def manipulability_measure(arm: ChainArm) -> Measure:
    """Yoshikawa's measure of the whole Jacobian."""
    return lambda q: manipulability(forward_kinematics(arm, q).jacobian)


def clearance(arm: ChainArm, obstacles: tuple[Sphere, ...], link_radius: float = 0.0) -> Measure:
    """Least distance of the arm from the obstacles [m]; its links are lines of a thickness `link_radius` [m]."""

    def measure(q: FloatArray) -> float:
        points = joint_origins(arm, q)
        return min(
            _segment_distance(points[i], points[i + 1], ball.centre) - ball.radius - link_radius
            for i in range(len(points) - 1)
            for ball in obstacles
        )

    return measure


def measure_of(arm: ChainArm, task: SecondaryTask, obstacles: tuple[Sphere, ...] = ()) -> Measure:
    """The measure of a secondary task; `clear` needs obstacles."""
    if task == "centred":
        return joint_centring(arm)
    return manipulability_measure(arm) if task == "manipulability" else clearance(arm, obstacles)


def better_posture(
    arm: ChainArm, positions: FloatArray, measure: Measure, steps: int = 200, task: int = POSE
) -> FloatArray:
    """Joint positions (n,) that meet the same task as `positions`, with a larger measure.

    Args:
        task: what is kept: POSE of the tip, its place and the tool's direction (POINTING), or its place (POSITION).
        steps: most steps; the search ends earlier where no step betters the measure.
    """
    goal = forward_kinematics(arm, positions)
    q, value, step = positions.copy(), measure(positions), 0.2
    for _ in range(steps):
        direction = _null_motion(arm, task, q, _gradient(measure, q))
        size = float(np.max(np.abs(direction)))
        if size < _FLAT:  # at the bottom of a measure that is symmetric there, as in a singular posture: any way
            direction = _null_motion(arm, task, q, np.cos(np.arange(arm.joint_count)))
            size = float(np.max(np.abs(direction)))
        if size < _FLAT:
            break
        trial = _back_to_tip(arm, task, np.clip(q + direction * (step / size), arm.lower, arm.upper), goal)
        new = measure(trial) if trial is not None else -np.inf
        if trial is not None and new > value:
            q, value, step = trial, new, min(1.5 * step, 0.5)
        else:
            step *= 0.5
            if step < _SMALLEST_STEP:
                break
    return q


def joint_origins(arm: ChainArm, positions: FloatArray) -> FloatArray:
    """Places of the base's origin, of each joint (one that slides: before and after) and of the tip, (m, 3) [m]."""
    rotation, position = np.eye(3), np.zeros(3)
    points = [position]
    for i in range(arm.joint_count):
        position = position + rotation @ arm.chain.translation[i]
        rotation = rotation @ arm.chain.rotation[i]
        points.append(position)
        axis = arm.chain.axis[i]
        if arm.chain.revolute[i] > 0.5:
            k = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
            rotation = rotation @ (np.eye(3) + np.sin(positions[i]) * k + (1.0 - np.cos(positions[i])) * (k @ k))
        else:
            position = position + rotation @ axis * positions[i]
            points.append(position)
    points.append(position + rotation @ arm.chain.tip_translation)
    return np.array(points)


def _null_motion(arm: ChainArm, task: int, q: FloatArray, gradient: FloatArray) -> FloatArray:
    """Part of the gradient that leaves the tip at rest, with joints at their limits held."""
    free = np.ones(arm.joint_count, dtype=bool)
    tip = forward_kinematics(arm, q)
    jacobian = tip.jacobian if task == POSE else task_jacobian(arm, task, tip.jacobian, tip.tool_direction)
    motion = np.zeros(arm.joint_count)
    for _ in range(arm.joint_count):
        part = jacobian[:, free]
        motion[:] = 0.0
        motion[free] = gradient[free] - np.linalg.pinv(part, rcond=1e-6) @ (part @ gradient[free])
        blocked = free & (((q <= arm.lower) & (motion < 0.0)) | ((q >= arm.upper) & (motion > 0.0)))
        if not np.any(blocked):
            break
        free &= ~blocked
    return motion


def _back_to_tip(arm: ChainArm, task: int, q: FloatArray, goal: TipPose) -> FloatArray | None:
    """The nearest posture that meets the task, or None."""
    reach = arm.reach
    wanted = np.array(goal.rotation)
    if task == POINTING:
        wanted[:, 2] = goal.tool_direction
    settings = SearchSettings(1e-9 * reach, 1e-9, 1e-12 * reach**2, 0.5, 20)
    target = TipTarget(task, goal.position, wanted, 0.25 * reach)
    found, distance, angle = search(arm.chain, q, arm.lower, arm.upper, target, settings)
    return np.asarray(found) if distance < 1e-8 * reach and angle < 1e-8 else None


def _gradient(measure: Measure, q: FloatArray) -> FloatArray:
    gradient = np.empty(q.shape[0])
    for i in range(q.shape[0]):
        ahead, behind = q.copy(), q.copy()
        ahead[i] += _DIFFERENCE
        behind[i] -= _DIFFERENCE
        gradient[i] = (measure(ahead) - measure(behind)) / (2.0 * _DIFFERENCE)
    return gradient


def _segment_distance(start: FloatArray, end: FloatArray, point: FloatArray) -> float:
    along = end - start
    length = float(along @ along)
    share = 0.0 if length < 1e-18 else min(max(float((point - start) @ along) / length, 0.0), 1.0)
    return float(np.linalg.norm(start + share * along - point))
