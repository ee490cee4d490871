"""What keep-out zones make of a goal before it starts: refused, led round them at once, or left as it is.

A way round is planned on the maps of obstacle handling, which hold the zones wherever they lie, seen or not. A drive
without obstacle handling goes round nothing: it refuses a way that would lead through a zone.
"""

import math

import numpy as np

from sojourn_flight.hazards.keep_out import KeepOut
from sojourn_flight.hazards.zone_params import first_in
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_state import FollowerState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.goal_follower import rerouted
from sojourn_flight.planning.path import PlannedPath
from sojourn_flight.planning.route import route_of
from sojourn_flight.supervision.avoidance import detour
from sojourn_flight.supervision.avoidance_types import Avoidance, AvoidanceState
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray


def clear_of_zones(
    zones: KeepOut,
    avoidance: Avoidance | None,
    state: AvoidanceState | None,
    goal: Goal,
    answer: FollowerState | GoalOutcome,
    here: OdometryState,
) -> FollowerState | GoalOutcome:
    """The follower's answer to a goal, on a way that keeps out of the zones, or the refusal."""
    if not zones.zones or isinstance(answer, GoalOutcome):
        return answer
    margin = 0.0 if avoidance is None else avoidance.params.outline.half_width
    asked = first_in(zones.zones, np.array(goal.points), margin)
    if asked is not None:
        (x, y), zone = goal.points[asked[0]], asked[1]
        where = "in" if zone.distances(np.array([[x, y]]))[0] == 0.0 else "too near to"
        return _refused(goal, f"the goal ({x:.2f}, {y:.2f}) lies {where} the keep-out zone {zone.name}")
    places = _places(answer.path)
    crossed = first_in(zones.zones, places, margin)
    if crossed is None:
        return answer
    x, y = places[crossed[0]].tolist()
    text = f"the way leads through the keep-out zone {crossed[1].name} at ({x:.2f}, {y:.2f})"
    if avoidance is None or state is None:
        return _refused(goal, f"{text}, and without obstacle handling there is no way round")
    pose = Pose(here.x, here.y, here.yaw)
    begun = replace(state, route=route_of(goal, (here.x, here.y), here.distance))
    found = detour(avoidance, begun, pose, 0.0)
    if found is None or isinstance(found, GoalOutcome):
        return _refused(goal, f"{text}, and the maps know no way round")
    more = found.path.length - answer.path.length
    if more > avoidance.params.max_detour:
        return _refused(goal, f"{text}, and the way round is {more:.0f} m longer")
    return rerouted(answer, found, pose)


def _places(path: PlannedPath) -> FloatArray:
    """x, y along a path, shape (n, 2)."""
    parts = [leg.samples[:, 1:3] for leg in path.legs]
    return np.concatenate(parts) if parts else np.empty((0, 2))


def _refused(goal: Goal, reason: str) -> GoalOutcome:
    return GoalOutcome("refused", reason, goal, math.nan)
