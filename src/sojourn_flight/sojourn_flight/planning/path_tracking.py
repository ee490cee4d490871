"""Keeping on a path: curvature feed-forward with feedback of lateral error and course.

With e the rover's place to the left of the path, p = yaw + drift - h the angle of its course to the path's heading
h, and s, c the distance and curvature of the path, distance driven as time:

    e' = sin p,    p' = k - c cos p / (1 - c e),

where k is the curvature driven. `drift` is the angle by which the rover slides off its heading, downhill on a side
slope: the course is led along the path and the heading stands off by itself (a crab angle). The course wanted and
the curvature are

    p_w = -atan(e / L),    k = c cos p / (1 - c e) + p_w' - (p - p_w) / l,    p_w' = -L sin p / (L^2 + e^2),

so that p - p_w falls as exp(-s / l) and e then as exp(-s / L) once it is small, from any side: the errors do not
oscillate.

Sources: Micaelli and Samson, INRIA RR-2097 (1993), sec. 3 (equations of the errors along the path); Hoffmann,
Tomlin, Montemerlo and Thrun, ACC 2007, 2296 (the course wanted against the lateral error); Krstic, Kanellakopoulos
and Kokotovic (1995), ch. 2 (the derivative of the wanted value as feed-forward). Assumptions: |c e| < 0.9, else the
path is taken as straight; the curvature follows its command within a distance small against l. Slip that makes
curves wider by a part g leaves e = L l c g / (1 + g)."""

import math
from typing import NamedTuple

from sojourn_flight.odometry.odometry import wrap_angle
from sojourn_flight.planning.path import NearestPoint

FARTHEST = 0.9
"""|c e| from which the feed-forward means nothing [-]."""


class Tracking(NamedTuple):
    """What brings the rover back to the path."""

    curvature: float
    """To drive [1/m], without limit."""
    course_error: float
    """Course wanted less course [rad]."""


def track(place: NearestPoint, yaw: float, drift: float, lateral_length: float, heading_length: float) -> Tracking:
    """Curvature for a rover at a place of the path.

    Args:
        place: nearest on the path.
        yaw: heading [rad].
        drift: direction of the motion in base_link [rad], to the left.
        lateral_length: L, distance over which a lateral error is steered out [m].
        heading_length: l, the same for the course [m].
    """
    course = wrap_angle(yaw + drift - place.heading)
    e, c = place.lateral, place.curvature
    wanted = -math.atan(e / lateral_length)
    growth = -lateral_length * math.sin(course) / (lateral_length**2 + e * e)
    ahead = c * math.cos(course) / (1.0 - c * e) if abs(c * e) < FARTHEST else 0.0
    error = wrap_angle(wanted - course)
    return Tracking(ahead + growth + error / heading_length, error)
