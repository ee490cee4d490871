"""Lenses: where directions fall, and back; the published figures of a camera."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_config.paths import config_folder
from sojourn_config.yaml_file import parse_yaml
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.imaging.lens import LensParams, pixel_directions, project

PLUMB_BOB = st.tuples(*[st.floats(-0.05, 0.05)] * 2, *[st.floats(-0.003, 0.003)] * 2, st.floats(-0.01, 0.01))
FISHEYE = st.tuples(*[st.floats(-0.02, 0.02)] * 4)


def lens(**changes: object) -> LensParams:
    return LensParams.model_validate({"columns": 64, "rows": 48, "horizontal_view_deg": 60.0} | changes)


@settings(max_examples=50)
@given(st.data(), st.sampled_from(("plumb_bob", "equidistant")))
def test_a_pixel_sees_the_direction_that_falls_on_it(data: st.DataObject, model: str) -> None:
    distortion = data.draw(PLUMB_BOB if model == "plumb_bob" else FISHEYE)
    view = data.draw(st.floats(10.0, 70.0 if model == "plumb_bob" else 100.0))  # beyond, some fold the corners
    camera = lens(model=model, distortion=distortion, horizontal_view_deg=view)
    rays = pixel_directions(camera)
    u, v = np.meshgrid(np.arange(64), np.arange(48))
    assert np.abs(project(camera, rays.reshape(-1, 3)) - np.column_stack([u.ravel(), v.ravel()])).max() < 1e-5
    assert np.abs(np.linalg.norm(rays, axis=2) - 1.0).max() < 1e-12


@given(st.floats(10.0, 160.0), st.sampled_from(("plumb_bob", "equidistant")))
def test_the_outer_edges_are_the_angle_of_view_apart(view: float, model: str) -> None:
    camera = lens(model=model, horizontal_view_deg=view)
    half = math.radians(view) / 2
    edges = project(camera, np.array([[math.sin(side * half), 0.0, math.cos(half)] for side in (-1.0, 1.0)]))
    assert edges[:, 0] == pytest.approx([-0.5, 63.5])


def test_radial_and_tangential_distortion_are_those_of_the_formula() -> None:
    """Written out by hand at one place."""
    k1, k2, p1, p2, k3 = 0.1, -0.02, 0.003, -0.004, 0.005
    camera = lens(distortion=(k1, k2, p1, p2, k3))
    x, y = 0.2, -0.3
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    expected = (
        camera.focal_length * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + 31.5,
        camera.focal_length * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + 23.5,
    )
    assert project(camera, np.array([[2 * x, 2 * y, 2.0]]))[0] == pytest.approx(expected)


@pytest.mark.published
def test_navigation_camera_of_mer_is_as_published() -> None:
    """Maki et al. 2003: 45 degrees square, 1024 pixels, 0.82 mrad a pixel."""
    path = config_folder() / "parts" / "mer_navcam.yaml"
    camera = LensParams.model_validate(parse_yaml(path.read_text(encoding="utf-8"), path.name).data["lens"])
    assert (camera.columns, camera.rows) == (1024, 1024)
    assert camera.horizontal_view_deg == pytest.approx(45.0, abs=0.5)
    rays = pixel_directions(camera)
    apart = math.acos(float(rays[511, 511] @ rays[511, 512]))
    assert apart == pytest.approx(0.82e-3, abs=0.005e-3)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"distortion": (0.1,)}, "5 for plumb_bob"),
        ({"model": "equidistant", "distortion": (0.1,) * 5}, "4 for equidistant"),
        ({"horizontal_view_deg": 175.0}, "equidistant is for wider lenses"),
        ({"columns": 1}, "greater than or equal to 2"),
    ],
)
def test_a_lens_that_cannot_be_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        lens(**changes)


@pytest.mark.parametrize(
    "changes",
    [
        {"horizontal_view_deg": 120.0, "distortion": (-0.5, 0.0, 0.0, 0.0, 0.0)},
        {"horizontal_view_deg": 120.0, "distortion": (0.0, 0.0, 0.5, 0.0, 0.0)},
        {"distortion": (1e200, 0.0, 0.0, 0.0, -1e200)},
        {"horizontal_view_deg": 160.0, "model": "equidistant", "distortion": (-1.0, 0.0, 0.0, 0.0)},
    ],
)
def test_a_distortion_that_folds_the_image_is_refused(changes: dict[str, object]) -> None:
    """When it is read, not when the first image is made."""
    with pytest.raises(ValidationError, match="gives each pixel one direction"):
        lens(**changes)
    unchecked = lens().model_copy(update=changes)
    with pytest.raises(InvalidValueError, match="gives each pixel one direction"), np.errstate(all="ignore"):
        pixel_directions(unchecked)


@given(st.integers(2, 600), st.integers(2, 600))
def test_no_pixel_of_a_fisheye_sees_beyond_straight_behind(columns: int, rows: int) -> None:
    """The largest view that is named is allowed, and just beyond it the corners would see what is before them."""
    size = {"columns": columns, "rows": rows, "model": "equidistant"}
    try:
        widest = lens(**size, horizontal_view_deg=359.9).horizontal_view_deg
    except ValidationError as error:
        widest = float(str(error).split("allowed is at most ")[1].split(" ")[0])
    allowed = lens(**size, horizontal_view_deg=widest)
    corner = math.hypot(*allowed.principal_point) / allowed.focal_length
    assert corner <= math.pi and (widest > 359.0 or corner > math.pi * (1.0 - 0.11 / widest))
