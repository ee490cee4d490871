"""Lidars: where their beams end, what comes back of them, and what is read."""

import math
from typing import Any

import numpy as np
import pytest
from camera_scenes import MOON, NO_BODY, UNTOUCHED, flat, ground, rough
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import BOX, CYLINDER, Shapes
from sojourn_physics.imaging.body import meet_shape
from sojourn_physics.imaging.ranging import Beams, LidarParams, beams_of, measured, strayed
from sojourn_physics.imaging.scenery import GroundLook, Scenery
from sojourn_physics.sensors.hazcam import cast_rays, relief_of
from sojourn_physics.terrain.height_field import HeightField


def lidar(**told: Any) -> LidarParams:
    usual = {
        "columns": 180, "rows": 16, "horizontal_view_deg": 360.0, "vertical_view_deg": 30.0,
        "nearest": 0.3, "range": 100.0, "noise": 0.01,
    }  # fmt: skip
    return LidarParams.model_validate(usual | told)


def sound(field: HeightField, beams: Beams, place: FloatArray, **more: Any) -> tuple[FloatArray, FloatArray]:
    return Scenery(field, more.get("look", MOON)).sound(beams, UNTOUCHED, more.get("body", NO_BODY), np.eye(3), place)


def test_beams_go_all_round_in_even_steps_from_left_to_right_and_down() -> None:
    beams = beams_of(lidar(columns=8, rows=3))
    assert np.linalg.norm(beams.directions, axis=1) == pytest.approx(np.ones(24))
    across = np.degrees(np.arctan2(beams.directions[8:16, 1], beams.directions[8:16, 0]))
    assert np.abs(across) == pytest.approx([180.0, 135.0, 90.0, 45.0, 0.0, 45.0, 90.0, 135.0])
    assert across[3] > 0.0 > across[5], "from left to right"
    assert np.degrees(np.arcsin(beams.directions[[4, 12, 20], 2])) == pytest.approx([15.0, 0.0, -15.0])
    single = beams_of(lidar(columns=1, rows=1, horizontal_view_deg=0.0, vertical_view_deg=0.0))
    assert single.directions == pytest.approx(np.array([[1.0, 0.0, 0.0]]))


@settings(max_examples=20, deadline=None)
@given(st.floats(0.3, 3.0), st.floats(-20.0, 20.0))
def test_a_plane_is_where_geometry_has_it_and_returns_what_it_should(height: float, slope_deg: float) -> None:
    slope = math.tan(math.radians(slope_deg))
    field = ground(np.tile(0.1 * (np.arange(201) - 100.0) * slope, (201, 1)), 0.1)
    beams = beams_of(lidar(vertical_view_deg=90.0))
    distance, returned = sound(field, beams, np.array([0.0, 0.0, height]))
    down = beams.directions[:, 0] * slope - beams.directions[:, 2]
    expected = height / np.where(down > 0.0, down, np.nan)
    there = np.nan_to_num(np.abs(beams.directions[:, :2] * expected[:, np.newaxis]).max(axis=1), nan=99.0) < 9.5
    assert there.sum() > 100
    assert (np.abs(distance - expected)[there] * down[there] < 1e-3).all()
    assert returned[there] == pytest.approx(MOON.albedo * down[there] * math.cos(math.atan(slope)), rel=1e-4)
    assert (returned[np.isinf(distance)] == 0.0).all()


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10_000), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.3, 2.0))
def test_over_rough_ground_beams_end_where_a_march_in_small_steps_ends(
    seed: int, x: float, y: float, height: float
) -> None:
    field = rough(seed)
    place = np.array([x, y, field.height(x, y) + height])
    beams = beams_of(lidar(columns=360, rows=24, vertical_view_deg=60.0))
    distance, _ = sound(field, beams, place)
    marched = cast_rays(relief_of(field), place, beams.directions, 0.004, 50.0)
    ends = place + beams.directions * np.where(np.isfinite(marched), marched, 0.0)[:, np.newaxis]
    on_map = np.isfinite(marched) & (np.abs(ends[:, :2]).max(axis=1) < 3.9)
    distance, marched = distance[on_map], marched[on_map]
    near = np.abs(distance - marched) < 0.03 + 0.02 * marched
    # towers are narrower than the beams are apart, so some stand between two walks
    assert near.size > 300 and near.mean() > 0.95  # from high up few beams end on it


@settings(max_examples=40, deadline=None)
@given(
    st.floats(0.03, 0.47), st.floats(0.3, 8.0), st.sampled_from([(1, 0.0), (181, 120.0), (90, 60.0), (900, 120.0)]),
    st.sampled_from([1, 7]),
)  # fmt: skip
def test_a_wall_of_one_cell_is_met_on_its_face(
    height: float, before: float, columns: tuple[int, float], rows: int
) -> None:
    """A beam that ended just beside it, on level ground, would find nothing that returns it."""
    nodes = 0.05 * np.arange(-200, 201)
    field = ground(np.tile(np.where(nodes > 0.01, 0.5, 0.0), (401, 1)))
    count, view = columns
    beams = beams_of(lidar(columns=count, rows=rows, horizontal_view_deg=view, vertical_view_deg=3.0 * (rows - 1)))
    place, face = np.array([-before, 0.0, height]), np.array([-10.0, 0.0, 1.0]) / math.sqrt(101.0)
    distance, returned = sound(field, beams, place)
    facing = -beams.directions @ face
    expected = (face @ place) / np.where(facing > 0.0, facing, np.nan)
    met = place + expected[:, np.newaxis] * beams.directions
    on_face = (met[:, 2] > 0.02) & (met[:, 2] < 0.48) & (np.abs(met[:, 1]) < 9.0)
    assert on_face.any() or rows > 1
    assert distance[on_face] == pytest.approx(expected[on_face], abs=1e-3)
    assert returned[on_face] == pytest.approx(MOON.albedo * facing[on_face], rel=1e-6)


def test_a_box_in_the_way_ends_a_beam_and_returns_its_own_light() -> None:
    box = Shapes(
        np.array([[BOX, 0.2, 0.5, 0.5, 0.75, 0.6]]), np.eye(3)[np.newaxis], np.array([[3.0, 0.0, 1.0]]),
        np.array([3.0, 0.0, 1.0, 0.75]),
    )  # fmt: skip
    beams = beams_of(lidar(columns=3, rows=1, horizontal_view_deg=180.0, vertical_view_deg=0.0))
    distance, returned = sound(flat(), beams, np.array([0.0, 0.0, 1.0]), body=box)
    assert distance[1] == pytest.approx(2.8) and returned[1] == pytest.approx(0.6)
    assert np.isinf(distance[[0, 2]]).all()


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([(40, 12, 90.0), (7, 5, 360.0), (2, 1, 170.0)]))
def test_no_shape_is_missed_by_beams_that_are_looked_after_in_blocks(seed: int, shape: tuple[int, int, float]) -> None:
    """Against each beam with each shape."""
    random, count = np.random.default_rng(seed), 12
    columns, rows, view = shape
    half = random.uniform(0.02, 0.6, (count, 3))
    kinds = random.choice([BOX, CYLINDER], count)
    half[kinds == CYLINDER, 1] = half[kinds == CYLINDER, 0]
    around = np.where(kinds == BOX, np.linalg.norm(half, axis=1), np.hypot(half[:, 0], half[:, 2]))
    turns = np.linalg.qr(random.normal(size=(count, 3, 3)))[0]
    places = random.uniform(-3.0, 3.0, (count, 3))
    sizes = np.column_stack([kinds, half, around, np.full(count, 0.5)])
    body = Shapes(sizes, np.ascontiguousarray(turns), places, np.array([0.0, 0.0, 0.0, 9.0]))
    beams = beams_of(lidar(columns=columns, rows=rows, horizontal_view_deg=view, vertical_view_deg=60.0))
    place = np.array([0.0, 0.0, 1.0])
    bare, _ = sound(flat(), beams, place)
    distance, _ = sound(flat(), beams, place, body=body)
    each = [min(meet_shape(body, one, place, tuple(ray))[0] for one in range(count)) for ray in beams.directions]
    assert distance == pytest.approx(np.minimum(bare, each))


def test_what_is_out_of_reach_is_not_looked_for_and_what_is_within_is_where_it_was() -> None:
    field = rough(3)
    place = np.array([0.0, 0.0, field.height(0.0, 0.0) + 1.2])
    near, far = (beams_of(lidar(range=reach, columns=200, rows=32, vertical_view_deg=80.0)) for reach in (3.0, 5000.0))
    short, whole = (sound(field, beams, place)[0] for beams in (near, far))
    within = whole < 3.0
    assert within.sum() > 300 and short[within] == pytest.approx(whole[within], abs=2e-3)
    assert (short[~within] > 2.99).all()


def test_beams_stray_by_as_much_as_is_told() -> None:
    straight = beams_of(lidar(columns=1000, rows=30)).directions
    off = strayed(straight, 0.004, np.random.default_rng(2))
    assert np.linalg.norm(off, axis=1) == pytest.approx(np.ones(len(off)))
    angle = np.linalg.norm(np.cross(straight, off), axis=1)
    assert math.sqrt((angle**2).mean() / 2.0) == pytest.approx(0.004, rel=0.02)


def test_darker_ground_and_flatter_beams_are_lost_sooner() -> None:
    """At the limit R_0 sqrt(rho cos i / rho_0), of a field that goes on to the horizon."""
    params = lidar(range=40.0, noise=0.0, rows=64, columns=4, vertical_view_deg=60.0)
    beams, height = beams_of(params), 1.5
    for albedo in (0.1, 0.3):
        distance, returned = sound(
            flat(200.0, 0.5), beams, np.array([0.0, 0.0, height]), look=GroundLook(albedo, True, math.inf, (1.0,))
        )
        read = measured(params, distance, returned, np.random.default_rng(1))
        farthest = (40.0**2 * albedo * height / 0.8) ** (1.0 / 3.0)  # cos i = h / r
        assert np.isfinite(read[distance < 0.98 * farthest]).all()
        assert np.isinf(read[distance > 1.02 * farthest]).all()


@given(st.floats(0.0, 0.1), st.floats(0.0, 0.005), st.floats(5.0, 50.0), st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_the_error_is_that_of_the_data_sheet(noise: float, growth: float, true: float, seed: int) -> None:
    params = lidar(noise=noise, noise_per_metre=growth)
    read = measured(params, np.full(20_000, true), np.full(20_000, 0.8), np.random.default_rng(seed))
    assert read.std() == pytest.approx(math.hypot(noise, growth * true), rel=0.03, abs=1e-12)
    assert read.mean() == pytest.approx(true, abs=0.03 * math.hypot(noise, growth * true) + 1e-9)


def test_steps_losses_and_what_is_too_near() -> None:
    params = lidar(noise=0.02, resolution=0.05, dropped=0.2)
    read = measured(params, np.full(50_000, 7.0), np.full(50_000, 0.8), np.random.default_rng(4))
    assert np.isposinf(read).mean() == pytest.approx(0.2, abs=0.01)
    steps = read[np.isfinite(read)] / 0.05
    assert steps == pytest.approx(np.round(steps), abs=1e-9) and len(np.unique(np.round(steps))) > 2
    near = measured(params, np.array([0.1, 1.0, 200.0, math.inf]), np.array([0.8, 0.8, 0.8, 0.0]), _no_luck())
    assert np.isfinite(near).tolist() == [False, True, False, False]
    assert near[[0, 2, 3]].tolist() == [-math.inf, math.inf, math.inf], "too near; nothing comes back (REP 117)"


def _no_luck() -> np.random.Generator:
    """A stream whose first draws lose nothing of four beams."""
    for seed in range(100):
        random = np.random.default_rng(seed)
        random.standard_normal(4)
        if (random.random(4) >= 0.2).all():
            return np.random.default_rng(seed)
    raise AssertionError


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"nearest": 100.0}, "less than range"),
        ({"vertical_view_deg": 0.0}, "more than 0 with 16 rows"),
        ({"dropped": 1.0}, "dropped"),
        ({"columns": 0}, "columns"),
    ],
)
def test_what_cannot_be_is_refused(told: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        lidar(**told)
