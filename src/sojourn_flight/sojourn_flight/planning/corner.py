"""A corner of a line of straight parts, rounded: clothoid, arc, clothoid, the same way in and out.

With (X, Y) the way that a turn by a makes along and across the first straight, and (x, y) that of its middle,

    T = X / (1 + cos a)          distance of its begin and its end from the corner
    c = |(x - T, y)|             how far it passes the corner

T falls with the curvature, and so does c; with an arc alone they are tan(a/2) / k and (1 / cos(a/2) - 1) / k, which
bounds the curvature from below. The gentlest turn with T and c inside their limits is found by bisection:
it asks least of the steering and of the soil. (Genta and Genta 2017, sec. 5.5; the clothoids are those of
vehicle.clothoid.) Range: |a| < pi - 0.01."""

import math
from typing import NamedTuple

from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.planning.clothoid import Piece, Pose, end_of, turn_pieces

SHARPEST_TURN = math.pi - 0.01
"""A turn by more leads back along the way it came [rad]."""
HALVINGS = 7
"""Steps towards the gentlest turn: its curvature is found to 1 % of the range or better."""
ORIGIN = Pose(0.0, 0.0, 0.0)


class Corner(NamedTuple):
    """A rounded corner."""

    pieces: tuple[Piece, ...]
    tangent: float
    """Distance of its begin and its end from the corner [m]."""
    cut: float
    """How far it passes the corner [m]."""
    curvature: float
    """The greatest on it [1/m]."""


def round_corner(angle: float, curvature: float, sharpness: float) -> Corner:
    """Turn by `angle` [rad] with a greatest curvature [1/m] and its growth [1/m^2]."""
    pieces = turn_pieces(angle, curvature, sharpness)
    end = middle = ORIGIN
    for piece in pieces:
        end = end_of(end, piece)
    half = (pieces[0], pieces[1]._replace(length=0.5 * pieces[1].length)) if len(pieces) == 3 else pieces[:1]
    for piece in half:
        middle = end_of(middle, piece)
    tangent = end.x / (1.0 + math.cos(angle))
    reached = abs(pieces[0].sharpness) * pieces[0].length
    return Corner(pieces, tangent, math.hypot(middle.x - tangent, middle.y), reached)


def gentlest_corner(angle: float, room: float, cut: float, limits: TurningLimits) -> Corner | None:
    """The gentlest turn by `angle` [rad] that needs no more than `room` [m] of the straights and passes the corner
    within `cut` [m]; None if the limits do not allow one.
    """
    if abs(angle) > SHARPEST_TURN:
        return None
    sharpest = round_corner(angle, limits.curvature, limits.sharpness)
    if sharpest.tangent > room or sharpest.cut > cut:
        return None
    low, high, best = needed_curvature(angle, room, cut), limits.curvature, sharpest
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        corner = round_corner(angle, middle, limits.sharpness)
        if corner.tangent <= room and corner.cut <= cut:
            high, best = middle, corner
        else:
            low = middle
    return best


def needed_curvature(angle: float, room: float, cut: float) -> float:
    """Curvature that an arc alone would need for a corner [1/m]; with clothoids it is more."""
    half = 0.5 * min(abs(angle), SHARPEST_TURN)
    by_room = math.tan(half) / room if room > 0.0 else math.inf
    by_cut = (1.0 / math.cos(half) - 1.0) / cut if cut > 0.0 else math.inf
    return max(by_room, by_cut)
