"""A spindle against its motor's equations, its energy, and what it does under too much load."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.drives import GearParams, MotorParams
from sojourn_physics.actuators.spindle import Spindle, SpindleOutput, spindle_step, stall_torque

MOTOR = MotorParams(
    resistance=2.32, torque_constant=0.0234, rotor_inertia=1.08e-6, no_load_current=0.0369, max_current=1.2
)
GEAR = GearParams(ratio=30.0, efficiency=0.75, friction_torque=0.01, viscous_friction=0.001)
DT = 0.02


def turn(rate: float, wanted: float, load: float, voltage: float = 28.0, supply: float = 1.0) -> SpindleOutput:
    return spindle_step(Spindle(MOTOR, GEAR, 60.0), rate, wanted, load, voltage, supply, DT)


def settled(wanted: float, load: float, voltage: float = 28.0) -> SpindleOutput:
    found = turn(0.0, wanted, load, voltage)
    for _ in range(200):
        found = turn(found.rate, wanted, load, voltage)
    return found


@settings(max_examples=60, deadline=None)
@given(st.floats(1.0, 60.0), st.floats(0.0, 0.55), st.floats(10.0, 32.0))
def test_steady_state_is_the_motors_equation(wanted: float, load: float, voltage: float) -> None:
    found = settled(wanted, load, voltage)
    assert not found.stalled
    shaft = GEAR.ratio * found.rate
    torque = (load + GEAR.friction_torque + GEAR.viscous_friction * found.rate) / (GEAR.ratio * GEAR.efficiency)
    current = torque / MOTOR.torque_constant + MOTOR.no_load_current
    assert found.current == pytest.approx(current, rel=1e-9)
    terminals = MOTOR.resistance * current + MOTOR.torque_constant * shaft
    if found.rate < wanted * (1.0 - 1e-9):
        assert terminals == pytest.approx(voltage, rel=1e-9), "it turns as fast as the bus allows"
    else:
        assert found.rate == pytest.approx(wanted) and terminals <= voltage * (1.0 + 1e-9)
    assert found.electrical == pytest.approx(terminals * current, rel=1e-9)
    assert found.electrical == pytest.approx(found.winding_heat + found.friction_heat + load * found.rate, rel=1e-9)
    assert found.friction_heat >= -1e-12


def test_it_stalls_where_its_current_ends_and_starts_again_below() -> None:
    most = stall_torque(MOTOR, GEAR)
    assert most == pytest.approx(0.75 * 30.0 * 0.0234 * (1.2 - 0.0369) - 0.01)
    running = settled(30.0, 0.3)
    found = turn(running.rate, 30.0, 1.05 * most)
    while found.rate > 0.0:
        assert turn(found.rate, 30.0, 1.05 * most).rate < found.rate
        found = turn(found.rate, 30.0, 1.05 * most)
    found = turn(0.0, 30.0, 1.05 * most)
    assert found.stalled and found.current == pytest.approx(1.2)
    assert found.electrical == found.winding_heat == pytest.approx(2.32 * 1.2**2) and found.friction_heat == 0.0
    again = turn(0.0, 30.0, 0.9 * most)
    assert not again.stalled and again.rate > 0.0


def test_without_power_it_does_not_turn() -> None:
    assert turn(0.0, 30.0, 0.1, supply=0.0).rate == 0.0
    stopped = turn(0.5, 0.0, 0.1)
    assert stopped.rate == 0.0 and stopped.current == 0.0 and stopped.electrical == 0.0
