"""What an IMU on the machine feels of its true motion."""

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.values import Odometry
from sojourn_sensors.motion import ImuMotion, rotation_vector

angles = st.floats(-3.0, 3.0)


@given(st.tuples(angles, angles, angles), st.tuples(angles, angles, angles), st.sampled_from([1e-8, 1e-3, 0.5]))
def test_the_rotation_vector_between_two_attitudes(
    start: tuple[float, float, float], turn: tuple[float, float, float], size: float
) -> None:
    before = pin.exp3(np.array(start))
    now = before @ pin.exp3(size * np.array(turn))
    first, second = (np.array(pin.Quaternion(rotation).coeffs()) for rotation in (before, now))
    expected = pin.log3(before.T @ now)
    np.testing.assert_allclose(rotation_vector(first, second), expected, atol=1e-8)
    np.testing.assert_allclose(rotation_vector(-first, second), expected, atol=1e-8)


def test_a_machine_that_shakes_within_a_period_does_not_seem_to_turn() -> None:
    """Yaw swings at 50 Hz: every sample is taken at the same rate, and their sum was a heading that ran away."""
    scenario, dt = load_scenario("flat_drive"), 0.02
    motion, turned = ImuMotion(scenario.urdf_xml, scenario.gravity_field), 0.0
    before = None
    for period in range(100):
        yaw, rate = 1e-3 * math.sin(100.0 * math.pi * period * dt), 0.1 * math.pi
        orientation, angular = np.array([0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)]), np.array([0.0, 0.0, rate])
        message = Odometry(0, "map", "base_link", np.zeros(3), orientation, np.zeros(3), angular)
        before, felt = motion.felt(before, message, dt)
        turned += felt.angular_velocity[2] * dt if period else 0.0
    assert turned == pytest.approx(0.0, abs=1e-9)
