"""Gears, backlash, harmonic drives, screws and brakes: work in, work out, and what is lost."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_mechanics.actuators import gear, harmonic_drive, screw
from sojourn_mechanics.actuators.brake import BrakeParams, BrakeState, step_brake
from sojourn_mechanics.actuators.harmonic_drive import HarmonicDriveParams, HarmonicDriveState
from sojourn_mechanics.errors import InvalidValueError

HARMONIC = HarmonicDriveParams(
    torque_1=14.0, torque_2=48.0, stiffness_1=8.1e3, stiffness_2=1.2e4, stiffness_3=1.6e4,
    hysteresis_torque=1.5, hysteresis_twist=1e-4,
)  # fmt: skip


@given(forward=st.floats(0.51, 1.0), torque=st.floats(0.1, 10.0), rate=st.floats(0.1, 10.0))
def test_a_gear_loses_power_in_both_senses(forward: float, torque: float, rate: float) -> None:
    backward = gear.backward_efficiency(forward)
    driving = gear.output_torque(torque, rate, 50.0, forward, backward) * rate / 50.0
    assert driving == pytest.approx(forward * torque * rate)
    if backward > 1e-6:
        # back-driven: the output brings more than the input takes
        brought = -gear.output_torque(torque, -rate, 50.0, forward, backward) * -rate / 50.0
        assert torque * rate == pytest.approx(backward * brought)
    # one loss for both senses: what is missing of the input's torque is the same
    assert torque * (1.0 - forward) / forward == pytest.approx(torque * (1.0 - backward), abs=1e-9)


def test_half_efficiency_locks() -> None:
    assert not gear.is_back_drivable(0.5) and gear.is_back_drivable(0.51)
    forward, backward = gear.stages([0.9, 0.9, 0.45])
    assert forward == pytest.approx(0.3645) and backward == 0.0
    with pytest.raises(InvalidValueError, match="locks"):
        gear.output_torque(1.0, -1.0, 10.0, 0.4, 0.0)


def test_play_has_the_width_of_its_gap() -> None:
    output, places = 0.0, []
    for position in np.concatenate([np.linspace(0, 1, 101), np.linspace(1, -1, 201), np.linspace(-1, 1, 201)]):
        output = gear.play(float(position), output, 0.1)
        places.append((position, output))
    path = np.array(places[101:])
    assert np.abs(path[:, 0] - path[:, 1]).max() <= 0.1 + 1e-12
    down = path[(np.abs(path[:, 0]) < 1e-9), 1]
    assert sorted(down)[0] == pytest.approx(-0.1) and sorted(down)[-1] == pytest.approx(0.1)


@given(twist=st.floats(-0.1, 0.1), rate=st.floats(-5.0, 5.0))
def test_teeth_push_and_do_not_pull(twist: float, rate: float) -> None:
    torque = gear.dead_band_torque(twist, rate, 0.01, 1e4, 10.0)
    assert torque * twist >= 0.0
    if abs(twist) < 0.01:
        assert torque == 0.0


@given(torque=st.floats(-200.0, 200.0))
def test_harmonic_stiffness_is_inverted(torque: float) -> None:
    twist = harmonic_drive.elastic_twist(HARMONIC, torque)
    assert harmonic_drive.elastic_torque(HARMONIC, twist) == pytest.approx(torque, abs=1e-9)


def test_a_harmonic_cycle_loses_four_times_its_friction() -> None:
    state, top = HarmonicDriveState(), 0.01
    path = np.concatenate([np.linspace(0, top, 500), np.linspace(top, -top, 1001), np.linspace(-top, top, 1001)])
    torques = []
    for twist in path:
        state, torque = harmonic_drive.step_twist(HARMONIC, state, float(twist))
        torques.append(torque)
    # one closed cycle
    cycle_twist = np.concatenate([path[500:], path[500:501]])
    cycle_torque = np.concatenate([torques[500:], torques[500:501]])
    work = np.sum(0.5 * (cycle_torque[1:] + cycle_torque[:-1]) * np.diff(cycle_twist))
    expected = 4.0 * 1.5 * top
    assert work == pytest.approx(expected, rel=0.05)


def test_harmonic_hysteresis_is_independent_of_the_steps() -> None:
    fine = coarse = HarmonicDriveState()
    for twist in np.linspace(0.0, 0.003, 301):
        fine, torque = harmonic_drive.step_twist(HARMONIC, fine, float(twist))
    coarse, other = harmonic_drive.step_twist(HARMONIC, coarse, 0.003)
    assert torque == pytest.approx(other)
    assert harmonic_drive.step_twist(HARMONIC, coarse, 0.003)[1] == other


@given(lead=st.floats(1e-3, 0.02), friction=st.floats(0.0, 0.3))
def test_screw_work(lead: float, friction: float) -> None:
    part = screw.Screw(lead, 0.02, friction, math.radians(15.0))
    if part.lead_angle + part.friction_angle >= 1.5:
        return
    force = 1000.0
    assert force * lead == pytest.approx(
        screw.raising_efficiency(part) * screw.raising_torque(part, force) * 2.0 * math.pi
    )
    held = screw.lowering_torque(part, force)
    assert screw.locks_itself(part) == (held >= 0.0)
    if not screw.locks_itself(part):
        assert -held * 2.0 * math.pi == pytest.approx(screw.back_driving_efficiency(part) * force * lead, rel=1e-6)
    # the forces on the inclined plane: raising against gravity and friction
    angle, rho = part.lead_angle, part.friction_angle
    normal = force / (math.cos(angle) - math.tan(rho) * math.sin(angle))
    along = normal * (math.sin(angle) + math.tan(rho) * math.cos(angle))
    assert screw.raising_torque(part, force) == pytest.approx(along * 0.01)


def test_ball_screw_and_rack() -> None:
    part = screw.ball_screw(0.005, 0.016, 0.9)
    assert screw.raising_efficiency(part) == pytest.approx(0.9)
    assert 0.8 < screw.back_driving_efficiency(part) < 0.9
    assert screw.rack_force(2.0, 0.02, 0.95) == pytest.approx(95.0)


def test_brake_stops_and_its_heat_is_the_energy() -> None:
    brake = BrakeParams(holding_torque=2.0, closing_time=0.0)
    state, rate, inertia = BrakeState(closed=0.0), 30.0, 0.01
    steps = 0
    while rate > 0.0 and steps < 10_000:
        state, rate = step_brake(brake, state, True, rate, 0.5, inertia, 1e-4)
        steps += 1
    assert rate == 0.0
    # deceleration (0.85 x 2 - 0.5)/I
    assert steps * 1e-4 == pytest.approx(30.0 / ((1.7 - 0.5) / inertia), rel=1e-3)
    work_of_load = 0.5 * 0.5 * 30.0 * steps * 1e-4
    assert state.heat == pytest.approx(0.5 * inertia * 30.0**2 + work_of_load, rel=5e-3)


def test_brake_holds_up_to_its_torque() -> None:
    brake = BrakeParams(holding_torque=2.0)
    state, rate = step_brake(brake, BrakeState(), True, 0.0, 1.99, 0.01, 1e-3)
    assert rate == 0.0
    state, rate = step_brake(brake, BrakeState(), True, 0.0, -2.5, 0.01, 1e-3)
    assert rate < 0.0
    state, rate = step_brake(brake, BrakeState(), False, 0.0, 1.5, 0.01, 0.03)
    assert state.closed == pytest.approx(0.0) and rate > 0.0
    # a shaft that would turn round within the step comes to rest
    _, rate = step_brake(brake, BrakeState(), True, 0.01, -1.0, 0.01, 1e-3)
    assert rate == 0.0


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="forward"):
        gear.backward_efficiency(0.0)
    with pytest.raises(InvalidValueError, match="position"):
        gear.play(math.nan, 0.0, 0.1)
    with pytest.raises(InvalidValueError, match="twist"):
        harmonic_drive.step_twist(HARMONIC, HarmonicDriveState(), math.inf)
    with pytest.raises(ValueError, match="torque_1"):
        HarmonicDriveParams.model_validate(HARMONIC.model_dump() | {"torque_1": 100.0})
    with pytest.raises(InvalidValueError, match="screw"):
        screw.raising_torque(screw.Screw(0.0, 0.01, 0.1), 1.0)
    with pytest.raises(InvalidValueError, match="efficiency"):
        screw.ball_screw(0.005, 0.01, 0.0)
    with pytest.raises(InvalidValueError, match="pinion"):
        screw.rack_force(1.0, 0.0)
    with pytest.raises(InvalidValueError, match="rate"):
        step_brake(BrakeParams(holding_torque=1.0), BrakeState(), True, math.nan, 0.0, 1.0, 1.0)
    with pytest.raises(InvalidValueError, match="inertia"):
        step_brake(BrakeParams(holding_torque=1.0), BrakeState(), True, 0.0, 0.0, 0.0, 1.0)
