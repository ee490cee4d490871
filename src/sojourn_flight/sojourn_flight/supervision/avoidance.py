"""Obstacle handling of the drive: sees, judges, keeps clear, goes round, backs off, or says why it stops.

Three layers, from slow to fast:

- With each cloud: the map, what of it no part of the rover may meet, the clearance map, and what of it the wide map
  keeps (`see`).
- With each cloud, and when the guard has stopped a motion: is the path ahead closed (`path_check`)? Then a detour is
  planned on both maps and given to the goal follower in place of the way asked for (`guide`). With no room to turn into
  it the rover first goes back over its own track. A goal ends as stopped, with the obstacle, its measure and the limit,
  where no way is known and the obstacle is near, where the goal lies in an obstacle, where the detour gets too long,
  or where the rover cannot get free.
- Every period: a motion that would bring the outline nearer to an obstacle than the guard's margin, or onto ground too
  steep in its direction, is not made (`guarded`); one that leads away from it is. On the way back the margin is zero.
  This holds for /cmd_vel, too, unless it is switched off.

A plan is made by the costs of cells and then checked pose by pose with the chassis settled on the map; where that finds
it too steep or too narrow, the place is closed and the next plan made (for a rover turned off its path the next first
keeps more clearance), TRIES times (Toupet et al. 2020, IEEE Aerospace Conf.: ENav ranks paths by costs and checks the
best by settling). No path is taken that this check finds closed within HURRY. It keeps to the limits; under way they
may be exceeded by the part `hysteresis`, so that noise about a limit changes no plan.

A goal in an obstacle that the map knows is refused (`refusal`). Hidden ground closes the way, but does not make a goal
impossible: it may be seen from elsewhere. Positions in odom.
"""

import math

import numpy as np

from sojourn_flight.hazards.clearance import AHEAD, clearance_in, clearance_of_motion
from sojourn_flight.hazards.obstacle_map import empty_map, with_cloud, with_slip
from sojourn_flight.hazards.traversability import HIDDEN_GROUND, Obstacle, judged
from sojourn_flight.hazards.wide_map import JudgedCells, empty_wide_map, remembered
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.detour import Maps, plan_detour
from sojourn_flight.planning.detour_search import Slopes, static_costs, sure_slopes
from sojourn_flight.planning.follower_state import FollowerPhase, FollowerState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.goal_follower import accept, rerouted, stop
from sojourn_flight.planning.route import advanced, route_of
from sojourn_flight.planning.way_back import driven_on, go_back, way_back
from sojourn_flight.supervision.avoidance_types import Avoidance, AvoidanceState, ClosedPlace, Guidance
from sojourn_flight.supervision.path_check import closed_ahead, nearest_obstacle, obstacle_in, slope_at, tilts_of
from sojourn_flight.supervision.slip_policy import SlipPolicyParams
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

NEAR_GOAL = 3.0
"""A goal in an obstacle is given up from here [m]: beyond it the error of stereo may have made the obstacle."""
LAST_STRETCH = 0.35
"""Without a detour the rover goes on to so far before the closed place [m]: it may find one there."""
ATTEMPTS = 5
"""Motions that the guard stops, on and back in turn, before the rover gives up [-]."""
PATIENCE, HURRY = 0.5, 1.2
"""A detour is kept for so long [m], unless it is closed within so far [m]: what is far off may look other soon."""
FREE_WAY = 0.3
"""So far along its route the rover has to get to be free of such a series; so far it backs off in it [m]."""
HEADWAY, WITHOUT_HEADWAY = 0.3, 8
"""So many detours may be planned within so much of driving [m]; with one more the rover gives up [-]."""
CORNER_CUTS = (1.0, 0.5, 0.25, 0.1)
"""Parts of the follower's corner_cut that are tried for a path that stays clear [-]."""
STARTS = (*((part, False) for part in CORNER_CUTS), (CORNER_CUTS[-1], True))
"""Paths that are tried along the same points: part of corner_cut, and whether they begin with a turn on the spot."""
TRIES = 4
"""Plans that are made for one detour, each without the place where the one before was closed [-]."""
TOO_STEEP, TOO_NARROW = 0.3, 0.2
"""So far about such a place the next plan does not go [m]."""
EXAMPLE_CLOUD = np.array([[3.0, 0.2 * y, 0.2 * z] for y in range(-6, 7) for z in range(5)])
"""A wall that closes the way, for the warm-up [m]."""
STANDSTILL = PlanarTwist(0.0, 0.0, 0.0)
STEPS = np.array(AHEAD)
ON_A_PATH = np.array([0.05, 0.1])
"""The same of a motion that keeps the rover on a path [m]: the path has been looked at, and a curve that leads back to
it is not driven on for 0.25 m; the rover stands within 0.02 m."""


def initial_avoidance(avoidance: Avoidance, x: float, y: float) -> AvoidanceState:
    """Nothing seen yet, at a place in odom [m]."""
    map_ = empty_map(avoidance.params, x, y)
    ground = avoidance.keep_out.closing(judged(avoidance.params, map_), map_.cell)
    wide = avoidance.keep_out.closing_wide(empty_wide_map(avoidance.params.map, x, y), avoidance.straight)
    return AvoidanceState(map_, ground, clearance_in(map_, ground.kinds), wide)


def warm_up_guard(avoidance: Avoidance, state: AvoidanceState) -> None:
    """Have the kernel ready that only a motion near an obstacle asks."""
    pose, twist = (0.0, 0.0, 0.0), (0.1, 0.0, 0.0)
    clearance_of_motion(
        state.clearance.grid, avoidance.circles, pose, twist, avoidance.params.outline.turn_radius, STEPS
    )


def see(
    avoidance: Avoidance, state: AvoidanceState, points: FloatArray | None, odometry: OdometryState, dt: float
) -> AvoidanceState:
    """The state with a cloud, shape (n, 3) in base_link [m], or without one in this period."""
    track = driven_on(state.track, Pose(odometry.x, odometry.y, odometry.yaw))
    if points is None:
        return replace(state, track=track, since_cloud=state.since_cloud + dt, fresh=False)
    position = np.array([odometry.x, odometry.y, odometry.z])
    rotation = rotation_of(odometry.roll, odometry.pitch, odometry.yaw)
    map_ = with_cloud(avoidance.params, state.map, points, avoidance.camera, position, rotation, odometry.distance)
    level = odometry.z + map_.lift - avoidance.params.outline.ride_height
    state = judged_anew(avoidance, replace(state, map=map_, track=track, level=level), odometry)
    return replace(state, since_cloud=0.0, fresh=True)


def judged_anew(avoidance: Avoidance, state: AvoidanceState, odometry: OdometryState) -> AvoidanceState:
    """The state with all that follows from its map."""
    map_ = state.map
    ground = avoidance.keep_out.closing(judged(avoidance.params, map_, state.ground), map_.cell)
    clearance = clearance_in(map_, ground.kinds)
    wide = remembered(
        avoidance.params.map,
        state.wide,
        JudgedCells(
            map_.grid,
            static_costs(clearance, avoidance.straight, avoidance.turning),
            sure_slopes(ground.slopes),
            map_.known,
        ),
        (odometry.x, odometry.y, odometry.distance),
    )
    wide = avoidance.keep_out.closing_wide(wide, avoidance.straight)
    return replace(state, ground=ground, clearance=clearance, wide=wide)


def refusal(avoidance: Avoidance, state: AvoidanceState, goal: Goal) -> str | None:
    """Why a goal cannot be: it lies in an obstacle that the map knows. None if it can."""
    if not goal.points or not all(math.isfinite(value) for value in goal.points[-1]):
        return None  # the follower says what is wrong with it
    place = goal.points[-1]
    if state.clearance.at(*place) >= avoidance.params.outline.half_width:
        return None
    cell = state.clearance.nearest_to(*place)
    if cell is None or state.ground.kinds[cell] == HIDDEN_GROUND:
        return None
    obstacle = obstacle_in(avoidance, state, *cell)
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
    known = (state.map, state.ground, state.clearance, state.wide, state.track)
    start = AvoidanceState(*known, state.level, state.since_cloud, state.fresh)
    return answer, replace(start, route=route_of(goal, (odometry.x, odometry.y), odometry.distance))


def guide(avoidance: Avoidance, state: AvoidanceState, way: FollowerState, odometry: OdometryState) -> Guidance:
    """Looks at the path ahead where there is something new, and answers with the way to follow from here."""
    params = avoidance.params
    if state.since_cloud > params.blind_timeout:
        text = f"waiting for the hazard camera, nothing seen for {params.blind_timeout:.0f} s"
        return Guidance(state, way, STANDSTILL, text=text)
    if state.back is not None:
        return _back_off(avoidance, state, way, odometry)
    if state.route is None or not (state.fresh or state.blocked or state.replan):
        return Guidance(state, way)
    if state.blocked and state.attempts > 1 and not state.fresh:  # what this look has closed twice, the next may open
        return Guidance(state, way, STANDSTILL, text=f"stopped before {state.obstacle}")
    position = (odometry.x, odometry.y)
    route = advanced(state.route, position, 0.5 * state.clearance.cell)
    state = replace(state, route=route)
    if route.progress > state.mark + FREE_WAY:
        state = replace(state, mark=route.progress, attempts=0)
    closed = closed_ahead(avoidance, state, way, params.passable.hysteresis)
    if closed is None and not (state.blocked or state.replan):
        return Guidance(replace(state, obstacle=None), way)
    stuck, backed, forced = state.blocked and state.attempts % 2 == 0, state.replan, state.blocked or state.replan
    if closed is not None:
        state = replace(state, obstacle=closed.obstacle)
    elif state.obstacle is None:
        state = replace(state, obstacle=nearest_obstacle(avoidance, state, position))
    state = replace(state, blocked=False, replan=False)
    reach = 0.0 if closed is None else closed.distance
    if not forced and reach > HURRY and odometry.distance < state.planned_at + PATIENCE:
        return Guidance(state, way)
    reason = refusal(avoidance, state, route.goal)
    if reason is not None and math.dist(position, route.goal.points[-1]) <= NEAR_GOAL:
        return _given_up(state, way, reason)
    if state.attempts > ATTEMPTS:
        return _given_up(state, way, f"{state.obstacle}: no room to move beside it")
    narrow = state.clearance.at(*position) < params.outline.turn_radius + params.guard_margin
    answer = detour(avoidance, state, Pose(*position, odometry.yaw), way.drift)
    if answer is None:
        if reach > LAST_STRETCH:
            return Guidance(state, way)
        if narrow and not backed:
            return _go_back(avoidance, state, way, odometry, params.back_off)
        return _given_up(state, way, f"{state.obstacle}: the map knows no way round")
    if isinstance(answer, GoalOutcome):
        return _given_up(state, way, f"{state.obstacle}: no path round it, {answer.reason}")
    if odometry.distance - route.driven + answer.path.length > route.length + params.max_detour:
        more = f"no way round with {params.max_detour:.0f} m more than asked for"
        return _given_up(state, way, f"{state.obstacle}: {more}")
    if stuck:
        return _go_back(avoidance, state, way, odometry, FREE_WAY)
    if answer.phase is FollowerPhase.ALIGN and narrow and not backed:
        return _go_back(avoidance, state, way, odometry, params.back_off)
    return _go_round(state, way, answer, odometry)


def detour(avoidance: Avoidance, state: AvoidanceState, here: Pose, drift: float) -> FollowerState | GoalOutcome | None:
    """The detour from a pose, or why the follower refuses it; None where the maps know none.

    Args:
        drift: angle by which the rover slides off its heading [rad].
    """
    route, clearance = state.route, state.clearance
    if route is None:
        return None
    limits, slopes = avoidance.params.passable, sure_slopes(state.ground.slopes)
    maps = Maps(state.map.known, Slopes(slopes, limits.tilts), state.wide)
    straight, wide = avoidance.straight, avoidance.straight_at(drift)
    farthest: FollowerState | GoalOutcome | None = None
    reach = HURRY
    for _ in range(TRIES):
        points = plan_detour(maps, clearance, route, here, straight, avoidance.turning)
        if points is None:
            break
        goal = replace(route.goal, points=tuple(points), heights=())
        found, closed = _path_along(avoidance, state, goal, here, drift)
        if closed is None:
            return found
        if closed.distance > reach:
            farthest, reach = found, closed.distance
        if closed.tilt or straight == wide:
            clearance = clearance.without(closed.pose.x, closed.pose.y, TOO_STEEP if closed.tilt else TOO_NARROW)
        else:
            straight = wide
    return farthest


def _path_along(
    avoidance: Avoidance, state: AvoidanceState, goal: Goal, here: Pose, drift: float
) -> tuple[FollowerState | GoalOutcome, ClosedPlace | None]:
    """The path along planned points that keeps clear, or the last that was tried and where it does not."""
    answer: FollowerState | GoalOutcome
    closed: ClosedPlace | None = None
    follower = avoidance.follower
    for part, turns in STARTS:
        angle = follower.align_tolerance if turns else follower.realign_angle
        narrow = follower.model_copy(update={"corner_cut": part * follower.corner_cut, "realign_angle": angle})
        answer = accept(narrow, avoidance.turning_limits, goal, here)
        closed = None
        if isinstance(answer, FollowerState):
            closed = closed_ahead(avoidance, state, replace(answer, drift=drift), 0.0)
        if isinstance(answer, FollowerState) and closed is None:
            break
    return answer, closed


def _go_round(state: AvoidanceState, way: FollowerState, answer: FollowerState, odometry: OdometryState) -> Guidance:
    """On along another path, unless too many have been taken without headway."""
    here = Pose(odometry.x, odometry.y, odometry.yaw)
    plans, since = state.plans + 1, state.plans_from
    if odometry.distance > since + HEADWAY:
        plans, since = 1, odometry.distance
    if plans > WITHOUT_HEADWAY:
        return _given_up(state, way, f"{state.obstacle}: {WITHOUT_HEADWAY} ways round planned, and no headway")
    state = replace(state, detours=state.detours + 1, planned_at=odometry.distance, plans=plans, plans_from=since)
    return Guidance(state, rerouted(way, answer, here))


def _given_up(state: AvoidanceState, way: FollowerState, reason: str) -> Guidance:
    return Guidance(replace(state, route=None), way, outcome=stop(way, reason))


def _go_back(
    avoidance: Avoidance, state: AvoidanceState, way: FollowerState, odometry: OdometryState, longest: float
) -> Guidance:
    """Back over the own track, then the way is planned again; at once where there is no way back."""
    here = Pose(odometry.x, odometry.y, odometry.yaw)
    turning = avoidance.turning if longest > FREE_WAY else None
    back = way_back(state.track, here, state.clearance, turning, longest)
    if back is None:
        return Guidance(replace(state, replan=True), way, STANDSTILL, text="no way back")
    return _back_off(avoidance, replace(state, back=back), way, odometry)


def from_loose_ground(
    avoidance: Avoidance, state: AvoidanceState, odometry: OdometryState, policy: SlipPolicyParams, slip: float
) -> AvoidanceState:
    """The state of a rover whose wheels slip by a mean `slip` [-]: the ground ahead is closed, and it goes back.

    Not where the goal lies in that ground: no other way leads there, and the rover goes on slowly while it can.
    """
    if state.route is None or state.back is not None:
        return state
    here = Pose(odometry.x, odometry.y, odometry.yaw)
    ahead = avoidance.params.outline.front + policy.loose_radius
    place = (here.x + ahead * math.cos(here.heading), here.y + ahead * math.sin(here.heading))
    closes = (
        policy.loose_radius + avoidance.straight + (0.5 + math.sqrt(0.5)) * state.clearance.cell
    )  # to the cells' edges
    if math.dist(place, state.route.goal.points[-1]) < closes:
        return state
    map_ = with_slip(state.map, place, policy.loose_radius, slip, odometry.distance)
    state = judged_anew(avoidance, replace(state, map=map_), odometry)
    back = way_back(state.track, here, state.clearance, None, policy.back)
    return replace(
        state, back=back, replan=back is None, obstacle=Obstacle("loose ground", *place, slip, policy.another_way)
    )


def _back_off(avoidance: Avoidance, state: AvoidanceState, way: FollowerState, odometry: OdometryState) -> Guidance:
    """One period of the way back."""
    if state.back is None:
        return Guidance(state, way)
    here = Pose(odometry.x, odometry.y, odometry.yaw)
    back, twist = go_back(avoidance.follower, state.back, here, avoidance.params.back_off_speed)
    if back is None:
        return Guidance(replace(state, back=None, replan=True), way, STANDSTILL, text="backed off")
    return Guidance(replace(state, back=back), way, twist, text=f"backing off from {state.obstacle}")


def guarded(
    avoidance: Avoidance, state: AvoidanceState, twist: PlanarTwist, odometry: OdometryState, by_hand: bool
) -> tuple[AvoidanceState, bool]:
    """Whether a motion may be made; the state notes one that may not.

    Args:
        by_hand: it is an operator's, who may have switched the guard off.
    """
    clearance, outline = state.clearance, avoidance.params.outline
    if by_hand:
        state = replace(state, blocked=False, obstacle=None)
        if not avoidance.params.guard_cmd_vel:
            return state, True
    steep = _steep_ahead(avoidance, state, twist, odometry)
    if (
        steep is None
        and clearance.at(odometry.x, odometry.y) > outline.turn_radius + AHEAD[-1] + avoidance.params.margin
    ):
        return state, True  # the usual case must be cheap
    on_the_spot = twist.v_x == 0.0 and twist.v_y == 0.0
    if on_the_spot and clearance.at(odometry.x, odometry.y) >= outline.turn_radius + avoidance.params.guard_margin:
        return state, True  # its circle; those that cover the outline sweep more than it does
    pose = (odometry.x, odometry.y, odometry.yaw)
    motion = (float(twist.v_x), float(twist.v_y), float(twist.yaw_rate))
    ways = STEPS if by_hand else ON_A_PATH
    now, least = clearance_of_motion(clearance.grid, avoidance.circles, pose, motion, outline.turn_radius, ways)
    margin = avoidance.params.guard_margin if state.back is None else 0.0  # its own track it has been through
    clear = least >= margin or least >= now - 1e-3
    if clear and steep is None:
        return state, True
    obstacle = nearest_obstacle(avoidance, state, (odometry.x, odometry.y)) if steep is None or not clear else steep
    return replace(state, blocked=True, attempts=state.attempts + 1, obstacle=obstacle, back=None), False


def _steep_ahead(
    avoidance: Avoidance, state: AvoidanceState, twist: PlanarTwist, odometry: OdometryState
) -> Obstacle | None:
    """The slope that a motion leads onto, if it is too steep and steeper than where the rover is."""
    fastest = math.hypot(twist.v_x, twist.v_y)
    cell = state.clearance.cell_of(odometry.x, odometry.y)
    if fastest == 0.0 or not state.ground.steep_near(*cell):
        return None
    way = AHEAD[-1] / fastest
    cosine, sine = math.cos(odometry.yaw), math.sin(odometry.yaw)
    x = odometry.x + way * (cosine * twist.v_x - sine * twist.v_y)
    y = odometry.y + way * (sine * twist.v_x + cosine * twist.v_y)
    there = Pose(x, y, odometry.yaw + way * twist.yaw_rate)
    now, then = tilts_of(avoidance, state, np.array([(odometry.x, odometry.y, odometry.yaw), there]))
    if then <= 1.0 + avoidance.params.passable.hysteresis or then <= now + 0.05:
        return None
    return slope_at(avoidance, state, there)
