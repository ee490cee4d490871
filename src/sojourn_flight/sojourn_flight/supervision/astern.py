"""Driving astern: a machine whose leading wheels have lost their motors turns about and trails them.

A wheel without its motor stands still. Ahead of the machine it ploughs, and the machine must push it; trailed in what
the others have loosened it drags less. Explorer on lunar_nominal with a dead front wheel, kept to a straight way up a
grade, rims at 0.12 m/s (measured in the plant): 0.032 m/s forwards and 0.086 m/s backwards on the level, 0.0016 and
0.07 on 3 degrees, 0.0014 and 0.005 on 4; on 5 degrees it gets up neither way.

It is chosen where wheels slip by as much as calls for another way (`slip_policy.another_way`, `slip.stuck_slip`), where
more wheels without motors lie ahead of base_link than behind it, and where the machine can turn on the spot. The goal
lies ahead and nothing looks backwards: it stands for a look, turns about, drives on its path backwards as far as the
ground about it has been seen, and turns to look again. What closes the path, too, is looked at with the camera, and
the detour planned from there. With the motor back, or at the goal, it drives forwards again.

Without a camera no ground is looked at anyway, and all of the way is driven backwards.

Source: Arvidson et al. (2010), J. Geophys. Res. 115:E00F03 (Spirit, its right front wheel dead, driven backwards).
"""

from typing import NamedTuple

import numpy as np

from sojourn_flight.hazards.obstacle_map import HIDDEN
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.planning.follower_state import FollowerPhase, FollowerState
from sojourn_flight.planning.goal_follower import turned_about
from sojourn_flight.planning.route import advanced
from sojourn_flight.supervision.avoidance_types import Avoidance, AvoidanceState
from sojourn_flight.supervision.driven_machine import DrivenMachine
from sojourn_flight.supervision.path_check import closed_ahead, path_ahead
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

OBSERVATION_TIME = 2.5
"""It stands so long to observe before it turns about: two of the camera's periods, and a little more [s]."""
WORTH_A_TURN = 0.6
"""Way that must have been seen for it to turn about [m]."""
LEFT = 0.25
"""With so much of it left it turns to observe again [m]."""
GAP = 1
"""Cells so far from one that has been seen count as seen: an observation leaves gaps [-]."""


class Sense(NamedTuple):
    """In which sense a way is driven in a period."""

    way: FollowerState
    seen: AvoidanceState | None
    observing: bool = False
    """It stands to observe the ground."""


def is_answered(way: FollowerState, rather_astern: bool) -> bool:
    """Whether wheels that spin end no goal yet: the other sense is to be tried, or is being tried.

    There it takes a while until they are through what they have loosened; the time-out ends what gets nowhere.

    Args:
        rather_astern: the machine would get on better backwards, see `Mobility`.
    """
    if way.phase is not FollowerPhase.DRIVE or way.astern:
        return way.trails
    return rather_astern and (not way.trails or _is_observing(way))


def choose_sense(
    machine: DrivenMachine,
    seen: AvoidanceState | None,
    way: FollowerState,
    rather_astern: bool,
    slipping: bool,
    odometry: OdometryState,
) -> Sense:
    """The way, driven on, or turned about.

    Args:
        seen: None without a camera. rather_astern: as for `is_answered`.
        slipping: the wheels slip by so much that another way is called for.
    """
    if not rather_astern:
        return Sense(turned_about(way, astern=False) if way.astern else replace(way, trails=False), seen)
    if way.phase is not FollowerPhase.DRIVE or not (way.astern or way.trails or slipping):
        return Sense(way, seen)
    if not way.trails:
        way = replace(way, trails=True, phase_elapsed=0.0)
    if machine.avoidance is None or seen is None:
        return Sense(way if way.astern else turned_about(way, astern=True), seen)
    if not seen.fresh:
        return Sense(way, seen, observing=_is_observing(way))
    length = _seen_length(machine.avoidance, seen, way)
    if way.astern:
        position = (odometry.x, odometry.y)
        route = None if seen.route is None else advanced(seen.route, position, 0.5 * seen.clearance.cell)
        seen = replace(seen, route=route)
        return Sense(way if length >= LEFT and not seen.blocked else turned_about(way, astern=False), seen)
    can_turn = seen.clearance.at(odometry.x, odometry.y) >= machine.avoidance.turning
    if _is_observing(way) and way.phase_elapsed > 0.5 * OBSERVATION_TIME and can_turn and length >= WORTH_A_TURN:
        return Sense(turned_about(way, astern=True), seen)
    return Sense(way, seen, observing=_is_observing(way))


def _is_observing(way: FollowerState) -> bool:
    return way.trails and not way.astern and way.phase is FollowerPhase.DRIVE and way.phase_elapsed <= OBSERVATION_TIME


def _seen_length(avoidance: Avoidance, seen: AvoidanceState, way: FollowerState) -> float:
    """Length of the path ahead on which all ground under it, driven astern, has been seen and is open [m]."""
    from scipy.ndimage import binary_dilation  # here: a drive without a camera need not wait for it to load

    distances, poses = path_ahead(way)
    if not len(poses):
        return 0.0
    map_, astern = seen.map, avoidance.astern
    known = binary_dilation(map_.known, np.ones((2 * GAP + 1, 2 * GAP + 1))) & (map_.layers[HIDDEN] == 0.0)
    outline = astern.params.outline
    ahead = np.array([(outline.front, y) for y in np.linspace(-outline.half_width, outline.half_width, 9)])
    ends = _under(poses, ahead)
    columns = np.floor((ends[..., 0] - map_.x0) / map_.cell).astype(np.int64)
    rows = np.floor((ends[..., 1] - map_.y0) / map_.cell).astype(np.int64)
    on_map = (rows >= 0) & (rows < len(known)) & (columns >= 0) & (columns < len(known))
    open_ = on_map & known[rows * on_map, columns * on_map]
    unseen = np.flatnonzero(~open_.all(axis=1))
    length = float(distances[unseen[0]] if len(unseen) else distances[-1] + LEFT)
    closed = closed_ahead(astern, seen, way, avoidance.params.passable.hysteresis)
    return length if closed is None else min(length, closed.distance)


def _under(poses: FloatArray, points: FloatArray) -> FloatArray:
    """Places in odom of points of the machine, shape (n, 2), at poses, shape (m, 3): shape (m, n, 2) [m]."""
    cosine, sine = np.cos(poses[:, 2, np.newaxis]), np.sin(poses[:, 2, np.newaxis])
    x = poses[:, 0, np.newaxis] + cosine * points[:, 0] - sine * points[:, 1]
    y = poses[:, 1, np.newaxis] + sine * points[:, 0] + cosine * points[:, 1]
    return np.stack([x, y], axis=-1)
