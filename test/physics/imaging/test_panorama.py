"""Where rays meet the ground: against planes, a ball, and a march in small steps."""

import math

import numpy as np
import pytest
from camera_scenes import flat, ground, rough
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ground import seen_ground, with_changes
from sojourn_physics.imaging.panorama import meetings
from sojourn_physics.imaging.walks import Eye, WalkRoom, azimuth_of, direction_of, panorama
from sojourn_physics.sensors.hazcam import cast_rays, relief_of
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, TILE

PIXEL = 2e-3
REACH = 50.0


def distances(
    field: HeightField, place: FloatArray, rays: FloatArray, fall: float = 0.0, memory: GroundMemory | None = None
) -> FloatArray:
    seen = seen_ground(field)
    if memory is not None:
        seen = with_changes(seen, memory)
    around = panorama(PIXEL, float(rays[:, 2].min()), float(rays[:, 2].max()), WalkRoom())
    found: FloatArray = meetings(seen, Eye(place, 4000.0, fall), around, rays)
    return found


def directions(count: int, seed: int, lowest: float = -1.2, highest: float = 0.2) -> FloatArray:
    """Unit vectors of random azimuth; elevations in rad."""
    random = np.random.default_rng(seed)
    azimuth, elevation = random.uniform(-np.pi, np.pi, count), random.uniform(lowest, highest, count)
    return np.stack(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], axis=1
    )


@given(st.floats(-math.pi, math.pi))
def test_azimuth_in_quarters_has_its_inverse(angle: float) -> None:
    azimuth = azimuth_of(math.cos(angle), math.sin(angle))
    assert 0.0 <= azimuth <= 4.0
    assert direction_of(azimuth) == pytest.approx((math.cos(angle), math.sin(angle)), abs=1e-12)


@settings(max_examples=25)
@given(st.floats(0.2, 3.0), st.floats(-20.0, 20.0), st.integers(0, 1000))
def test_distance_to_a_plane_is_that_of_geometry(height: float, slope_deg: float, seed: int) -> None:
    nodes = np.arange(201) - 100.0
    slope = math.tan(math.radians(slope_deg))
    field = ground(np.tile(0.1 * nodes * slope, (201, 1)), 0.1)
    rays = directions(300, seed)
    found = distances(field, np.array([0.0, 0.0, height]), rays)
    down = rays[:, 0] * slope - rays[:, 2]
    expected = np.where(down > 0.0, height / np.where(down > 0.0, down, 1.0), np.inf)
    ends = rays * np.where(np.isfinite(expected), expected, 0.0)[:, np.newaxis]
    on_map = np.isfinite(expected) & (np.abs(ends[:, :2]).max(axis=1) < 9.5)
    assert on_map.sum() > 20
    found, expected, down = found[on_map], expected[on_map], down[on_map]
    # a ray runs along the ground at a flat angle: there a little height is a long way
    assert (np.abs(found - expected) * down < 2e-4 + 2e-5 * expected).all()


def test_what_was_seen_before_in_the_same_memory_changes_nothing() -> None:
    """From other places, by finer and by coarser bins, with other rays: the same to the last bit each time."""
    seen, ways = seen_ground(rough(3)), WalkRoom()
    cases = [(0.4, 2e-3, 5), (2.0, 1e-3, 6), (1.0, 4e-3, 7), (0.4, 2e-3, 5)]
    for height, pixel, seed in cases:
        rays, eye = directions(500, seed), Eye(np.array([0.3, -0.2, height]), 4000.0, 0.0)
        limits = float(rays[:, 2].min()), float(rays[:, 2].max())
        alone = meetings(seen, eye, panorama(pixel, *limits, WalkRoom()), rays)
        assert np.array_equal(meetings(seen, eye, panorama(pixel, *limits, ways), rays), alone)


@settings(max_examples=25)
@given(st.floats(0.2, 3.0), st.floats(-20.0, 20.0), st.floats(0.2, 6.0), st.integers(0, 1000))
def test_beneath_the_eye_too(height: float, slope_deg: float, off_deg: float, seed: int) -> None:
    """Near the plumb line the way over ground changes fast with the rise of a ray."""
    slope = math.tan(math.radians(slope_deg))
    field = ground(np.tile(0.1 * (np.arange(201) - 100.0) * slope, (201, 1)), 0.1)
    upright = 0.5 * math.pi
    rays = directions(300, seed, -upright, math.radians(off_deg) - upright)
    expected = height / (rays[:, 0] * slope - rays[:, 2])
    assert distances(field, np.array([0.0, 0.0, height]), rays) == pytest.approx(expected, abs=1e-3)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.3, 2.0))
def test_rays_over_rough_ground_end_where_a_march_in_small_steps_ends(
    seed: int, x: float, y: float, height: float
) -> None:
    field = rough(seed)
    place = np.array([x, y, field.height(x, y) + height])
    rays = directions(400, seed)
    found = distances(field, place, rays)
    marched = cast_rays(relief_of(field), place, rays, 0.004, REACH)
    ends = place + rays * np.where(np.isfinite(marched), marched, 0.0)[:, np.newaxis]
    on_map = np.isfinite(marched) & (np.abs(ends[:, :2]).max(axis=1) < 3.9)
    found, marched = found[on_map], marched[on_map]
    near = np.abs(found - marched) < 0.02 + 0.01 * marched
    # at the edges of towers, narrower than a pixel there, the two may fall on either side
    assert near.size > 100 and near.mean() > 0.97


@given(st.floats(0.5, 5.0), st.floats(1e4, 2e6))
@settings(max_examples=20)
def test_the_horizon_of_a_ball_is_as_far_as_geometry_has_it(height: float, radius: float) -> None:
    """A ray just under the horizon's dip sqrt(2h/R) meets the ground near sqrt(2hR), one just over it does not."""
    dip, way = math.sqrt(2.0 * height / radius), math.sqrt(2.0 * height * radius)
    below, above = ([math.cos(dip * k), 0.0, -math.sin(dip * k)] for k in (1.04, 0.96))
    found = distances(flat(4.0), np.array([0.0, 0.0, height]), np.array([below, above]), 0.5 / radius)
    if way < 3000.0:
        assert 0.7 * way < found[0] < 1.05 * way
    assert found[1] == math.inf


def test_straight_down_and_from_below() -> None:
    rays = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    assert distances(flat(4.0), np.array([0.1, 0.2, 1.5]), rays) == pytest.approx([1.5, math.inf, math.inf])


def test_a_hole_is_seen_where_the_ground_was_dug() -> None:
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[8:24, 8:24, DUG] = 0.2
    memory = GroundMemory(0.02, 0.0, 0.0, {(1, 1): tile})
    middle = (TILE + 16) * 0.02
    place = np.array([middle, middle, 1.0])
    down = np.array([[0.0, 0.0, -1.0], [0.6, 0.0, -0.8]])
    assert distances(flat(4.0), place, down)[0] == pytest.approx(1.0)
    assert distances(flat(4.0), place, down, memory=memory) == pytest.approx([1.2, 1.25], abs=1e-6)


def test_ground_that_was_left_alone_is_seen_as_it_was() -> None:
    """Whatever has been done elsewhere, of which the same walks tell."""
    field, rays = rough(11), directions(3000, 11)
    place = np.array([0.3, -0.2, field.height(0.3, -0.2) + 1.4])
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[..., DUG] = 0.1
    dug_tiles = (8, 3), (3, 9)
    before = distances(field, place, rays)
    after = distances(field, place, rays, memory=GroundMemory(0.02, -4.0, -4.0, dict.fromkeys(dug_tiles, tile)))
    x, y = (place + np.where(np.isfinite(before), before, 0.0)[:, np.newaxis] * rays)[:, :2].T
    side, near = TILE * 0.02, 0.1
    dug = np.zeros(len(rays), dtype=bool)
    for column, row in dug_tiles:
        across, up = x + 4.0 - column * side, y + 4.0 - row * side
        dug |= (-near < across) & (across < side + near) & (-near < up) & (up < side + near)
    assert dug.sum() > 20 and (after[dug] > before[dug] + 0.01).mean() > 0.5
    left = np.isfinite(before) & np.isfinite(after) & ~dug
    shifted = np.abs(after[left] - before[left]) > 1e-9
    assert shifted.mean() < 0.01  # beyond the edge of what was dug more is seen


def test_bicubic_ground_is_drawn_within_a_little_of_itself() -> None:
    nodes = np.arange(81) * 0.1
    heights = 0.2 * np.sin(nodes)[np.newaxis, :] * np.cos(0.7 * nodes)[:, np.newaxis]
    field = ground(heights, 0.1, "bicubic")
    for x, y in ((0.33, 1.21), (-2.04, 0.57)):
        found = distances(field, np.array([x, y, 2.0]), np.array([[0.0, 0.0, -1.0]]))[0]
        assert 2.0 - found == pytest.approx(field.height(x, y), abs=1e-4)
