"""Is a path closed? Pose by pose: clearance of the outline, and the tilt of the chassis settled on the map."""

import math

import numpy as np

from sojourn_flight.hazards.clearance import ClearanceMap, clearance_along
from sojourn_flight.hazards.keep_out import KEEP_OUT
from sojourn_flight.hazards.settling import settled, tilts_along
from sojourn_flight.hazards.traversability import SLOPES, Obstacle, obstacle_at
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_state import FollowerPhase, FollowerState
from sojourn_flight.planning.goal import Point
from sojourn_flight.supervision.avoidance_types import Avoidance, AvoidanceState, ClosedPlace
from sojourn_machine.params import FloatArray

LOOKAHEAD = 3.0
"""The path is checked so far ahead [m]."""
ESCAPE = 0.8
"""For so long a path may be as narrow and as steep as the rover's own place [m]."""


def nearest_obstacle(avoidance: Avoidance, state: AvoidanceState, place: Point) -> Obstacle | None:
    """The obstacle of the map that is nearest to a place [m], if it knows any."""
    cell = state.clearance.nearest_to(*place)
    return None if cell is None else obstacle_in(avoidance, state, *cell)


def obstacle_in(avoidance: Avoidance, state: AvoidanceState, row: int, column: int) -> Obstacle:
    """What is in a cell of the map that is not free."""
    if state.ground.kinds[row, column] == KEEP_OUT:
        return avoidance.keep_out.obstacle_at(*state.map.centre(row, column), state.map.cell)
    return obstacle_at(avoidance.params, state.map, state.ground, row, column, state.level)


def slope_at(avoidance: Avoidance, state: AvoidanceState, pose: Pose) -> Obstacle:
    """The tilt of the rover at a pose that is nearest to its limit, or farthest beyond."""
    limits = avoidance.params.passable
    climb, lean = settled(state.ground.under(state.map), avoidance.supports, *pose)[:2].tolist()
    degrees = (math.degrees(math.atan(tilt)) for tilt in (climb, -climb, abs(lean)))
    named = zip(SLOPES, degrees, (limits.max_climb_deg, limits.max_descent_deg, limits.max_side_deg), strict=True)
    kind, measured, limit = max(named, key=lambda tilt: tilt[1] / tilt[2])
    return Obstacle(kind, pose.x, pose.y, measured, limit)


def tilts_of(avoidance: Avoidance, state: AvoidanceState, poses: FloatArray) -> FloatArray:
    """The worst tilt over its limit at poses x, y, yaw in odom, shape (n, 3): shape (n,) [-]."""
    limits = avoidance.params.passable.tilts
    return np.asarray(tilts_along(state.ground.under(state.map), avoidance.supports, limits, poses))


def clearances_of(avoidance: Avoidance, clearance: ClearanceMap, poses: FloatArray) -> FloatArray:
    """Clearance at poses x, y, yaw in odom, shape (n, 3): shape (n,) [m]."""
    return np.asarray(clearance_along(clearance.grid, avoidance.circles, poses))


def path_ahead(way: FollowerState, farthest: float = LOOKAHEAD) -> tuple[FloatArray, FloatArray]:
    """The next metres of a path: distances from the rover, shape (n,) [m], and poses x, y, heading in odom, (n, 3).

    Headings are those of the body: where it slides downhill, it is turned off the path by the angle of the slide.
    """
    if not way.path.legs or way.phase in (FollowerPhase.FINAL_ALIGN, FollowerPhase.SETTLE):
        return np.empty(0), np.empty((0, 3))
    rest = [leg.samples for leg in way.path.legs[way.leg :]]
    rest[0] = rest[0][np.searchsorted(rest[0][:, 0], way.on_leg) :]
    before = np.cumsum([-way.on_leg] + [leg.length for leg in way.path.legs[way.leg : -1]])
    distances = np.concatenate([part[:, 0] + start for part, start in zip(rest, before, strict=True)])
    near = distances <= farthest
    poses = np.ascontiguousarray(np.concatenate(rest)[near, 1:4])
    poses[:, 2] -= way.drift
    return distances[near], poses


def closed_ahead(
    avoidance: Avoidance, state: AvoidanceState, way: FollowerState, exceeded: float
) -> ClosedPlace | None:
    """Where the path first has less clearance than the guard asks for, or is too steep.

    Args:
        avoidance: that for the sense in which it is driven. exceeded: part by which slopes may exceed their limits [-].
    """
    distances, poses = path_ahead(way)
    if not len(poses):
        return None
    margin = avoidance.params.guard_margin
    clearances, tilts = clearances_of(avoidance, state.clearance, poses), tilts_of(avoidance, state, poses)
    near = distances < ESCAPE
    narrow = clearances < np.where(near, min(margin, clearances[0] - 0.02), margin)
    steep = tilts > np.where(near, max(1.0 + exceeded, tilts[0] + 0.05), 1.0 + exceeded)
    closed = np.flatnonzero(narrow | steep)
    if not len(closed):
        return None
    first = int(closed[0])
    pose = Pose(*(float(value) for value in poses[first]))
    tilt = bool(steep[first]) and not narrow[first]
    obstacle = slope_at(avoidance, state, pose) if tilt else nearest_obstacle(avoidance, state, pose[:2])
    return ClosedPlace(float(distances[first]), pose, obstacle, tilt)
