"""The machine's shapes: against points on them, and their shadows."""

import math

import numpy as np
import pytest
from camera_scenes import NO_BODY
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.mounting import mounting
from sojourn_machine.shapes import BALL, BOX, CYLINDER, MachineShapes, Shapes, moved
from sojourn_physics.imaging.body import hides_sun, meet_shape

HALF = st.floats(0.05, 0.5)


def body(kind: float, half: tuple[float, float, float], seed: int) -> Shapes:
    random = np.random.default_rng(seed)
    place = random.uniform(-1.0, 1.0, 3)
    turn = Rotation.random(random_state=seed).as_matrix()
    about = float(np.linalg.norm(half)) * 1.01
    return Shapes(np.array([[kind, *half, about, 0.3]]), turn[np.newaxis], place[np.newaxis], np.array([*place, about]))


def inside(kind: float, half: tuple[float, float, float], local: np.ndarray) -> np.ndarray:
    """How far a point is inside of a shape, negative outside: the shapes said in another way."""
    x, y, z = local.T
    if kind == BOX:
        return np.min([half[0] - abs(x), half[1] - abs(y), half[2] - abs(z)], axis=0)
    if kind == CYLINDER:
        return np.min([half[0] - np.hypot(x, y), half[2] - abs(z)], axis=0)
    return half[0] - np.sqrt(x * x + y * y + z * z)


@settings(max_examples=150)
@given(st.sampled_from((BOX, CYLINDER, BALL)), HALF, HALF, HALF, st.integers(0, 10_000))
def test_a_ray_enters_a_shape_where_its_surface_is(kind: float, a: float, b: float, c: float, seed: int) -> None:
    half = (a, b, c) if kind == BOX else (a, a, c) if kind == CYLINDER else (a, a, a)
    shapes = body(kind, half, seed)
    random = np.random.default_rng(seed + 1)
    origin = shapes.places[0] + 2.0 * _unit(random)
    ray = (shapes.places[0] + random.uniform(-0.6, 0.6, 3)) - origin
    ray /= np.linalg.norm(ray)
    found, *normal = meet_shape(shapes, 0, origin, tuple(ray))
    ways = np.linspace(0.0, 4.0, 8001)
    depth = inside(kind, half, (origin + ways[:, np.newaxis] * ray - shapes.places[0]) @ shapes.turns[0].T)
    if (depth > 1e-3).any():
        assert found == pytest.approx(ways[int((depth > 0.0).argmax())], abs=2e-3)
        assert np.linalg.norm(normal) == pytest.approx(1.0)
        assert np.dot(normal, ray) < 1e-9
        # a step along the normal leaves the shape
        out = origin + found * ray + 1e-6 * np.array(normal)
        assert inside(kind, half, ((out - shapes.places[0]) @ shapes.turns[0].T)[np.newaxis])[0] < 1e-9
    elif (depth < -1e-3).all():
        assert found == math.inf


def _unit(random: np.random.Generator) -> np.ndarray:
    vector = random.standard_normal(3)
    return np.asarray(vector / np.linalg.norm(vector))


@given(st.integers(0, 1000))
def test_a_ball_hides_the_sun_from_the_points_in_its_shadow(seed: int) -> None:
    random = np.random.default_rng(seed)
    shapes = body(BALL, (0.3, 0.3, 0.3), seed)
    sun = np.array([*_unit(random), 0.00465])
    aside = np.cross(sun[:3], _unit(random))
    aside /= np.linalg.norm(aside)
    for off, hidden in ((0.28, True), (0.32, False)):
        point = shapes.places[0] - 1.5 * sun[:3] + off * aside
        assert hides_sun(shapes, sun, *point, np.empty(3)) == hidden
    towards = shapes.places[0] + 1.5 * sun[:3]
    assert not hides_sun(shapes, sun, *towards, np.empty(3))
    assert not hides_sun(NO_BODY, sun, *towards, np.empty(3))


def test_links_and_shapes_are_where_the_urdf_has_them() -> None:
    urdf = load_scenario("flat_drive").urdf_xml
    turn, place, shapes = MachineShapes(urdf, "navcam_link").at((), np.zeros(0))
    expected, at = mounting(urdf, "navcam_link")
    assert turn == pytest.approx(expected) and place == pytest.approx(at)
    # the solar deck of urdf/explorer.urdf: a box of 1.05 by 0.8 by 0.03 m in the middle, 0.185 m up
    deck = [k for k, size in enumerate(shapes.sizes) if np.allclose(size[1:4], [0.525, 0.4, 0.015])]
    assert len(deck) == 1 and shapes.places[deck[0]] == pytest.approx([-0.025, 0.0, 0.185])
    rotation, there = Rotation.from_euler("z", 0.7).as_matrix(), np.array([1.0, 2.0, 0.5])
    on_map = moved(shapes, rotation, there)
    assert on_map.places[deck[0]] == pytest.approx(rotation @ [-0.025, 0.0, 0.185] + there)
    assert np.linalg.norm(on_map.places - on_map.around[:3], axis=1).max() < on_map.around[3]


def test_a_joint_moves_the_shapes_beyond_it() -> None:
    shapes = MachineShapes(load_scenario("lunar_sample").urdf_xml, "navcam_link")
    still = shapes.at((), np.zeros(0))[2].places.copy()
    steered = shapes.at(("steer_front_left_joint",), np.array([0.5]))[2].places
    changed = np.abs(steered - still).max(axis=1) > 1e-3
    assert 0 < changed.sum() < len(changed) / 2


def test_a_link_that_is_not_there_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="link of a sensor"):
        MachineShapes(load_scenario("flat_drive").urdf_xml, "nowhere_link")
