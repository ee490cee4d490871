"""Goal follower: drives forward along a path and turns on the spot where the path has a corner that cannot be driven.

Phases: align (turn on the spot to the leg's heading) -> drive -> the next leg, or final align -> settle -> end.

- The path is planned when the goal is accepted (path_planner) and kept by the law of path_tracking, with the drift
  that the odometry expects on a side slope, smoothed over a distance.
- Off the course wanted by more than realign_angle: stop and align, by a machine that can turn on the spot.
- Speed: min(limit, distance_gain x distance, sqrt(2 deceleration distance)) x cos of the course error, at least
  approach_speed; the distance is that to the next stop. The last of it is braked evenly over stop_time: a machine that
  stops at once rocks on its soil, one that brakes evenly for a whole period of that comes to rest with it (the two-step
  shaper of Singer and Seering, ASME J. Dynamic Systems, Measurement and Control 112 (1990) 76, spread over a period).
- Turn on the spot: rate = yaw_gain x error, bounded by the limit and by sqrt(2 deceleration error).
- A leg ends arrive_fraction x tolerance before its end. The goal is reached when the rover stands still inside the
  position (and yaw) tolerance; if not, the path is planned anew from where it stands. So it is where a rover that
  stands is too far beside the end of its path to come back to it: a turn on the spot on a slope moves it downhill. By
  then the slope is felt, and the new path leaves room for what its two turns will do.
- Astern the same path is driven backwards: what counts is the heading of the motion, which is that of the rover and pi.
- It ends as stopped when there is no progress: slip scales the motion but does not change where the law leads, so
  only a rover that cannot move at all stays behind.

Lateral error is to the left of the path, of the estimated pose; its root mean square is over the distance driven on
the path. Source of the speeds: Aicardi, Casalino, Bicchi, Balestrino, IEEE Robotics & Automation Magazine 2(1)
(1995) 27. Assumptions: pose in odom is continuous; obstacles are somebody else's concern. Positions [m], angles
[rad]."""

import math
from typing import Literal

from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.mobility.rate_limiter import stopping_speed
from sojourn_flight.odometry.odometry import wrap_angle
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.planning.follower_state import FollowerLimits, FollowerPhase, FollowerState, FollowerStep
from sojourn_flight.planning.goal import Goal, GoalOutcome, refusal
from sojourn_flight.planning.path import NearestPoint, PlannedPath
from sojourn_flight.planning.path_planner import plan_path
from sojourn_flight.planning.path_tracking import Tracking, track
from sojourn_machine.evolution import replace

SLOWEST_TURN = 0.1
"""Smallest rate of a point turn as a fraction of the largest, so that it ends [-]."""
SLOWEST_STOP = 0.1
"""Smallest speed of a stop as a fraction of the approach speed, so that it ends [-]."""
DRIFT_LENGTH = 0.5
"""Distance over which the drift is smoothed [m]."""
BESIDE = 5.0
"""Times its distance from the path a rover needs to come back to it [-]."""
AIMS = 4
"""Times that a way is drawn anew between the turns at its ends, each of which moves the rover."""
SAME_POINT = 1e-6
"""Points so near to each other are one [m]."""


def accept(params: GoalFollowerParams, machine: TurningLimits, goal: Goal, pose: Pose) -> FollowerState | GoalOutcome:
    """Start of the way to a goal from a pose in odom, or the outcome `refused` with its reason."""
    reason = refusal(params, goal, (pose.x, pose.y))
    path = plan_path(params, machine, pose, goal) if reason is None else reason
    if isinstance(path, str):
        return GoalOutcome("refused", path, goal, math.nan)
    return _on_path(params, FollowerState(goal, path, FollowerPhase.DRIVE), path, pose)


def rerouted(state: FollowerState, there: FollowerState, pose: Pose) -> FollowerState:
    """The same goal on its way along another path: what counts and what is measured on the way goes on.

    Args:
        there: from `accept`, for the points of the other path; the last ones are those of the goal that are still to
            be passed. pose: of the rover in odom.
    """
    marks, place, mark = [], len(there.goal.points) - 1, there.path.length
    for waypoint in reversed(state.goal.points):  # one that is not on the new path is passed with the next one
        same = [at for at in range(place + 1) if math.dist(there.goal.points[at], waypoint) < SAME_POINT]
        if same:
            place, mark = same[-1] - 1, there.path.marks[same[-1]]
        marks.append(mark)
    turn = abs(wrap_angle(there.path.legs[0].start.heading - pose.heading)) if there.path.legs else math.inf
    return replace(
        state,
        path=replace(there.path, marks=tuple(reversed(marks))),
        phase=there.phase,
        leg=0,
        on_leg=0.0,
        distance_to_go=there.distance_to_go,
        best_distance=there.distance_to_go,
        best_yaw_error=turn,
        phase_elapsed=0.0,
        astern=False,
    )


def turned_about(state: FollowerState, astern: bool) -> FollowerState:
    """The same way, to be driven backwards or forwards from here: first it turns on the spot."""
    return replace(_enter(state, FollowerPhase.ALIGN), astern=astern, drift=0.0)


def stop(state: FollowerState, reason: str) -> GoalOutcome:
    """Outcome of a goal that is given up."""
    return _outcome("stopped", state, reason)


def _outcome(kind: Literal["reached", "stopped"], state: FollowerState, reason: str) -> GoalOutcome:
    return GoalOutcome(kind, reason, state.goal, state.distance_to_go, state.lateral_rms, state.lateral_max)


def _on_path(params: GoalFollowerParams, state: FollowerState, path: PlannedPath, pose: Pose) -> FollowerState:
    """The state at the begin of a path."""
    state = replace(state, path=path, leg=0, on_leg=0.0, best_distance=math.inf)
    if path.legs:
        return _enter_leg(params, replace(state, distance_to_go=path.length), 0, pose.heading)
    x, y = state.goal.points[-1]
    return _enter(replace(state, distance_to_go=math.hypot(x - pose.x, y - pose.y)), FollowerPhase.DRIVE)


def _enter_leg(params: GoalFollowerParams, state: FollowerState, leg: int, yaw: float) -> FollowerState:
    """The state at the begin of a leg: driving, or turning to its heading first."""
    off = wrap_angle(state.path.legs[leg].start.heading - yaw)
    phase = FollowerPhase.DRIVE if abs(off) <= params.align_tolerance else FollowerPhase.ALIGN
    return _enter(replace(state, leg=leg, on_leg=0.0), phase)


def _enter(state: FollowerState, phase: FollowerPhase) -> FollowerState:
    """The same way in another phase, with that phase's clocks at zero."""
    return replace(state, phase=phase, phase_elapsed=0.0, best_yaw_error=math.inf, turn_stall=0.0)


def _turn(params: GoalFollowerParams, error: float, limits: FollowerLimits) -> float:
    """Yaw rate of a point turn for a heading error."""
    size = abs(error)
    rate = min(params.yaw_gain * size, stopping_speed(size, limits.yaw_deceleration), limits.yaw_rate)
    return math.copysign(max(rate, SLOWEST_TURN * limits.yaw_rate), error)


def _locate(state: FollowerState, pose: Pose, drift: float | None) -> tuple[FollowerState, NearestPoint | None]:
    """Where the rover is on its path, with the errors of this period; no place where there is no path."""
    if not state.path.legs:
        return state, None
    place = state.path.legs[state.leg].nearest(pose.x, pose.y, state.on_leg)
    gone = max(place.distance - state.on_leg, 0.0)
    before = sum(leg.length for leg in state.path.legs[: state.leg])
    passed = state.passed
    if len(state.path.marks) == len(state.goal.points):  # not of a path planned anew to the last one
        while passed < len(state.path.marks) and state.path.marks[passed] <= before + place.distance:
            passed += 1
    part = gone / (gone + DRIFT_LENGTH)
    return replace(
        state,
        on_leg=place.distance,
        passed=passed,
        distance_to_go=max(state.path.length - before - place.distance, 0.0),
        lateral_error=place.lateral,
        lateral_max=max(state.lateral_max, abs(place.lateral)),
        lateral_square=state.lateral_square + place.lateral**2 * gone,
        followed=state.followed + gone,
        drift=state.drift if drift is None else state.drift + part * (drift - state.drift),
    ), place


def _watch(params: GoalFollowerParams, state: FollowerState, yaw_error: float, dt: float) -> FollowerState:
    """State with its clocks moved on and progress noted."""
    best_distance, drive_stall = state.best_distance, state.drive_stall
    if state.distance_to_go < best_distance - params.progress_distance:
        best_distance, drive_stall = state.distance_to_go, 0.0
    elif state.phase is FollowerPhase.DRIVE:
        drive_stall += dt
    best_yaw_error, turn_stall = state.best_yaw_error, 0.0
    if state.phase in (FollowerPhase.ALIGN, FollowerPhase.FINAL_ALIGN):
        turn_stall = state.turn_stall + dt
        if abs(yaw_error) < best_yaw_error - params.progress_angle:
            best_yaw_error, turn_stall = abs(yaw_error), 0.0
    return replace(
        state,
        elapsed=state.elapsed + dt,
        phase_elapsed=state.phase_elapsed + dt,
        yaw_error=yaw_error,
        best_distance=best_distance,
        drive_stall=drive_stall,
        best_yaw_error=best_yaw_error,
        turn_stall=turn_stall,
    )


def _finish(
    params: GoalFollowerParams, state: FollowerState, limits: FollowerLimits, pose: Pose, moving: bool
) -> tuple[FollowerState, GoalOutcome | None]:
    """Settle: wait until the rover stands, then judge."""
    if moving and state.phase_elapsed < params.settle_timeout:
        return state, None
    goal, distance = state.goal, state.distance_to_go
    yaw_met = goal.yaw is None or abs(state.yaw_error) <= params.yaw_tolerance
    if distance <= params.position_tolerance and yaw_met:
        heading = "" if goal.yaw is None else f", {abs(state.yaw_error):.3f} rad off the heading"
        return state, _outcome("reached", state, f"{distance:.3f} m from the goal{heading}")
    return _approach(params, state, limits, pose)


def _approach(
    params: GoalFollowerParams, state: FollowerState, limits: FollowerLimits, pose: Pose
) -> tuple[FollowerState, GoalOutcome | None]:
    """Once more to the goal, from where the rover stands; the end where it has been tried often enough."""
    goal, (x, y) = state.goal, state.goal.points[-1]
    distance = math.hypot(x - pose.x, y - pose.y)
    state = replace(state, attempts=state.attempts + 1)
    if state.attempts >= params.settle_attempts:
        reason = f"not within tolerance after {params.settle_attempts} approaches, {distance:.3f} m from the goal"
        return state, stop(state, reason)
    if distance <= params.position_tolerance and (goal.yaw is None or limits.turning.on_the_spot):
        return _enter(state, FollowerPhase.SETTLE if goal.yaw is None else FollowerPhase.FINAL_ALIGN), None
    begin, end = _between_turns(goal, pose, limits.slide)
    path = plan_path(params, limits.turning, begin, replace(goal, points=(end,)))
    if isinstance(path, str):
        return state, stop(state, f"{distance:.3f} m from the goal, and no path from there: {path}")
    return _on_path(params, replace(state, astern=False), path, pose), None


def _between_turns(goal: Goal, pose: Pose, slide: tuple[float, float]) -> tuple[Pose, tuple[float, float]]:
    """Where the rover will be when it has turned to a straight way to its goal, and where that way has to end for the
    turn to the goal's heading to end there. slide: of a turn, see `FollowerLimits`.
    """
    (x, y), begin, end = goal.points[-1], pose, goal.points[-1]
    if slide == (0.0, 0.0):
        return begin, end
    for _ in range(AIMS):
        bearing = math.atan2(end[1] - begin.y, end[0] - begin.x)
        first = abs(wrap_angle(bearing - pose.heading))
        last = 0.0 if goal.yaw is None else abs(wrap_angle(goal.yaw - bearing))
        begin = pose._replace(x=pose.x + first * slide[0], y=pose.y + first * slide[1])
        end = x - last * slide[0], y - last * slide[1]
    return begin, end


def _is_beside(params: GoalFollowerParams, state: FollowerState) -> bool:
    """Whether the rover stands beside its way, too near to its end to come back to it: a turn on the spot has moved
    it, or it was not where it was thought to be.
    """
    aside = abs(state.lateral_error)
    return aside > params.room and state.distance_to_go < BESIDE * aside


def _before_arrival(params: GoalFollowerParams, state: FollowerState) -> float:
    """Distance to where driving on this leg ends [m]."""
    left = state.path.legs[state.leg].length - state.on_leg
    return left - params.arrive_fraction * params.position_tolerance


def _arrived(params: GoalFollowerParams, state: FollowerState, pose: Pose) -> FollowerState | None:
    """The state after the end of a leg, None before it."""
    legs = state.path.legs
    if legs and _before_arrival(params, state) > 0.0:
        return None
    if legs and state.leg + 1 < len(legs):
        return _enter_leg(params, state, state.leg + 1, pose.heading)
    return _enter(state, FollowerPhase.FINAL_ALIGN if state.goal.yaw is not None else FollowerPhase.SETTLE)


def follow(
    params: GoalFollowerParams,
    state: FollowerState,
    pose: Pose,
    drift: float | None,
    moving: bool,
    limits: FollowerLimits,
    dt: float,
) -> FollowerStep:
    """Wanted motion for one period.

    Args:
        params: tolerances and gains.
        state: from `accept` or the last period.
        pose: x, y [m] and yaw [rad] in odom.
        drift: angle of the motion to its heading [rad], None where it means nothing (slow, turning on the spot).
        moving: true while the rover has not come to rest.
        limits: what the machine can do at the moment.
        dt: period [s].
    """
    if not state.astern or state.phase in (FollowerPhase.FINAL_ALIGN, FollowerPhase.SETTLE):
        return _followed(params, state, pose, drift, moving, limits, dt)
    ahead = pose._replace(heading=wrap_angle(pose.heading + math.pi))
    step = _followed(params, state, ahead, drift, moving, limits, dt)
    return step._replace(v_x=-step.v_x)


def _followed(
    params: GoalFollowerParams,
    state: FollowerState,
    pose: Pose,
    drift: float | None,
    moving: bool,
    limits: FollowerLimits,
    dt: float,
) -> FollowerStep:
    """What `follow` answers, `pose` with the heading of the motion."""
    goal = state.goal
    if state.phase in (FollowerPhase.FINAL_ALIGN, FollowerPhase.SETTLE):
        x, y = goal.points[-1]
        state = replace(state, distance_to_go=math.hypot(x - pose.x, y - pose.y), passed=len(goal.points))
        yaw_error = wrap_angle(goal.yaw - pose.heading) if goal.yaw is not None else 0.0
        place = None
    else:
        state, place = _locate(state, pose, drift if state.phase is FollowerPhase.DRIVE else None)
        tracking = (
            track(place, pose.heading, state.drift, params.lateral_length, params.heading_length) if place else None
        )
        yaw_error = tracking.course_error if tracking else 0.0
    state = _watch(params, state, yaw_error, dt)
    if state.drive_stall > params.progress_timeout or state.turn_stall > params.progress_timeout:
        reason = f"no progress for {params.progress_timeout:.0f} s, {state.distance_to_go:.2f} m to go"
        return FollowerStep(state, 0.0, 0.0, stop(state, reason))

    if state.phase is FollowerPhase.SETTLE:
        state, outcome = _finish(params, state, limits, pose, moving)
        return FollowerStep(state, 0.0, 0.0, outcome)
    if state.phase is FollowerPhase.FINAL_ALIGN:
        if abs(yaw_error) <= 0.5 * params.yaw_tolerance or not limits.turning.on_the_spot:
            return FollowerStep(_enter(state, FollowerPhase.SETTLE), 0.0, 0.0, None)
        return FollowerStep(state, 0.0, _turn(params, yaw_error, limits), None)
    aligned = state.phase is FollowerPhase.ALIGN and abs(yaw_error) <= params.align_tolerance
    starts = aligned or (state.phase is FollowerPhase.DRIVE and not moving)
    if starts and not state.astern and _is_beside(params, state):
        state, outcome = _approach(params, state, limits, pose)
        return FollowerStep(state, 0.0, 0.0, outcome)
    if state.phase is FollowerPhase.ALIGN:
        if aligned:
            return FollowerStep(_enter(state, FollowerPhase.DRIVE), 0.0, 0.0, None)
        return FollowerStep(state, 0.0, _turn(params, yaw_error, limits), None)
    arrived = _arrived(params, state, pose)
    if arrived is not None or tracking is None:
        return FollowerStep(arrived or state, 0.0, 0.0, None)
    if abs(yaw_error) > params.realign_angle and limits.turning.on_the_spot:
        return FollowerStep(_enter(state, FollowerPhase.ALIGN), 0.0, 0.0, None)
    return FollowerStep(state, *_drive(params, state, tracking, limits), None)


def _drive(
    params: GoalFollowerParams, state: FollowerState, tracking: Tracking, limits: FollowerLimits
) -> tuple[float, float]:
    """Speed and yaw rate on a leg."""
    most = limits.turning.curvature
    curvature = min(max(tracking.curvature, -most), most)
    left = state.path.legs[state.leg].length - state.on_leg
    speed = limits.speed * max(math.cos(tracking.course_error), 0.0)
    speed = min(speed, params.distance_gain * left, stopping_speed(left, limits.deceleration))
    last = stopping_speed(_before_arrival(params, state), params.approach_speed / params.stop_time)
    speed = min(max(speed, params.approach_speed), max(last, SLOWEST_STOP * params.approach_speed), limits.speed)
    return speed, curvature * speed
