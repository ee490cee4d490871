"""Goal follower for a rover that drives forward along curves and turns in place.

Phases: align (point turn) -> drive -> final align -> settle -> end.

- Drive is pure pursuit: with the bearing a of a point on the path one lookahead L ahead, the arc through that
  point has the curvature k = 2 sin a / L. The path is the polyline from where the goal was accepted through
  the waypoints; the pursued point does not go beyond the present waypoint, so each waypoint is passed within
  pass_radius.
- Bearing beyond realign_angle: stop and align. So every start converges: after an align, the bearing is
  within align_tolerance and the miss distance at range d is at most d sin(align_tolerance) plus what pursuit
  takes out.
- Speed: min(limit, distance_gain x distance, sqrt(2 deceleration distance)) x cos a, at least approach_speed.
- Point turn: rate = yaw_gain x error, bounded by the limit and by sqrt(2 deceleration error).
- Driving ends within arrive_fraction x tolerance of the last point, or abeam of it inside the tolerance. The
  goal is reached when the rover stands still inside the position (and yaw) tolerance; if not, it tries again.
- It ends as stopped when there is no progress: slip scales the motion but does not change where the law
  leads, so only a rover that cannot move at all stays behind.

Sources: Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01 (1992);
Aicardi, Casalino, Bicchi, Balestrino, IEEE Robotics & Automation Magazine 2(1) (1995) 27
(polar coordinates and speed falling with distance and cos of the bearing).

Assumptions: pose in odom is continuous; obstacles are somebody else's concern. Positions [m], angles [rad].
"""

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NamedTuple

from sojourn_mechanics.steering.goal import Goal, GoalOutcome, Point, path_lengths, refusal
from sojourn_mechanics.steering.odometry import wrap_angle
from sojourn_mechanics.steering.params import GoalFollowerParams
from sojourn_mechanics.steering.rate_limiter import stopping_speed

SLOWEST_TURN = 0.1
"""Smallest rate of a point turn as a fraction of the largest, so that it ends [-]."""


class Phase(StrEnum):
    """What the follower is doing."""

    ALIGN = "align"
    DRIVE = "drive"
    FINAL_ALIGN = "final_align"
    SETTLE = "settle"


@dataclass(frozen=True, slots=True)
class FollowerState:
    """One goal on its way."""

    goal: Goal
    phase: Phase
    index: int
    """Waypoint the rover drives to."""
    segment_start: Point
    """Where the present straight part of the path begins [m]."""
    lengths: tuple[float, ...]
    """Path from each waypoint to the last [m]."""
    elapsed: float = 0.0
    """Time since the goal was accepted [s]."""
    phase_elapsed: float = 0.0
    """Time in this phase [s]."""
    distance_to_go: float = 0.0
    """To the present waypoint and on along the path [m]."""
    yaw_error: float = 0.0
    """Heading still to turn in the present phase [rad]."""
    lateral_error: float = 0.0
    """Position to the left of the path [m]."""
    best_distance: float = math.inf
    """distance_to_go at the last progress [m]."""
    drive_stall: float = 0.0
    """Time of driving since then [s]."""
    best_yaw_error: float = math.inf
    """|yaw_error| at the last progress of this turn [rad]."""
    turn_stall: float = 0.0
    """Time of turning since then [s]."""
    attempts: int = 0
    """Times the rover stood still and was not within tolerance."""


class FollowerLimits(NamedTuple):
    """What the machine can do at the moment."""

    speed: float
    """[m/s]"""
    yaw_rate: float
    """[rad/s]"""
    deceleration: float
    """At the rim of a wheel [m/s^2]."""
    yaw_deceleration: float
    """Of a point turn [rad/s^2]."""


class FollowerStep(NamedTuple):
    """Result of one period."""

    state: FollowerState
    v_x: float
    """Wanted speed [m/s]."""
    yaw_rate: float
    """Wanted yaw rate [rad/s]."""
    outcome: GoalOutcome | None
    """Not None when the goal has ended."""


def accept(params: GoalFollowerParams, goal: Goal, position: Point) -> FollowerState | GoalOutcome:
    """Start of the way to a goal from a position in odom [m], or the outcome `refused` with its reason."""
    reason = refusal(params, goal, position)
    if reason is not None:
        return GoalOutcome("refused", reason, goal, math.nan)
    lengths = path_lengths(position, goal.points)
    return FollowerState(goal, Phase.DRIVE, 0, position, lengths[1:], distance_to_go=lengths[0])


def stop(state: FollowerState, reason: str) -> GoalOutcome:
    """Outcome of a goal that is given up."""
    return GoalOutcome("stopped", reason, state.goal, state.distance_to_go)


def _pursued_point(start: Point, end: Point, position: Point, lookahead: float) -> tuple[Point, float]:
    """Point on a straight part of the path to drive at, and the position to the left of that part [m]."""
    along_x, along_y = end[0] - start[0], end[1] - start[1]
    length = math.hypot(along_x, along_y)
    if length < 1e-9:
        return end, 0.0
    along_x, along_y = along_x / length, along_y / length
    from_x, from_y = position[0] - start[0], position[1] - start[1]
    ahead = from_x * along_x + from_y * along_y + lookahead
    lateral = along_x * from_y - along_y * from_x
    if ahead >= length:
        return end, lateral
    ahead = max(ahead, 0.0)
    return (start[0] + ahead * along_x, start[1] + ahead * along_y), lateral


def _turn(params: GoalFollowerParams, error: float, limits: FollowerLimits) -> float:
    """Yaw rate of a point turn for a heading error."""
    size = abs(error)
    rate = min(params.yaw_gain * size, stopping_speed(size, limits.yaw_deceleration), limits.yaw_rate)
    return math.copysign(max(rate, SLOWEST_TURN * limits.yaw_rate), error)


def _enter(state: FollowerState, phase: Phase) -> FollowerState:
    """The same way in another phase, with that phase's clocks at zero."""
    return replace(state, phase=phase, phase_elapsed=0.0, best_yaw_error=math.inf, turn_stall=0.0)


def _watch(
    params: GoalFollowerParams,
    state: FollowerState,
    distance_to_go: float,
    yaw_error: float,
    lateral_error: float,
    dt: float,
) -> FollowerState:
    """State with the errors of this period, its clocks moved on and progress noted."""
    best_distance, drive_stall = state.best_distance, state.drive_stall
    if distance_to_go < best_distance - params.progress_distance:
        best_distance, drive_stall = distance_to_go, 0.0
    elif state.phase is Phase.DRIVE:
        drive_stall += dt
    best_yaw_error, turn_stall = state.best_yaw_error, 0.0
    if state.phase in (Phase.ALIGN, Phase.FINAL_ALIGN):
        turn_stall = state.turn_stall + dt
        if abs(yaw_error) < best_yaw_error - params.progress_angle:
            best_yaw_error, turn_stall = abs(yaw_error), 0.0
    return FollowerState(
        goal=state.goal,
        phase=state.phase,
        index=state.index,
        segment_start=state.segment_start,
        lengths=state.lengths,
        elapsed=state.elapsed + dt,
        phase_elapsed=state.phase_elapsed + dt,
        distance_to_go=distance_to_go,
        yaw_error=yaw_error,
        lateral_error=lateral_error,
        best_distance=best_distance,
        drive_stall=drive_stall,
        best_yaw_error=best_yaw_error,
        turn_stall=turn_stall,
        attempts=state.attempts,
    )


def _pass_waypoints(params: GoalFollowerParams, state: FollowerState, position: Point) -> FollowerState:
    """Moves on to the next waypoint while the present one is within the pass radius."""
    index, points = state.index, state.goal.points
    while index < len(points) - 1 and math.dist(position, points[index]) <= params.pass_radius:
        index += 1
    if index == state.index:
        return state
    return replace(state, index=index, segment_start=points[index - 1])


def _finish(
    params: GoalFollowerParams, state: FollowerState, moving: bool, distance: float
) -> tuple[FollowerState, GoalOutcome | None]:
    """Settle: wait until the rover stands, then judge."""
    if moving and state.phase_elapsed < params.settle_timeout:
        return state, None
    goal = state.goal
    yaw_met = goal.yaw is None or abs(state.yaw_error) <= params.yaw_tolerance
    if distance <= params.position_tolerance and yaw_met:
        heading = "" if goal.yaw is None else f", {abs(state.yaw_error):.3f} rad off the heading"
        reason = f"{distance:.3f} m from the goal{heading}"
        return state, GoalOutcome("reached", reason, goal, distance)
    if state.attempts + 1 >= params.settle_attempts:
        reason = f"not within tolerance after {params.settle_attempts} approaches, {distance:.3f} m from the goal"
        return state, stop(state, reason)
    next_phase = Phase.DRIVE if distance > params.position_tolerance else Phase.FINAL_ALIGN
    return _enter(replace(state, attempts=state.attempts + 1), next_phase), None


def follow(
    params: GoalFollowerParams,
    state: FollowerState,
    pose: tuple[float, float, float],
    moving: bool,
    limits: FollowerLimits,
    dt: float,
) -> FollowerStep:
    """Wanted motion for one period.

    Args:
        params: tolerances and gains.
        state: from `accept` or the last period.
        pose: x, y [m] and yaw [rad] in odom.
        moving: true while the rover has not come to rest.
        limits: what the machine can do at the moment.
        dt: period [s].
    """
    x, y, yaw = pose
    position = (x, y)
    state = _pass_waypoints(params, state, position)
    goal, index = state.goal, state.index
    end = goal.points[index]
    last = index == len(goal.points) - 1
    to_end = math.hypot(end[0] - x, end[1] - y)
    distance = to_end + state.lengths[index]
    target, lateral = _pursued_point(state.segment_start, end, position, params.lookahead)
    bearing = wrap_angle(math.atan2(target[1] - y, target[0] - x) - yaw)
    heading_error = bearing
    if state.phase in (Phase.FINAL_ALIGN, Phase.SETTLE):
        heading_error = wrap_angle(goal.yaw - yaw) if goal.yaw is not None else 0.0
    state = _watch(params, state, distance, heading_error, lateral, dt)
    if state.drive_stall > params.progress_timeout or state.turn_stall > params.progress_timeout:
        reason = f"no progress for {params.progress_timeout:.0f} s, {distance:.2f} m to go"
        return FollowerStep(state, 0.0, 0.0, stop(state, reason))

    if state.phase is Phase.SETTLE:
        state, outcome = _finish(params, state, moving, distance)
        return FollowerStep(state, 0.0, 0.0, outcome)
    if state.phase is Phase.FINAL_ALIGN:
        if abs(heading_error) <= 0.5 * params.yaw_tolerance:
            return FollowerStep(_enter(state, Phase.SETTLE), 0.0, 0.0, None)
        return FollowerStep(state, 0.0, _turn(params, heading_error, limits), None)

    # An align that began inside the tolerance circle would chase a bearing that means little there.
    abeam = abs(bearing) > params.realign_angle
    arrived = to_end <= params.arrive_fraction * params.position_tolerance
    if last and (arrived or (abeam and to_end <= params.position_tolerance)):
        phase = Phase.FINAL_ALIGN if goal.yaw is not None else Phase.SETTLE
        return FollowerStep(_enter(state, phase), 0.0, 0.0, None)
    if state.phase is Phase.ALIGN:
        if abs(bearing) <= params.align_tolerance:
            return FollowerStep(_enter(state, Phase.DRIVE), 0.0, 0.0, None)
        return FollowerStep(state, 0.0, _turn(params, bearing, limits), None)
    if abeam:
        return FollowerStep(_enter(state, Phase.ALIGN), 0.0, 0.0, None)

    to_target = math.hypot(target[0] - x, target[1] - y)
    curvature = 2.0 * math.sin(bearing) / max(to_target, params.lookahead)
    curvature = min(max(curvature, -params.max_curvature), params.max_curvature)
    speed = limits.speed * math.cos(bearing)
    if last:
        speed = min(speed, params.distance_gain * to_end, stopping_speed(to_end, limits.deceleration))
    speed = min(max(speed, params.approach_speed), limits.speed)
    return FollowerStep(state, speed, curvature * speed, None)
