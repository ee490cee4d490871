"""Geometry of stereo pairs, by independent routes: rigid motions of Pinocchio, triangulation of OpenCV, differences."""

import cv2
import numpy as np
import pinocchio as pin
from hypothesis import given
from hypothesis import strategies as st

from sojourn_flight.odometry.disparity_plane import homography, into_later, into_right, mapped, plane_of
from sojourn_flight.odometry.stereo_geometry import (
    CameraPlace,
    Motion,
    PinholePair,
    motion_jacobians,
    moved_on,
    projected,
    projection_jacobian,
    seen_after,
    triangulated,
    triangulation_jacobian,
)
from sojourn_machine.params import FloatArray

PAIR = PinholePair(300.0, (127.5, 95.5), 0.2)
STEP = 1e-6
SEEDS = st.integers(0, 10_000)


def some(seed: int, count: int = 12) -> tuple[CameraPlace, Motion, FloatArray]:
    """A camera anywhere on a machine, a motion, and points before the camera."""
    random = np.random.default_rng(seed)
    camera = CameraPlace(pin.exp3(random.standard_normal(3)), random.standard_normal(3))
    motion = Motion(pin.exp3(0.2 * random.standard_normal(3)), 0.3 * random.standard_normal(3))
    points = np.column_stack([random.uniform(-1.0, 1.0, (count, 2)), random.uniform(3.0, 9.0, count)])
    return camera, motion, points


@given(SEEDS)
def test_points_are_where_opencv_has_them(seed: int) -> None:
    _, _, points = some(seed)
    seen = projected(PAIR, points)
    f, (u, v) = PAIR.focal_length, PAIR.middle
    left = np.array([[f, 0.0, u, 0.0], [0.0, f, v, 0.0], [0.0, 0.0, 1.0, 0.0]])
    right = left + np.array([0.0, 0.0, 0.0, 1.0]) * np.array([[-f * PAIR.baseline], [0.0], [0.0]])
    there = cv2.triangulatePoints(left, right, seen[:, :2].T, seen[:, [2, 1]].T)
    np.testing.assert_allclose((there[:3] / there[3]).T, points, atol=1e-6)
    np.testing.assert_allclose(triangulated(PAIR, seen), points, atol=1e-9)


@given(SEEDS)
def test_points_after_a_motion_are_where_rigid_motions_have_them(seed: int) -> None:
    camera, motion, points = some(seed)
    on_machine, moved = pin.SE3(camera.turn, camera.place), pin.SE3(motion.turn, motion.shift)
    back = on_machine.inverse() * moved.inverse() * on_machine
    expected = np.array([back.act(point) for point in points])
    np.testing.assert_allclose(seen_after(camera, motion, points), expected, atol=1e-12)


@given(SEEDS)
def test_derivatives_are_those_of_differences(seed: int) -> None:
    camera, motion, points = some(seed, 3)
    seen = projected(PAIR, points)
    by_motion, by_point = motion_jacobians(camera, motion, points)
    for place in range(3):
        step = STEP * np.eye(3)[place]
        change = (triangulated(PAIR, seen + step) - triangulated(PAIR, seen - step)) / (2.0 * STEP)
        np.testing.assert_allclose(triangulation_jacobian(PAIR, seen)[..., place], change, rtol=1e-5, atol=1e-6)
        change = (projected(PAIR, points + step) - projected(PAIR, points - step)) / (2.0 * STEP)
        np.testing.assert_allclose(projection_jacobian(PAIR, points)[..., place], change, rtol=1e-5, atol=1e-4)
        change = (seen_after(camera, motion, points + step) - seen_after(camera, motion, points - step)) / (2.0 * STEP)
        np.testing.assert_allclose(np.broadcast_to(by_point, (3, 3, 3))[..., place], change, atol=1e-8)
    for place in range(6):
        step = STEP * np.eye(6)[place]
        after, before = (seen_after(camera, moved_on(motion, sign * step), points) for sign in (1.0, -1.0))
        np.testing.assert_allclose(by_motion[..., place], (after - before) / (2.0 * STEP), atol=1e-7)


@given(SEEDS)
def test_a_turn_is_that_of_the_exponential(seed: int) -> None:
    _, motion, _ = some(seed)
    turn = np.random.default_rng(seed).standard_normal(3)
    found = moved_on(motion, np.concatenate([np.ones(3), turn]))
    np.testing.assert_allclose(found.turn, pin.exp3(turn) @ motion.turn, atol=1e-12)
    np.testing.assert_allclose(found.shift, motion.shift + 1.0)


@given(SEEDS)
def test_level_ground_is_a_plane_of_disparities_whatever_sticks_out_of_it(seed: int) -> None:
    """Of points on a plane, a fifth of them raised, and what both cameras see of the plane after a motion."""
    random = np.random.default_rng(seed)
    normal = np.array([random.uniform(-0.2, 0.2), 0.9, 0.4])
    rays = np.column_stack([random.uniform(-0.4, 0.4, 50), random.uniform(0.0, 0.4, 50), np.ones(50)])
    points = rays * (1.5 / (rays @ normal))[:, np.newaxis]
    seen = projected(PAIR, points)
    raised = seen.copy()
    raised[::5, 2] -= 4.0
    plane = plane_of(raised)
    np.testing.assert_allclose(plane.at(seen[:, :2]), seen[:, 0] - seen[:, 2], atol=1e-6)
    np.testing.assert_allclose(mapped(into_right(plane), seen[:, :2]), seen[:, [2, 1]], atol=1e-6)
    camera = CameraPlace(np.eye(3), np.array([0.0, 0.2, 0.1]))
    motion = Motion(pin.exp3(0.02 * random.standard_normal(3)), 0.1 * random.standard_normal(3))
    onto = into_later(plane, PAIR, camera, motion, (192, 256))
    assert onto is not None
    later = projected(PAIR, seen_after(camera, motion, points))
    np.testing.assert_allclose(mapped(onto[0], seen[:, :2]), later[:, :2], atol=1e-5)
    np.testing.assert_allclose(mapped(onto[1], seen[:, :2]), later[:, [2, 1]], atol=1e-5)


@given(SEEDS)
def test_a_homography_of_four_places_is_that_of_opencv(seed: int) -> None:
    random = np.random.default_rng(seed)
    places = np.array([[0.0, 0.0], [200.0, 0.0], [200.0, 150.0], [0.0, 150.0]])
    images = places + random.uniform(-20.0, 20.0, (4, 2))
    expected = cv2.getPerspectiveTransform(places.astype(np.float32), images.astype(np.float32))
    np.testing.assert_allclose(mapped(homography(places, images), places), images, atol=1e-6)
    inside = random.uniform(20.0, 130.0, (10, 2))
    np.testing.assert_allclose(mapped(homography(places, images), inside), mapped(expected, inside), atol=1e-3)


def test_ground_behind_the_camera_is_not_in_view() -> None:
    plane = plane_of(np.array([[100.0, 90.0, 60.0], [20.0, 50.0, 0.0], [150.0, 20.0, 140.0]]))
    camera = CameraPlace(np.eye(3), np.zeros(3))
    assert into_later(plane, PAIR, camera, Motion(np.eye(3), np.array([0.0, 0.0, 50.0])), (192, 256)) is None
