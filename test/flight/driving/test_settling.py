"""The chassis on the map: against planes, against an independent least squares, and against its limits."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_examples import PARAMS, dense, mapped

from sojourn_config.scenario import load_scenario
from sojourn_flight.hazards.obstacle_map import COUNT, NOISE, ObstacleMap
from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_flight.hazards.settling import settled, tilt_ratio, tilts_along
from sojourn_flight.hazards.traversability import judged
from sojourn_machine.params import FloatArray

WHEELS = np.array([(wheel.x, wheel.y) for wheel in load_scenario("flat_drive").steering.wheels])


def tilt(map_: ObstacleMap, pose: tuple[float, float, float], wheels: FloatArray = WHEELS) -> FloatArray:
    return settled(judged(PARAMS, map_).under(map_), wheels, *pose)


@settings(max_examples=25, deadline=None)
@given(st.floats(0.0, 17.0), st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_on_a_plane_the_tilt_is_that_of_its_directions(slope_deg: float, direction: float, yaw: float) -> None:
    rise = math.tan(math.radians(slope_deg))
    map_ = mapped(dense(lambda x, y: rise * (math.cos(direction) * x + math.sin(direction) * y), reach=2.0))
    climb, lean, *_ = tilt(map_, (0.1, -0.2, yaw))
    assert climb == pytest.approx(rise * math.cos(direction - yaw), abs=0.005)
    assert lean == pytest.approx(rise * math.sin(direction - yaw), abs=0.005)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 1000), st.floats(-math.pi, math.pi))
def test_on_waves_it_lies_on_the_ground_under_its_wheels(seed: int, yaw: float) -> None:
    """Against least squares of the true heights; waves of 2.5 m and more are smeared by FOOTING by some percent."""
    phases = np.random.default_rng(seed).uniform(0.0, 6.0, 4)

    def waves(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.asarray(0.04 * (np.sin(2.5 * x + phases[0]) + np.sin(1.5 * y + phases[1])
                                  + np.sin(1.2 * (x + y) + phases[2])))  # fmt: skip

    climb, lean, *_ = tilt(mapped(dense(waves, reach=2.0)), (0.0, 0.0, yaw))
    cosine, sine = math.cos(yaw), math.sin(yaw)
    heights = waves(WHEELS @ (cosine, -sine), WHEELS @ (sine, cosine))
    expected = np.linalg.lstsq(np.column_stack([np.ones(len(WHEELS)), WHEELS]), heights, rcond=None)[0]
    assert (climb, lean) == pytest.approx(tuple(expected[1:]), abs=0.012)


def test_wheels_on_unknown_ground_do_not_count_and_too_few_say_nothing() -> None:
    map_ = mapped(dense(lambda x, y: 0.1 * x, reach=2.0))
    middles = map_.x0 + map_.cell * (np.arange(map_.layers.shape[1]) + 0.5)
    without_front = map_.layers.copy()
    without_front[:, :, middles > 0.4] = 0.0
    half = map_.__class__(map_.x0, map_.y0, map_.cell, without_front)
    assert tilt(half, (0.0, 0.0, 0.0))[0] == pytest.approx(0.1, abs=0.005)
    without_front[:, :, middles > -0.4] = 0.0
    assert np.isnan(tilt(half, (0.0, 0.0, 0.0))).all()
    ground = judged(PARAMS, half).under(half)
    assert tilts_along(ground, WHEELS, PARAMS.passable.tilts, np.zeros((1, 3))) == [0.0], "nothing said is no tilt"


def test_the_variance_is_that_of_the_noise_of_the_cells() -> None:
    """Heights drawn with the noise that the cells state: the spread of the tilt is the stated one."""
    map_ = mapped(dense(lambda x, y: 0.0 * x, reach=2.0))
    map_.layers[COUNT][map_.layers[COUNT] > 0.0] = 4.0
    map_.layers[NOISE] = 0.01**2
    generator, found = np.random.default_rng(3), []
    ground = judged(PARAMS, map_).under(map_)._replace(slopes=np.zeros((3, *map_.known.shape)))
    heights = ground.layers[3].copy()
    for _ in range(400):
        ground.layers[3] = heights + generator.normal(0.0, 0.005, heights.shape)
        found.append(settled(ground, WHEELS, 0.0, 0.0, 0.3))
    spread = np.std(found, axis=0)[:2]
    stated = np.sqrt(np.mean(found, axis=0)[2:])
    np.testing.assert_allclose(spread, stated, rtol=0.12)


@pytest.mark.parametrize(
    "climb,lean,noise,ratio",
    [
        (0.2, 0.0, 0.0, 1.0),  # up
        (-0.2, 0.0, 0.0, 0.5),  # down
        (0.0, -0.15, 0.0, 0.5),  # across
        (0.2, 0.2, 0.0, 1.0),
        (0.2, 0.0, 0.1, 0.5),
        (0.05, 0.0, 0.1, 0.0),
    ],
)
def test_each_direction_has_its_limit_and_noise_is_taken_off(
    climb: float, lean: float, noise: float, ratio: float
) -> None:
    assert tilt_ratio(climb, lean, noise, noise, TiltLimits(0.2, 0.4, 0.3)) == pytest.approx(ratio)
