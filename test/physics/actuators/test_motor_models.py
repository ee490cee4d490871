"""Warm and brushless motors against integration, heat balance and power balance."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_machine.drives import BrushlessMotorParams, JointDriveParams, MotorThermalParams
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.actuators import brushless
from sojourn_physics.actuators.motor_thermal import (
    MotorTemperatures,
    allowed_current,
    continuous_current,
    demagnetisation_current,
    steady_temperatures,
    step_temperatures,
    warm_resistance,
    warm_torque_constant,
)

WARM = MotorThermalParams(
    winding_capacity=8.0, housing_capacity=120.0, winding_to_housing=3.1, housing_to_ambient=14.0, surroundings=250.0,
    derate_temperature=390.0, largest_temperature=428.0,
    demagnetisation_cold=(253.0, 12.0), demagnetisation_hot=(373.0, 6.0),
)  # fmt: skip
MOTOR = BrushlessMotorParams(
    kind="brushless", phase_resistance=0.3, inductance_d=2e-4, inductance_q=3e-4, flux=0.008, pole_pairs=7,
    rotor_inertia=2e-5, friction_torque=0.002, viscous_friction=1e-5, max_current=10.0,
)  # fmt: skip


def test_temperatures_by_integration() -> None:
    def flow(t: float, x: np.ndarray) -> list[float]:
        through = (x[0] - x[1]) / 3.1
        return [(5.0 - through) / 8.0, (through - (x[1] - 250.0) / 14.0) / 120.0]

    path = solve_ivp(flow, (0.0, 300.0), [300.0, 290.0], rtol=1e-10, atol=1e-10)
    found = step_temperatures(WARM, MotorTemperatures(300.0, 290.0), 5.0, 300.0)
    assert found == pytest.approx(path.y[:, -1], abs=1e-6)
    twice = MotorTemperatures(300.0, 290.0)
    for _ in range(2):
        twice = step_temperatures(WARM, twice, 5.0, 150.0)
    assert twice == pytest.approx(found)


def test_the_continuous_current_ends_at_the_largest_temperature() -> None:
    current = continuous_current(WARM, 2.32)
    loss = warm_resistance(2.32, WARM.largest_temperature) * current**2
    assert steady_temperatures(WARM, loss).winding == pytest.approx(WARM.largest_temperature)
    assert continuous_current(WARM.model_copy(update={"surroundings": 500.0}), 2.32) == 0.0


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


def steady_voltage(current_d: float, current_q: float, rate: float) -> tuple[float, float]:
    """v_d, v_q [V] that hold currents [A] at a rate [rad/s], by the equations of the phases."""
    electrical = MOTOR.pole_pairs * rate
    v_d = MOTOR.phase_resistance * current_d - electrical * MOTOR.inductance_q * current_q
    v_q = MOTOR.phase_resistance * current_q + electrical * (MOTOR.inductance_d * current_d + MOTOR.flux)
    return v_d, v_q


@given(rate=st.floats(-300.0, 300.0), current=st.floats(-10.0, 10.0))
def test_the_supply_sees_a_motor_with_a_commutator(rate: float, current: float) -> None:
    """Same torque, same power, same losses, from the algebra of the phases; the voltage but for the cross drop."""
    seen = MOTOR.from_supply
    torque = brushless.electromagnetic_torque(MOTOR, 0.0, current)
    drawn = torque / seen.torque_constant
    assert drawn == pytest.approx(0.5 * math.sqrt(3.0) * current)
    _, v_q = steady_voltage(0.0, current, rate)
    power = seen.resistance * drawn**2 + seen.torque_constant * rate * drawn
    assert power == pytest.approx(1.5 * v_q * current, abs=1e-9)
    voltage = seen.resistance * drawn + seen.torque_constant * rate
    assert math.sqrt(3.0) * v_q == pytest.approx(voltage, abs=1e-9)
    assert seen.max_current * seen.torque_constant == pytest.approx(brushless.torque_constant(MOTOR) * 10.0)
    assert seen.no_load_current * seen.torque_constant == pytest.approx(0.002)


def test_a_drive_takes_a_brushless_motor() -> None:
    servo = {"mode": "rate", "proportional": 1.0, "max_torque": 100.0}
    gear = {"ratio": 50.0, "efficiency": 0.8, "friction_torque": 1.0, "viscous_friction": 0.5}
    base = {"joints": ["a"], "load": "drive", "gear": gear, "servo": servo}
    drive = JointDriveParams.model_validate(base | {"motor": MOTOR.model_dump()})
    other = JointDriveParams.model_validate(base | {"motor": MOTOR.from_supply.model_dump()})
    for name in ("winding_loss", "motor_effort", "friction_torque", "reflected_inertia"):
        assert getattr(drive, name) == pytest.approx(getattr(other, name))
    assert drive.viscous_friction == pytest.approx(0.5 + 1e-5 * 50.0**2)
    with pytest.raises(ValueError, match="flux"):
        JointDriveParams.model_validate(base | {"motor": {"kind": "brushless", "phase_resistance": 1.0}})


@given(rate=st.floats(0.0, 600.0))
def test_power_is_copper_and_shaft(rate: float) -> None:
    i_d, i_q = -3.0, 5.0
    v_d, v_q = steady_voltage(i_d, i_q, rate)
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
    assert math.hypot(*steady_voltage(i_d, i_q, 1.05 * base)) <= bus / math.sqrt(3.0) * (1 + 1e-9)
    assert brushless.largest_torque(MOTOR, 10.0 * base, bus)[0] == 0.0
    # saliency with L_q > L_d: some negative i_d helps even at standstill
    assert slow >= brushless.torque_constant(MOTOR) * MOTOR.max_current


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="loss"):
        step_temperatures(WARM, MotorTemperatures(300.0, 300.0), math.nan, 1.0)
    with pytest.raises(ValueError, match="derate_temperature"):
        MotorThermalParams.model_validate(WARM.model_dump() | {"derate_temperature": 500.0})
    with pytest.raises(ValueError, match="demagnetisation"):
        MotorThermalParams.model_validate(WARM.model_dump() | {"demagnetisation_hot": (200.0, 5.0)})
    with pytest.raises(InvalidValueError, match="bus_voltage"):
        brushless.largest_torque(MOTOR, 1.0, -1.0)
