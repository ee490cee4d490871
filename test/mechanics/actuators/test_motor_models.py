"""Warm and brushless motors against integration, heat balance and power balance."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_mechanics.actuators import brushless
from sojourn_mechanics.actuators.brushless import BrushlessParams, BrushlessState
from sojourn_mechanics.actuators.motor_thermal import (
    MotorTemperatures,
    MotorThermalParams,
    allowed_current,
    continuous_current,
    demagnetisation_current,
    steady_temperatures,
    step_temperatures,
    warm_resistance,
    warm_torque_constant,
)
from sojourn_mechanics.errors import InvalidValueError

WARM = MotorThermalParams(
    winding_capacity=8.0, housing_capacity=120.0, winding_to_housing=3.1, housing_to_ambient=14.0,
    derate_temperature=390.0, largest_temperature=428.0,
    demagnetisation_cold=(253.0, 12.0), demagnetisation_hot=(373.0, 6.0),
)  # fmt: skip
MOTOR = BrushlessParams(
    phase_resistance=0.3, inductance_d=2e-4, inductance_q=3e-4, flux=0.008, pole_pairs=7, rotor_inertia=2e-5,
    friction_torque=0.002, viscous_friction=1e-5, cogging_torque=0.004, cogging_periods=84, max_current=10.0,
)  # fmt: skip


def test_temperatures_by_integration() -> None:
    def flow(t: float, x: np.ndarray) -> list[float]:
        through = (x[0] - x[1]) / 3.1
        return [(5.0 - through) / 8.0, (through - (x[1] - 250.0) / 14.0) / 120.0]

    path = solve_ivp(flow, (0.0, 300.0), [300.0, 290.0], rtol=1e-10, atol=1e-10)
    found = step_temperatures(WARM, MotorTemperatures(300.0, 290.0), 5.0, 250.0, 300.0)
    assert found == pytest.approx(path.y[:, -1], abs=1e-6)
    twice = MotorTemperatures(300.0, 290.0)
    for _ in range(2):
        twice = step_temperatures(WARM, twice, 5.0, 250.0, 150.0)
    assert twice == pytest.approx(found)


def test_the_continuous_current_ends_at_the_largest_temperature() -> None:
    current = continuous_current(WARM, 2.32, 293.0)
    loss = warm_resistance(2.32, WARM.largest_temperature) * current**2
    assert steady_temperatures(WARM, loss, 293.0).winding == pytest.approx(WARM.largest_temperature)
    assert continuous_current(WARM, 2.32, 500.0) == 0.0


@given(winding=st.floats(200.0, 450.0), housing=st.floats(200.0, 400.0))
def test_allowed_current_falls_with_heat(winding: float, housing: float) -> None:
    now = allowed_current(WARM, 8.0, MotorTemperatures(winding, housing))
    hotter = allowed_current(WARM, 8.0, MotorTemperatures(winding + 5.0, housing + 5.0))
    assert 0.0 <= hotter <= now <= 8.0
    assert now <= demagnetisation_current(WARM, housing)
    if winding >= 428.0:
        assert now == 0.0


def test_hot_magnets_give_less_torque() -> None:
    assert warm_torque_constant(WARM, 0.0234, 398.15) == pytest.approx(0.0234 * 0.89)
    assert demagnetisation_current(WARM, 313.0) == pytest.approx(9.0)
    assert demagnetisation_current(WARM, 600.0) == 0.0


def test_steady_state_of_the_step_is_the_algebra() -> None:
    state = BrushlessState(0.0, 0.0, 0.0, 0.0)
    smooth = MOTOR.model_copy(update={"cogging_torque": 0.0})
    voltage = (0.0, 6.0)
    for _ in range(12_000):
        state = brushless.step_brushless(smooth, state, voltage, 0.05, 1e-5, 1e-4)
    assert brushless.steady_voltage(smooth, state.current_d, state.current_q, state.rate) == pytest.approx(
        voltage, abs=1e-3
    )
    torque = brushless.electromagnetic_torque(smooth, state.current_d, state.current_q)
    assert torque == pytest.approx(0.05 + 0.002 + 1e-5 * state.rate, rel=1e-3)


@given(rate=st.floats(0.0, 600.0))
def test_power_is_copper_and_shaft(rate: float) -> None:
    i_d, i_q = -3.0, 5.0
    v_d, v_q = brushless.steady_voltage(MOTOR, i_d, i_q, rate)
    power = 1.5 * (v_d * i_d + v_q * i_q)
    copper = 1.5 * MOTOR.phase_resistance * (i_d**2 + i_q**2)
    assert power == pytest.approx(copper + brushless.electromagnetic_torque(MOTOR, i_d, i_q) * rate)


def test_field_weakening_goes_beyond_the_base_speed() -> None:
    bus = 24.0
    base = bus / math.sqrt(3.0) / (MOTOR.pole_pairs * MOTOR.flux)
    slow, i_d, i_q = brushless.largest_torque(MOTOR, 0.1 * base, bus)
    assert i_q <= MOTOR.max_current and math.hypot(i_d, i_q) <= MOTOR.max_current * (1 + 1e-9)
    fast, i_d, i_q = brushless.largest_torque(MOTOR, 1.05 * base, bus)
    assert 0.0 < fast < slow and i_d < 0.0
    assert math.hypot(*brushless.steady_voltage(MOTOR, i_d, i_q, 1.05 * base)) <= bus / math.sqrt(3.0) * (1 + 1e-9)
    assert brushless.largest_torque(MOTOR, 10.0 * base, bus)[0] == 0.0
    # saliency with L_q > L_d: some negative i_d helps even at standstill
    assert slow >= brushless.torque_constant(MOTOR) * MOTOR.max_current


def test_cogging_does_no_work() -> None:
    angles = np.linspace(0.0, 2.0 * math.pi, 84 * 50, endpoint=False)
    torques = [brushless.cogging(MOTOR, float(angle)) for angle in angles]
    assert np.sum(torques) == pytest.approx(0.0, abs=1e-9)
    assert max(torques) == pytest.approx(0.004, rel=1e-2)


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="loss"):
        step_temperatures(WARM, MotorTemperatures(300.0, 300.0), math.nan, 300.0, 1.0)
    with pytest.raises(ValueError, match="derate_temperature"):
        MotorThermalParams.model_validate(WARM.model_dump() | {"derate_temperature": 500.0})
    with pytest.raises(ValueError, match="demagnetisation"):
        MotorThermalParams.model_validate(WARM.model_dump() | {"demagnetisation_hot": (200.0, 5.0)})
    with pytest.raises(InvalidValueError, match="bus_voltage"):
        brushless.largest_torque(MOTOR, 1.0, -1.0)
