"""Jerk-limited, synchronised joint motions from any state: to a point, to rest, through points.

Point to point and stop: time-optimal under limits of speed, acceleration and jerk (Berscheid & Kroeger,
"Jerk-limited Real-time Trajectory Generation with Arbitrary Target States", RSS 2021; the `ruckig` library,
its offline calculation only). All joints arrive together, and from rest they move on a straight line in
joint space. The result is copied into a JointPath, so that a state which carries it can be saved and
branched.

Through points: one such piece per interval, with the given or chosen velocity at each point (zero where the
joint turns round, else the harmonic mean of the neighbouring slopes: Fritsch & Butland, SIAM J. Sci. Stat.
Comput. 5(2), 1984) and zero acceleration there. The given times are kept when the limits allow it. If they
do not, slower passing velocities are tried, down to a stop at every point; then the path is stretched
(`retime`) or refused.

Position limits: Ruckig knows none. A motion that would swing past a joint limit (because it starts at
speed) is replaced by a stop followed by a motion from rest. A start that is itself out of limits is allowed
to come back.

Range: reference states within the speed and acceleration limits; a slight excess is braked off first.
"""

from dataclasses import dataclass

import numpy as np
import ruckig

from sojourn_flight.arm.joint_path import JointPath, join
from sojourn_flight.arm.model import ArmModel
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray

_SLACK = 1.0e-6  # relative excess over a limit that is taken for rounding
_TIME_SLACK = 1.0e-6  # [s] a piece may be longer than asked for by this


class TrajectoryError(MachineError):
    """No trajectory keeps the limits; the message says which one is broken and by how much."""


@dataclass(frozen=True, slots=True)
class JointReference:
    """Position, velocity and acceleration of every joint at one instant, arrays (n,)."""

    position: FloatArray  # [rad or m]
    velocity: FloatArray  # [rad/s]
    acceleration: FloatArray  # [rad/s2]


def at_rest(position: FloatArray) -> JointReference:
    """Reference that stands still at `position` (n,)."""
    zero = np.zeros(position.shape[0])
    return JointReference(position.copy(), zero, zero.copy())


def point_to_point(model: ArmModel, start: JointReference, target: FloatArray) -> JointPath:
    """Fastest synchronised motion from `start` to rest at `target` (n,) [rad].

    Raises:
        TrajectoryError: the target or the braking distance is out of the limits.
    """
    goal = at_rest(target)
    try:
        path = _piece(model, start, goal, None)
        check_limits(model, path, start.position)
        return path
    except TrajectoryError:
        if not (np.any(start.velocity) or np.any(start.acceleration)):
            raise
    brake = stop(model, start)
    halt = at_rest(brake.sample(brake.duration)[0])
    path = join([brake, _piece(model, halt, goal, None)])
    check_limits(model, path, start.position)
    return path


def stop(model: ArmModel, start: JointReference) -> JointPath:
    """Fastest stop from `start` within acceleration and jerk limits.

    On the straight line that the joints are on, if they are on one; else all come to rest at the same time.
    """
    return towards_rates(model, start, np.zeros(model.joint_count))


def towards_rates(model: ArmModel, start: JointReference, rates: FloatArray) -> JointPath:
    """Fastest change from `start` to joint rates (n,) [rad/s or m/s] within acceleration and jerk limits.

    All joints are there at the same time, on a straight line of velocities where that is possible. The path ends there.
    """
    problem = ruckig.InputParameter(model.joint_count)
    problem.control_interface = ruckig.ControlInterface.Velocity
    problem.synchronization = ruckig.Synchronization.Phase
    goal = JointReference(start.position, rates, np.zeros(model.joint_count))
    return _solve(model, problem, start, goal, None)


def through_points(
    model: ArmModel,
    start: JointReference,
    points: FloatArray,
    times: FloatArray | None,
    velocities: FloatArray | None = None,
    retime: bool = True,
) -> tuple[JointPath, bool]:
    """Motion from `start` through `points` (m, n), at rest at the last one.

    Args:
        times: of each point after the start (m,) [s], rising; None for as fast as the limits allow.
        velocities: at each point (m, n) [rad/s]; None to choose them. The last one must be zero.
        retime: stretch the times if they break a limit.

    Returns:
        the path, and whether its times were stretched.

    Raises:
        TrajectoryError: limits broken and `retime` is false, or points out of limits.
    """
    if velocities is not None and np.any(velocities[-1] != 0.0):
        raise TrajectoryError(f"velocity at the last point = {velocities[-1].tolist()} rad/s: allowed is zero")
    best: JointPath | None = None
    reason = ""
    for factor in (1.0, 0.6, 0.3, 0.0):
        passing = factor * (_passing_velocities(model, start, points, times) if velocities is None else velocities)
        try:
            path = _chain_of_pieces(model, start, points, times, passing)
            check_limits(model, path, start.position)
        except TrajectoryError as error:
            reason = reason or str(error)
            continue
        if times is not None and path.duration <= times[-1] + _TIME_SLACK * len(points):
            return path, False
        if best is None or path.duration < best.duration:
            best = path
        if velocities is not None and times is None:
            break
    if best is None:
        raise TrajectoryError(reason)
    if times is None:
        return best, False
    if not retime:
        raise TrajectoryError(
            f"the points need {best.duration:.3f} s within the limits of speed, acceleration and jerk: "
            f"given were {times[-1]:.3f} s"
        )
    return best, True


def check_limits(model: ArmModel, path: JointPath, start: FloatArray | None = None) -> None:
    """Refuse a path that breaks a limit anywhere (exact, not sampled).

    Args:
        start: a position (n,) that may itself be out of the position limits.

    Raises:
        TrajectoryError: names the joint, the quantity, its value and the limit.
    """
    low, high, speed, acceleration, jerk = path.extremes()
    lower = model.lower if start is None else np.minimum(model.lower, start)
    upper = model.upper if start is None else np.maximum(model.upper, start)
    for values, limits, sign, what in (
        (low, lower, -1.0, "position [rad]"),
        (high, upper, 1.0, "position [rad]"),
        (speed, model.max_velocity, 1.0, "speed [rad/s]"),
        (acceleration, model.max_acceleration, 1.0, "acceleration [rad/s2]"),
        (jerk, model.max_jerk, 1.0, "jerk [rad/s3]"),
    ):
        excess = sign * (values - limits) - _SLACK * np.maximum(np.abs(limits), 1.0)
        worst = int(np.argmax(excess))
        if excess[worst] > 0.0:
            raise TrajectoryError(
                f"{model.joint_names[worst]}: {what} would be {values[worst]:.4f}, the limit is {limits[worst]:.4f}"
            )


def _passing_velocities(
    model: ArmModel, start: JointReference, points: FloatArray, times: FloatArray | None
) -> FloatArray:
    """Velocity at each point (m, n): harmonic mean of the slopes, zero where they differ in sign."""
    knots = np.vstack([start.position, points])
    steps = np.diff(knots, axis=0)
    if times is None:
        spans = np.maximum(np.max(np.abs(steps) / model.max_velocity, axis=1), 1e-3)
    else:
        spans = np.diff(np.concatenate([[0.0], times]))
    slopes = steps / spans[:, None]
    velocities = np.zeros_like(points)
    before, after = slopes[:-1], slopes[1:]
    total = before + after
    smooth = before * after > 0.0
    velocities[:-1] = np.where(smooth, 2.0 * before * after / np.where(smooth, total, 1.0), 0.0)
    return np.clip(velocities, -model.max_velocity, model.max_velocity)


def _chain_of_pieces(
    model: ArmModel, start: JointReference, points: FloatArray, times: FloatArray | None, passing: FloatArray
) -> JointPath:
    pieces = []
    reference = start
    elapsed = 0.0
    for k in range(points.shape[0]):
        goal = JointReference(points[k], passing[k], np.zeros(model.joint_count))
        # A late piece is made up for by the next ones where they have time to spare.
        span = None if times is None else max(float(times[k]) - elapsed, 1e-3)
        pieces.append(_piece(model, reference, goal, span))
        elapsed += pieces[-1].duration
        reference = goal
    return join(pieces)


def _piece(model: ArmModel, start: JointReference, goal: JointReference, duration: float | None) -> JointPath:
    """One Ruckig motion; on a straight line where that is possible, otherwise synchronised in time only."""
    reason = ""
    for synchronization in (ruckig.Synchronization.Phase, ruckig.Synchronization.Time):
        problem = ruckig.InputParameter(model.joint_count)
        problem.synchronization = synchronization
        problem.target_position = goal.position.tolist()
        try:
            return _solve(model, problem, start, goal, duration)
        except TrajectoryError as error:
            reason = str(error)
    raise TrajectoryError(reason)


def _solve(
    model: ArmModel,
    problem: ruckig.InputParameter,
    start: JointReference,
    goal: JointReference,
    duration: float | None,
) -> JointPath:
    n = model.joint_count
    problem.current_position = start.position.tolist()
    problem.current_velocity = _inside(start.velocity, model.max_velocity).tolist()
    problem.current_acceleration = _inside(start.acceleration, model.max_acceleration).tolist()
    problem.target_velocity = goal.velocity.tolist()
    problem.target_acceleration = goal.acceleration.tolist()
    problem.max_velocity = model.max_velocity.tolist()
    problem.max_acceleration = model.max_acceleration.tolist()
    problem.max_jerk = model.max_jerk.tolist()
    if duration is not None:
        problem.minimum_duration = duration
    solution = ruckig.Trajectory(n)
    try:
        result = ruckig.Ruckig(n).calculate(problem, solution)
    except RuntimeError as error:
        raise TrajectoryError(f"no jerk-limited motion from this state: {error}") from error
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        raise TrajectoryError(f"no jerk-limited motion from this state: {result.name}")
    return _copy(solution, goal, problem.control_interface == ruckig.ControlInterface.Position)


def _inside(values: FloatArray, limits: FloatArray) -> FloatArray:
    """Values with a rounding excess over the limits taken off; a real excess is left for Ruckig to brake."""
    clipped = np.clip(values, -limits, limits)
    return np.where(np.abs(values) <= limits * (1.0 + 1e-6), clipped, values)


def _copy(solution: ruckig.Trajectory, goal: JointReference, exact_end: bool) -> JointPath:
    """Profiles of a Ruckig solution (braking, 7 sections, then a tail) as a JointPath."""
    n = solution.degrees_of_freedom
    sections = 10
    starts, p, v, a, j = (np.zeros((n, sections)) for _ in range(5))
    for i in range(n):
        profile = solution.profiles[0][i]
        time = 0.0
        for k in range(2):
            starts[i, k] = time
            p[i, k], v[i, k], a[i, k] = profile.brake.p[k], profile.brake.v[k], profile.brake.a[k]
            j[i, k] = profile.brake.j[k]
            length = profile.brake.t[k] if profile.brake.duration > 0.0 else 0.0
            if length <= 0.0:
                p[i, k], v[i, k], a[i, k], j[i, k] = profile.p[0], profile.v[0], profile.a[0], 0.0
            time += length
        for k in range(7):
            m = k + 2
            starts[i, m] = time
            p[i, m], v[i, m], a[i, m], j[i, m] = profile.p[k], profile.v[k], profile.a[k], profile.j[k]
            time += profile.t[k]
        starts[i, 9] = time
        p[i, 9] = goal.position[i] if exact_end else profile.p[7]
        v[i, 9] = goal.velocity[i]
    return JointPath(starts, p, v, a, j, float(solution.duration))
