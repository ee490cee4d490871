"""Telemetry channels: resolution, noise, offset, range."""

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.sensors import bus
from sojourn_physics.sensors.bus import BusTelemetryParams, ChannelParams


def channel(**changes: float) -> ChannelParams:
    values = {"resolution": 0.05, "noise": 0.0, "offset": 0.0, "minimum": -40.0, "maximum": 40.0}
    return ChannelParams(**(values | changes))


def telemetry(**changes: float) -> BusTelemetryParams:
    warm = channel(minimum=100.0, maximum=400.0)
    return BusTelemetryParams(voltage=channel(**changes), current=channel(), temperature=warm)


def test_a_quiet_channel_is_within_half_a_step_of_the_truth() -> None:
    state = bus.initial_state(telemetry(), 1, ("main",))
    for truth in np.linspace(-39.0, 39.0, 301):
        state, reading = bus.step(state, np.array([[truth, -truth, 290.0]]))
        assert np.abs(reading[0, :2] - [truth, -truth]).max() <= 0.025 + 1e-12
        assert reading[0, 0] / 0.05 == pytest.approx(round(reading[0, 0] / 0.05))


def test_readings_stay_within_the_range() -> None:
    state = bus.initial_state(telemetry(), 1, ("main",))
    _, reading = bus.step(state, np.array([[90.0, -90.0, 20.0]]))
    assert reading[0].tolist() == [40.0, -40.0, 100.0]


def test_noise_and_offset_have_their_deviations() -> None:
    params = telemetry(resolution=1e-6, noise=0.2)
    state, readings = bus.initial_state(params, 5, ("main",)), []
    for _ in range(4000):
        state, reading = bus.step(state, np.array([[28.0, 1.0, 290.0]]))
        readings.append(reading[0, 0])
    assert np.std(readings) == pytest.approx(0.2, rel=0.05)
    assert np.mean(readings) == pytest.approx(28.0, abs=0.02)
    offsets = [bus.initial_state(telemetry(offset=0.3), seed, ("main",)).offset[0] for seed in range(600)]
    assert np.std(offsets) == pytest.approx(0.3, rel=0.1)


def test_a_second_store_does_not_change_the_first() -> None:
    params = telemetry(noise=0.2, offset=0.1)
    alone, both = bus.initial_state(params, 5, ("main",)), bus.initial_state(params, 5, ("spare", "main"))
    for _ in range(300):
        alone, one = bus.step(alone, np.array([[28.0, 1.0, 290.0]]))
        both, two = bus.step(both, np.array([[12.0, 3.0, 250.0], [28.0, 1.0, 290.0]]))
        assert np.array_equal(one[0], two[1])


def test_a_range_upside_down_is_refused() -> None:
    with pytest.raises(ValidationError, match="maximum"):
        channel(minimum=5.0, maximum=5.0)


@pytest.mark.parametrize(("truth", "reason"), [([[28.0, 1.0]], "shape"), ([[28.0, np.nan, 290.0]], "finite")])
def test_truth_that_is_none_is_refused(truth: list[list[float]], reason: str) -> None:
    with pytest.raises(InvalidValueError, match=reason):
        bus.step(bus.initial_state(telemetry(), 1, ("main",)), np.array(truth))
