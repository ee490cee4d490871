"""Routes over the map of a site: against Bellman and Ford, round what is closed, refused in words."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import lil_matrix
from scipy.sparse.csgraph import bellman_ford

from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_flight.hazards.zone_params import KeepOutZone
from sojourn_flight.planning.detour_search import slope_costs
from sojourn_flight.planning.global_route import NoRouteError, SiteMap
from sojourn_flight.planning.goal import Point

LIMITS = TiltLimits(0.25, 0.25, 0.2)
KEEP = 1.2


def level(rows: int = 30, columns: int = 40) -> SiteMap:
    return SiteMap(0.5, 0.5, 1.0, np.zeros((rows, columns)), LIMITS, KEEP)


def with_mound(map_: SiteMap, x: float, y: float, height: float, width: float) -> SiteMap:
    rows, columns = np.indices(map_.heights.shape)
    away = np.hypot(map_.x0 + map_.cell * columns - x, map_.y0 + map_.cell * rows - y)
    heights = map_.heights + height * np.exp(-0.5 * (away / width) ** 2)
    return SiteMap(map_.x0, map_.y0, map_.cell, heights, LIMITS, KEEP, map_.zones)


def length(points: list[Point], start: Point) -> float:
    return sum(math.dist(one, other) for one, other in itertools.pairwise([start, *points]))


def along(points: list[Point], start: Point) -> np.ndarray:
    line = np.array([start, *points])
    return np.concatenate([np.linspace(one, other, 200) for one, other in itertools.pairwise(line)])


def test_over_level_ground_it_is_straight() -> None:
    assert level().route((2.2, 3.1), (37.0, 25.4)) == [(37.0, 25.4)]


@settings(max_examples=25, deadline=None)
@given(st.floats(12.0, 28.0), st.floats(8.0, 22.0), st.floats(1.5, 3.5))
def test_it_goes_round_a_mound_and_no_farther_than_over_its_foot(x: float, y: float, height: float) -> None:
    map_, start, goal = with_mound(level(), x, y, height, 2.5), (2.5, 15.0), (37.5, 15.0)
    points = map_.route(start, goal)
    # the steepest place of the mound is one deviation from its middle: there |g| = h / (w sqrt(e))
    steep = height / 2.5 / math.sqrt(math.e) > 1.2 * LIMITS.climb
    places = along(points, start)
    if steep:  # cells are a metre: a line may cut the corner of one
        away = np.hypot(*(places - (x, y)).T)
        assert away.min() > 2.5 + KEEP - 1.5
    assert math.dist(start, goal) <= length(points, start) + 1e-9 <= math.dist(start, goal) + 25.0
    assert points[-1] == goal


def test_its_cost_is_that_of_bellman_and_ford() -> None:
    generator = np.random.default_rng(3)
    heights = np.cumsum(generator.normal(0.0, 0.04, (9, 11)), axis=1)
    map_ = SiteMap(0.5, 0.5, 1.0, heights, LIMITS, 0.5)
    nodes = [(row, column) for row in range(9) for column in range(11) if not map_.closed[row, column]]
    matrix = lil_matrix((99, 99))
    for (row, column), (over, across) in itertools.product(nodes, nodes):
        way = np.array([across - column, over - row], dtype=float)
        if max(abs(way)) != 1.0:
            continue
        slope = 0.5 * (map_.slopes[:, row, column] + map_.slopes[:, over, across])
        ahead = way / np.hypot(*way)
        extra = slope_costs(np.array(slope @ ahead), np.array(slope[1] * ahead[0] - slope[0] * ahead[1]), LIMITS)
        if math.isfinite(extra):
            matrix[row * 11 + column, over * 11 + across] = np.hypot(*way) * (1.0 + extra)
    first, last = nodes[0], nodes[-1]
    wanted = bellman_ford(matrix.tocsr(), indices=first[0] * 11 + first[1])[last[0] * 11 + last[1]]
    ends = [(0.5 + column, 0.5 + row) for row, column in (first, last)]
    assert math.isfinite(wanted)
    points = map_.route(ends[0], ends[1])
    # drawn taut it costs within 2 % of the cells, and no metre less than one
    assert length(points, ends[0]) <= 1.02 * wanted + 1e-9


def test_what_the_rover_finds_turns_it_the_other_way() -> None:
    start, goal = (2.5, 12.5), (37.5, 12.5)
    wall = np.array([(20.5, y + 0.5) for y in range(8, 29)])
    points = level().with_found(wall).route(start, goal)
    assert min(y for _, y in points[:-1]) < 8.5 - KEEP and points[-1] == goal
    away = np.hypot(*(along(points, start)[:, np.newaxis] - wall).transpose(2, 0, 1)).min()
    assert away > KEEP - 0.75
    again = level().with_found(wall[:5]).with_found(wall[5:])  # nothing found before is forgotten
    assert again.route(start, goal) == points


def test_a_rover_beside_what_it_found_gets_away_from_it() -> None:
    wall = np.array([(20.5, y + 0.5) for y in range(2, 29)])
    points = level().with_found(wall).route((19.5, 15.5), (37.5, 15.5))
    assert points[-1] == (37.5, 15.5) and len(points) > 1


def test_zones_are_kept_out_of() -> None:
    zone = KeepOutZone(name="lander", points=((15.0, 8.0), (25.0, 8.0), (25.0, 22.0), (15.0, 22.0)))
    map_ = SiteMap(0.5, 0.5, 1.0, np.zeros((30, 40)), LIMITS, KEEP, (zone,))
    points = map_.route((2.5, 14.5), (37.5, 15.5))
    assert zone.distances(along(points, (2.5, 14.5))).min() > KEEP - 0.75
    with pytest.raises(NoRouteError, match="it is closed there: keep-out zone lander"):
        map_.route((2.5, 14.5), (20.0, 15.0))


def test_where_there_is_no_way_it_is_said() -> None:
    with pytest.raises(NoRouteError, match=r"\(99.00, 3.00\) m is off the map of the site: allowed is x from 0 to 40"):
        level().route((2.5, 2.5), (99.0, 3.0))
    with pytest.raises(NoRouteError, match=r"no route to \(3.00, 3.00\) m: \(-4.00, 3.00\) m is off the map"):
        level().route((-4.0, 3.0), (3.0, 3.0))
    wall = np.array([(20.5, y + 0.5) for y in range(30)])
    with pytest.raises(NoRouteError, match="lies round it"):
        level().with_found(wall).route((2.5, 2.5), (37.0, 3.0))
    with pytest.raises(NoRouteError, match=r"within 1\.2 m the ground is steeper than 14 degrees, or the rover"):
        level().with_found(wall).route((2.5, 2.5), (20.5, 3.0))
