"""The sun sensor: noise and mounting as stated, no fix where it cannot see the Sun, values that can be branched."""

import math

import numpy as np
import pytest

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import sun_sensor
from sojourn_physics.sensors.sun_sensor import SunSensorParams, SunSensorState

PARAMS = SunSensorParams(link="deck", field_of_view_deg=60.0, noise_deg=0.1, misalignment_deg=0.0)
FULL = 1.0
SUN = np.array([0.48, -0.36, 0.8])


def readings(params: SunSensorParams, seed: int, count: int) -> FloatArray:
    state, found = sun_sensor.initial_state(params, seed), []
    for _ in range(count):
        state, reading = sun_sensor.step(params, state, SUN, FULL)
        found.append(reading)
    return np.array(found)


def test_noise_lies_across_the_line_of_sight_with_the_stated_deviation() -> None:
    found = readings(PARAMS, 3, 4000)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=1e-12)
    first = np.cross(SUN, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first)
    for axis in (first, np.cross(SUN, first)):
        angles = found @ axis
        assert angles.std() == pytest.approx(math.radians(0.1), rel=0.05)
        assert abs(angles.mean()) < 4.0 * math.radians(0.1) / math.sqrt(4000)


def test_the_mounting_stays_through_a_run_and_has_the_stated_deviation_over_seeds() -> None:
    params = PARAMS.model_copy(update={"noise_deg": 0.0, "misalignment_deg": 0.5})
    np.testing.assert_array_equal(*readings(params, 1, 2))
    errors = np.array([np.cross(SUN, readings(params, seed, 1)[0]) for seed in range(400)])
    # the rotation about the line of sight itself cannot be seen: two of three axes are
    assert math.sqrt((errors**2).sum(axis=1).mean() / 2.0) == pytest.approx(math.radians(0.5), rel=0.1)


@pytest.mark.parametrize(
    "direction,visible",
    [(SUN, 0.0), (SUN, 0.5), (np.array([math.sin(1.05), 0.0, math.cos(1.05)]), FULL), (-SUN, FULL)],
    ids=["hidden", "half hidden", "out of the field of view", "behind"],
)
def test_no_fix_where_there_is_no_sun(direction: FloatArray, visible: float) -> None:
    state = sun_sensor.initial_state(PARAMS, 5)
    hidden, reading = sun_sensor.step(PARAMS, state, direction, visible)
    assert not reading.any()
    seen, _ = sun_sensor.step(PARAMS, state, SUN, FULL)
    after = [sun_sensor.step(PARAMS, branch, SUN, FULL)[1] for branch in (hidden, seen)]
    np.testing.assert_array_equal(*after)  # a hidden Sun shifts no later noise


def test_a_direction_that_is_none_is_refused() -> None:
    state: SunSensorState = sun_sensor.initial_state(PARAMS, 5)
    for bad in (np.zeros(3), np.array([math.nan, 0.0, 1.0]), np.array([1.0, 0.0])):
        with pytest.raises(InvalidValueError, match="direction of the Sun"):
            sun_sensor.step(PARAMS, state, bad, FULL)
