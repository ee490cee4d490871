"""Springs, dampers and series motors in a joint's drive: closed forms, the motor's own model, energy."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from joint_bench import Bench

from sojourn_machine.drives import SeriesMotorParams
from sojourn_physics.actuators import joint_drive as jd
from sojourn_physics.actuators.series_motor import series_largest_torque, series_working_point

# --- springs and dampers ---


def test_a_sprung_joint_swings_at_its_frequency_and_loses_nothing() -> None:
    """T = 2 pi sqrt(J/k); the energy of spring and flywheel stays."""
    bench = Bench(kind=jd.PASSIVE, inertia=2.0, spring=130.0, rest=-0.2)
    bench.states[0, 0] = 0.1
    start = 0.5 * 130.0 * 0.3**2
    passages, energies, before = [], [], 0.1
    for step in range(4000):
        bench.step()
        angle = float(bench.states[0, 0])
        energies.append(0.5 * 2.0 * bench.rate**2 + 0.5 * 130.0 * (angle + 0.2) ** 2)
        if (angle + 0.2) * (before + 0.2) < 0.0:
            passages.append(step * bench.dt)
        before = angle
    half_periods = np.diff(passages)
    assert np.mean(half_periods) == pytest.approx(math.pi * math.sqrt(2.0 / 130.0), rel=2e-3)
    assert max(energies) == pytest.approx(start, rel=5e-3)  # it swings by half of dt k/J's root, and stays
    assert np.mean(energies[-779:]) == pytest.approx(start, rel=2e-4)  # one period


def test_what_a_damper_takes_is_friction_heat() -> None:
    bench = Bench(kind=jd.PASSIVE, inertia=2.0, spring=130.0, viscous=8.0)
    bench.states[0, 0] = 0.3
    decay = 8.0 / (2.0 * 2.0)
    bench.step(1000)
    left = 0.5 * 2.0 * bench.rate**2 + 0.5 * 130.0 * float(bench.states[0, 0]) ** 2
    start = 0.5 * 130.0 * 0.3**2
    assert bench.energy[2] == pytest.approx(start - left, rel=5e-3)
    frequency = math.sqrt(130.0 / 2.0 - decay**2)
    wanted = 0.3 * math.exp(-decay) * (math.cos(frequency) + decay / frequency * math.sin(frequency))
    assert float(bench.states[0, 0]) == pytest.approx(wanted, abs=2e-3 * 0.3)


def test_a_spring_at_rest_carries_its_load_for_ever() -> None:
    bench = Bench(kind=jd.PASSIVE, inertia=2.0, spring=130.0, viscous=10.0, friction=0.2, rest=-0.25, load=33.0)
    bench.step(20_000)
    held = float(bench.states[0, 0])
    assert abs(130.0 * (held + 0.25) - 33.0) <= 0.2 * 1.01
    bench.step(20_000)
    assert float(bench.states[0, 0]) == pytest.approx(held, abs=1e-9)
    assert bench.effort == pytest.approx(-33.0, rel=1e-6)


# --- series motor ---

LRV = SeriesMotorParams(
    series_resistance=0.555, field_constant=0.005546, saturation_current=40.0, rotor_inertia=1e-4, friction_torque=0.01,
    viscous_friction=1.175e-5, max_current=40.0,
)  # fmt: skip


def series(**options: float) -> Bench:
    """The motor of the lunar roving vehicle behind its gear, at full rate."""
    bench = Bench(
        ratio=80.0, resistance=0.555, torque_constant=0.005546, saturation=40.0, max_current=40.0, voltage=36.0,
        friction=0.01 * 80.0, viscous=1.175e-5 * 80.0**2, rotor=1e-4, proportional=60.0, **options,  # type: ignore[arg-type]
    )  # fmt: skip
    bench.command[1, 0] = 1e3
    return bench


@pytest.mark.parametrize("load", [5.0, 12.0, 40.0, 100.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_series_motor_at_full_voltage_is_on_its_curve(load: float, sense: float) -> None:
    """The rate at which the model of `series_motor`, which is another piece of code, has this torque at 36 V."""
    bench = series(load=-load * sense, inertia=1.0)
    bench.command[1, 0] *= sense
    bench.step(20_000)
    assert bench.rate * sense > 0.0
    torque = series_largest_torque(LRV, abs(bench.rate) * 80.0, 36.0)
    assert torque * 80.0 == pytest.approx(load, rel=1e-4)
    point = series_working_point(LRV, load / 80.0, abs(bench.rate) * 80.0)
    assert abs(bench.current) == pytest.approx(point.current, rel=1e-3)
    assert bench.power == pytest.approx(point.power, rel=1e-3)


def test_a_series_motor_keeps_its_rate_and_its_current_limit() -> None:
    bench = series(load=-12.0, inertia=1.0, integral=60.0)
    bench.command[1, 0] = 7.0
    bench.step(20_000)
    assert bench.rate == pytest.approx(7.0, rel=1e-3)
    stalled = series(inertia=1e9, fraction=0.5)
    stalled.step()
    assert stalled.current == pytest.approx(20.0, rel=1e-6)
    assert stalled.effort == pytest.approx(80.0 * 0.005546 * 400.0 / 1.5, rel=0.02)


@pytest.mark.parametrize("fraction", [1.0, 0.0])
def test_a_series_motor_does_not_brake_its_brake_does(fraction: float) -> None:
    """Told to stand, or without power: the brake stops the wheel, its work is heat, nothing goes back to the bus."""
    bench = series(inertia=3.0, integral=60.0, max_torque=120.0, fraction=fraction)
    bench.velocity[0] = 7.0
    bench.command[1, 0] = 0.0 if fraction else 7.0
    bench.load = 10.0
    bench.step(20_000)
    held = float(bench.states[0, 0])
    assert abs(bench.rate) < 1e-6
    bench.step(20_000)
    assert float(bench.states[0, 0]) == pytest.approx(held, abs=1e-5)
    assert bench.energy[0] == 0.0
    assert bench.current == 0.0
    kinetic = 0.5 * (3.0 + 1e-4 * 80.0**2) * 7.0**2
    assert bench.energy[2] == pytest.approx(kinetic + bench.work, rel=1e-2)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 100.0), st.floats(-12.0, 12.0), st.floats(-12.0, 12.0), st.floats(0.0, 1.0))
def test_the_account_of_a_series_drive_is_balanced(load: float, start: float, wanted: float, fraction: float) -> None:
    bench = series(inertia=3.0, integral=60.0, max_torque=120.0, load=-load, fraction=fraction, efficiency=0.75)
    bench.velocity[0], bench.command[1, 0] = start, wanted
    inertia = 3.0 + 1e-4 * 80.0**2
    bench.step(1500)
    electrical, winding, friction, stop = bench.energy
    gain = 0.5 * inertia * (bench.rate**2 - start**2)
    size = max(abs(electrical), abs(winding), abs(friction), abs(gain), abs(bench.work), 1e-3)
    assert electrical + bench.work - winding - friction - stop - gain == pytest.approx(0.0, abs=1e-6 * size)
    assert electrical >= -1e-9 * size
