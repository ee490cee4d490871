"""The hazard camera: rays against planes, occlusion against geometry, noise against the law of stereo."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sojourn_config.machine_reader import joined_machine
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.shapes import BALL, Shapes
from sojourn_physics.imaging.ground import NO_CHANGES, changes_within
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import Hazcam, HazcamParams, HazcamView, hazcam_on, relief_of
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, TILE

ROOT = Path(__file__).parents[3]
EXPLORER = joined_machine("explorer")
URDF = EXPLORER.urdf.text
PARAMS: HazcamParams = EXPLORER.sensors.first(HazcamParams)
HEIGHT = 0.47
"""Of base_link above level ground [m]."""
LEVEL = np.eye(3)


def camera_with(**changes: Any) -> Hazcam:
    return hazcam_on(PARAMS.model_copy(update={"disparity_noise_px": 0.0, **changes}), URDF)


def ground(heights: Any = None, resolution: float = 0.05, interpolation: Any = "bilinear") -> HeightField:
    """Ground of 16 m square round the origin; `heights`: function of x, y."""
    nodes = np.arange(-8.0, 8.0 + resolution / 2, resolution)
    x, y = np.meshgrid(nodes, nodes)
    values = np.zeros_like(x) if heights is None else heights(x, y)
    return HeightField(values, np.zeros(x.shape, dtype=np.uint8), resolution, -8.0, -8.0, ("sand",), interpolation)


def cloud_of(camera: Hazcam, field: HeightField, height: float = HEIGHT, seed: int = 1) -> NDArray[np.float64]:
    """Points in a level frame on the ground below base_link."""
    _, points = hazcam.step(
        camera, hazcam.initial_state(camera, seed), HazcamView(field), np.array([0.0, 0.0, height]), LEVEL
    )
    assert points.dtype == np.float32
    return points.astype(np.float64) + np.array([0.0, 0.0, height])


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-math.pi, math.pi), st.floats(-0.2, 0.2))
def test_rays_meet_a_plane_where_geometry_says(slope_x: float, slope_y: float, yaw: float, pitch: float) -> None:
    field = ground(lambda x, y: slope_x * x + slope_y * y, resolution=0.1)
    c, s, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    camera = camera_with()
    origin = np.array([0.3, -0.2, 0.6]) + rotation @ camera.position
    rays = camera.directions @ rotation.T
    normal = np.array([-slope_x, -slope_y, 1.0])
    with np.errstate(divide="ignore"):
        exact = -(normal @ origin) / (rays @ normal)
    expected = np.where((exact > 0.0) & (exact <= PARAMS.range), exact, np.inf)
    found = hazcam.cast_rays(relief_of(field), origin, rays, 0.05, PARAMS.range)
    at_the_limit = abs(exact - PARAMS.range) < 1e-3
    np.testing.assert_allclose(found[~at_the_limit], expected[~at_the_limit], atol=2e-3)


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
@pytest.mark.parametrize("resolution", [0.05, 0.2])
def test_points_lie_on_the_ground_within_range_and_view(resolution: float, interpolation: str) -> None:
    field = ground(lambda x, y: 0.1 * np.sin(2.0 * x) + 0.05 * np.cos(3.0 * y), resolution, interpolation)
    camera = camera_with()
    points = cloud_of(camera, field)
    assert len(points) > 700
    for x, y, z in points:
        assert z == pytest.approx(field.height(x, y), abs=2e-3)
    seen = points - [0.0, 0.0, HEIGHT] - camera.position
    distances = np.linalg.norm(seen, axis=1)
    assert distances.min() >= PARAMS.nearest - 2e-3 and distances.max() <= PARAMS.range + 2e-3
    assert (np.arccos(seen @ camera.directions.T / distances[:, None]).min(axis=1) < 0.01).all(), "each on a ray"


def test_a_wall_hides_what_is_behind_it() -> None:
    """A wall 0.3 m high at 1.5 m: of the level ground behind it nothing nearer than similar triangles allow."""
    field = ground(lambda x, y: np.where((x > 1.5) & (x < 1.7), 0.3, 0.0))
    camera = camera_with()
    points = cloud_of(camera, field)
    middle = points[abs(points[:, 1]) < 0.3 * points[:, 0]]
    camera_height = HEIGHT + camera.position[2]
    distance = 1.7 - camera.position[0]
    shadow_ends = camera.position[0] + distance * camera_height / (camera_height - 0.3)
    behind = middle[(middle[:, 0] > 1.8) & (middle[:, 2] < 0.05)]
    assert (behind[:, 0] > shadow_ends - 0.05).all()
    assert len(behind) < len(middle) and len(middle[abs(middle[:, 0] - 1.5) < 0.06]) > 20, "its face is seen"


def test_a_drop_hides_its_foot() -> None:
    field = ground(lambda x, y: np.where(x > 1.5, -1.0, 0.0))
    camera = camera_with()
    points = cloud_of(camera, field)
    camera_height, edge = HEIGHT + camera.position[2], 1.5 - camera.position[0]
    low = points[points[:, 2] < -0.9]
    assert (low[:, 0] > camera.position[0] + edge * (camera_height + 1.0) / camera_height - 0.1).all()
    assert (points[:, 2] > -1.01).all()


def test_nothing_is_seen_from_below_the_ground_and_in_the_sky() -> None:
    assert len(cloud_of(camera_with(), ground(lambda x, y: np.full_like(x, 2.0)))) == 0
    assert len(cloud_of(camera_with(), ground(), height=50.0)) == 0


def test_the_ground_goes_on_beyond_the_edge_of_the_map() -> None:
    camera = camera_with()
    state = hazcam.initial_state(camera, 1)
    _, inside = hazcam.step(camera, state, HazcamView(ground()), np.array([0.0, 0.0, HEIGHT]), LEVEL)
    _, beyond = hazcam.step(camera, state, HazcamView(ground()), np.array([7.9, 0.0, HEIGHT]), LEVEL)
    np.testing.assert_allclose(beyond, inside, atol=2e-3)


def dug(x: float, y: float, depth: float) -> GroundMemory:
    """A hole of two by two tiles, 1 cm a node."""
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[:, :, DUG], side = depth, TILE * 0.01
    first = int((x + 8.0) / side), int((y + 8.0) / side)
    return GroundMemory(0.01, -8.0, -8.0, {(first[0] + i, first[1] + j): tile for i in range(2) for j in range(2)})


def test_a_hole_and_a_heap_are_seen_where_they_are() -> None:
    camera = camera_with()
    place = np.array([0.0, 0.0, HEIGHT])
    for depth in (0.1, -0.1):
        changes = changes_within(dug(1.5, 0.2, depth), 0.4, 0.0, PARAMS.range)
        seen = HazcamView(ground(), changes)
        _, points = hazcam.step(camera, hazcam.initial_state(camera, 1), seen, place, LEVEL)
        points = points + place
        off = np.maximum(np.abs(points[:, 0] - 1.6), np.abs(points[:, 1] - 0.32))  # from its middle: 1.28 + 0.32, 0.32
        inside, outside = off < 0.3, off > 0.34
        assert inside.sum() > 20 and np.abs(points[inside][:, 2] + depth).max() < 2e-3
        assert outside.sum() > 500 and np.abs(points[outside][:, 2]).max() < 2e-3


def test_what_was_changed_elsewhere_changes_nothing() -> None:
    """Of this camera's values, to the last bit, and of their cost: nothing is looked up."""
    assert changes_within(dug(-6.0, -6.0, 0.1), 0.4, 0.0, PARAMS.range) is NO_CHANGES
    camera, place = camera_with(disparity_noise_px=0.25), np.array([0.0, 0.0, HEIGHT])
    rough = ground(lambda x, y: 0.05 * np.sin(3.0 * x) + 0.03 * np.cos(5.0 * y))
    state = hazcam.initial_state(camera, 1)
    _, before = hazcam.step(camera, state, HazcamView(rough), place, LEVEL)
    beside = changes_within(dug(-1.5, 0.0, 0.1), 0.4, 0.0, PARAMS.range)
    assert beside is not NO_CHANGES
    _, after = hazcam.step(camera, state, HazcamView(rough, beside), place, LEVEL)
    np.testing.assert_array_equal(before, after)


def test_the_machine_s_body_ends_a_ray_before_the_ground() -> None:
    """A ball before the camera: points on it, and none behind it."""
    camera, place = camera_with(), np.array([0.0, 0.0, HEIGHT])
    middle, radius = camera.position + np.array([0.6, 0.0, -0.3]), 0.1
    around = np.array([[BALL, radius, radius, radius, radius, 0.5]])
    ball = Shapes(around, np.eye(3)[np.newaxis], middle[np.newaxis], np.array([*middle, radius]))
    _, points = hazcam.step(camera, hazcam.initial_state(camera, 1), HazcamView(ground(), body=ball), place, LEVEL)
    from_ball = np.linalg.norm(points - middle, axis=1)
    on_it = from_ball < radius + 2e-3
    assert on_it.sum() > 15 and np.abs(from_ball[on_it] - radius).max() < 2e-3
    rays = points[~on_it] - camera.position
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    miss = np.linalg.norm(np.cross(rays, middle - camera.position), axis=1)
    assert miss.min() > radius - 2e-3


def test_error_grows_with_the_square_of_depth() -> None:
    """Standard deviation of the measured range at four depths against z^2 / (f b) sigma_d, 200 looks at a plane."""
    camera = camera_with(disparity_noise_px=0.25, horizontal_view_deg=2.0, vertical_view_deg=2.0, rows=5, columns=5)
    axis = camera.directions[12]
    state = hazcam.initial_state(camera, 3)
    for depth in (1.0, 2.0, 3.0, 4.0):
        height = -axis[2] * depth - camera.position[2]
        ranges = []
        for _ in range(200):
            state, points = hazcam.step(camera, state, HazcamView(ground()), np.array([0.0, 0.0, height]), LEVEL)
            assert len(points) == 25
            ranges.append((points - camera.position) @ axis)
        spread = np.std(ranges, axis=0).mean()
        # 25 rays x 200 looks: the estimate itself is good to one in a hundred
        assert spread == pytest.approx(depth**2 / (476.0 * 0.1) * 0.25, rel=0.04)
        assert np.mean(ranges) == pytest.approx(depth, rel=0.005)


def test_noise_belongs_to_the_state() -> None:
    camera = camera_with(disparity_noise_px=0.25)
    state = hazcam.initial_state(camera, 5)
    pose = (HazcamView(ground()), np.array([0.0, 0.0, HEIGHT]), LEVEL)
    after, first = hazcam.step(camera, state, *pose)
    _, again = hazcam.step(camera, state, *pose)
    _, second = hazcam.step(camera, after, *pose)
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, second)
    assert not np.array_equal(first, hazcam.step(camera, hazcam.initial_state(camera, 6), *pose)[1])


def test_it_sees_the_ground_before_its_wheels_and_packs_well() -> None:
    """What the drive relies on: the strip before the front wheels, and a cloud of a size that a bag can take."""
    points = cloud_of(camera_with(disparity_noise_px=0.25), ground())
    assert 700 <= len(points) <= 1300
    for y in np.arange(-0.6, 0.61, 0.2):
        strip = points[abs(points[:, 1] - y) < 0.15]
        assert strip[:, 0].min() < 1.1
    assert np.all(np.mod(points - [0.0, 0.0, HEIGHT], hazcam.RESOLUTION) == 0.0)


def test_what_is_no_pose_or_no_camera_is_refused() -> None:
    camera = camera_with()
    with pytest.raises(InvalidValueError, match="pose of base_link"):
        hazcam.step(
            camera, hazcam.initial_state(camera, 1), HazcamView(ground()), np.array([math.nan, 0.0, 0.0]), LEVEL
        )
    with pytest.raises(InvalidValueError, match="hazcam_rear_link"):
        camera_with(link="hazcam_rear_link")
    with pytest.raises(ValueError, match="nearest"):
        HazcamParams(**{**PARAMS.model_dump(), "nearest": 5.0})
