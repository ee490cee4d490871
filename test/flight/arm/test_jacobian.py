"""Forward kinematics, Jacobian and measures of every arm against Pinocchio and finite differences."""

import numpy as np
import pinocchio
import pytest
from scipy.spatial.transform import Rotation

from sojourn_config.arms import load_arm
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.manipulability import (
    condition_number,
    largest_force,
    manipulability,
    smallest_singular_value,
)
from sojourn_flight.arm.serial_arm import SerialArm


def test_jacobian_is_the_derivative_of_the_tip(named_arm: SerialArm) -> None:
    generator, h = np.random.default_rng(2), 1e-6
    for _ in range(5):
        q = generator.uniform(named_arm.lower, named_arm.upper)
        jacobian = forward_kinematics(named_arm, q).jacobian
        for i in range(named_arm.joint_count):
            step = np.zeros(named_arm.joint_count)
            step[i] = h
            ahead, behind = forward_kinematics(named_arm, q + step), forward_kinematics(named_arm, q - step)
            velocity = (ahead.position - behind.position) / (2 * h)
            turn = Rotation.from_matrix(ahead.rotation @ behind.rotation.T).as_rotvec() / (2 * h)
            np.testing.assert_allclose(jacobian[:3, i], velocity, atol=1e-8 * max(named_arm.reach, 1.0))
            np.testing.assert_allclose(jacobian[3:, i], turn, atol=1e-8)


def test_tip_and_jacobian_are_those_of_pinocchio(named_arm: SerialArm) -> None:
    model, data = named_arm.pinocchio_model, named_arm.data
    generator = np.random.default_rng(4)
    frame = model.getFrameId(named_arm.tip_link)
    for _ in range(10):
        q = generator.uniform(named_arm.lower, named_arm.upper)
        tip = forward_kinematics(named_arm, q)
        expected = pinocchio.computeFrameJacobian(model, data, q, frame, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        pinocchio.framesForwardKinematics(model, data, q)
        np.testing.assert_allclose(tip.position, data.oMf[frame].translation, atol=1e-12 * max(named_arm.reach, 1.0))
        np.testing.assert_allclose(tip.rotation, data.oMf[frame].rotation, atol=1e-12)
        np.testing.assert_allclose(tip.jacobian, expected, atol=1e-12 * max(named_arm.reach, 1.0))


@pytest.mark.published("SRMS, from the lengths of its links")
def test_srms_is_where_its_publication_puts_it() -> None:
    srms = load_arm("srms")
    zero = forward_kinematics(srms, np.zeros(6)).position
    assert zero == pytest.approx(np.array([15.3166, 0.0, -1.1268]), abs=1e-9)
    bent = forward_kinematics(srms, np.radians([0, 30, -60, 30, 0, 0])).position
    assert bent == pytest.approx(np.array([13.5164, 0.0, -0.7445]), abs=1e-4)


def test_measures_of_a_puma_stretched_and_bent() -> None:
    puma = load_arm("puma560")
    bent = forward_kinematics(puma, np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0])).jacobian
    assert manipulability(bent) == pytest.approx(np.sqrt(np.linalg.det(bent @ bent.T)), rel=1e-9)
    assert condition_number(puma, bent) > 1.0
    straight = np.array([0.3, 0.4, -0.5, 0.2, 0.0, 0.1])  # axes 4 and 6 on one line
    jacobian = forward_kinematics(puma, straight).jacobian
    assert manipulability(jacobian) < 1e-12 and smallest_singular_value(puma, jacobian) < 1e-12


def test_largest_force_loads_one_joint_to_its_limit() -> None:
    puma = load_arm("puma560")
    jacobian = forward_kinematics(puma, np.array([0.1, 0.6, -2.8, 0.3, 0.8, 0.0])).jacobian
    gravity = np.array([0.0, 30.0, 6.0, 0.0, 0.03, 0.0])
    for direction in np.eye(3):
        force = largest_force(puma, jacobian, gravity, direction)
        torque = gravity + jacobian[:3].T @ (force * direction)
        assert np.max(np.abs(torque) / puma.max_effort) == pytest.approx(1.0, rel=1e-9)
    assert largest_force(puma, jacobian, gravity * 100.0, np.eye(3)[0]) == 0.0
