"""Ground that the camera looks at and does not see: behind an edge, and so perhaps a drop.

In base_link, where level ground under the rover is the plane z = -ride_height, the camera stands H above that
plane. In a sector of directions the points are ordered by distance over ground. Where the ground goes on, they
follow each other as the rays of the camera do. A point at distance d and height h above the plane, and no other
for longer than

    d (h + s) / (H - h - s) + spacing(d),        s = highest step that the rover passes,

hides more than it would if it were s higher than it is (similar triangles): then the ground behind it falls by more
than about s, or something stands there that is an obstacle in its own right. spacing(d) = SPACING (d^2 + H^2) / H is
what lies between two rays that are SPACING apart on level ground.

Assumptions: within `near` a slope that the rover can go down stays in view (its angle is below atan(H / near)); the
rows of the camera are nearer together than SPACING; the sector is one in which all rows reach.

Sources: Matthies & Rankin (2003), IEEE/RSJ Int. Conf. Intelligent Robots and Systems, 370 (negative obstacles from the
gap between a near edge and what is seen beyond it); the bound is this module's.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

SECTORS = 18
"""Directions that are looked at."""
SPACING = 0.1
"""Angle between two points, one above the other, that is taken for granted: over twice that of the rows [rad]."""
DEPTH = 0.6
"""Of a hidden strip only so much is marked [m]: what lies behind is seen when the rover is there."""


class HiddenStrips(NamedTuple):
    """What an observation did not see: the first hidden strip of each sector, over ground from the camera."""

    edges: FloatArray
    """Where it begins, shape (SECTORS,) [m]; infinite where nothing is hidden, NaN where nothing can be said."""
    ends: FloatArray
    """Where it ends, shape (SECTORS,) [m]; where nothing is hidden, how far edges count."""
    camera: FloatArray
    """The camera in base_link, shape (3,) [m]."""
    view_deg: float
    """All sectors together, evenly to both sides."""


@njit(cache=True)
def hidden_strips(
    points: FloatArray, camera: FloatArray, ride_height: float, view_deg: float, near: float, step: float
) -> HiddenStrips:
    """First hidden strip of each sector.

    Args:
        points: in base_link, shape (n, 3) [m]. camera: its place there, shape (3,) [m].
        view_deg: all sectors together, evenly to both sides. near: only edges within this distance count [m].
    """
    edges, ends = np.full(SECTORS, np.nan), np.full(SECTORS, np.inf)
    half = math.radians(0.5 * view_deg)
    height = camera[2] + ride_height
    count = points.shape[0]
    sectors, distances = np.empty(count, np.int64), np.empty(count)
    for i in range(count):
        ahead, left = points[i, 0] - camera[0], points[i, 1] - camera[1]
        sector = math.floor((math.atan2(left, ahead) + half) / (2.0 * half) * SECTORS)
        sectors[i] = sector
        distances[i] = math.sqrt(ahead * ahead + left * left)
    order = np.argsort(distances)
    last, top = np.full(SECTORS, -1.0), np.zeros(SECTORS)
    done = np.zeros(SECTORS, np.bool_)
    for place in range(count + SECTORS):
        if place < count:
            i = order[place]
            sector, distance = sectors[i], distances[i]
            if not 0 <= sector < SECTORS:
                continue
            above = max(points[i, 2] + ride_height, 0.0)
        else:  # behind the last point of each sector
            sector, distance, above = place - count, math.inf, 0.0
        if done[sector]:
            continue
        if last[sector] >= 0.0:
            if last[sector] > near:
                done[sector] = True
                edges[sector], ends[sector] = math.inf, near
                continue
            room = height - top[sector] - step
            shadow = last[sector] * (top[sector] + step) / room if room > 0.0 else math.inf
            spacing = SPACING * (last[sector] * last[sector] + height * height) / height
            if distance - last[sector] > shadow + spacing:
                edges[sector], ends[sector] = last[sector], min(distance, last[sector] + DEPTH)
                done[sector] = True
                continue
        last[sector] = distance
        top[sector] = above
    return HiddenStrips(edges, ends, camera, view_deg)


@njit(cache=True)
def is_hidden(ahead: float, left: float, strips: HiddenStrips) -> int:
    """1 where a place, relative to the camera in the plane of the body [m], lies in a hidden strip; 0 where it lies in
    ground that the camera sees up to there; -1 where the observation says nothing about it.
    """
    edges, ends, half = strips.edges, strips.ends, math.radians(0.5 * strips.view_deg)
    sector = math.floor((math.atan2(left, ahead) + half) / (2.0 * half) * SECTORS)
    if not 0 <= sector < SECTORS or math.isnan(edges[sector]):
        return -1
    distance = math.sqrt(ahead * ahead + left * left)
    if distance > ends[sector]:
        return -1
    return 1 if distance > edges[sector] else 0
