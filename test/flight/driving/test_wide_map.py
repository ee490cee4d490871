"""The wide map: what it takes from the map, what it keeps when that has rolled on, and what it forgets."""

import numpy as np
import pytest
from obstacle_examples import PARAMS

from sojourn_flight.hazards.obstacle_map import CellGrid
from sojourn_flight.hazards.wide_map import (
    COST,
    NEVER,
    SEEN_AT,
    SLOPE_X,
    JudgedCells,
    WideMap,
    empty_wide_map,
    remembered,
)

MAP = PARAMS.map
CELLS = MAP.cells


def observed(
    wide: WideMap, x: float, driven: float, closed: tuple[float, float] = (9e9, 9e9), known: bool = True
) -> WideMap:
    """A map round (x, 0), closed for east of the one and west of the other, slope 0.1 along x."""
    corner = (round(x / MAP.wide_cell) * MAP.wide_cell - 0.5 * MAP.size, -0.5 * MAP.size)
    east = corner[0] + (np.arange(CELLS) + 0.5) * MAP.cell
    costs = np.ones((CELLS, CELLS)) * np.where((east > closed[0]) & (east < closed[1]), np.inf, 1.5)
    slopes = np.zeros((2, CELLS, CELLS))
    slopes[0] = 0.1
    judged = JudgedCells(CellGrid(*corner, MAP.cell), costs, slopes, np.full((CELLS, CELLS), known))
    return remembered(MAP, wide, judged, (x, 0.0, driven))


def at(wide: WideMap, x: float, y: float = 0.1) -> tuple[float, float, float]:
    row, column = int((y - wide.y0) // wide.cell), int((x - wide.x0) // wide.cell)
    cost, slope, _, seen = wide.layers[:, row, column].tolist()
    return cost, slope, seen


def test_it_takes_costs_and_slopes_from_the_map_and_leaves_the_rest_unknown() -> None:
    wide = observed(empty_wide_map(MAP, 0.0, 0.0), 0.0, 3.0, closed=(2.0, 4.0))
    assert at(wide, 0.3) == (1.5, 0.1, 3.0)
    assert at(wide, 3.0)[0] == np.inf
    assert at(wide, 7.0) == (1.0, 0.0, NEVER) and wide.known.sum() == (CELLS // MAP.wide_cells) ** 2
    assert (wide.layers[SLOPE_X][~wide.known] == 0.0).all()


def test_ground_that_the_map_does_not_know_is_not_taken_but_for_what_is_closed() -> None:
    wide = observed(empty_wide_map(MAP, 0.0, 0.0), 0.0, 3.0, closed=(2.0, 4.0), known=False)
    assert at(wide, 0.3) == (1.0, 0.0, NEVER) and at(wide, 3.0)[0] == np.inf


def test_what_the_map_has_left_behind_is_kept_until_it_is_forgotten() -> None:
    wide = observed(empty_wide_map(MAP, 0.0, 0.0), 0.0, 0.0, closed=(2.0, 4.0))
    for x in (6.0, 12.0, 18.0):
        wide = observed(wide, x, x, closed=(2.0, 4.0) if x < 9.0 else (9e9, 9e9))
    assert at(wide, 3.0)[0] == np.inf, "15 m behind"
    assert at(wide, 18.0)[0] == 1.5 and abs(wide.x0 + 0.5 * MAP.wide_size - 18.0) < 4.5, "it follows the rover"
    assert at(observed(wide, 18.0, 7.0 + MAP.wide_memory), 3.0) == (1.0, 0.0, NEVER)


def test_an_obstacle_is_opened_again_in_the_middle_of_the_map_and_not_at_its_edge() -> None:
    """At the edge the map does not know what stands beyond."""
    closed = observed(empty_wide_map(MAP, 0.0, 0.0), 0.0, 0.0, closed=(-9.0, 9.0))
    opened = observed(closed, 0.0, 1.0)
    assert at(opened, 0.3)[0] == 1.5 and at(opened, 5.7)[0] == np.inf
    assert at(observed(empty_wide_map(MAP, 0.0, 0.0), 0.0, 1.0), 5.7)[0] == 1.5


def test_a_rover_that_comes_back_finds_its_map_and_one_that_jumps_far_an_empty_one() -> None:
    wide = observed(empty_wide_map(MAP, 0.0, 0.0), 0.0, 0.0, closed=(2.0, 4.0))
    there = observed(observed(wide, 7.0, 7.0, closed=(2.0, 4.0)), 0.0, 14.0, closed=(2.0, 4.0))
    assert (there.x0, there.y0) == pytest.approx((wide.x0, wide.y0))
    np.testing.assert_array_equal(there.layers[COST][wide.known], wide.layers[COST][wide.known])
    far = observed(wide, 500.0, 1.0)
    assert far.layers[SEEN_AT].max() == 1.0 and np.isfinite(far.layers[COST]).all()
