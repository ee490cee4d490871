"""Tip-over margin against closed forms, and against turning the machine until it falls."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from sojourn_analysis.vehicle.stability import tip_over_margin
from sojourn_machine.errors import InvalidValueError

HALF_LENGTH, HALF_WIDTH, HEIGHT = 0.7, 0.53, 0.4
LEVEL = np.array([[a * HALF_LENGTH, b * HALF_WIDTH, 0.0] for a in (1, 0, -1) for b in (1, -1)])
ALL = np.ones((1, 6), dtype=bool)


def turn(axis: str, angle: float) -> np.ndarray:
    """Rotation about x or y."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]] if axis == "x" else [[c, 0, s], [0, 1, 0], [-s, 0, c]])


def margin(places: np.ndarray, centre: np.ndarray, carries: np.ndarray | None = None) -> float:
    """Of one instant."""
    flags = np.ones((1, len(places)), dtype=bool) if carries is None else carries[None]
    return float(tip_over_margin(places[None], flags, np.asarray(centre)[None])[0])


@pytest.mark.parametrize("slope", np.radians([-60.0, -20.0, 0.0, 5.0, 30.0, 52.0, 70.0]))
def test_rectangle_on_a_slope_across_its_sides(slope: float) -> None:
    rotation = turn("x", slope)
    sideways = math.atan(HALF_WIDTH / HEIGHT) - abs(slope)
    found = margin(LEVEL @ rotation.T, rotation @ np.array([0.0, 0.0, HEIGHT]))
    # over the ends the slope does nothing: it runs along their edges
    assert found == pytest.approx(min(sideways, math.atan(HALF_LENGTH / HEIGHT)), abs=1e-12)


@pytest.mark.parametrize("slope", np.radians([-50.0, -10.0, 0.0, 25.0, 58.0]))
def test_rectangle_on_a_slope_along_its_length(slope: float) -> None:
    rotation = turn("y", slope)
    lengthways = math.atan(HALF_LENGTH / HEIGHT) - abs(slope)
    found = margin(LEVEL @ rotation.T, rotation @ np.array([0.0, 0.0, HEIGHT]))
    assert found == pytest.approx(min(lengthways, math.atan(HALF_WIDTH / HEIGHT)), abs=1e-12)


def test_lifted_wheel_and_mass_off_the_middle() -> None:
    lifted = np.array([True, True, False, True, True, True])  # middle left: the outline stays
    assert margin(LEVEL, [0.0, 0.0, HEIGHT], lifted) == pytest.approx(math.atan(HALF_WIDTH / HEIGHT))
    assert margin(LEVEL, [0.0, 0.1, HEIGHT]) == pytest.approx(math.atan((HALF_WIDTH - 0.1) / HEIGHT))
    assert margin(LEVEL, [0.0, HALF_WIDTH + 0.1, HEIGHT]) == pytest.approx(-math.atan(0.1 / HEIGHT))
    triangle = np.array([True, False, False, True, True, False])  # front left, middle right, rear left
    normal = np.array([HALF_WIDTH * 2.0, -HALF_LENGTH]) / math.hypot(HALF_WIDTH * 2.0, HALF_LENGTH)
    to_edge = float(normal @ (LEVEL[0, :2] - np.zeros(2)))
    assert margin(LEVEL, [0.0, 0.0, HEIGHT], triangle) == pytest.approx(math.atan(abs(to_edge) / HEIGHT))


def test_no_outline_is_no_number_and_many_instants_are_the_single_ones() -> None:
    two, line = np.array([True, True] + [False] * 4), np.array([True, False, True, False, True, False])
    centres = np.array([[0.0, 0.0, HEIGHT], [0.0, 0.0, HEIGHT], [0.05, -0.02, HEIGHT], [np.nan, 0.0, 0.0]])
    flags = np.stack([two, line, ALL[0], ALL[0]])
    places = np.repeat(LEVEL[None], 4, axis=0)
    places[0, 5] = np.nan  # a wheel in the air has no place
    found = tip_over_margin(places, flags, centres)
    assert np.isnan(found[[0, 1, 3]]).all()
    assert found[2] == margin(LEVEL, centres[2])


@given(st.integers(0, 2**32 - 1), st.integers(3, 7))
def test_tipping_by_the_margin_lifts_the_mass_to_its_highest(seed: int, count: int) -> None:
    """Independent route: outline by scipy; a machine that turns outwards over an edge by psi has its mass at the height
    A cos psi + B sin psi over the edge, which is highest, and from there falls by itself, at atan2(B, A).
    """
    random = np.random.default_rng(seed)
    places, mass = random.uniform(-1.0, 1.0, (count, 3)), np.array([*random.uniform(-0.8, 0.8, 2), 1.5])
    hull = ConvexHull(places[:, :2]).vertices  # counter-clockwise
    least = np.inf
    for first, last in zip(hull, np.roll(hull, -1), strict=True):
        axis = (places[last] - places[first]) / np.linalg.norm(places[last] - places[first])
        arm = mass - places[first]
        across = arm - (arm @ axis) * axis
        least = min(least, math.atan2(np.cross(axis, across)[2], across[2]))
    assert margin(places, mass) == pytest.approx(least, abs=1e-9)


@pytest.mark.parametrize(
    ("places", "flags", "centres", "up"),
    [
        (np.zeros((1, 6)), ALL, np.zeros((1, 3)), None),
        (LEVEL[None], ALL[:, :5], np.zeros((1, 3)), None),
        (LEVEL[None], ALL, np.zeros((2, 3)), None),
        (LEVEL[None], ALL, np.zeros((1, 3)), np.array([0.0, 0.0, 9.81])),
    ],
)
def test_what_does_not_fit_is_refused(places: np.ndarray, flags: np.ndarray, centres: np.ndarray, up: object) -> None:
    with pytest.raises(InvalidValueError):
        tip_over_margin(places, flags, centres, up)  # type: ignore[arg-type]
