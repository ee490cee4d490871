"""From points to a path: straights joined by clothoid, arc, clothoid; turns on the spot where these do not fit.

1. Points that lie within a part of corner_cut of the line through their neighbours are left out (Douglas and
   Peucker, Cartographica 10 (1973) 112): a path that was sampled densely has no corners of its own.
2. The rover turns from its heading towards the first point, in a curve up to realign_angle, else on the spot.
3. Every corner becomes the gentlest turn (see corner) that passes its point within the rest of corner_cut. Two
   corners that share a straight each get what their sharpest turn needs and of the rest a part in proportion to what
   they would like.
4. A corner that no turn within the machine's limits rounds is a stop, a turn on the spot, and on; a machine that
   cannot turn on the spot refuses the path, with the point and the numbers.
5. A heading at the end is turned to on the spot, or by a machine that cannot is led up to by one more point before
   the end.

The curves ask for no more than `planned_curvature` of the machine's greatest: the rest is for the feedback.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.odometry.odometry import wrap_angle
from sojourn_flight.planning.clothoid import Piece, Pose, end_of, turn_pieces
from sojourn_flight.planning.corner import (
    Corner,
    gentlest_corner,
    needed_curvature,
    round_corner,
)
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.planning.goal import Goal, Point
from sojourn_flight.planning.path import Leg, PlannedPath

DROPPED = (0.25, 0.5, 0.1, 0.0)
"""Parts of corner_cut within which points are left out, in the order in which they are tried; 0 leaves out none but
repeated ones, for one in line with its neighbours may be what the first turn has to lead to [-]."""
STRAIGHT_ON = 1e-8
"""A smaller turn is no corner: a hundred metres on, the path is less than a micrometre beside its point [rad]."""
SCAN = 0.05
"""Step in which the turn towards a point is looked for [rad]."""
APPROACHES = (1.5, 2.0, 3.0, 4.0)
"""Straight ways tried before a heading at the end, in radii of the sharpest curve [-]."""


class _Refused(Exception):
    """Reason why a path cannot be; never leaves this module."""


class _Vertex(NamedTuple):
    """Where the path changes its direction."""

    place: Point
    waypoint: int | None
    """Of the waypoint, None for a point that was put in."""
    cut: float
    """How far the path may pass it [m]."""


def plan_path(params: GoalFollowerParams, machine: TurningLimits, start: Pose, goal: Goal) -> PlannedPath | str:
    """The path from a pose in odom to a goal, or why there is none.

    Args:
        params: tolerances.
        machine: what the machine can do.
        start: where it stands.
        goal: finite points, at least one.
    """
    limits = machine._replace(curvature=params.planned_curvature * machine.curvature)
    try:
        if goal.yaw is None or machine.on_the_spot:
            return _plan(params, limits, start, goal, None)
        return _plan_approach(params, limits, start, goal, goal.yaw)
    except _Refused as refusal:
        return str(refusal)


def _plan_approach(
    params: GoalFollowerParams, limits: TurningLimits, start: Pose, goal: Goal, yaw: float
) -> PlannedPath:
    """The path to a goal whose heading has to be met by driving."""
    x, y = goal.points[-1]
    for radii in (0.0, *APPROACHES):
        back = radii / limits.curvature
        before = None if radii == 0.0 else (x - back * math.cos(yaw), y - back * math.sin(yaw))
        try:
            path = _plan(params, limits, start, goal, before)
        except _Refused:
            if before is None:  # then it is not for the heading
                raise
            continue
        end = path.legs[-1].end.heading if path.legs else start.heading
        if abs(wrap_angle(end - yaw)) <= params.align_tolerance:
            return path
    raise _Refused(
        f"the heading of {yaw:.2f} rad at the end: no curve of at most {limits.curvature:.2f} 1/m and "
        f"{APPROACHES[-1] / limits.curvature:.1f} m straight before the end lead there, and this machine does not turn "
        "on the spot"
    )


def _plan(
    params: GoalFollowerParams, limits: TurningLimits, start: Pose, goal: Goal, before: Point | None
) -> PlannedPath:
    """The path with the fewest stops, with one more point before the end if there is one."""
    if _is_there(params, start, goal.points):
        return PlannedPath((), (0.0,) * len(goal.points))
    paths: list[PlannedPath] = []
    refused: _Refused | None = None
    for dropped in DROPPED:
        vertices = _vertices(params.corner_cut, dropped, start, goal.points)
        if before is not None:
            vertices.insert(len(vertices) - 1, _Vertex(before, None, math.inf))
        try:
            paths.append(_through(params, limits, start, goal.points, vertices))
        except _Refused as refusal:
            refused = refused or refusal
            continue
        if len(paths[-1].legs) == 1 or len(vertices) >= len(goal.points):
            break
    if not paths:
        raise refused or _Refused("no path")
    return min(paths, key=lambda path: len(path.legs))


def _through(
    params: GoalFollowerParams,
    limits: TurningLimits,
    start: Pose,
    points: Sequence[Point],
    vertices: Sequence[_Vertex],
) -> PlannedPath:
    """The path along these vertices."""
    first, turn = _first_turn(params, limits, start, vertices[0].place)
    places = [(first.x, first.y), *(vertex.place for vertex in vertices)]
    ways = [math.dist(here, there) for here, there in pairwise(places)]
    headings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(places)]
    corners = _corners(limits, vertices, ways, headings)
    legs: list[Leg] = []
    passed: list[float] = []
    origin, pieces, before, taken = (start if turn else first), list(turn), 0.0, 0.0
    for place, corner in enumerate([*corners, None]):
        tangent = corner.tangent if corner else 0.0
        straight = ways[place] - taken - tangent
        if straight > 1e-9:
            pieces.append(Piece(straight, 0.0, 0.0))
        taken, here = tangent, before + _length(pieces)
        if corner is not None:
            passed.append(here + 0.5 * _length(corner.pieces))
            pieces += corner.pieces
            continue
        passed.append(here)
        legs.append(Leg.of(origin, tuple(pieces)))
        if place < len(corners):
            origin, pieces, before = Pose(*places[place + 1], headings[place + 1]), [], here
    known = {vertex.waypoint: s for vertex, s in zip(vertices, passed, strict=True) if vertex.waypoint is not None}
    _refuse_missed(params, limits, points, known, legs)
    return PlannedPath(tuple(legs), _marks(start, points, known))


def _refuse_missed(
    params: GoalFollowerParams,
    limits: TurningLimits,
    points: Sequence[Point],
    known: Mapping[int, float],
    legs: Sequence[Leg],
) -> None:
    """Raise _Refused for a point that was left out and that the first turn leads away from."""
    places = np.concatenate([leg.samples[:, 1:3] for leg in legs])
    for waypoint, point in enumerate(points):
        if waypoint not in known:
            missed = float(np.hypot(*(places - point).T).min())
            if missed > params.corner_cut:
                raise _Refused(
                    f"point {waypoint} would be passed at {missed:.2f} m with curves of at most "
                    f"{limits.curvature:.2f} 1/m, allowed are {params.corner_cut:.2f} m"
                )


def _length(pieces: Sequence[Piece]) -> float:
    return sum(piece.length for piece in pieces)


def _is_there(params: GoalFollowerParams, start: Pose, points: Sequence[Point]) -> bool:
    """True if a single point is as near as driving leads, or within the tolerance but not ahead."""
    x, y = points[0][0] - start.x, points[0][1] - start.y
    away = math.hypot(x, y)
    beside = abs(wrap_angle(math.atan2(y, x) - start.heading)) > params.realign_angle
    nearest = params.arrive_fraction * params.position_tolerance
    return len(points) == 1 and (away <= nearest or (beside and away <= params.position_tolerance))


def _vertices(corner_cut: float, dropped: float, start: Pose, points: Sequence[Point]) -> list[_Vertex]:
    """The points that matter: those farther than a part of corner_cut from the line through the others."""
    line = [(start.x, start.y), *points]
    kept, spans = {len(points)}, [(0, len(points))]
    if dropped == 0.0:
        kept |= {place for place, (here, there) in enumerate(pairwise(line[1:]), 1) if line[0] != here != there}
        spans = []
    while spans:
        begin, end = spans.pop()
        far, worst = dropped * corner_cut, None
        for place in range(begin + 1, end):
            away = _from_segment(line[place], line[begin], line[end])
            if away > far:
                far, worst = away, place
        if worst is not None:
            kept.add(worst)
            spans += [(begin, worst), (worst, end)]
    cut = (1.0 - dropped) * corner_cut
    return [_Vertex(line[place], place - 1, cut) for place in sorted(kept)]


def _from_segment(point: Point, begin: Point, end: Point) -> float:
    x, y = end[0] - begin[0], end[1] - begin[1]
    square = x * x + y * y
    along = ((point[0] - begin[0]) * x + (point[1] - begin[1]) * y) / square if square > 0.0 else 0.0
    along = min(max(along, 0.0), 1.0)
    return math.dist(point, (begin[0] + along * x, begin[1] + along * y))


def _first_turn(
    params: GoalFollowerParams, limits: TurningLimits, start: Pose, target: Point
) -> tuple[Pose, tuple[Piece, ...]]:
    """Where the first straight begins, and the curve that leads there; none if the rover turns on the spot."""
    bearing = math.atan2(target[1] - start.y, target[0] - start.x)
    turn = abs(wrap_angle(bearing - start.heading))
    ahead = start._replace(heading=bearing)
    if turn <= params.align_tolerance or (limits.on_the_spot and turn > params.realign_angle):
        return ahead, ()
    for part in (0.5, 1.0):
        pieces = _turn_towards(start, target, part * limits.curvature, limits.sharpness)
        if pieces:
            end = start
            for piece in pieces:
                end = end_of(end, piece)
            return end, pieces
    if limits.on_the_spot:
        return ahead, ()
    raise _Refused(
        f"point 0 is {math.dist(target, (start.x, start.y)):.2f} m away at {math.degrees(turn):.0f} deg to the "
        f"heading: inside the turning circle, the sharpest curve planned is {limits.curvature:.2f} 1/m"
    )


def _turn_towards(start: Pose, target: Point, curvature: float, sharpness: float) -> tuple[Piece, ...]:
    """The turn after which the target is straight ahead; empty if none within a full circle does."""
    cosine, sine = math.cos(start.heading), math.sin(start.heading)
    x, y = target[0] - start.x, target[1] - start.y
    ahead, left = cosine * x + sine * y, cosine * y - sine * x
    side = math.copysign(1.0, left)

    def missed(angle: float) -> tuple[float, float]:
        """How far the target is to the outer side after the turn, and ahead."""
        end = Pose(0.0, 0.0, 0.0)
        for piece in turn_pieces(angle, curvature, sharpness):
            end = end_of(end, piece)
        x, y = ahead - end.x, side * left - end.y
        return math.cos(angle) * y - math.sin(angle) * x, math.cos(angle) * x + math.sin(angle) * y

    low = 0.0
    while low < 2.0 * math.pi:
        high = low + SCAN
        if low > 0.0 and missed(low)[0] < 0.0:
            return ()
        if missed(high)[0] <= 0.0 < missed(high)[1]:
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if missed(middle)[0] > 0.0 else (low, middle)
            return turn_pieces(side * high, curvature, sharpness)
        low = high
    return ()


def _corners(
    limits: TurningLimits, vertices: Sequence[_Vertex], ways: Sequence[float], headings: Sequence[float]
) -> list[Corner | None]:
    """The corner at each vertex but the last; None where the rover stops and turns."""
    inner = vertices[:-1]
    turns = [wrap_angle(headings[place + 1] - headings[place]) for place in range(len(inner))]
    rooms = [min(ways[place], ways[place + 1]) for place in range(len(inner))]
    gentle = [
        gentlest_corner(turn, room, vertex.cut, limits) if abs(turn) > STRAIGHT_ON else Corner((), 0.0, 0.0, 0.0)
        for turn, room, vertex in zip(turns, rooms, inner, strict=True)
    ]
    least = [
        round_corner(turn, limits.curvature, limits.sharpness).tangent if corner and corner.pieces else 0.0
        for turn, corner in zip(turns, gentle, strict=True)
    ]
    for place in range(len(inner) - 1):  # what even the sharpest turns cannot share
        if least[place] + least[place + 1] > ways[place + 1]:
            sharper = place if least[place] > least[place + 1] else place + 1
            rooms[sharper] = max(ways[place + 1] - least[place] - least[place + 1] + least[sharper], 0.0)
            gentle[sharper], least[sharper] = None, 0.0
    found: list[Corner | None] = []
    for place, corner in enumerate(gentle):
        if corner is None:
            if not limits.on_the_spot:
                raise _Refused(_too_sharp(limits, vertices[place], turns[place], rooms[place]))
            found.append(None)
            continue
        if corner.pieces:
            room = min(
                _share(gentle, least, ways[place], place, place - 1),
                _share(gentle, least, ways[place + 1], place, place + 1),
            )
            if corner.tangent > room:
                corner = gentlest_corner(turns[place], room, vertices[place].cut, limits)
        found.append(corner)
    return found


def _share(gentle: Sequence[Corner | None], least: Sequence[float], way: float, own: int, other: int) -> float:
    """Part of a straight for one of the corners at its ends [m]."""
    mine = gentle[own]
    theirs = gentle[other] if 0 <= other < len(gentle) else None
    if mine is None or theirs is None or mine.tangent + theirs.tangent <= way:
        return way
    wish, other_wish = mine.tangent - least[own], theirs.tangent - least[other]
    spare = way - least[own] - least[other]
    return least[own] + spare * wish / (wish + other_wish) + 1e-12


def _too_sharp(limits: TurningLimits, vertex: _Vertex, turn: float, room: float) -> str:
    what = f"point {vertex.waypoint}" if vertex.waypoint is not None else "the point before the end"
    needed = needed_curvature(turn, room, vertex.cut)
    return (
        f"{what} ({vertex.place[0]:.2f}, {vertex.place[1]:.2f} m): a corner of {math.degrees(abs(turn)):.0f} deg "
        f"passed within {vertex.cut:.2f} m, with {room:.2f} m to turn in, needs a curvature of {needed:.2f} 1/m, "
        f"planned are at most {limits.curvature:.2f}, and this machine does not turn on the spot"
    )


def _marks(start: Pose, points: Sequence[Point], known: dict[int, float]) -> tuple[float, ...]:
    """Distance at which each waypoint is passed; those left out by their part of the way between their neighbours."""
    line, marks = [(start.x, start.y), *points], []
    begin, begin_s = 0, 0.0
    for end in sorted(known):
        steps = [math.dist(line[place], line[place + 1]) for place in range(begin, end + 1)]
        total, gone = sum(steps), 0.0
        for step in steps:
            gone += step
            marks.append(begin_s + (known[end] - begin_s) * (gone / total if total > 0.0 else 1.0))
        begin, begin_s = end + 1, known[end]
    return tuple(marks)
