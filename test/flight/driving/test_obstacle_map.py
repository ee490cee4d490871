"""The map of the ground: what it keeps, what it forgets, how it rolls along."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_examples import CAMERA, PARAMS, RIDE, STEREO, dense, driven_over, mapped

from sojourn_flight.hazards.obstacle_map import (
    COUNT,
    HIGH,
    LOW,
    MEAN,
    SIGHT,
    empty_map,
    recentred,
    with_cloud,
)

CELL = PARAMS.map.cell


def cell_at(map_, x: float, y: float) -> tuple[int, int]:  # type: ignore[no-untyped-def]
    return int((y - map_.y0) // CELL), int((x - map_.x0) // CELL)


def test_a_cell_keeps_lowest_highest_mean_and_number() -> None:
    points = np.array([[2.0, 0.5, -0.4], [2.01, 0.51, -0.1], [2.02, 0.5, -0.1], [2.0, -0.5, 0.3]])
    map_ = mapped(points)
    place = cell_at(map_, 2.01, 0.505)
    kept = map_.layers[[COUNT, LOW, HIGH, MEAN], place[0], place[1]]
    assert kept == pytest.approx([3.0, -0.4, -0.1, -0.2])
    assert map_.known.sum() == 2
    assert map_.layers[SIGHT][place] == pytest.approx(np.linalg.norm(points[:3] - CAMERA.position, axis=1).mean())


def test_points_off_the_map_are_left_out() -> None:
    assert not mapped(np.array([[50.0, 0.0, 0.0], [0.0, -6.1, 0.0]])).known.any()
    assert not mapped(np.zeros((0, 3))).known.any()


def test_a_nearer_look_replaces_and_a_farther_one_is_dropped() -> None:
    """The same place from 3 m, from 2.1 m, and from 3 m again; heights tell which look is kept."""
    first = mapped(np.array([[3.5, 0.01, 0.5]]))

    def observed(map_, x: float, height: float):  # type: ignore[no-untyped-def]
        position = np.array([x, 0.0, 0.0])
        points = np.array([[3.5, 0.01, height]]) - position
        return with_cloud(PARAMS, map_, points, STEREO, position, np.eye(3), 0.0)

    nearer = observed(first, 0.95, 0.1)  # within a metre of the middle, so that the map stays where it is
    place = cell_at(nearer, 3.5, 0.01)
    assert nearer.layers[[COUNT, LOW, HIGH], place[0], place[1]] == pytest.approx([1.0, 0.1, 0.1])
    again = observed(nearer, -0.3, 0.5)
    np.testing.assert_array_equal(again.layers[HIGH], nearer.layers[HIGH])
    merged = observed(nearer, 0.9, 0.2)
    assert merged.layers[[COUNT, LOW, HIGH, MEAN], place[0], place[1]] == pytest.approx([2.0, 0.1, 0.2, 0.15])
    assert first.layers[HIGH][place] == 0.5, "a map is never written to again"


def test_what_was_seen_long_ago_is_forgotten() -> None:
    map_ = mapped(np.array([[2.0, 0.0, 0.0]]), driven=1.0)
    kept = mapped(np.zeros((0, 3)), map_, driven=1.0 + PARAMS.map.memory)
    assert kept.known.sum() == 1
    assert not mapped(np.zeros((0, 3)), map_, driven=1.1 + PARAMS.map.memory).known.any()


@settings(max_examples=60, deadline=None)
@given(st.floats(-15.0, 15.0), st.floats(-15.0, 15.0))
def test_rolling_keeps_what_stays_on_the_map_in_its_place(x: float, y: float) -> None:
    generator = np.random.default_rng(3)
    points = np.concatenate([generator.uniform(-6.0, 6.0, (300, 2)), generator.normal(size=(300, 1))], axis=1)
    map_ = mapped(points)
    rolled = recentred(map_, x, y)
    side = PARAMS.map.cells * CELL
    assert abs(rolled.x0 + side / 2 - x) <= 1.0 + CELL and abs(rolled.y0 + side / 2 - y) <= 1.0 + CELL
    found = 0
    for row, column in np.argwhere(map_.known):
        east, north = map_.centre(row, column)
        i, j = cell_at(rolled, east, north)
        if 0 <= i < PARAMS.map.cells and 0 <= j < PARAMS.map.cells:
            np.testing.assert_array_equal(rolled.layers[:, i, j], map_.layers[:, row, column])
            found += 1
    assert found == rolled.known.sum()


def test_clouds_are_turned_into_odom() -> None:
    """A point ahead of a rover that stands at (1, 2), turned to the left and pitched nose down."""
    turn, pitch = np.pi / 2, 0.2
    yawed = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    pitched = np.array([[np.cos(pitch), 0, np.sin(pitch)], [0, 1, 0], [-np.sin(pitch), 0, np.cos(pitch)]])
    position = np.array([1.0, 2.0, 0.3])
    map_ = with_cloud(
        PARAMS,
        empty_map(PARAMS, 1.0, 2.0),
        np.array([[3.0, 0.0, 0.0]]),
        STEREO,
        position,
        yawed @ pitched,
        0.0,
    )
    ((row, column),) = np.argwhere(map_.known)
    assert np.abs(np.array(map_.centre(row, column)) - [1.0, 2.0 + 3.0 * np.cos(pitch)]).max() <= CELL / 2 + 1e-9
    assert map_.layers[MEAN, row, column] == pytest.approx(0.3 - 3.0 * np.sin(pitch))


def test_a_drive_past_fills_the_ground_ahead() -> None:
    """After three metres every cell of the lane is known, level within the noise, and nothing of it is hidden."""
    map_ = driven_over(lambda x, y: 0.0 * x, 3.0)
    lane = [cell_at(map_, x, y) for x in np.arange(1.5, 4.5, CELL) for y in np.arange(-0.6, 0.61, CELL)]
    rows, columns = (np.array(axis) for axis in zip(*lane, strict=True))
    assert (map_.layers[COUNT][rows, columns] > 0).mean() > 0.98
    heights = map_.layers[MEAN][rows, columns][map_.layers[COUNT][rows, columns] > 0]
    assert np.abs(heights).max() < 0.02
    assert map_.known.sum() > 1000
    assert dense(lambda x, y: 0.0 * x)[:, 2].max() == -RIDE
