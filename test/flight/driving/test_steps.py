"""The height of a step as the camera's map measures it, against the truth: without bias, and never missed."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from obstacle_examples import CAMERA, PARAMS, RIDE, STEREO, ground

from sojourn_flight.hazards.obstacle_map import COUNT, HIGH, LAYERS, LOW, MEAN, NOISE, SIGMAS, empty_map, with_cloud
from sojourn_flight.hazards.steps import EXPECTED, LARGEST, MOST, PLAUSIBLE, grounds, step_at
from sojourn_flight.hazards.stereo_camera import height_variances
from sojourn_flight.hazards.traversability import DROP, FREE, judged
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamView

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
        state, points = hazcam.step(CAMERA, state, HazcamView(field), place, rotation)
        map_ = with_cloud(PARAMS, map_, points.astype(float), STEREO, place, rotation, float(x))
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


def smooth(means: NDArray[np.float64], counts: NDArray[np.float64], sigma: float) -> NDArray[np.float64]:
    """Layers of cells of known means, without edges in them; a count of 0 is an unknown cell."""
    layers = np.zeros((LAYERS, *means.shape))
    layers[[LOW, HIGH, MEAN]], layers[COUNT], layers[NOISE] = means, counts, sigma**2
    return layers


def step_between(means: tuple[float, float], points: tuple[int, int], sigma: float) -> tuple[float, float, float]:
    """Rise and fall from one cell to another, alone on the map, and what of them is sure; no slope explains it [m]."""
    here = np.array([[1.0, 1.0], [0.0, 0.0]])
    layers = smooth(here * means, here * points, sigma)
    rise, fall, sure = step_at(layers, *grounds(layers), 0, 0, CELL, 0.0)
    return rise, fall, sure


def test_a_step_between_cells_of_a_few_points_is_no_obstacle_for_their_noise() -> None:
    """A terrace of 75 mm between two cells of one and two points seen from 4 m, one 25 mm too low, the other 30 too
    high: a drop of 0.13 m, for which the rover left its straight way along a side slope. Seen from nearby it is one.
    """
    heights = np.where(np.arange(12) < 6, 0.0, 0.075) * np.ones((12, 1))
    heights[6, 4], heights[6, 6] = -0.025, 0.075 + 0.03
    known = np.where(np.arange(12) == 5, 0.0, 6.0) * np.ones((12, 1))
    few, many = known.copy(), 20.0 * known
    few[6, 4], few[6, 6] = 1.0, 2.0
    map_ = empty_map(PARAMS, 0.0, 0.0)
    for counts, sigma, closed in ((few, 0.01, False), (many, 0.002, True)):
        map_.layers[:, :12, :12] = smooth(heights, counts, sigma)
        kinds = judged(PARAMS, map_).kinds
        assert [bool(kinds[6, column] != FREE) for column in (4, 6)] == [closed, closed]


@pytest.mark.parametrize("points", [(1, 1), (1, 5), (2, 3), (20, 20)])
def test_what_is_beyond_a_limit_by_no_more_than_noise_is_not_sure(points: tuple[int, int]) -> None:
    """Guarded rejection, by draws: of steps that are the limit, one in 44 is taken for more (beyond two deviations of a
    normal error); of those that are higher by four deviations, all but one in 44."""
    random, sigma, pairs, most = np.random.default_rng(4), 0.008, 4000, 0.5 * math.erfc(SIGMAS / math.sqrt(2.0))
    doubt = sigma * math.sqrt(sum(1.0 / n for n in points))
    for truth, share in ((LIMIT, most), (LIMIT + 2.0 * SIGMAS * doubt, 1.0 - most)):
        beyond = 0
        for _ in range(pairs):
            low, high = (sigma * random.standard_normal(n).mean() for n in points)
            beyond += step_between((low, truth + high), points, sigma)[2] > LIMIT
        assert beyond / pairs == pytest.approx(share, abs=0.01)


@settings(max_examples=50, deadline=None)
@given(st.floats(-0.5, 0.5), st.integers(1, 500), st.integers(1, 500), st.floats(0.0, 0.02))
def test_less_is_taken_for_noise_the_more_points_there_are(rise: float, here: int, there: int, sigma: float) -> None:
    """And nothing of a step that was measured without noise."""
    exact, once = (step_between((0.0, rise), (here, there), noise) for noise in (0.0, sigma))
    often = step_between((0.0, rise), (100 * here, 100 * there), sigma)
    assert exact == pytest.approx((max(rise, 0.0), max(-rise, 0.0), abs(rise)))
    assert exact[:2] == once[:2] == often[:2]
    largest = SIGMAS * sigma * math.sqrt(2.0)
    assert -1e-12 <= exact[2] - often[2] <= 0.1 * largest + 1e-12
    assert exact[2] - often[2] <= exact[2] - once[2] + 1e-12 <= largest + 2e-12


def test_of_a_stone_that_is_seen_for_sure_nothing_is_left_out() -> None:
    """A stone of one cell and 0.3 m, whose neighbour on one side is 0.13 m high, of single points seen from afar: that
    alone is in doubt, beside the stone it is closed."""
    map_ = empty_map(PARAMS, 0.0, 0.0)
    for height, closed in ((0.3, True), (0.0, False)):
        heights = np.zeros((12, 12))
        heights[6, 6], heights[6, 7] = height, 0.13
        map_.layers[:, :12, :12] = smooth(heights, np.ones((12, 12)), 0.01)
        assert (judged(PARAMS, map_).kinds[6, 8] != FREE) == closed


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
    depth = float(ray @ STEREO.axis)
    random = np.random.default_rng(1)
    measured = 1.0 / (1.0 / depth + STEREO.depth_noise * random.standard_normal(20000))
    heights = CAMERA.position[2] + measured / depth * ray[2] + RIDE
    (variance,) = height_variances(STEREO, point[np.newaxis], np.array([0.0, 0.0, 1.0]))
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
    state, points = hazcam.step(CAMERA, state, HazcamView(field), np.array([0.0, 0.0, RIDE]), np.eye(3))
    first = with_cloud(PARAMS, empty_map(PARAMS, 0.0, 0.0), points.astype(float), STEREO, np.zeros(3), np.eye(3), 0.0)
    state, points = hazcam.step(CAMERA, state, HazcamView(field), np.array([0.1, 0.0, RIDE]), np.eye(3))
    second = with_cloud(PARAMS, first, points.astype(float), STEREO, np.array([0.1, 0.0, 0.06]), np.eye(3), 0.1)
    assert second.lift == pytest.approx(-0.06, abs=0.003)
    assert set(judged(PARAMS, second).kinds.ravel().tolist()) == {FREE}
