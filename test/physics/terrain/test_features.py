"""Ramps, steps, trenches, side slopes and soil patches: by hand, turned, added up."""

import math
import os
import subprocess
import sys
from typing import Any

import pytest
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.terrain.generate import generate
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.params import TerrainParams

HEADINGS = (0.0, 90.0, -135.0, 37.0)


def ground(*features: dict[str, Any], patches: tuple[dict[str, Any], ...] = (), **values: Any) -> HeightField:
    given = {"kind": "flat", "size_x": 24.0, "size_y": 24.0, "resolution": 0.1, **values}
    params = TerrainParams.model_validate({**given, "features": features, "soil_patches": patches})
    return generate(params, "sand", "rock", 0)


def along(heading: float, s: float, t: float, x: float = 1.0, y: float = -0.5) -> tuple[float, float]:
    """Map coordinates of s along a heading and t to the left of it, from (x, y)."""
    c, n = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return x + c * s - n * t, y + n * s + c * t


@pytest.mark.parametrize("heading", HEADINGS)
def test_ramp_rises_is_level_and_falls(heading: float) -> None:
    ramp = {"kind": "ramp", "x": 1.0, "y": -0.5, "heading_deg": heading, "length": 3.0, "width": 2.0, "height": 0.6}
    field = ground({**ramp, "plateau": 1.5, "descent": 2.0})
    for s, height in ((-0.5, 0.0), (1.5, 0.3), (2.4, 0.48), (3.7, 0.6), (5.5, 0.3), (7.0, 0.0)):
        assert field.height(*along(heading, s, 0.3)) == pytest.approx(height, abs=0.02 if s in (2.4,) else 0.011)
    gradient = field.gradient(*along(heading, 1.5, 0.0))
    assert math.hypot(*gradient) == pytest.approx(0.2, rel=0.02)
    assert field.height(*along(heading, 1.5, 1.3)) == 0.0 and field.height(*along(heading, 1.5, -1.3)) == 0.0


@pytest.mark.parametrize("heading", HEADINGS)
def test_step_has_upright_walls(heading: float) -> None:
    step = {"kind": "step", "x": 1.0, "y": -0.5, "heading_deg": heading, "length": 2.0, "width": 3.0, "height": -0.25}
    field = ground(step)
    for s, t, height in ((-0.2, 0.0, 0.0), (0.2, 0.0, -0.25), (1.8, 1.3, -0.25), (2.2, 0.0, 0.0), (1.0, 1.8, 0.0)):
        assert field.height(*along(heading, s, t)) == pytest.approx(height, abs=1e-12)


@pytest.mark.parametrize("heading", HEADINGS)
def test_trench_has_its_bottom_and_the_steepness_of_its_walls(heading: float) -> None:
    trench = {"kind": "trench", "x": 1.0, "y": -0.5, "heading_deg": heading, "length": 5.0, "width": 1.0, "depth": 0.8}
    field = ground({**trench, "wall_deg": 45.0})
    for s, t, height in ((0.0, 0.3, -0.8), (2.2, -0.3, -0.8), (0.0, 0.9, -0.4), (2.9, 0.0, -0.4), (0.0, 1.5, 0.0)):
        assert field.height(*along(heading, s, t)) == pytest.approx(height, abs=0.011)
    assert math.hypot(*field.gradient(*along(heading, 0.0, 0.9))) == pytest.approx(1.0, rel=0.02)
    sheer = ground({**trench, "wall_deg": 90.0})
    assert sheer.height(*along(heading, 0.0, 0.35)) == pytest.approx(-0.8)
    assert sheer.height(*along(heading, 0.0, 0.65)) == pytest.approx(0.0)


@pytest.mark.parametrize("heading", HEADINGS)
@pytest.mark.parametrize("slope", [12.0, -12.0])
def test_side_slope_tilts_its_lane(heading: float, slope: float) -> None:
    lane = {"kind": "side_slope", "x": 1.0, "y": -0.5, "heading_deg": heading, "length": 6.0, "width": 2.0}
    field = ground({**lane, "slope_deg": slope})
    rise = math.tan(math.radians(12.0))
    high = 1.0 if slope > 0.0 else -1.0
    for across in (-0.8, 0.0, 0.7):
        assert field.height(*along(heading, 3.0, across)) == pytest.approx(rise * (across * high + 1.0), abs=0.005)
    assert field.height(*along(heading, 3.0, 2.0 * high)) == pytest.approx(rise * 1.0, abs=0.005)  # beyond the ridge
    assert field.height(*along(heading, 0.5, 0.9 * high)) == pytest.approx(0.5 * rise * 1.9, abs=0.02)
    assert field.height(*along(heading, 6.5, 0.0)) == 0.0
    assert field.height(*along(heading, 3.0, -1.2 * high)) == 0.0


def test_features_add_up_on_any_ground() -> None:
    step = {"kind": "step", "x": -2.0, "y": 0.0, "length": 4.0, "width": 4.0, "height": 0.1}
    ramp = {"kind": "ramp", "x": -2.0, "y": 0.0, "length": 2.0, "width": 4.0, "height": 0.4, "plateau": 2.0}
    field = ground(step, ramp, kind="slope", slope_deg=10.0)
    assert field.height(1.0, 0.5) == pytest.approx(math.tan(math.radians(10.0)) + 0.1 + 0.4, abs=1e-9)


def test_a_feature_that_sticks_out_of_the_map_is_cut_off() -> None:
    field = ground({"kind": "ramp", "x": 11.0, "y": 11.5, "length": 4.0, "width": 3.0, "height": 1.0})
    assert field.height(12.0, 11.5) == pytest.approx(0.25, abs=1e-9)
    assert not ground({"kind": "step", "x": 50.0, "y": 0.0, "length": 1.0, "width": 1.0, "height": 1.0}).heights.any()


def test_patches_lie_on_each_other_and_rocks_on_all() -> None:
    patches = (
        {"soil": "clay", "x": 0.0, "y": 0.0, "length": 6.0, "width": 2.0, "heading_deg": 90.0},
        {"soil": "snow", "x": 0.0, "y": 2.0, "length": 2.0, "width": 2.0, "shape": "ellipse"},
    )
    field = ground(patches=patches, rocks=({"x": 0.0, "y": 2.2, "diameter": 0.5, "height": 0.2},))
    assert field.soil_names == ("sand", "rock", "clay", "snow")
    places = {(0.0, -2.0): "clay", (0.0, -3.2): "sand", (1.2, 0.0): "sand", (0.0, 1.6): "snow", (0.9, 2.9): "clay"}
    for place, soil in places.items():
        assert field.soil_name(*place) == soil
    assert field.soil_name(0.0, 2.2) == "rock" and field.soil_name(2.5, 2.5) == "sand"


@pytest.mark.parametrize(
    ("feature", "words"),
    [
        ({"kind": "hill", "x": 0.0, "y": 0.0, "length": 1.0, "width": 1.0}, "ramp"),
        ({"kind": "ramp", "x": 0.0, "y": 0.0, "length": 0.0, "width": 1.0, "height": 1.0}, "greater than 0"),
        ({"kind": "trench", "x": 0.0, "y": 0.0, "length": 1.0, "width": 1.0, "depth": -1.0}, "greater than 0"),
        ({"kind": "step", "x": 0.0, "y": 0.0, "length": 1.0, "width": 1.0}, "height"),
    ],
)
def test_features_that_cannot_be_are_refused(feature: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        ground(feature)


def test_blends_longer_than_the_lane_are_refused() -> None:
    lane = {"kind": "side_slope", "x": 0.0, "y": 0.0, "length": 3.0, "width": 1.0, "slope_deg": 5.0, "blend": 2.0}
    with pytest.raises((ValidationError, InvalidValueError), match=r"at most half the length, 1\.5 m"):
        ground(lane)


WHOLE = """
import hashlib
from sojourn_physics.terrain.generate import generate
from sojourn_physics.terrain.params import TerrainParams

params = TerrainParams.model_validate(dict(
    kind="generated", size_x=20.0, size_y=16.0, resolution=0.05, roughness=dict(rms_slope_deg=3.0), crater_law={},
    rock_law=dict(area_fraction=0.05),
    features=[dict(kind="ramp", x=0.0, y=0.0, length=3.0, width=2.0, height=0.5, heading_deg=30.0)],
    soil_patches=[dict(soil="clay", x=2.0, y=2.0, length=3.0, width=1.0, shape="ellipse")],
))
field = generate(params, "sand", "rock", 11)
print(hashlib.sha256(field.heights.tobytes() + field.soil_index.tobytes()).hexdigest())
"""


def test_the_same_seed_is_the_same_ground_bit_for_bit_in_every_process() -> None:
    """Also where the hashes of strings, and with them the order of sets, differ."""
    digests = [
        subprocess.run(
            [sys.executable, "-c", WHOLE],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert len(digests[0].strip()) == 64 and digests[0] == digests[1]
