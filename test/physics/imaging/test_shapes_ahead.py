"""Which shapes a ray meets, by bundles, against one ray after the other and every shape."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import BALL, BOX, CYLINDER, Shapes
from sojourn_physics.imaging.body import meet_shape
from sojourn_physics.imaging.shapes_ahead import shorten


def shapes_about(random: np.random.Generator, count: int) -> Shapes:
    sizes = []
    for kind in random.choice([BOX, CYLINDER, BALL], count):
        x, y, z = random.uniform(0.05, 0.5, 3)
        if kind == BALL:
            y = z = x
        elif kind == CYLINDER:
            y = x
        around = {BOX: math.hypot(x, y, z), CYLINDER: math.hypot(x, z), BALL: x}[kind]
        sizes.append([kind, x, y, z, around, 0.5])
    turns = Rotation.random(count, random_state=int(random.integers(1 << 30))).as_matrix()
    return Shapes(np.array(sizes), np.ascontiguousarray(turns), random.uniform(-1.0, 1.0, (count, 3)), np.zeros(4))


def one_by_one(shapes: Shapes, place: FloatArray, rays: FloatArray, reach: float) -> FloatArray:
    met = [
        [meet_shape(shapes, shape, place, (x, y, z))[0] for shape in range(len(shapes.sizes))]
        for x, y, z in rays.tolist()
    ]
    return np.minimum(np.min(met, axis=1), reach)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000))
def test_no_bundle_misses_a_shape_that_a_ray_of_it_meets(seed: int) -> None:
    """From among the shapes, where many are nearer than their balls are wide, in narrow bundles and wide ones."""
    random = np.random.default_rng(seed)
    shapes, place = shapes_about(random, 12), random.uniform(-1.0, 1.0, 3)
    towards = random.standard_normal(3)
    rays = towards / np.linalg.norm(towards) + random.choice([0.02, 0.3, 3.0]) * random.standard_normal((48, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    found = np.full(len(rays), 2.0)
    shorten(shapes, place, rays, found)
    np.testing.assert_allclose(found, one_by_one(shapes, place, rays, 2.0), rtol=1e-12)


def test_what_a_camera_is_mounted_on_is_behind_it() -> None:
    """On the face of a box, within the ball about it, looking away and back."""
    box = Shapes(np.array([[BOX, 0.1, 0.2, 0.1, 0.3, 0.5]]), np.eye(3)[np.newaxis], np.zeros((1, 3)), np.zeros(4))
    rays = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [-1.0, 0.0, 0.0], [-0.6, 0.0, 0.8]])
    found = np.full(4, 9.0)
    shorten(box, np.array([0.15, 0.0, 0.0]), rays, found)
    assert found.tolist()[:2] == [9.0, 9.0]
    np.testing.assert_allclose(found[2:], [0.05, 0.05 / 0.6])
