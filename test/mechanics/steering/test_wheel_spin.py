"""Wheels that spin at a step: the accelerometer knows the speed meanwhile."""

import math

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_mechanics.steering.kinematics import PlanarTwist, wheels_from_twist
from sojourn_mechanics.steering.wheel_spin import WheelSpinParams, WheelSpinState, rim_speed, step_spin

PARAMS = WheelSpinParams(gate=0.3, settling=0.5, longest=10.0)
GRAVITY, DT, TILT_ERROR = 1.62, 0.02, 0.003


def drive(spins: float, slip: float = 0.05, pitch: float = 0.0) -> tuple[float, float, list[float | None]]:
    """Speed up to 2 m/s, go on for 5 s, and hit a step: the body slows down to 0.5 m/s in 0.5 s, while the wheels turn
    on for `spins` seconds. Returns the way that is estimated after the step, the true one, and the slips told.
    """
    state, told = WheelSpinState(), []
    for _ in range(100):
        state, _ = step_spin(PARAMS, state, 0.0, slip, (GRAVITY * math.sin(-pitch), 0.0, GRAVITY), pitch, DT)
    speed = way = estimate = 0.0
    for period in range(round((8.0 + spins) / DT)):
        time = period * DT
        wanted = min(time, 2.0) if time < 7.0 else max(2.0 - 3.0 * (time - 7.0), 0.5)
        acceleration, speed = (wanted - speed) / DT, wanted
        rim = speed / (1.0 - slip) if time < 7.0 or time > 7.0 + spins else 2.0 / (1.0 - slip)
        force = (acceleration - GRAVITY * math.sin(pitch), 0.0, GRAVITY * math.cos(pitch))
        state, found = step_spin(PARAMS, state, rim, slip, force, pitch + TILT_ERROR, DT)
        told.append(found)
        if time >= 7.0:
            way += speed * DT
            estimate += rim * (1.0 - (slip if found is None else found)) * DT
    return estimate, way, told


@pytest.mark.parametrize("pitch", [0.0, -0.17, 0.1])
@pytest.mark.parametrize("spins", [2.0, 6.0])
def test_the_way_over_a_step_is_known_while_the_wheels_spin(spins: float, pitch: float) -> None:
    """Within what the tilt's error makes of it, and what the speed has followed the wheels before they were found to
    spin (they leave it at 3 m/s^2); by the wheels alone it would be metres too long."""
    estimate, way, told = drive(spins, pitch=pitch)
    followed = PARAMS.gate**2 / (2.0 * 3.0 * PARAMS.settling)
    assert abs(estimate - way) < 0.05 + followed * (spins + 1.0) + 0.5 * GRAVITY * TILT_ERROR * (spins + 1.0) ** 2
    assert all(slip is None for slip in told[: round(7.0 / DT)]), "speeding up and rolling is no spin"
    spinning = [slip for slip in told if slip is not None]
    assert len(spinning) * DT == pytest.approx(spins, abs=0.3)
    assert np.median(spinning) == pytest.approx(1.0 - 0.5 / (2.0 / 0.95), abs=0.08)
    assert told[-1] is None, "they grip again"


def test_the_accelerometer_is_not_believed_for_ever() -> None:
    _, _, told = drive(20.0)
    assert sum(slip is not None for slip in told) * DT <= PARAMS.longest + 2.0 * DT


def test_wheels_that_slip_slowly_and_machines_that_have_not_stood_are_left_alone() -> None:
    state = WheelSpinState()
    assert step_spin(PARAMS, state, 2.0, 0.0, (0.0, 0.0, GRAVITY), 0.0, DT) == (WheelSpinState(None, 2.0), None)
    state = WheelSpinState(GRAVITY, 2.0)
    for period in range(500):  # to 30 % more slip in 10 s
        rim = 2.0 / (1.0 - 0.3 * period / 500)
        state, slip = step_spin(PARAMS, state, rim, 0.0, (0.0, 0.0, GRAVITY), 0.0, DT)
        assert slip is None


@pytest.mark.parametrize("yaw_rate", [0.0, 0.3, -0.2])
def test_the_speed_of_the_rims_is_that_of_the_body(yaw_rate: float) -> None:
    """But for the way from the kingpins to the wheels, which makes 0.02 %."""
    table = load_scenario("flat_drive", ["rover=lrv"]).steering.table()
    wheels = wheels_from_twist(table, PlanarTwist(1.5, 0.0, yaw_rate), np.zeros(4))
    assert rim_speed(table, wheels.wheel_rates, wheels.steer_angles) == pytest.approx(1.5, rel=1e-3)
