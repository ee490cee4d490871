"""Whole terrains: planes, steps, seeds, clear circles and what is placed by hand."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.terrain.generate import generate
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.params import TerrainParams

GENERATED: dict[str, Any] = dict(
    kind="generated",
    size_x=20.0,
    size_y=16.0,
    resolution=0.1,
    roughness={"rms_slope_deg": 2.5},
    crater_law={},
    rock_law={"area_fraction": 0.05, "diameter_min": 0.2, "diameter_max": 0.8},
)


def make(seed: int = 0, **values: Any) -> HeightField:
    return generate(TerrainParams(**values), "sand", "rock", seed)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.5, 35.0), st.floats(-180.0, 180.0), st.floats(-4.9, 4.9), st.floats(-4.9, 4.9))
def test_slope_is_an_exact_plane_through_the_origin(steep: float, towards: float, x: float, y: float) -> None:
    ground = make(kind="slope", size_x=10.0, size_y=10.0, resolution=0.1, slope_deg=steep, slope_direction_deg=towards)
    rise, direction = math.tan(math.radians(steep)), math.radians(towards)
    gradient = (rise * math.cos(direction), rise * math.sin(direction))
    assert ground.height(x, y) == pytest.approx(gradient[0] * x + gradient[1] * y, abs=1e-12)
    assert ground.gradient(x, y) == pytest.approx(gradient, abs=1e-11)
    assert math.degrees(math.acos(ground.normal(x, y)[2])) == pytest.approx(steep, abs=1e-6)


def test_flat_ground_is_level_and_all_of_one_soil() -> None:
    ground = make(kind="flat", size_x=5.0, size_y=4.0, center_x=2.0)
    assert not ground.heights.any() and not ground.soil_index.any()
    assert ground.soil_names == ("sand", "rock")
    assert ground.bounds == pytest.approx((-0.5, 4.5, -2.0, 2.0))
    assert ground.heights.shape == (81, 101)


def test_step_rises_within_one_cell() -> None:
    ground = make(kind="step", size_x=6.0, size_y=4.0, resolution=0.1, step_height=0.12, step_x=1.3)
    assert ground.height(1.2, 0.0) == 0.0 and ground.height(1.25, 0.0) == pytest.approx(0.06)
    assert ground.height(1.3 + 1e-9, 1.5) == 0.12 and ground.height(2.9, -2.0) == 0.12
    drop = make(kind="step", size_x=6.0, size_y=4.0, resolution=0.1, step_height=-0.3, step_x=0.0, step_y=0.5)
    assert drop.height(1.0, 0.4) == 0.0 and drop.height(1.0, 0.55) == -0.3 and drop.height(-1.0, 1.0) == 0.0


def test_the_same_seed_gives_the_same_ground_and_another_does_not() -> None:
    first, again, other = make(3, **GENERATED), make(3, **GENERATED), make(4, **GENERATED)
    assert np.array_equal(first.heights, again.heights)
    assert np.array_equal(first.soil_index, again.soil_index)
    assert not np.allclose(first.heights, other.heights, atol=0.01)
    assert not np.array_equal(first.soil_index, other.soil_index)


def test_each_part_has_its_own_stream() -> None:
    whole = make(3, **GENERATED)
    without_craters = make(3, **{**GENERATED, "crater_law": None})
    rougher = make(3, **{**GENERATED, "roughness": {"rms_slope_deg": 4.0}})
    assert np.array_equal(whole.soil_index, without_craters.soil_index)
    assert np.array_equal(whole.soil_index, rougher.soil_index)
    assert not np.array_equal(whole.heights, without_craters.heights)


def test_nothing_random_reaches_into_a_clear_circle() -> None:
    dense = {**GENERATED, "roughness": None, "rock_law": {**GENERATED["rock_law"], "area_fraction": 0.2}}
    circle = {"x": 1.0, "y": -2.0, "radius": 2.0}
    open_ground = make(1, **dense)
    clear = make(1, **dense, keep_clear=[circle])
    rows, columns = clear.heights.shape
    x = clear.origin_x + 0.1 * np.arange(columns)[np.newaxis, :]
    y = clear.origin_y + 0.1 * np.arange(rows)[:, np.newaxis]
    inside = np.hypot(x - 1.0, y + 2.0) <= 2.0
    assert bool(open_ground.soil_index[inside].any()) and not clear.soil_index[inside].any()
    assert open_ground.heights[inside].min() < -0.02
    # Only the thin far ejecta of craters outside may reach in: no bowl, so nothing below the ground.
    bare = make(1, **{**dense, "rock_law": None}, keep_clear=[circle])
    assert bare.heights[inside].min() > -0.02
    far = np.hypot(x - 1.0, y + 2.0) > 6.0
    assert bool(clear.soil_index[far].any())


def test_things_placed_by_hand_are_where_they_were_put() -> None:
    ground = make(
        kind="flat",
        size_x=10.0,
        size_y=10.0,
        craters=[{"x": -2.0, "y": 1.0, "diameter": 2.0, "depth": 0.3}],
        rocks=[{"x": 3.0, "y": -1.0, "diameter": 0.5, "height": 0.3}],
        keep_clear=[{"x": 0.0, "y": 0.0, "radius": 20.0}],
    )
    assert ground.height(-2.0, 1.0) == pytest.approx(-0.3) and ground.soil_name(-2.0, 1.0) == "sand"
    assert ground.height(-1.0, 1.0) == pytest.approx(0.06, abs=2e-3)
    assert ground.height(3.0, -1.0) == pytest.approx(0.3) and ground.soil_name(3.0, -1.0) == "rock"
    assert ground.height(3.3, -1.0) == pytest.approx(0.0, abs=1e-12) and ground.soil_name(3.3, -1.0) == "sand"


def test_rocks_of_the_soil_of_the_ground_share_its_index() -> None:
    params = TerrainParams(kind="flat", rocks=({"x": 0.0, "y": 0.0, "diameter": 1.0, "height": 0.3},))
    ground = generate(params, "rigid_rock", "rigid_rock", 0)
    assert ground.soil_names == ("rigid_rock",) and not ground.soil_index.any()


@pytest.mark.parametrize("seed", [-1, 1.5, True, "7"])
def test_bad_seed_is_refused(seed: Any) -> None:
    with pytest.raises(InvalidValueError, match="seed"):
        generate(TerrainParams(kind="flat"), "sand", "rock", seed)


def test_empty_soil_name_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="rock_soil"):
        generate(TerrainParams(kind="flat"), "sand", "", 0)
