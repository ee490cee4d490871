"""Room and ways round: against brute force, against arcs walked in small steps, and through gaps and walls."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_examples import PARAMS

from sojourn_mechanics.steering.detour import plan_detour
from sojourn_mechanics.steering.goal import Goal
from sojourn_mechanics.steering.obstacle_map import COUNT, ObstacleMap, empty_map
from sojourn_mechanics.steering.room import Room, circles_of, room_along, room_at_pose, room_in, room_of_motion
from sojourn_mechanics.steering.route import advanced, route_of
from sojourn_mechanics.steering.way_round import Area, cell_costs, cheapest_ways, taut_path
from sojourn_mechanics.vehicle.clothoid import Pose

CELL, CELLS = PARAMS.map.cell, PARAMS.map.cells
CIRCLES, RADIUS = circles_of(PARAMS.outline)
STRAIGHT = RADIUS + PARAMS.margin
HERE = Pose(0.0, 0.0, 0.0)
TURNING = PARAMS.outline.turn_radius + PARAMS.margin


def with_obstacles(*places: tuple[float, float, float, float]) -> tuple[ObstacleMap, Room]:
    """A map round the origin, all known, with rectangles x, y, x, y of obstacles."""
    map_ = empty_map(PARAMS, 0.0, 0.0)
    map_.layers[COUNT] = 1.0
    rows, columns = np.indices((CELLS, CELLS))
    east, north = map_.x0 + (columns + 0.5) * CELL, map_.y0 + (rows + 0.5) * CELL
    kinds = np.zeros((CELLS, CELLS), dtype=np.int64)
    for west, south, far_east, far_north in places:
        kinds[(east >= west) & (east <= far_east) & (north >= south) & (north <= far_north)] = 1
    return map_, room_in(map_, kinds)


def grid(room: Room) -> tuple[object, ...]:
    return room.distances, room.x0, room.y0, room.cell, CIRCLES, RADIUS


def test_the_circles_cover_the_outline() -> None:
    outline = PARAMS.outline
    for x in np.linspace(-outline.rear, outline.front, 60):
        for y in (-outline.half_width, 0.0, outline.half_width):
            assert np.hypot(x - CIRCLES, y).min() <= RADIUS + 1e-9


@settings(max_examples=40, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))
def test_room_is_the_distance_to_the_nearest_obstacle(x: float, y: float, yaw: float) -> None:
    """Against the distances to all middles of cells with obstacles; the grid's distance is good to half a cell."""
    _, room = with_obstacles((1.0, 1.0, 1.5, 1.5), (-2.0, -1.0, -1.8, 3.0))
    rows, columns = np.nonzero(room.distances == 0.0)
    blocked = np.stack([room.x0 + (columns + 0.5) * CELL, room.y0 + (rows + 0.5) * CELL], axis=1)
    centres = np.array([[x + place * math.cos(yaw), y + place * math.sin(yaw)] for place in CIRCLES])
    exact = np.linalg.norm(centres[:, None] - blocked[None], axis=2).min() - 0.5 * CELL - RADIUS
    found = room_at_pose(*grid(room), x, y, yaw)
    assert found == pytest.approx(max(exact, -RADIUS), abs=0.75 * CELL)
    assert room_along(*grid(room), np.array([[x, y, yaw]]))[0] == found
    nearest = room.nearest_to(x, y)
    assert nearest is not None and room.distances[nearest] == 0.0


def test_a_map_without_obstacles_and_places_off_it_have_room() -> None:
    _, room = with_obstacles()
    assert math.isinf(room.at(0.0, 0.0)) and room.nearest_to(0.0, 0.0) is None
    _, room = with_obstacles((5.0, -6.0, 5.9, 6.0))
    assert math.isinf(room.at(7.0, 0.0)) and not room.holds(7.0, 0.0)


@pytest.mark.parametrize("twist", [(0.1, 0.0, 0.0), (0.1, 0.0, 0.07), (0.0, 0.0, -0.1), (-0.05, 0.05, 0.0)])
def test_a_motion_is_looked_at_along_its_arc(twist: tuple[float, float, float]) -> None:
    """Against the same arc walked in ten thousand small steps."""
    _, room = with_obstacles((1.2, -0.3, 1.6, 0.4))
    ways = np.array([0.05, 0.15, 0.25])
    fastest = math.hypot(*twist[:2]) + abs(twist[2]) * PARAMS.outline.turn_radius
    x, y, yaw = 0.1, 0.05, 0.2
    rooms = []
    for before, after in itertools.pairwise([0.0, *ways]):
        steps = 2000
        dt = (after - before) / fastest / steps
        for _ in range(steps):
            x += dt * (twist[0] * math.cos(yaw) - twist[1] * math.sin(yaw))
            y += dt * (twist[0] * math.sin(yaw) + twist[1] * math.cos(yaw))
            yaw += dt * twist[2]
        rooms.append(room_at_pose(*grid(room), x, y, yaw))
    now, least = room_of_motion(*grid(room), (0.1, 0.05, 0.2), twist, PARAMS.outline.turn_radius, ways)
    assert now == room_at_pose(*grid(room), 0.1, 0.05, 0.2)
    assert least == pytest.approx(min(rooms), abs=1e-4)


def relaxed(costs: np.ndarray, start: tuple[int, int]) -> np.ndarray:
    """Cheapest ways by Bellman and Ford, cell by cell."""
    ways = np.full(costs.shape, np.inf)
    ways[start] = 0.0
    for _ in range(costs.size):
        before = ways.copy()
        for down, right in itertools.product((-1, 0, 1), repeat=2):
            for i in range(len(costs)):
                for j in range(len(costs)):
                    a, b = i + down, j + right
                    if (down or right) and 0 <= a < len(costs) and 0 <= b < len(costs):
                        step = 0.5 * (costs[i, j] + costs[a, b]) * math.hypot(down, right) * 0.1
                        ways[i, j] = min(ways[i, j], ways[a, b] + step)
        if np.array_equal(before, ways):
            return ways
    return ways


def test_cheapest_ways_against_bellman_and_ford() -> None:
    generator = np.random.default_rng(2)
    costs = generator.uniform(1.0, 5.0, (7, 7))
    costs[generator.random((7, 7)) < 0.25] = np.inf
    costs[3, 3] = 1.0
    ways, _ = cheapest_ways(costs, 0.1, (3, 3))
    np.testing.assert_allclose(ways, relaxed(costs, (3, 3)))


@settings(max_examples=15, deadline=None)
@given(st.floats(-4.0, 4.0), st.floats(-4.0, 4.0))
def test_a_taut_path_keeps_clear_and_costs_no_more(x: float, y: float) -> None:
    map_, room = with_obstacles((1.0, -1.0, 1.6, 1.0), (-2.0, 1.5, 1.0, 1.8))
    costs = cell_costs(room, map_.known, HERE, STRAIGHT, TURNING)
    ways, before = cheapest_ways(costs, CELL, room.cell_of(0.0, 0.0))
    end = room.cell_of(x, y)
    if not math.isfinite(ways[end]):
        return
    points = taut_path(room, costs, ways, before, end)
    corners = np.array([(0.0, 0.0), *points])
    stations = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    for station in np.arange(0.0, stations[-1], 0.05):
        place = [float(np.interp(station, stations, corners[:, axis])) for axis in range(2)]
        assert room.at(*place) > STRAIGHT - CELL
    assert stations[-1] <= ways[end] * 1.03 + 2.0 * CELL, "no metre costs less than one"


def detour(
    map_: ObstacleMap, room: Room, goal: Goal, heading: float = 0.0, area: Area | None = None
) -> list[tuple[float, float]] | None:
    here = Pose(0.0, 0.0, heading)
    return plan_detour(map_, room, route_of(goal, (0.0, 0.0), 0.0), here, STRAIGHT, TURNING, area)


def test_a_way_round_stays_in_the_area_and_on_the_side_that_the_rover_faces() -> None:
    """Longer to the left by 0.6 m: taken by a rover that faces left, and where there is no ground to the right."""
    ground = with_obstacles((2.0, -1.2, 2.3, 1.8))

    def side(**wishes: Any) -> float:
        points = detour(*ground, Goal.at(5.0, 0.0), **wishes)
        assert points is not None
        return max((y for _, y in points), key=abs)

    assert side() < 0.0 < side(heading=1.2)
    assert side(area=(-10.0, 10.0, -2.0, 10.0)) > 0.0
    assert detour(*ground, Goal.at(5.0, 0.0), area=(-10.0, 10.0, -2.0, 2.0)) is None


def test_a_detour_comes_back_to_the_way_that_was_asked_for() -> None:
    map_, room = with_obstacles((2.0, -0.6, 2.4, 0.5))
    points = detour(map_, room, Goal.along([(5.0, 0.0), (5.0, 3.0)]))
    assert points is not None and points[-1] == (5.0, 3.0)
    assert points[-2] == (5.0, 0.0), "a corner that is free is not cut off"
    assert max(y for _, y in points[:-2]) > 0.5 + STRAIGHT - CELL, "the shorter side is the left one"


def test_corners_before_the_obstacle_are_passed_and_one_inside_it_is_not() -> None:
    map_, room = with_obstacles((3.0, -0.6, 3.4, 0.5))
    points = detour(map_, room, Goal.along([(1.0, 0.5), (1.8, 0.0), (3.2, 0.0), (5.5, 0.0)]))
    assert points is not None and points[:2] == [(1.0, 0.5), (1.8, 0.0)] and points[-1] == (5.5, 0.0)
    assert (3.2, 0.0) not in points


def test_two_obstacles_on_the_line_are_gone_round_in_one_way() -> None:
    """To join the line between them would leave it closed by the second, and the next plan would be the same."""
    map_, room = with_obstacles((1.5, -0.6, 1.8, 0.5), (4.0, -0.6, 4.3, 0.5))
    points = detour(map_, room, Goal.at(5.8, 0.0))
    assert points is not None
    corners = np.array([(0.0, 0.0), *points])
    for one, other in itertools.pairwise(corners):
        for part in np.linspace(0.0, 1.0, 60):
            assert room.at(*(one + part * (other - one)).tolist()) > STRAIGHT - CELL


def test_a_gap_is_taken_where_the_rover_fits_and_not_else() -> None:
    """A wall across the whole map with a gap: 2 r + 2 cells wide it is driven through, narrower it is not."""
    for width, fits in ((2.0 * STRAIGHT + 2.0 * CELL, True), (2.0 * STRAIGHT - CELL, False)):
        map_, room = with_obstacles((2.0, -6.0, 2.3, 1.0), (2.0, 1.0 + width, 2.3, 6.0))
        points = detour(map_, room, Goal.at(5.0, 0.0))
        assert (points is not None) == fits, width
        if points is not None:
            assert any(1.0 < y < 1.0 + width for _, y in points)


def test_there_is_no_way_to_a_goal_in_an_obstacle_or_behind_a_wall() -> None:
    assert detour(*with_obstacles((2.0, -6.0, 2.3, 6.0)), Goal.at(5.0, 0.0)) is None
    assert detour(*with_obstacles((2.0, -0.5, 3.0, 0.5)), Goal.at(2.5, 0.0)) is None
    assert detour(*with_obstacles((2.0, -6.0, 5.9, 6.0)), Goal.at(50.0, 0.0)) is None, "nothing beyond it on the map"


def test_a_rover_that_stands_too_near_finds_a_way_out() -> None:
    """0.7 m from an obstacle: nearer than a plan would go."""
    map_, room = with_obstacles((0.75, -1.0, 1.2, 1.0))
    assert room.at(0.0, 0.0) < STRAIGHT
    points = detour(map_, room, Goal.at(4.0, 0.0))
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
