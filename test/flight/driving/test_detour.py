"""Clearance and detours: against brute force, against arcs walked in small steps, and through gaps and walls."""

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_examples import PARAMS

from sojourn_flight.hazards.clearance import (
    ClearanceMap,
    circles_of,
    clearance_along,
    clearance_at_pose,
    clearance_in,
    clearance_of_motion,
)
from sojourn_flight.hazards.obstacle_map import COUNT, ObstacleMap, empty_map
from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_flight.hazards.wide_map import COST, SEEN_AT, WideMap, empty_wide_map
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.detour import Maps, plan_detour
from sojourn_flight.planning.detour_search import CLIMB, SIDE, Slopes, cell_costs, cheapest_ways, graph_of, taut_path
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.route import advanced, route_of

CELL, CELLS = PARAMS.map.cell, PARAMS.map.cells
COVER = circles_of(PARAMS.outline)
CIRCLES, RADIUS = COVER
STRAIGHT = RADIUS + PARAMS.margin
HERE = Pose(0.0, 0.0, 0.0)
TURNING = PARAMS.outline.turn_radius + PARAMS.margin
WIDE = empty_wide_map(PARAMS.map, 0.0, 0.0)
LEVEL = Slopes(np.zeros((2, CELLS, CELLS)), PARAMS.passable.tilts)


def with_obstacles(*places: tuple[float, float, float, float]) -> tuple[ObstacleMap, ClearanceMap]:
    """A map round the origin, all known, with rectangles x, y, x, y of obstacles."""
    map_ = empty_map(PARAMS, 0.0, 0.0)
    map_.layers[COUNT] = 1.0
    rows, columns = np.indices((CELLS, CELLS))
    east, north = map_.x0 + (columns + 0.5) * CELL, map_.y0 + (rows + 0.5) * CELL
    kinds = np.zeros((CELLS, CELLS), dtype=np.int64)
    for west, south, far_east, far_north in places:
        kinds[(east >= west) & (east <= far_east) & (north >= south) & (north <= far_north)] = 1
    return map_, clearance_in(map_, kinds)


def test_the_circles_cover_the_outline() -> None:
    outline = PARAMS.outline
    for x in np.linspace(-outline.rear, outline.front, 60):
        for y in (-outline.half_width, 0.0, outline.half_width):
            assert np.hypot(x - CIRCLES, y).min() <= RADIUS + 1e-9


@settings(max_examples=40, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))
def test_clearance_is_the_distance_to_the_nearest_obstacle(x: float, y: float, yaw: float) -> None:
    """Against the distances to all middles of cells with obstacles; the grid's distance is good to half a cell."""
    _, clearance = with_obstacles((1.0, 1.0, 1.5, 1.5), (-2.0, -1.0, -1.8, 3.0))
    rows, columns = np.nonzero(clearance.distances == 0.0)
    blocked = np.stack([clearance.x0 + (columns + 0.5) * CELL, clearance.y0 + (rows + 0.5) * CELL], axis=1)
    centres = np.array([[x + place * math.cos(yaw), y + place * math.sin(yaw)] for place in CIRCLES])
    exact = np.linalg.norm(centres[:, None] - blocked[None], axis=2).min() - 0.5 * CELL - RADIUS
    found = clearance_at_pose(clearance.grid, COVER, x, y, yaw)
    assert found == pytest.approx(max(exact, -RADIUS), abs=0.75 * CELL)
    assert clearance_along(clearance.grid, COVER, np.array([[x, y, yaw]]))[0] == found
    nearest = clearance.nearest_to(x, y)
    assert nearest is not None and clearance.distances[nearest] == 0.0


def test_clearance_is_endless_without_obstacles_and_off_the_map() -> None:
    _, clearance = with_obstacles()
    assert math.isinf(clearance.at(0.0, 0.0)) and clearance.nearest_to(0.0, 0.0) is None
    _, clearance = with_obstacles((5.0, -6.0, 5.9, 6.0))
    assert math.isinf(clearance.at(7.0, 0.0)) and not clearance.holds(7.0, 0.0)


@pytest.mark.parametrize("twist", [(0.1, 0.0, 0.0), (0.1, 0.0, 0.07), (0.0, 0.0, -0.1), (-0.05, 0.05, 0.0)])
def test_a_motion_is_looked_at_along_its_arc(twist: tuple[float, float, float]) -> None:
    """Against the same arc walked in ten thousand small steps."""
    _, clearance = with_obstacles((1.2, -0.3, 1.6, 0.4))
    ways = np.array([0.05, 0.15, 0.25])
    fastest = math.hypot(*twist[:2]) + abs(twist[2]) * PARAMS.outline.turn_radius
    x, y, yaw = 0.1, 0.05, 0.2
    clearances = []
    for before, after in itertools.pairwise([0.0, *ways]):
        steps = 2000
        dt = (after - before) / fastest / steps
        for _ in range(steps):
            x += dt * (twist[0] * math.cos(yaw) - twist[1] * math.sin(yaw))
            y += dt * (twist[0] * math.sin(yaw) + twist[1] * math.cos(yaw))
            yaw += dt * twist[2]
        clearances.append(clearance_at_pose(clearance.grid, COVER, x, y, yaw))
    now, least = clearance_of_motion(clearance.grid, COVER, (0.1, 0.05, 0.2), twist, PARAMS.outline.turn_radius, ways)
    assert now == clearance_at_pose(clearance.grid, COVER, 0.1, 0.05, 0.2)
    assert least == pytest.approx(min(clearances), abs=1e-4)


def relaxed(costs: Any, slopes: Any, start: tuple[int, int], limits: TiltLimits) -> Any:
    """Cheapest ways by relaxing every edge until nothing changes (Bellman and Ford), cell 0.1 m."""
    size = len(costs)
    ways = np.full(costs.shape, np.inf)
    ways[start] = 0.0
    while True:
        before = ways.copy()
        for i, j in itertools.product(range(size), repeat=2):
            for down, right in itertools.product((-1, 0, 1), repeat=2):
                a, b = i - down, j - right  # from there to (i, j)
                if (down or right) and 0 <= a < size and 0 <= b < size:
                    length = math.hypot(down, right)
                    g = 0.5 * (slopes[:, i, j] + slopes[:, a, b])
                    climb, lean = (g[0] * right + g[1] * down) / length, (g[1] * right - g[0] * down) / length
                    if climb > limits.climb or -climb > limits.descent or abs(lean) > limits.side:
                        continue
                    metre = 0.5 * (costs[i, j] + costs[a, b]) + SIDE * abs(lean) / limits.side
                    metre += CLIMB * max(climb, 0.0) / limits.climb
                    ways[i, j] = min(ways[i, j], ways[a, b] + metre * length * 0.1)
        if np.array_equal(before, ways):
            return ways


def test_cheapest_ways_against_bellman_and_ford() -> None:
    """With slopes of which some are too steep in some directions; the wide map is closed."""
    generator = np.random.default_rng(2)
    size, limits = 8, TiltLimits(0.2, 0.3, 0.25)
    costs = generator.uniform(1.0, 5.0, (size, size))
    costs[generator.random((size, size)) < 0.2] = np.inf
    costs[3, 3] = 1.0
    slopes = generator.uniform(-0.3, 0.3, (2, size, size))
    endless = np.full((size, size), np.inf)
    clearance = ClearanceMap(0.0, 0.0, 0.1, endless, np.zeros((2, size, size), dtype=np.int64))
    wide = WideMap(-0.8, -0.8, 0.4, np.full((4, 6, 6), np.inf))
    graph = graph_of(clearance, costs, wide, Slopes(slopes, limits))
    ways, _ = cheapest_ways(graph, 3 * size + 3)
    expected = relaxed(costs, slopes, (3, 3), limits)
    assert 20 < np.isfinite(expected).sum() < size * size
    np.testing.assert_allclose(ways[: size * size].reshape(size, size), expected)
    assert np.isinf(ways[size * size :]).all()


def test_up_a_slope_that_is_too_steep_it_goes_aslant_and_down_it_straight() -> None:
    """On a plane of 16 degrees: 14 up, 18 down and 18 across are the limits."""
    map_, clearance = with_obstacles()
    slopes = np.zeros((2, CELLS, CELLS))
    slopes[0] = math.tan(math.radians(16.0))
    limits = PARAMS.passable.tilts
    costs = cell_costs(clearance, map_.known, HERE, STRAIGHT, TURNING)
    graph = graph_of(clearance, costs, WIDE, Slopes(slopes, limits))
    start = graph.node_of(0.0, 0.0)
    assert start is not None
    ways, before = cheapest_ways(graph, start)
    for x, straight in ((4.0, False), (-4.0, True)):
        end = graph.node_of(x, 0.0)
        assert end is not None
        corners = np.array([graph.places()[start], *taut_path(graph, ways, before, end)])
        steps = np.diff(corners, axis=0)
        climbs = math.tan(math.radians(16.0)) * steps[:, 0] / np.hypot(*steps.T)
        assert (climbs <= limits.climb + 1e-9).all() and (climbs >= -limits.descent).all()
        assert (np.abs(corners[:, 1]).max() < 0.3) == straight


@settings(max_examples=20, deadline=None)
@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
def test_ways_over_both_maps_are_as_long_as_on_one(x: float, y: float) -> None:
    """On open known ground: no shorter than the straight line, and no longer than over a grid of eight neighbours, to
    within the middles of the cells."""
    _, clearance = with_obstacles()
    layers = WIDE.layers.copy()
    layers[SEEN_AT] = 0.0
    graph = graph_of(clearance, np.ones((CELLS, CELLS)), replace(WIDE, layers=layers), LEVEL)
    start, end = graph.node_of(0.0, 0.0), graph.node_of(x, y)
    assert start is not None and end is not None
    ways, before = cheapest_ways(graph, start)
    there, here = graph.places()[[end, start]]
    far, near = sorted(np.abs(there - here).tolist(), reverse=True)
    octile = far + (math.sqrt(2.0) - 1.0) * near
    length = float(np.hypot(*(there - here)))
    assert length - 1e-9 <= ways[end] <= octile + 0.6
    if length > 1.0:
        path = np.array([here, *taut_path(graph, ways, before, end)])
        assert np.hypot(*np.diff(path, axis=0).T).sum() <= 1.03 * length + 0.3


@settings(max_examples=15, deadline=None)
@given(st.floats(-4.0, 4.0), st.floats(-4.0, 4.0))
def test_a_taut_path_keeps_clear_and_costs_no_more(x: float, y: float) -> None:
    map_, clearance = with_obstacles((1.0, -1.0, 1.6, 1.0), (-2.0, 1.5, 1.0, 1.8))
    costs = cell_costs(clearance, map_.known, HERE, STRAIGHT, TURNING)
    graph = graph_of(clearance, costs, WIDE, LEVEL)
    start, end = graph.node_of(0.0, 0.0), graph.node_of(x, y)
    assert start is not None and end is not None
    ways, before = cheapest_ways(graph, start)
    if not math.isfinite(ways[end]):
        return
    points = taut_path(graph, ways, before, end)
    corners = np.array([(0.0, 0.0), *points])
    stations = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    for station in np.arange(0.0, stations[-1], 0.05):
        place = [float(np.interp(station, stations, corners[:, axis])) for axis in range(2)]
        assert clearance.at(*place) > STRAIGHT - CELL
    assert stations[-1] <= ways[end] * 1.03 + 2.0 * CELL, "no metre costs less than one"


def detour(
    map_: ObstacleMap, clearance: ClearanceMap, goal: Goal, heading: float = 0.0, wide: WideMap = WIDE
) -> list[tuple[float, float]] | None:
    here = Pose(0.0, 0.0, heading)
    return plan_detour(
        Maps(map_.known, LEVEL, wide), clearance, route_of(goal, (0.0, 0.0), 0.0), here, STRAIGHT, TURNING
    )


def remembering(x: tuple[float, float], y: tuple[float, float]) -> WideMap:
    """A wide map with a rectangle that is closed."""
    middles = WIDE.cell * (np.arange(WIDE.layers.shape[1]) + 0.5)
    east, north = WIDE.x0 + middles[np.newaxis, :], WIDE.y0 + middles[:, np.newaxis]
    layers = WIDE.layers.copy()
    closed = (east > x[0]) & (east < x[1]) & (north > y[0]) & (north < y[1])
    layers[COST][closed], layers[SEEN_AT][closed] = np.inf, 0.0
    return replace(WIDE, layers=layers)


def test_a_detour_search_goes_to_the_side_that_the_rover_faces() -> None:
    """Longer to the left by 0.6 m: taken by a rover that faces left."""
    ground = with_obstacles((2.0, -1.2, 2.3, 1.8))

    def side(**wishes: Any) -> float:
        points = detour(*ground, Goal.at(5.0, 0.0), **wishes)
        assert points is not None
        return max((y for _, y in points), key=abs)

    assert side() < 0.0 < side(heading=1.2)


def test_a_wall_across_the_map_is_gone_round_where_the_wide_map_knows_its_end() -> None:
    """Or does not know it yet. It goes on to the left for 8 m, to the right for 2 m; both are beyond the map."""
    ground = with_obstacles((2.0, -6.0, 2.3, 6.0))
    for wide, to_the_left in (
        (remembering((1.0, 3.4), (5.9, 14.0)), False),
        (remembering((1.0, 3.4), (-14.0, -5.9)), True),
    ):
        points = detour(*ground, Goal.at(5.0, 0.0), wide=wide)
        assert points is not None and points[-1] == (5.0, 0.0)
        farthest = max((y for _, y in points), key=abs)
        assert (farthest > 0.0) == to_the_left and 6.0 < abs(farthest) < 9.0
    assert detour(*ground, Goal.at(5.0, 0.0), wide=remembering((1.0, 3.4), (-25.0, 25.0))) is None


def test_a_detour_comes_back_to_the_way_that_was_asked_for() -> None:
    map_, clearance = with_obstacles((2.0, -0.6, 2.4, 0.5))
    points = detour(map_, clearance, Goal.along([(5.0, 0.0), (5.0, 3.0)]))
    assert points is not None and points[-1] == (5.0, 3.0)
    assert points[-2] == (5.0, 0.0), "a corner that is free is not cut off"
    assert max(y for _, y in points[:-2]) > 0.5 + STRAIGHT - CELL, "the shorter side is the left one"


def test_corners_before_the_obstacle_are_passed_and_one_inside_it_is_not() -> None:
    map_, clearance = with_obstacles((3.0, -0.6, 3.4, 0.5))
    points = detour(map_, clearance, Goal.along([(1.0, 0.5), (1.8, 0.0), (3.2, 0.0), (5.5, 0.0)]))
    assert points is not None and points[:2] == [(1.0, 0.5), (1.8, 0.0)] and points[-1] == (5.5, 0.0)
    assert (3.2, 0.0) not in points


def test_two_obstacles_on_the_line_are_gone_round_in_one_way() -> None:
    """To join the line between them would leave it closed by the second, and the next plan would be the same."""
    map_, clearance = with_obstacles((1.5, -0.6, 1.8, 0.5), (4.0, -0.6, 4.3, 0.5))
    points = detour(map_, clearance, Goal.at(5.8, 0.0))
    assert points is not None
    corners = np.array([(0.0, 0.0), *points])
    for one, other in itertools.pairwise(corners):
        for part in np.linspace(0.0, 1.0, 60):
            assert clearance.at(*(one + part * (other - one)).tolist()) > STRAIGHT - CELL


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.floats(-3.0, 5.0), st.floats(-3.0, 5.0)), max_size=6), st.booleans())
def test_a_rover_beside_its_way_gets_to_it_past_what_stands_between(
    blocks: list[tuple[float, float]], corner: bool
) -> None:
    """The rover has left its way at (-4, 3.5) by 3.5 m, and the way itself is open, or closed beyond a corner. Such a
    way was taken up at its end, or at the corner, straight through the block between."""
    blocks = [(x, y) for x, y in blocks if math.hypot(x, y) > 1.8 and abs(y - 3.5) > 1.2] + [(0.0, 1.8)]
    places = [(x - 0.3, y - 0.3, x + 0.3, y + 0.3) for x, y in blocks]
    map_, clearance = with_obstacles(*places, *([(3.6, 3.2, 4.0, 3.8)] if corner else []))
    goal = Goal.along([(0.5, 3.5), (5.5, 3.5)]) if corner else Goal.at(5.5, 3.5)
    route = advanced(route_of(goal, (-4.0, 3.5), 0.0), (-0.5, 3.5), 0.05)
    points = plan_detour(Maps(map_.known, LEVEL, WIDE), clearance, route, HERE, STRAIGHT, TURNING)
    if points is None:
        assert len(blocks) > 1, "past a single one there is a way"
        return
    assert points[-1] == (5.5, 3.5) and (not corner or (0.5, 3.5) in points)
    for one, other in itertools.pairwise(np.array([(0.0, 0.0), *points])):
        for part in np.linspace(0.0, 1.0, 60):
            assert clearance.at(*(one + part * (other - one)).tolist()) > STRAIGHT - CELL


def test_a_gap_is_taken_where_the_rover_fits_and_not_else() -> None:
    """A wall across both maps with a gap: 2 r + 2 cells wide it is driven through, narrower it is not."""
    walls = remembering((1.0, 3.4), (-25.0, 25.0))
    for width, fits in ((2.0 * STRAIGHT + 2.0 * CELL, True), (2.0 * STRAIGHT - CELL, False)):
        map_, clearance = with_obstacles((2.0, -6.0, 2.3, 1.0), (2.0, 1.0 + width, 2.3, 6.0))
        points = detour(map_, clearance, Goal.at(5.0, 0.0), wide=walls)
        assert (points is not None) == fits, width
        if points is not None:
            assert any(1.0 < y < 1.0 + width for _, y in points)


def test_there_is_no_way_to_a_goal_in_an_obstacle() -> None:
    assert detour(*with_obstacles((2.0, -0.5, 3.0, 0.5)), Goal.at(2.5, 0.0)) is None


def test_a_rover_that_stands_too_near_finds_a_way_out() -> None:
    """0.7 m from an obstacle: nearer than a plan would go."""
    map_, clearance = with_obstacles((0.75, -1.0, 1.2, 1.0))
    assert clearance.at(0.0, 0.0) < STRAIGHT
    points = detour(map_, clearance, Goal.at(4.0, 0.0))
    assert points is not None and points[-1] == (4.0, 0.0)


def test_progress_goes_forward_along_a_way_that_crosses_itself() -> None:
    route = route_of(Goal.along([(4.0, 0.0), (4.0, 4.0), (2.0, 4.0), (2.0, -4.0)]), (0.0, 0.0), 0.0)
    assert route.length == pytest.approx(18.0)
    early = advanced(route, (2.0, 0.1), 0.05)
    assert early.progress == pytest.approx(2.0, abs=0.06)
    late = advanced(advanced(advanced(early, (4.0, 1.0), 0.05), (3.5, 4.0), 0.05), (2.0, 3.0), 0.05)
    late = advanced(late, (2.0, 0.1), 0.05)
    assert late.progress == pytest.approx(13.9, abs=0.06)
    assert late.corners_beyond(late.progress) == [(2.0, -4.0)]
    np.testing.assert_allclose(route.points_at(np.array([5.0, 9.0])), [[4.0, 1.0], [3.0, 4.0]])
