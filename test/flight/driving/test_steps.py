"""The height of a step as the camera's map measures it, against the truth: without bias, and never missed."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from obstacle_examples import CAMERA, EYE, PARAMS, RIDE, ground

from sojourn_flight.hazards.obstacle_map import HIGH, LOW, empty_map, with_cloud
from sojourn_flight.hazards.steps import EXPECTED, LARGEST, MOST, PLAUSIBLE, grounds
from sojourn_flight.hazards.stereo_camera import height_variances
from sojourn_flight.hazards.traversability import DROP, FREE, judged
from sojourn_physics.sensors import hazcam

LIMIT, CELL = PARAMS.passable.max_step, PARAMS.map.cell
SEEDS = 6


def approach(height: float, slope: float, seed: int, begin: float) -> tuple[NDArray[np.float64], ...]:
    """Drive towards an edge that lies somewhere in its cell and up to 40 degrees askew, on a slope.

    Args:
        begin: distance from camera to edge at the first look [m]; the last is at half a metre.

    Returns:
        Distances from camera to edge [m], the highest step found along it as wide as the rover [m], and whether it is
        closed; each of shape (looks,).
    """
    random = np.random.default_rng(seed)
    edge, askew = 4.0 + random.uniform(0.0, CELL), random.uniform(-0.7, 0.7)
    c, s = math.cos(askew), math.sin(askew)
    field = ground(lambda x, y: np.where(x * c + y * s > edge, height, 0.0) + slope * x)
    map_, state = empty_map(PARAMS, 0.0, 0.0), hazcam.initial_state(CAMERA, seed)
    cosine = 1.0 / math.hypot(1.0, slope)
    rotation = np.array([[cosine, 0.0, -slope * cosine], [0.0, 1.0, 0.0], [slope * cosine, 0.0, cosine]])
    rows, columns = np.indices(map_.layers.shape[1:])
    distances, steps, closed = np.arange(begin, 0.49, -0.15), [], []
    for distance in distances:
        x = edge / c - distance - CAMERA.position[0]
        place = np.array([x, 0.0, slope * x]) + RIDE * rotation[:, 2]
        state, points = hazcam.step(CAMERA, state, field, place, rotation)
        map_ = with_cloud(PARAMS, map_, points.astype(float), EYE, place, rotation, float(x))
        found = judged(PARAMS, map_)
        east, north = map_.x0 + (columns + 0.5) * CELL, map_.y0 + (rows + 0.5) * CELL
        there = (np.abs(east * c + north * s - edge) < 0.4) & (np.abs(north) < PARAMS.outline.half_width)
        steps.append(np.where(found.kinds[there] <= DROP, found.measures[there], 0.0).max())
        closed.append((found.kinds[there] != FREE).any())
    return distances, np.array(steps), np.array(closed)


def approaches(height: float, begin: float, slope: float = 0.0) -> tuple[NDArray[np.float64], ...]:
    """Several of them: distances, and steps and closed of shape (seeds, looks)."""
    found = [approach(height, slope, seed, begin) for seed in range(SEEDS)]
    return found[0][0], np.array([one[1] for one in found]), np.array([one[2] for one in found])


@pytest.mark.parametrize("height", [0.1, -0.1])
def test_a_step_of_a_decimetre_is_measured_without_bias_and_driven_over(height: float) -> None:
    """It looked like 0.126 up at 2 m and 0.13 at 0.6 m, and like 0.03 to 0.07 down."""
    distances, steps, closed = approaches(height, 2.3)
    near = distances < 1.5
    assert abs(steps[:, near].mean() - abs(height)) < 0.005
    assert steps[:, near].std() < 0.004
    if height > 0.0:
        assert abs(steps[:, ~near].mean() - height) < 0.01
    assert not closed[:, near].any()
    assert closed.mean() < 0.05


@pytest.mark.parametrize(
    "height,slope,beyond",
    [(1, 0.0, 0.01), (-1, 0.0, 0.01), (-1, -0.15, 0.01), (1, -0.15, 0.03), (-1, 0.15, 0.03)],
    ids=["up", "down", "down on a way down", "up on a way down", "down on a way up"],
)
def test_a_step_beyond_the_limit_is_never_missed(height: int, slope: float, beyond: float) -> None:
    """In no look from 1 m on, where the rover has half a metre to go. With 24 looks and none missed, fewer than 1 in 8
    are missed with 95 % confidence (rule of three), and a rover that is not stopped has to be missed by all four of
    them: fewer than 1 in 4000. Against the slope of the ground the step has to be 3 cm beyond: a cell's own slope
    hides up to 2.
    """
    distances, _, closed = approaches(height * (LIMIT + beyond), 1.55, slope)
    assert closed[:, distances < 1.05].all()


def test_the_expected_and_the_largest_of_normal_errors() -> None:
    """Against draws, and the distribution of a maximum."""
    random = np.random.default_rng(3)
    for n in (1, 2, 5, 20, 100):
        highest = random.standard_normal((20000, n)).max(axis=1)
        assert EXPECTED[n] == pytest.approx(highest.mean(), abs=0.03)
        assert (highest <= LARGEST[n]).mean() == pytest.approx(PLAUSIBLE, abs=0.003)
    assert len(EXPECTED) == len(LARGEST) == MOST + 1 and (np.diff(EXPECTED[1:]) > 0.0).all()


@pytest.mark.parametrize("forward", [1.0, 2.0, 3.0, 4.0])
def test_the_error_of_a_height_against_draws_of_the_camera(forward: float) -> None:
    """Level ground, one ray drawn often: what its points are above the ground."""
    point = np.array([forward, 0.3 * forward, -RIDE])
    ray = point - CAMERA.position
    depth = float(ray @ EYE.axis)
    random = np.random.default_rng(1)
    measured = 1.0 / (1.0 / depth + EYE.depth_noise * random.standard_normal(20000))
    heights = CAMERA.position[2] + measured / depth * ray[2] + RIDE
    (variance,) = height_variances(EYE, point[np.newaxis], np.array([0.0, 0.0, 1.0]))
    assert heights.std() == pytest.approx(math.sqrt(variance), rel=0.05)


def test_noise_makes_no_ground_of_its_own_and_a_wall_stays() -> None:
    """A cell of level ground has one height; one with a wall keeps its height to a fraction of the noise."""
    random, sigma, n = np.random.default_rng(2), 0.01, 40
    layers = np.zeros((8, 2, 2))
    for column, wall in ((0, 0.0), (1, 0.3)):
        heights = sigma * random.standard_normal(n) + wall * (np.arange(n) % 2)
        layers[:5, 0, column] = n, heights.min(), heights.max(), heights.mean(), sigma**2
    lows, highs = grounds(layers)
    assert lows[0, 0] == highs[0, 0] == layers[3, 0, 0]
    assert highs[0, 1] - lows[0, 1] == pytest.approx(0.3, abs=1.5 * sigma)
    assert layers[HIGH, 0, 1] - layers[LOW, 0, 1] > 0.3 + 2.0 * sigma


def test_a_look_is_lifted_onto_what_is_known() -> None:
    """Odometry that is 6 cm too high after a climb: the second look would make a step of it."""
    field = ground(lambda x, y: 0.02 * np.sin(3.0 * x))
    state = hazcam.initial_state(CAMERA, 1)
    state, points = hazcam.step(CAMERA, state, field, np.array([0.0, 0.0, RIDE]), np.eye(3))
    first = with_cloud(PARAMS, empty_map(PARAMS, 0.0, 0.0), points.astype(float), EYE, np.zeros(3), np.eye(3), 0.0)
    state, points = hazcam.step(CAMERA, state, field, np.array([0.1, 0.0, RIDE]), np.eye(3))
    second = with_cloud(PARAMS, first, points.astype(float), EYE, np.array([0.1, 0.0, 0.06]), np.eye(3), 0.1)
    assert second.lift == pytest.approx(-0.06, abs=0.003)
    assert set(judged(PARAMS, second).kinds.ravel().tolist()) == {FREE}
