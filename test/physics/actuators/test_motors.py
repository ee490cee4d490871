"""Permanent-magnet and series motors: catalogue, energy, and steady state against simulation."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.drives import MotorParams, SeriesMotorParams
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.actuators import dc_motor, series_motor

RE25 = MotorParams(
    resistance=2.32, torque_constant=0.0234, rotor_inertia=1.08e-6, no_load_current=0.0369, max_current=20.0
)
SERIES = SeriesMotorParams(
    series_resistance=0.5, field_constant=0.005, saturation_current=30.0, rotor_inertia=1e-4,
    friction_torque=0.01, viscous_friction=1e-5, max_current=60.0,
)  # fmt: skip


@given(torque=st.floats(-0.2, 0.2), rate=st.floats(-1000.0, 1000.0))
def test_power_in_is_shaft_heat_and_friction(torque: float, rate: float) -> None:
    point = dc_motor.working_point(RE25, torque, rate)
    heat = RE25.resistance * point.current**2
    friction = RE25.torque_constant * RE25.no_load_current * abs(rate)
    assert point.power == pytest.approx(torque * rate + heat + friction, abs=1e-9)


def test_greatest_efficiency_is_the_best_of_all_points() -> None:
    best = max(
        dc_motor.working_point(RE25, t, (24.0 - RE25.resistance * (t / 0.0234 + 0.0369)) / 0.0234).efficiency
        for t in (i * 1e-4 for i in range(1, 1500))
    )
    assert best == pytest.approx(dc_motor.greatest_efficiency(RE25, 24.0), rel=1e-5)


def test_largest_torque_meets_the_voltage_and_the_current() -> None:
    fast = dc_motor.largest_torque(RE25, 800.0, 24.0)
    assert dc_motor.working_point(RE25, fast, 800.0).voltage == pytest.approx(24.0)
    weak = RE25.model_copy(update={"max_current": 1.0})
    assert dc_motor.working_point(weak, dc_motor.largest_torque(weak, 10.0, 24.0), 10.0).current == pytest.approx(1.0)
    assert dc_motor.largest_torque(RE25, dc_motor.no_load_rate(RE25, 24.0), 24.0) == pytest.approx(0.0, abs=1e-12)


@given(torque=st.floats(0.0, 2.0), rate=st.floats(0.1, 1500.0))
def test_series_motor_keeps_energy(torque: float, rate: float) -> None:
    point = series_motor.series_working_point(SERIES, torque, rate)
    lost = SERIES.series_resistance * point.current**2 + series_motor.friction_torque(SERIES, rate) * rate
    assert point.power == pytest.approx(torque * rate + lost, rel=1e-9)


@given(rate=st.floats(0.0, 1500.0))
def test_series_motor_at_full_voltage(rate: float) -> None:
    torque = series_motor.series_largest_torque(SERIES, rate, 36.0)
    if torque > 0.0:
        point = series_motor.series_working_point(SERIES, torque, rate)
        assert point.voltage == pytest.approx(36.0) or point.current == pytest.approx(60.0)


def test_bad_numbers_are_refused() -> None:
    with pytest.raises(InvalidValueError, match="rate"):
        series_motor.series_working_point(SERIES, 1.0, -1.0)
    with pytest.raises(InvalidValueError, match="torque"):
        series_motor.series_working_point(SERIES, -1.0, 1.0)
    with pytest.raises(InvalidValueError, match="torque"):
        dc_motor.working_point(RE25, math.nan, 1.0)
    with pytest.raises(InvalidValueError, match="voltage"):
        dc_motor.greatest_efficiency(RE25, 0.01)
    with pytest.raises(InvalidValueError, match="voltage"):
        dc_motor.largest_torque(RE25, 1.0, -2.0)
