"""What the rover cannot pass: steps, slopes, bumps and hidden ground against their geometry."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_examples import CAMERA, PARAMS, dense, driven_over, mapped

from sojourn_flight.hazards.hidden_ground import SECTORS, HiddenStrips, hidden_strips, is_hidden
from sojourn_flight.hazards.obstacle_map import HIGH, LOW, MEAN, NOISE, ObstacleMap
from sojourn_flight.hazards.traversability import (
    BUMP,
    DROP,
    FREE,
    HIDDEN_GROUND,
    STEP,
    Passability,
    judged,
    obstacle_at,
)

CELL, LIMITS, RIDE = PARAMS.map.cell, PARAMS.passable, PARAMS.outline.ride_height


def kinds_within(map_: ObstacleMap, ground: Passability, x: tuple[float, float], y: tuple[float, float]) -> set[int]:
    """Kinds of the cells whose middles lie in a rectangle."""
    rows, columns = np.indices(ground.kinds.shape)
    east, north = map_.x0 + (columns + 0.5) * CELL, map_.y0 + (rows + 0.5) * CELL
    inside = (east > x[0]) & (east < x[1]) & (north > y[0]) & (north < y[1])
    return set(ground.kinds[inside].tolist())


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 25.0), st.floats(-math.pi, math.pi))
def test_slopes_are_measured_in_any_direction_and_close_nothing(slope_deg: float, direction: float) -> None:
    rise = math.tan(math.radians(slope_deg))
    gradient = rise * math.cos(direction), rise * math.sin(direction)
    map_ = mapped(dense(lambda x, y: gradient[0] * x + gradient[1] * y, reach=2.0))
    ground = judged(PARAMS, map_)
    middle = PARAMS.map.cells // 2
    near = slice(middle - 6, middle + 6)
    np.testing.assert_allclose(ground.slopes[0, near, near], gradient[0], atol=0.005)
    np.testing.assert_allclose(ground.slopes[1, near, near], gradient[1], atol=0.005)
    assert ground.slopes[2, near, near].max() < 0.01
    if slope_deg < LIMITS.max_side_deg:
        assert kinds_within(map_, ground, (-1.2, 1.2), (-1.2, 1.2)) == {FREE}


def test_a_step_near_its_limit_does_not_open_and_close_with_the_noise() -> None:
    """0.13 m and then 0.115 m with a limit of 0.12 m: closed before, it stays so; not closed before, it is open."""

    def edge(height: float) -> ObstacleMap:
        return mapped(dense(lambda x, y: np.where(x > 2.03, height, 0.0)))

    high, low = edge(0.13), edge(0.115)
    closed = judged(PARAMS, high)
    for before, found in ((closed, {STEP, DROP}), (None, {FREE}), (judged(PARAMS, low), {FREE})):
        kinds = kinds_within(low, judged(PARAMS, low, before), (1.8, 2.25), (-2.0, 2.0))
        assert kinds & found, before
    assert kinds_within(low, judged(PARAMS, edge(0.1), closed), (1.8, 2.25), (-2.0, 2.0)) == {FREE}


@pytest.mark.parametrize("height", [0.08, 0.11, 0.14, 0.3, -0.11, -0.14, -0.3])
def test_steps_and_drops_against_the_limit(height: float) -> None:
    """An edge along y at x = 2.03, in the middle of a cell."""
    map_ = mapped(dense(lambda x, y: np.where(x > 2.03, height, 0.0)))
    ground = judged(PARAMS, map_)
    assert kinds_within(map_, ground, (-3.0, 1.4), (-3.0, 3.0)) == {FREE}
    at_edge = kinds_within(map_, ground, (1.8, 2.25), (-2.0, 2.0))
    if abs(height) < LIMITS.max_step:
        assert at_edge == {FREE}
        return
    assert at_edge & {STEP, DROP} and not at_edge & {HIDDEN_GROUND, BUMP}
    row, column = next((i, j) for i, j in np.argwhere(ground.kinds == STEP) if abs(map_.centre(i, j)[1]) < 1.0)
    found = obstacle_at(PARAMS, map_, ground, row, column, -RIDE)
    assert found.kind == ("step" if height > 0.0 else "drop")
    assert found.measured == pytest.approx(abs(height), abs=0.01) and found.limit == LIMITS.max_step
    assert abs(found.x - 2.03) < 2.0 * CELL
    assert str(found).startswith(f"{found.kind} of {abs(height):.2f} m at (")


def test_a_rock_is_a_step_and_no_slope_beside_it() -> None:
    """Half an ellipsoid 0.6 m wide and 0.35 m high; free again from half a metre off its edge."""

    def rock(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        inside = np.clip(1.0 - ((x - 2.0) ** 2 + y**2) / 0.3**2, 0.0, None)
        return 0.35 * np.sqrt(inside)

    map_ = mapped(dense(rock))
    ground = judged(PARAMS, map_)
    assert kinds_within(map_, ground, (1.85, 2.15), (-0.15, 0.15)) <= {STEP, DROP, BUMP}
    rows, columns = np.indices(ground.kinds.shape)
    away = np.hypot(map_.x0 + (columns + 0.5) * CELL - 2.0, map_.y0 + (rows + 0.5) * CELL)
    assert not ground.kinds[away > 0.3 + 2.0 * CELL].any()


def test_a_bump_that_would_touch_the_belly() -> None:
    """A mound without a step is passable while it is low; a cone higher than the clearance over the rover's width has
    steps in it already, so the kind shows with limits of its own."""
    steep = {"max_climb_deg": 50.0, "max_step": 0.3}
    gentle = PARAMS.model_copy(update={"passable": LIMITS.model_copy(update=steep)})
    map_ = mapped(dense(lambda x, y: np.maximum(0.5 - 0.8 * np.hypot(x - 2.0, y), 0.0)))
    low = mapped(dense(lambda x, y: np.maximum(0.2 - 0.3 * np.hypot(x - 2.0, y), 0.0)))
    assert BUMP in kinds_within(map_, judged(gentle, map_), (1.7, 2.3), (-0.3, 0.3))
    assert kinds_within(low, judged(gentle, low), (1.0, 3.0), (-1.0, 1.0)) == {FREE}


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.3), st.floats(-0.02, 0.02))
def test_bumps_and_slopes_are_those_of_the_plane_through_each_patch(seed: int, rise: float, excess: float) -> None:
    """Against the plane of least squares of NumPy and a search over the whole patch, cell by cell about a peak that is
    a little higher or lower than what the belly clears.
    """
    generator = np.random.default_rng(seed)
    flat = mapped(dense(lambda x, y: rise * x, reach=1.0))
    known, reach = np.argwhere(flat.known), PARAMS.outline.half_width
    layers = flat.layers.copy()
    layers[MEAN] += 0.01 * generator.standard_normal(layers[MEAN].shape)
    layers[HIGH] = layers[LOW] = layers[MEAN]
    layers[NOISE] = 1.0  # of the camera: no step is sure, every cell has a part in the planes
    peak = tuple(generator.choice(known))
    layers[HIGH][peak] += LIMITS.clearance + excess
    ground = judged(PARAMS, replace(flat, layers=layers))
    for row, column in known[((CELL * (known - peak)) ** 2).sum(axis=1) <= reach * reach]:
        off = CELL * (known - (row, column))
        patch = known[(off**2).sum(axis=1) <= reach * reach + 1e-9]
        places = np.column_stack([CELL * (patch - (row, column)), np.ones(len(patch))])
        means, tops = (layers[layer][tuple(patch.T)] for layer in (MEAN, HIGH))
        plane, *_ = np.linalg.lstsq(places, means)
        found = (ground.slopes[1, row, column], ground.slopes[0, row, column])
        if found == (0.0, 0.0):  # too few cells, or in a row
            continue
        np.testing.assert_allclose(found, plane[:2], atol=1e-6)
        above = float((tops - places @ plane).max())
        if abs(above - LIMITS.clearance) > 1e-6:
            assert (ground.kinds[row, column] == BUMP) == (above > LIMITS.clearance)


def test_level_ground_and_passable_slopes_hide_nothing() -> None:
    """By the camera, with its noise: level, up, down, across, and rough ground of one degree."""
    generator = np.random.default_rng(5)
    waves = [(k, *generator.uniform(0.0, 6.0, 2)) for k in (1.5, 2.5, 4.0)]

    def rough(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return sum(0.012 / k * (np.sin(k * x + a) + np.cos(k * y + b)) for k, a, b in waves)

    for slope, pitch in ((0.0, 0.0), (0.15, -math.atan(0.15)), (-0.15, math.atan(0.15))):
        map_ = driven_over(lambda x, y, slope=slope: slope * x + rough(x, y), 1.5, pitch=pitch)  # type: ignore[misc]
        ground = judged(PARAMS, map_)
        assert kinds_within(map_, ground, (0.5, 5.0), (-2.5, 2.5)) == {FREE}, slope


def test_a_drop_is_seen_as_hidden_ground_or_as_a_drop_before_the_rover_is_there() -> None:
    """A cliff of one metre at x = 3.5: closed along its whole width when the camera is 1.5 m before it."""
    map_ = driven_over(lambda x, y: np.where(x > 3.5, -1.0, 0.0), 1.6)
    ground = judged(PARAMS, map_)
    for y in np.arange(-0.6, 0.61, 0.15):
        found = kinds_within(map_, ground, (3.3, 4.2), (y - 0.08, y + 0.08))
        assert found & {HIDDEN_GROUND, DROP}, y
    assert kinds_within(map_, ground, (0.8, 3.2), (-0.7, 0.7)) == {FREE}


def test_a_crater_is_closed_and_its_surroundings_are_not() -> None:
    def crater(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.minimum(0.4 * (np.hypot(x - 4.0, y) ** 2 / 1.2**2 - 1.0), 0.0)

    map_ = driven_over(crater, 1.8)
    ground = judged(PARAMS, map_)
    assert kinds_within(map_, ground, (2.9, 3.2), (-0.3, 0.3)) & {DROP, HIDDEN_GROUND} or steepest(map_, ground) > 0.4
    assert kinds_within(map_, ground, (1.5, 2.3), (-1.5, 1.5)) == {FREE}


def steepest(map_: ObstacleMap, ground: Passability) -> float:
    """Of the slopes about (3.1, 0)."""
    row, column = int((0.0 - map_.y0) / CELL), int((3.1 - map_.x0) / CELL)
    return float(np.hypot(*ground.slopes[:2, row - 2 : row + 3, column - 2 : column + 3]).max())


def strips(points: list[tuple[float, float, float]]) -> HiddenStrips:
    return hidden_strips(np.array(points), np.zeros(3), 0.5, 90.0, 2.0, 0.12)


def test_a_gap_is_hidden_where_it_is_longer_than_the_shadow_of_a_passable_step() -> None:
    """Points straight ahead every 5 cm up to an edge at 1 m, then a gap. With H = 0.5: shadow 0.12 / 0.38 = 0.32 m,
    spacing 0.1 (1 + 0.25) / 0.5 = 0.25 m."""
    before = [(x, 0.01, -0.5) for x in np.arange(0.6, 1.0001, 0.05)]
    sector = SECTORS // 2
    for gap, hidden in ((0.5, False), (0.62, True)):
        beyond = [(x, 0.01, -0.5) for x in np.arange(1.0 + gap, 3.0, 0.05)]
        seen = strips(before + beyond)
        assert math.isfinite(seen.edges[sector]) == hidden
        if hidden:
            assert (seen.edges[sector], seen.ends[sector]) == pytest.approx((1.0, 1.6), abs=1e-3)
            found = [is_hidden(x, 0.01, seen) for x in (0.8, 1.3, 1.7)]
            assert found == [0, 1, -1]
    tall = [*before, (1.01, 0.01, -0.2)]
    seen = strips([*tall, *((x, 0.01, -0.5) for x in np.arange(1.0 + 0.62, 3.0, 0.05))])
    assert seen.edges[sector] == math.inf, "a rock of 0.3 m hides more, and is an obstacle itself"
    assert np.isnan(seen.edges[0]) and is_hidden(1.0, 0.95, seen) == -1, "nothing is said about other sectors"
    assert is_hidden(-1.0, 0.0, seen) == -1
    assert CAMERA.position[2] + RIDE == pytest.approx(0.52)
