"""The way back: over the own track, backwards, to where there is room to turn.

The track is kept as the last poses driven through, SPACING apart, since the rover last turned on the spot: there it had
room to turn, and behind such a place its wheels stood otherwise. Ground that has been driven over is passable, whatever
the camera sees of it now; so the way back needs no map. It is followed by the law of `path_tracking`, for a rover that
looks the other way: heading + pi, and so the yaw rate of a curve is its curvature times the speed as ever. Without a
track (the rover has just been set down) it goes straight back for as long as it is itself.
"""

import math
from typing import NamedTuple, TypeAlias

import numpy as np

from sojourn_flight.hazards.clearance import ClearanceMap
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.odometry.odometry import wrap_angle
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.planning.path import Leg
from sojourn_flight.planning.path_tracking import track

SPACING = 0.1
"""Of the poses of a track [m]."""
KEPT = 100
"""Poses of a track [-]."""
TURNED = 0.35
"""A turn within SPACING that is one on the spot [rad]."""
SET_DOWN = 1.0
"""Way back without a track [m]: the rear wheels stood nearly so far behind."""

Track: TypeAlias = tuple[Pose, ...]


class WayBack(NamedTuple):
    """A leg that is driven backwards; its headings are those of the motion."""

    leg: Leg
    gone: float = 0.0
    """[m]"""


def driven_on(track_: Track, here: Pose) -> Track:
    """The track with the rover's pose in odom; driving back takes poses off it."""
    if not track_ or abs(wrap_angle(here.heading - track_[-1].heading)) > TURNED:
        return (here,)
    last = track_[-1]
    x, y = here.x - last.x, here.y - last.y
    ahead = math.cos(here.heading) * x + math.sin(here.heading) * y
    if ahead >= SPACING:
        return (*track_[-KEPT + 1 :], here)
    return track_[:-1] if ahead <= -SPACING and len(track_) > 1 else track_


def way_back(
    track_: Track, here: Pose, clearance: ClearanceMap, turning: float | None, longest: float
) -> WayBack | None:
    """Back to the first place with `turning` clear [m], at most `longest` [m]; None where there is nowhere to go.

    Args:
        turning: None for all of the way.
    """
    behind = [here, *(pose for pose in reversed(track_) if math.dist(pose[:2], here[:2]) > 0.5 * SPACING)]
    if len(behind) == 1:
        straight = np.arange(SPACING, SET_DOWN + 0.5 * SPACING, SPACING)
        cosine, sine = math.cos(here.heading), math.sin(here.heading)
        behind += [here._replace(x=here.x - s * cosine, y=here.y - s * sine) for s in straight.tolist()]
    poses, gone = [here], 0.0
    for pose in behind[1:]:
        gone += math.dist(pose[:2], poses[-1][:2])
        if gone > longest + 1e-9:
            break
        poses.append(pose)
        if turning is not None and clearance.at(pose.x, pose.y) >= turning:
            break
    if len(poses) == 1:
        return None
    places = np.array([pose[:2] for pose in poses])
    distances = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    headings = np.unwrap([pose.heading for pose in poses]) + math.pi
    curvatures = np.gradient(headings, distances)
    samples = np.column_stack([distances, places, headings, curvatures])
    return WayBack(Leg(Pose(*(float(value) for value in samples[0, 1:4])), (), samples))


def go_back(params: GoalFollowerParams, way: WayBack, here: Pose, speed: float) -> tuple[WayBack | None, PlanarTwist]:
    """The way behind a rover at a pose in odom, None at its end, and the motion along it at a speed [m/s]."""
    place = way.leg.nearest(here.x, here.y, way.gone)
    if way.leg.length - place.distance <= 0.25 * SPACING:
        return None, PlanarTwist(0.0, 0.0, 0.0)
    steering = track(place, here.heading + math.pi, 0.0, params.lateral_length, params.heading_length)
    curvature = min(max(steering.curvature, -params.max_curvature), params.max_curvature)
    return way._replace(gone=place.distance), PlanarTwist(-speed, 0.0, curvature * speed)
