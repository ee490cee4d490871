"""Images: what is where, and two ways of finding how far it is."""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import cv2
import numpy as np
import pytest
from camera_scenes import NOON, Shooting, camera, flat, ground, looking, rough, sun
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_machine.shapes import BALL, Shapes
from sojourn_physics.imaging.camera import StereoParams, expose, exposure_for, stereo_depth
from sojourn_physics.imaging.lens import project
from sojourn_physics.imaging.photometry import Illumination
from sojourn_physics.imaging.pixel_noise import pixel_noise
from sojourn_physics.imaging.ranging import LidarParams, beams_of
from sojourn_physics.imaging.scenery import GroundLook, Moment, Seen
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, TILE

ABOVE = np.array([0.0, 0.0, 1.5])


def off_the_ground(field: HeightField, x: float, y: float, z: float) -> float:
    """Distance of a point from the ground under it, across its slope: walls of towers are next to upright."""
    step = 1e-4
    slope = [field.height(x + a, y + b) - field.height(x - a, y - b) for a, b in ((step, 0.0), (0.0, step))]
    return abs(field.height(x, y) - z) / math.hypot(1.0, *(rise / (2.0 * step) for rise in slope))


@settings(max_examples=10)
@example(864, 0.0, 10.0)  # sees towers from the side
@given(st.integers(0, 1000), st.floats(-180.0, 180.0), st.floats(10.0, 50.0))
def test_points_of_the_image_lie_on_the_ground_and_fall_back_on_their_pixels(
    seed: int, yaw: float, down: float
) -> None:
    field, eye, turn = rough(seed), camera(distortion=(-0.05, 0.01, 0.001, -0.002, 0.0)), looking(yaw, down)
    place = np.array([0.0, 0.0, field.height(0.0, 0.0) + 1.5])
    _, distance = Shooting(field, sun(40.0)).see(eye, turn, place)
    points = place + distance[..., np.newaxis] * (eye.rays @ turn.T)
    on_map = np.isfinite(distance) & (np.abs(points[..., :2]).max(axis=2) < 3.9)
    off = np.array([off_the_ground(field, *point) for point in points[on_map].tolist()])
    assert on_map.sum() > 500 and (off < 0.01 + 0.003 * distance[on_map]).mean() > 0.98
    v, u = np.nonzero(on_map)
    fallen = project(eye.lens, (points[on_map] - place) @ turn)
    assert np.abs(fallen - np.column_stack([u, v])).max() < 0.01


def test_the_sky_is_black_over_airless_ground_and_bright_under_air() -> None:
    eye, turn = camera(), looking(0.0, 0.0)
    moon, distance = Shooting(flat(), sun(40.0, 120.0)).see(eye, turn, ABOVE)
    assert (moon[:55] == 0.0).all() and np.isinf(distance[:55]).all()
    assert (moon[65:] > 1.0).all() and np.isfinite(distance[70:]).all()
    mars = Shooting(flat(), sun(40.0, 120.0), GroundLook(0.2, False, math.inf, (1.0,)), Illumination(400.0, 100.0))
    bright, _ = mars.see(eye, turn, ABOVE)
    assert (bright[:55] > 15.0).all()


def test_the_sun_is_seen_as_a_disc_where_it_stands() -> None:
    eye, turn = camera(view=20.0), looking(30.0, -20.0)
    radiance, _ = Shooting(flat(), sun(20.0, 30.0)).see(eye, turn, ABOVE)
    v, u = np.nonzero(radiance > 1e5)
    assert (u.mean(), v.mean()) == pytest.approx(eye.lens.principal_point, abs=0.6)
    assert len(u) == pytest.approx(math.pi * (0.00465 / eye.pixel) ** 2, rel=0.3)
    below, _ = Shooting(flat(), sun(-20.0, 30.0)).see(eye, looking(30.0, 20.0), ABOVE)
    assert below.max() < 1e3


def test_the_length_of_a_ball_s_shadow_is_its_height_over_the_tangent() -> None:
    """Seen from straight above: a ball of 0.2 m, 0.8 m up."""
    elevation, radius, up = 35.0, 0.2, 0.8
    around = np.array([0.0, 0.0, up, radius])
    ball = Shapes(
        np.array([[BALL, radius, radius, radius, radius, 0.5]]), np.eye(3)[np.newaxis], around[None, :3], around
    )
    eye, turn = camera(view=50.0), looking(0.0, 90.0)
    place = np.array([-0.7, 0.0, 6.0])
    radiance, distance = Shooting(flat(), sun(elevation), body=ball).see(eye, turn, place)
    points = place + distance[..., np.newaxis] * (eye.rays @ turn.T)
    on_ground = np.abs(points[..., 2]) < 1e-3
    dark = on_ground & (radiance < 0.2 * np.median(radiance[on_ground]))
    e = math.radians(elevation)
    assert points[dark][:, 0].mean() == pytest.approx(-up / math.tan(e), abs=0.02)
    assert np.ptp(points[dark][:, 0]) == pytest.approx(2.0 * radius / math.sin(e), abs=0.06)
    assert np.ptp(points[dark][:, 1]) == pytest.approx(2.0 * radius, abs=0.06)
    seen = points[..., 2] > 0.5
    assert np.abs(np.linalg.norm(points[seen] - around[:3], axis=1) - radius).max() < 1e-5


def test_shadows_point_away_from_the_sun() -> None:
    """Towers of rough ground are brighter on the side of the Sun, on average over all slopes."""
    field, eye = rough(3), camera(view=90.0)
    place, turn = np.array([0.0, 0.0, 4.0]), looking(0.0, 90.0)
    for azimuth in (0.0, 90.0, 180.0, 270.0):
        radiance, distance = Shooting(field, sun(30.0, azimuth)).see(eye, turn, place)
        points = place + distance[..., np.newaxis] * (eye.rays @ turn.T)
        on_map = np.abs(points[..., :2]).max(axis=2) < 3.5
        towards = np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))])
        slopes = np.array([field.gradient(x, y) for x, y, _ in points[on_map]]) @ towards
        bright = radiance[on_map]
        assert bright[slopes < -0.3].mean() > 2.0 * bright[slopes > 0.3].mean()


@pytest.mark.parametrize("tower", [False, True])
def test_the_floor_of_a_hole_is_lit_but_where_its_edge_throws_a_shadow(tower: bool) -> None:
    """Whether all around is lit, or a tower beside it throws a shadow over ground about it."""
    cell, deep = 0.02, 0.06
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[4:28, 4:28, DUG] = deep  # x and y from 0.72 to 1.18
    heights = np.zeros((81, 81))
    heights[64:66, 58:62] = 0.3 if tower else 0.0  # y from 1.2
    shot = Shooting(ground(heights), sun(30.0), memory=GroundMemory(cell, 0.0, 0.0, {(1, 1): tile}))
    eye, turn, place = camera(96, 96, 40.0), looking(0.0, 90.0), np.array([0.95, 0.95, 1.0])
    radiance, distance = shot.see(eye, turn, place)
    x, y, z = np.moveaxis(place + distance[..., np.newaxis] * (eye.rays @ turn.T), 2, 0)
    level, floor = (np.abs(z) < 1e-4) & (y < 0.7), (np.abs(z + deep) < 1e-4) & (y < 1.1)
    shadow = 1.18 - deep / math.tan(math.radians(30.0))
    assert radiance[floor & (x < shadow - 0.04)].mean() == pytest.approx(radiance[level].mean(), rel=0.15)
    assert radiance[floor & (x > shadow + 0.04)].mean() < 0.1 * radiance[level].mean()


@pytest.mark.parametrize(("columns", "rows"), [(37, 21), (16, 48), (2, 3)])
def test_images_of_any_size_are_filled_to_their_edges(columns: int, rows: int) -> None:
    eye, turn = camera(columns, rows, 30.0), looking(10.0, 50.0)
    radiance, distance = Shooting(flat(), sun(45.0)).see(eye, turn, ABOVE)
    assert distance == pytest.approx(-ABOVE[2] / (eye.rays @ turn[2]), rel=1e-4)
    assert radiance.min() > 0.5 * radiance.mean()


PAIR = StereoParams(baseline=0.2, nearest=0.5, range=12.0, disparity_noise_px=0.25)


def test_matching_the_pair_by_another_way_finds_the_depth_within_its_error() -> None:
    """Semi-global matching (Hirschmueller 2008) of OpenCV against the distance of the rays."""
    field, eye, turn = rough(5, height=0.15), camera(480, 360, 60.0), looking(20.0, 22.0)
    place = np.array([0.0, 0.0, field.height(0.0, 0.0) + 1.5])
    shooting = Shooting(field, sun(45.0, 120.0))
    images = []
    for right in (0.0, PAIR.baseline):
        radiance, distance = shooting.see(eye, turn, place + right * turn[:, 0])
        images.append(
            (expose(eye, radiance, exposure_for(eye, radiance), pixel_noise(1, "x", int(right * 10))), distance)
        )
    # along paths from all sides: the matcher's usual five draw the ground's depth towards that of what lies behind
    matcher = cv2.StereoSGBM_create(0, 96, 7, P1=8 * 49, P2=32 * 49, mode=cv2.STEREO_SGBM_MODE_HH)
    matcher.setUniquenessRatio(10)
    disparity = matcher.compute(images[0][0], images[1][0]).astype(np.float64) / 16.0
    true = images[0][1] * eye.rays[..., 2]
    expected = eye.lens.focal_length * PAIR.baseline / np.where(np.isfinite(true), true, np.inf)
    known = (disparity > 2.0) & (true < PAIR.range) & (true > PAIR.nearest)
    off = (disparity - expected)[known]
    assert known.mean() > 0.4
    assert abs(np.median(off)) < 0.1
    assert np.percentile(np.abs(off), 68.0) < PAIR.disparity_noise_px


def test_cameras_that_look_at_once_see_what_each_would_alone() -> None:
    """Shadows are worked out where a camera first looks: each has its own."""
    field, light = rough(7), sun(12.0, 40.0)
    eye, turn = camera(), looking(40.0, 20.0)
    places = [ABOVE, ABOVE + 0.2 * turn[:, 0], ABOVE + 0.4 * turn[:, 0]]
    scene = Shooting(field, light)
    moment = Moment(scene.sun, scene.light, scene.memory, scene.body)
    with ThreadPoolExecutor(len(places)) as threads:
        together = scene.scenery.see(
            eye, moment, turn, places, lambda looks: list(threads.map(lambda look: look(), looks))
        )
    for place, seen in zip(places, together, strict=True):
        alone = Shooting(field, light).see(eye, turn, place)
        assert np.array_equal(seen[0], alone[0]) and np.array_equal(seen[1], alone[1])


def test_what_needs_no_light_does_not_wait_for_who_looks() -> None:
    """It is asked within a look here, which would else not end."""
    field, light = rough(7), sun(12.0, 40.0)
    eye, turn = camera(), looking(40.0, 20.0)
    scene = Shooting(field, light)
    moment = Moment(scene.sun, scene.light, scene.memory, scene.body)
    all_round = {"columns": 90, "rows": 4, "horizontal_view_deg": 360.0, "vertical_view_deg": 60.0}
    beams = beams_of(LidarParams.model_validate(all_round | {"nearest": 0.1, "range": 50.0, "noise": 0.0}))

    def meanwhile(looks: Sequence[Callable[[], Seen]]) -> list[Seen]:
        distance, _ = scene.scenery.sound(beams, scene.memory, scene.body, np.eye(3), ABOVE)
        assert np.isfinite(distance).any()
        assert scene.scenery.way_ahead(ABOVE[None, :], np.array([0.0, 0.0, -1.0]), scene.memory, 9.0) > 0.0
        return [look() for look in looks]

    scene.scenery.see(eye, moment, turn, [ABOVE], meanwhile)


def test_depth_of_the_pair_has_the_error_of_its_model() -> None:
    eye, turn = camera(320, 240), looking(0.0, 25.0)
    radiance, distance = Shooting(flat(40.0), sun(40.0, 100.0)).see(eye, turn, ABOVE)
    time = exposure_for(eye, radiance)
    depth = stereo_depth(eye, PAIR, (radiance, distance), time, pixel_noise(0, "b", 0)) / 1000.0
    true = distance * eye.rays[..., 2]
    scale = eye.lens.focal_length * PAIR.baseline
    for low, high in ((1.5, 2.0), (3.0, 4.0), (5.0, 6.0)):
        chosen = (depth > 0.0) & (true > low) & (true < high)
        off = scale / depth[chosen] - scale / true[chosen]
        assert chosen.sum() > 300 and off.std() == pytest.approx(0.25, rel=0.1)
        assert (depth - true)[chosen].std() == pytest.approx(0.25 * (true[chosen] ** 2).mean() / scale, rel=0.25)
    assert (depth[(true > 13.0) | ~np.isfinite(true)] == 0.0).mean() > 0.95


def test_nothing_is_seen_or_matched_in_the_dark() -> None:
    eye, turn = camera(), looking(0.0, 25.0)
    radiance, distance = Shooting(flat(), sun(-10.0), light=Illumination(0.0, 0.0)).see(eye, turn, ABOVE)
    assert (radiance == 0.0).all()
    time = exposure_for(eye, radiance)
    assert expose(eye, radiance, time, pixel_noise(0, "a", 0)).max() < 20
    assert (stereo_depth(eye, PAIR, (radiance, distance), time, pixel_noise(0, "b", 0)) == 0).all()


def test_a_sun_below_the_horizon_lights_no_ground_on_the_map_or_off_it() -> None:
    """Whatever its light is said to be: grains lean towards a Sun that is just below."""
    image, distance = Shooting(flat(), sun(-1.0)).see(camera(view=10.0), looking(0.0, 8.0), ABOVE)
    assert distance.min() < 9.0 and distance.max() > 14.0 and (image == 0.0).all()


def test_a_turned_camera_sees_the_same_ground() -> None:
    """A roll of the camera turns the image."""
    field, eye, turn = rough(8), camera(121, 121), looking(10.0, 30.0)
    place = np.array([0.0, 0.0, field.height(0.0, 0.0) + 1.5])
    shooting = Shooting(field, sun(50.0))
    rolled = turn @ Rotation.from_euler("z", 90.0, degrees=True).as_matrix()
    _, one = shooting.see(eye, turn, place)
    _, other = shooting.see(eye, rolled, place)
    same = np.abs(np.rot90(other, -1) - one) < 0.02 + 0.01 * one
    assert same.mean() > 0.97


def test_noon_radiance_of_the_moon_is_that_of_its_albedo() -> None:
    """Of flat ground with the Sun 60 degrees up, seen from straight above, where the law has its scale."""
    eye, turn = camera(view=5.0), looking(0.0, 90.0)
    radiance, _ = Shooting(flat(), sun(60.0)).see(eye, turn, np.array([0.0, 0.0, 8.0]))
    assert radiance.mean() == pytest.approx(NOON.direct * 0.12 / math.pi, rel=0.03)
