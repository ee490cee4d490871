"""Obstacle handling of the drive: sees, judges, keeps clear, goes round, backs off, or says why it stops.

Three layers, from slow to fast:

- With each cloud: the map, what of it the rover cannot pass, and the room between (`see`).
- With each cloud, and when the guard has stopped a motion: is the way ahead closed? Then a way round is planned and
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
from dataclasses import dataclass, field, replace

import numpy as np

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.detour import plan_detour
from sojourn_mechanics.steering.goal import Goal, GoalOutcome, Point
from sojourn_mechanics.steering.goal_follower import FollowerState, accept, stop
from sojourn_mechanics.steering.kinematics import PlanarTwist
from sojourn_mechanics.steering.obstacle_map import ObstacleMap, empty_map, with_cloud
from sojourn_mechanics.steering.obstacle_params import ObstacleParams
from sojourn_mechanics.steering.odometry import OdometryState, wrap_angle
from sojourn_mechanics.steering.params import GoalFollowerParams
from sojourn_mechanics.steering.room import AHEAD, Room, circles_of, room_at_pose, room_in, room_of_motion
from sojourn_mechanics.steering.route import Route, advanced, first_closed, route_of
from sojourn_mechanics.steering.traversability import HIDDEN_GROUND, Obstacle, Passability, judged, obstacle_at

LOOK = 4.0
"""The way is looked at so far ahead [m]."""
NEAR_GOAL = 3.0
"""A goal in an obstacle is given up from here [m]: beyond it the stereo error may have made the obstacle."""
LAST_STRETCH = 0.35
"""Without a way round the rover goes on to so far before the closed place [m]: it may find one there."""
ATTEMPTS = 5
"""Motions that the guard stops, one after the other, before the rover gives up [-]."""
FREE_WAY = 0.3
"""A drive of this length ends such a series [m]."""
ESCAPE = 0.8
"""Round the rover, see `first_closed` [m]."""


@dataclass(frozen=True, eq=False)
class Avoidance:
    """Obstacle handling of one machine."""

    params: ObstacleParams
    eye: FloatArray
    """The camera in base_link, shape (3,) [m]."""
    circles: FloatArray = field(init=False)
    radius: float = field(init=False)

    def __post_init__(self) -> None:
        circles, radius = circles_of(self.params.outline)
        object.__setattr__(self, "circles", circles)
        object.__setattr__(self, "radius", radius)

    @property
    def straight(self) -> float:
        """Distance from an obstacle that a plan keeps [m]."""
        return self.radius + self.params.margin

    @property
    def turning(self) -> float:
        """That from which the rover can turn on the spot [m]."""
        return self.params.outline.turn_radius + self.params.margin


@dataclass(frozen=True, slots=True)
class AvoidanceState:
    """What is known and what is under way."""

    map: ObstacleMap
    ground: Passability
    room: Room
    since_cloud: float = 0.0
    """[s]"""
    fresh: bool = False
    """A cloud came in this period."""
    route: Route | None = None
    obstacle: Obstacle | None = None
    """What stands in the way, or has ended it."""
    blocked: bool = False
    """The guard has stopped the last motion."""
    attempts: int = 0
    """Motions that it has stopped since the rover was free."""
    stopped_at: float = 0.0
    """Odometer when it last did [m]."""
    back_until: float | None = None
    """Odometer at which backing off ends [m]; None while driving forward."""
    detours: int = 0
    """Ways round on the way to this goal."""


@dataclass(frozen=True, slots=True)
class Guidance:
    """What the drive is to do in a period."""

    state: AvoidanceState
    way: FollowerState
    twist: PlanarTwist | None = None
    """In place of the follower's."""
    outcome: GoalOutcome | None = None
    text: str = ""


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
        return replace(state, since_cloud=state.since_cloud + dt, fresh=False) if state.fresh else _waited(state, dt)
    position = np.array([odometry.x, odometry.y, odometry.z])
    rotation = _rotation(odometry.roll, odometry.pitch, odometry.yaw)
    map_ = with_cloud(avoidance.params, state.map, points, avoidance.eye, position, rotation, odometry.distance)
    ground = judged(avoidance.params, map_)
    return replace(state, map=map_, ground=ground, room=room_in(map_, ground.kinds), since_cloud=0.0, fresh=True)


def _waited(state: AvoidanceState, dt: float) -> AvoidanceState:
    return replace(state, since_cloud=state.since_cloud + dt)


def _rotation(roll: float, pitch: float, yaw: float) -> FloatArray:
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def nearest_obstacle(avoidance: Avoidance, state: AvoidanceState, place: Point) -> Obstacle | None:
    """The obstacle of the map that is nearest to a place [m], if it knows any."""
    cell = state.room.nearest_to(*place)
    return None if cell is None else obstacle_at(avoidance.params, state.map, state.ground, *cell)


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
    obstacle = obstacle_at(avoidance.params, state.map, state.ground, *cell)
    return f"the goal ({place[0]:.2f}, {place[1]:.2f}) lies in an obstacle: {obstacle}"


def begin(state: AvoidanceState, way: FollowerState, odometry: OdometryState) -> AvoidanceState:
    """The state at the start of a goal that the follower has accepted."""
    route = route_of(way.goal, (odometry.x, odometry.y), odometry.distance)
    return replace(state, route=route, obstacle=None, blocked=False, attempts=0, back_until=None, detours=0)


def guide(
    avoidance: Avoidance,
    state: AvoidanceState,
    follower: GoalFollowerParams,
    way: FollowerState,
    odometry: OdometryState,
) -> Guidance:
    """Looks at the way ahead where there is something new, and answers with the way to follow from here."""
    params = avoidance.params
    if state.since_cloud > params.blind_timeout:
        text = f"waiting for the hazard camera, nothing seen for {params.blind_timeout:.0f} s"
        return Guidance(state, way, PlanarTwist(0.0, 0.0, 0.0), text=text)
    if state.back_until is not None:
        return _back_off(avoidance, state, way, odometry)
    if state.route is None or not (state.fresh or state.blocked):
        return Guidance(state, way)
    position = (odometry.x, odometry.y)
    route = advanced(state.route, position, 0.5 * state.room.cell)
    state = replace(state, route=route)
    line = np.array([position, *way.goal.points[way.index :]])
    least = avoidance.radius + params.guard_margin
    closed = first_closed(state.room, line, least, LOOK, ESCAPE)
    if closed is None and not state.blocked:
        return Guidance(replace(state, obstacle=None), way)
    reach, place = closed if closed is not None else (0.0, position)
    obstacle = nearest_obstacle(avoidance, state, place)
    state = replace(state, obstacle=obstacle, blocked=False)
    reason = refusal(avoidance, state, route.goal)
    if reason is not None and math.dist(position, route.goal.points[-1]) <= NEAR_GOAL:
        return _given_up(state, way, reason)
    if state.attempts > ATTEMPTS:
        return _given_up(state, way, f"no room to move beside {obstacle}")
    return _go_round(avoidance, state, follower, way, odometry, reach)


def _go_round(
    avoidance: Avoidance,
    state: AvoidanceState,
    follower: GoalFollowerParams,
    way: FollowerState,
    odometry: OdometryState,
    reach: float,
) -> Guidance:
    """A way round in place of the present way; or the end of the goal where there is none."""
    params, route = avoidance.params, state.route
    if route is None:
        return Guidance(state, way)
    position = (odometry.x, odometry.y)
    if odometry.distance - route.driven > route.length + params.max_detour:
        return _given_up(
            state, way, f"{state.obstacle}: no way round within {params.max_detour:.0f} m beyond the way asked for"
        )
    points = plan_detour(state.map, state.room, route, position, avoidance.straight, avoidance.turning)
    if points is None:
        if reach > LAST_STRETCH:
            return Guidance(state, way)
        return _given_up(state, way, f"{state.obstacle}: the map knows no way round")
    bearing = wrap_angle(math.atan2(points[0][1] - odometry.y, points[0][0] - odometry.x) - odometry.yaw)
    turns = abs(bearing) > follower.realign_angle
    if state.attempts > 1 or (turns and state.room.at(*position) < params.outline.turn_radius + params.guard_margin):
        back = params.back_off if state.attempts <= 1 else 0.3
        state = replace(state, back_until=odometry.distance + back)
        return _back_off(avoidance, state, way, odometry)
    goal = replace(route.goal, points=tuple(points))
    answer = accept(follower, goal, position)
    if isinstance(answer, GoalOutcome):
        return _given_up(state, way, answer.reason)
    return Guidance(replace(state, detours=state.detours + 1), answer)


def _given_up(state: AvoidanceState, way: FollowerState, reason: str) -> Guidance:
    return Guidance(replace(state, route=None), way, outcome=stop(way, reason))


def _back_off(avoidance: Avoidance, state: AvoidanceState, way: FollowerState, odometry: OdometryState) -> Guidance:
    """Straight back over the own tracks until there is room to turn; then the way is planned again."""
    until = state.back_until if state.back_until is not None else odometry.distance
    free = state.attempts <= 1 and state.room.at(odometry.x, odometry.y) >= avoidance.turning
    if free or odometry.distance >= until:
        state = replace(state, back_until=None, blocked=True)
        return Guidance(state, way, PlanarTwist(0.0, 0.0, 0.0), text="backed off")
    twist = PlanarTwist(-avoidance.params.back_off_speed, 0.0, 0.0)
    return Guidance(state, way, twist, text=f"backing off from {state.obstacle}")


def guarded(
    avoidance: Avoidance, state: AvoidanceState, twist: PlanarTwist, odometry: OdometryState
) -> tuple[AvoidanceState, bool]:
    """Whether a motion may be made; the state notes one that may not."""
    room = state.room
    grid = (room.distances, room.x0, room.y0, room.cell, avoidance.circles, avoidance.radius)
    pose = (odometry.x, odometry.y, odometry.yaw)
    steps = np.array(AHEAD)
    reach = avoidance.params.outline.turn_radius
    now, least = room_of_motion(
        *grid, pose, (float(twist.v_x), float(twist.v_y), float(twist.yaw_rate)), reach, steps
    )
    if least >= avoidance.params.guard_margin or least >= now - 1e-3:
        if state.attempts and odometry.distance - state.stopped_at > FREE_WAY:
            state = replace(state, attempts=0)
        return state, True
    obstacle = nearest_obstacle(avoidance, state, (odometry.x, odometry.y))
    return (
        replace(
            state,
            blocked=True,
            attempts=state.attempts + 1,
            stopped_at=odometry.distance,
            obstacle=obstacle,
            back_until=None,
        ),
        False,
    )


def room_now(avoidance: Avoidance, state: AvoidanceState, odometry: OdometryState) -> float:
    """Room between the outline and the nearest obstacle [m]; infinite where the map knows none."""
    room = state.room
    grid = (room.distances, room.x0, room.y0, room.cell, avoidance.circles, avoidance.radius)
    return float(room_at_pose(*grid, odometry.x, odometry.y, odometry.yaw))
