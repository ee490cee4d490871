"""Obstacle handling of the drive: sees, judges, keeps clear, goes round, backs off, or says why it stops.

Three layers, from slow to fast:

- With each cloud: the map, what of it the rover cannot pass, and the room between (`see`).
- With each cloud, and when the guard has stopped a motion: is the path ahead closed? Then a way round is planned and
  given to the goal follower in place of the way asked for (`guide`). With no room to turn into it the rover first
  backs off over its own tracks. A goal ends as stopped, with the obstacle, its measure and the limit, where no way is
  known and the obstacle is near, where the goal lies in an obstacle, where the way round gets too long, or where the
  rover cannot get free.
- Every period: a motion that would bring the outline nearer to an obstacle than the guard's margin is not made
  (`guarded`); one that leads away from it is. This holds for /cmd_vel, too, unless it is switched off.

A goal in an obstacle that the map knows is refused (`refusal`). Hidden ground closes the way, but does not make a goal
impossible: it may be seen from elsewhere. Positions in odom.
"""

import math
from dataclasses import replace

import numpy as np

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.attitude import rotation_of
from sojourn_mechanics.steering.avoidance_types import Avoidance, AvoidanceState, Guidance
from sojourn_mechanics.steering.detour import plan_detour
from sojourn_mechanics.steering.goal import Goal, GoalOutcome, Point
from sojourn_mechanics.steering.goal_follower import FollowerState, Phase, accept, stop
from sojourn_mechanics.steering.kinematics import PlanarTwist
from sojourn_mechanics.steering.obstacle_map import empty_map, with_cloud
from sojourn_mechanics.steering.odometry import OdometryState
from sojourn_mechanics.steering.room import AHEAD, room_along, room_in, room_of_motion
from sojourn_mechanics.steering.route import advanced, route_of
from sojourn_mechanics.steering.traversability import HIDDEN_GROUND, Obstacle, judged, obstacle_at
from sojourn_mechanics.vehicle.clothoid import Pose

LOOK = 4.0
"""The path is looked at so far ahead [m]."""
NEAR_GOAL = 3.0
"""A goal in an obstacle is given up from here [m]: beyond it the error of stereo may have made the obstacle."""
LAST_STRETCH = 0.35
"""Without a way round the rover goes on to so far before the closed place [m]: it may find one there."""
ATTEMPTS = 5
"""Motions that the guard stops, one after the other, before the rover gives up [-]."""
PATIENCE, HURRY = 0.5, 1.2
"""A way round is kept for so long [m], unless it is closed within so far [m]: what is far off may look other soon."""
FREE_WAY = 0.3
"""So far along its route the rover has to get to be free of such a series; so far it backs off in it [m]."""
ESCAPE = 0.8
"""For so long a path may be as narrow as the rover's own place [m]."""
CORNER_CUTS = (1.0, 0.5, 0.25, 0.1)
"""Parts of the follower's corner_cut that are tried for a path that stays clear [-]."""
EXAMPLE_CLOUD = np.array([[3.0, 0.2 * y, 0.2 * z] for y in range(-6, 7) for z in range(5)])
"""A wall that closes the way, for the warm-up [m]."""
STANDSTILL = PlanarTwist(0.0, 0.0, 0.0)
STEPS = np.array(AHEAD)


def initial_avoidance(avoidance: Avoidance, x: float, y: float) -> AvoidanceState:
    """Nothing seen yet, at a place in odom [m]."""
    map_ = empty_map(avoidance.params, x, y)
    ground = judged(avoidance.params, map_)
    return AvoidanceState(map_, ground, room_in(map_, ground.kinds))


def see(
    avoidance: Avoidance, state: AvoidanceState, points: FloatArray | None, odometry: OdometryState, dt: float
) -> AvoidanceState:
    """The state with a cloud, shape (n, 3) in base_link [m], or without one in this period."""
    if points is None:
        return replace(state, since_cloud=state.since_cloud + dt, fresh=False)
    position = np.array([odometry.x, odometry.y, odometry.z])
    rotation = rotation_of(odometry.roll, odometry.pitch, odometry.yaw)
    map_ = with_cloud(avoidance.params, state.map, points, avoidance.eye, position, rotation, odometry.distance)
    ground = judged(avoidance.params, map_)
    level = odometry.z + map_.lift - avoidance.params.outline.ride_height
    room = room_in(map_, ground.kinds)
    return replace(state, map=map_, ground=ground, room=room, level=level, since_cloud=0.0, fresh=True)


def nearest_obstacle(avoidance: Avoidance, state: AvoidanceState, place: Point) -> Obstacle | None:
    """The obstacle of the map that is nearest to a place [m], if it knows any."""
    cell = state.room.nearest_to(*place)
    return None if cell is None else obstacle_at(avoidance.params, state.map, state.ground, *cell, state.level)


def refusal(avoidance: Avoidance, state: AvoidanceState, goal: Goal) -> str | None:
    """Why a goal cannot be: it lies in an obstacle that the map knows. None if it can."""
    if not goal.points or not all(math.isfinite(value) for value in goal.points[-1]):
        return None  # the follower says what is wrong with it
    place = goal.points[-1]
    if state.room.at(*place) >= avoidance.params.outline.half_width:
        return None
    cell = state.room.nearest_to(*place)
    if cell is None or state.ground.kinds[cell] == HIDDEN_GROUND:
        return None
    obstacle = obstacle_at(avoidance.params, state.map, state.ground, *cell, state.level)
    return f"the goal ({place[0]:.2f}, {place[1]:.2f}) lies in an obstacle: {obstacle}"


def accepted(
    avoidance: Avoidance,
    state: AvoidanceState,
    goal: Goal,
    answer: FollowerState | GoalOutcome,
    odometry: OdometryState,
) -> tuple[FollowerState | GoalOutcome, AvoidanceState]:
    """The follower's answer to a goal, or its refusal; and the state at the start of the way to it."""
    reason = refusal(avoidance, state, goal)
    if reason is not None:
        return GoalOutcome("refused", reason, goal, math.nan), state
    if isinstance(answer, GoalOutcome):
        return answer, state
    start = AvoidanceState(state.map, state.ground, state.room, state.level, state.since_cloud, state.fresh)
    return answer, replace(start, route=route_of(goal, (odometry.x, odometry.y), odometry.distance))


def guide(avoidance: Avoidance, state: AvoidanceState, way: FollowerState, odometry: OdometryState) -> Guidance:
    """Looks at the path ahead where there is something new, and answers with the way to follow from here."""
    params = avoidance.params
    if state.since_cloud > params.blind_timeout:
        text = f"waiting for the hazard camera, nothing seen for {params.blind_timeout:.0f} s"
        return Guidance(state, way, STANDSTILL, text=text)
    if state.back_until is not None:
        return _back_off(avoidance, state, way, odometry, state.back_until)
    if state.route is None or not (state.fresh or state.blocked or state.replan):
        return Guidance(state, way)
    position = (odometry.x, odometry.y)
    route = advanced(state.route, position, 0.5 * state.room.cell)
    state = replace(state, route=route)
    if route.progress > state.mark + FREE_WAY:
        state = replace(state, mark=route.progress, attempts=0)
    closed = _closed_ahead(avoidance, state, way)
    if closed is None and not (state.blocked or state.replan):
        return Guidance(replace(state, obstacle=None), way)
    reach, place = closed if closed is not None else (0.0, position)
    stuck, backed, forced = state.blocked and state.attempts > 1, state.replan, state.blocked or state.replan
    state = replace(state, obstacle=nearest_obstacle(avoidance, state, place), blocked=False, replan=False)
    reason = refusal(avoidance, state, route.goal)
    if not forced and reach > HURRY and odometry.distance < state.planned_at + PATIENCE:
        return Guidance(state, way)
    if reason is not None and math.dist(position, route.goal.points[-1]) <= NEAR_GOAL:
        return _given_up(state, way, reason)
    if state.attempts > ATTEMPTS:
        return _given_up(state, way, f"{state.obstacle}: no room to move beside it")
    if odometry.distance - route.driven > route.length + params.max_detour:
        more = f"no way round with {params.max_detour:.0f} m more than asked for"
        return _given_up(state, way, f"{state.obstacle}: {more}")
    here = Pose(*position, odometry.yaw)
    clear = (avoidance.straight, avoidance.turning)
    points = plan_detour(state.map, state.room, route, here, *clear, avoidance.area)
    if points is None:
        if reach > LAST_STRETCH:
            return Guidance(state, way)
        return _given_up(state, way, f"{state.obstacle}: the map knows no way round")
    if stuck:
        return _back_off(avoidance, state, way, odometry, odometry.distance + FREE_WAY)
    return _go_round(avoidance, state, way, odometry, replace(route.goal, points=tuple(points), heights=()), backed)


def _go_round(
    avoidance: Avoidance, state: AvoidanceState, way: FollowerState, odometry: OdometryState, goal: Goal, backed: bool
) -> Guidance:
    """The way along planned points in place of the present one, or back first where there is no room to turn to it.

    Args:
        backed: the rover has just done so; then it tries with the room that there is.
    """
    pose = Pose(odometry.x, odometry.y, odometry.yaw)
    answer: FollowerState | GoalOutcome | None = None
    for part in CORNER_CUTS:
        cut = part * avoidance.follower.corner_cut
        narrow = avoidance.follower.model_copy(update={"corner_cut": cut})
        answer = accept(narrow, avoidance.turning_limits, goal, pose)
        if isinstance(answer, FollowerState) and _closed_ahead(avoidance, state, answer) is None:
            break
    if not isinstance(answer, FollowerState):
        return _given_up(state, way, f"{state.obstacle}: no path round it" + (f", {answer.reason}" if answer else ""))
    turns = answer.phase is Phase.ALIGN
    room_to_turn = avoidance.params.outline.turn_radius + avoidance.params.guard_margin
    if turns and state.room.at(pose.x, pose.y) < room_to_turn and not backed:
        return _back_off(avoidance, state, way, odometry, odometry.distance + avoidance.params.back_off)
    return Guidance(replace(state, detours=state.detours + 1, planned_at=odometry.distance), answer)


def _closed_ahead(avoidance: Avoidance, state: AvoidanceState, way: FollowerState) -> tuple[float, Point] | None:
    """Where the outline on its path first has less room than the guard asks for: distance, and the place."""
    if not way.path.legs or way.phase in (Phase.FINAL_ALIGN, Phase.SETTLE):
        return None
    rest = [leg.samples for leg in way.path.legs[way.leg :]]
    rest[0] = rest[0][np.searchsorted(rest[0][:, 0], way.on_leg) :]
    before = np.cumsum([-way.on_leg] + [leg.length for leg in way.path.legs[way.leg : -1]])
    distances = np.concatenate([part[:, 0] + start for part, start in zip(rest, before, strict=True)])
    samples = np.concatenate(rest)[distances <= LOOK]
    if not len(samples):
        return None
    room, margin = state.room, avoidance.params.guard_margin
    grid = (room.distances, room.x0, room.y0, room.cell, avoidance.circles, avoidance.radius)
    rooms = room_along(*grid, np.ascontiguousarray(samples[:, 1:4]))
    needed = np.where(distances[: len(samples)] < ESCAPE, min(margin, rooms[0] - 0.02), margin)
    narrow = np.flatnonzero(rooms < needed)
    if not len(narrow):
        return None
    first = int(narrow[0])
    return float(distances[first]), (float(samples[first, 1]), float(samples[first, 2]))


def _given_up(state: AvoidanceState, way: FollowerState, reason: str) -> Guidance:
    return Guidance(replace(state, route=None), way, outcome=stop(way, reason))


def _back_off(
    avoidance: Avoidance, state: AvoidanceState, way: FollowerState, odometry: OdometryState, until: float
) -> Guidance:
    """Straight back over the own tracks until there is room to turn; then the way is planned again."""
    if odometry.distance >= until or state.room.at(odometry.x, odometry.y) >= avoidance.turning:
        return Guidance(replace(state, back_until=None, replan=True), way, STANDSTILL, text="backed off")
    state = replace(state, back_until=until)
    twist = PlanarTwist(-avoidance.params.back_off_speed, 0.0, 0.0)
    return Guidance(state, way, twist, text=f"backing off from {state.obstacle}")


def guarded(
    avoidance: Avoidance, state: AvoidanceState, twist: PlanarTwist, odometry: OdometryState, by_hand: bool
) -> tuple[AvoidanceState, bool]:
    """Whether a motion may be made; the state notes one that may not.

    Args:
        by_hand: it is an operator's, who may have switched the guard off.
    """
    room, outline = state.room, avoidance.params.outline
    if by_hand:
        state = replace(state, blocked=False, obstacle=None)
        if not avoidance.params.guard_cmd_vel:
            return state, True
    if room.at(odometry.x, odometry.y) > outline.turn_radius + AHEAD[-1] + avoidance.params.margin:
        return state, True  # the usual case must be cheap
    grid = (room.distances, room.x0, room.y0, room.cell, avoidance.circles, avoidance.radius)
    pose = (odometry.x, odometry.y, odometry.yaw)
    motion = (float(twist.v_x), float(twist.v_y), float(twist.yaw_rate))
    now, least = room_of_motion(*grid, pose, motion, outline.turn_radius, STEPS)
    if least >= avoidance.params.guard_margin or least >= now - 1e-3:
        return state, True
    return replace(
        state,
        blocked=True,
        attempts=state.attempts + 1,
        obstacle=nearest_obstacle(avoidance, state, (odometry.x, odometry.y)),
        back_until=None,
    ), False
