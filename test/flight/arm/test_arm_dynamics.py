"""Dynamics: the PUMA's published figures, and every law by a second route."""

import math

import numpy as np
import pinocchio
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from frictionless import no_friction
from sojourn_config.arms import load_arm
from sojourn_flight.arm.dynamics import (
    BaseMotion,
    coriolis_effort,
    effort_of_wrench,
    gravity_effort,
    inverse_dynamics,
    mass_matrix,
    rigid_effort,
)
from sojourn_flight.arm.friction import JointFriction, friction_effort
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.serial_arm import SerialArm, with_motors, with_payload, with_scaled_masses
from sojourn_machine.errors import InvalidValueError

Array = NDArray[np.float64]
EARTH = np.array([0.0, 0.0, -9.81])
NOMINAL = np.array([0.0, math.pi / 4, math.pi, 0.0, math.pi / 4, 0.0])


@pytest.mark.published
def test_the_puma_has_its_published_figures() -> None:
    """Corke & Armstrong-Helouvry 1994, at the nominal pose of Corke's toolbox."""
    puma = load_arm("puma560")
    position, effort = forward_kinematics(puma, NOMINAL).position, gravity_effort(puma, NOMINAL, EARTH)
    assert position == pytest.approx(np.array([0.5963, -0.1501, 0.6576]), abs=1e-4)
    assert effort == pytest.approx(np.array([0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0]), abs=1e-4)
    matrix = mass_matrix(puma, NOMINAL)
    published = {(0, 0): 3.6594, (0, 1): -0.4044, (0, 2): 0.1006, (1, 1): 4.4137, (1, 2): 0.3509, (2, 2): 0.9378}
    for (row, column), value in published.items():
        assert matrix[row, column] == pytest.approx(value, abs=1e-4)
        assert matrix[column, row] == matrix[row, column]


def _potential(arm: SerialArm, q: Array, gravity: Array) -> float:
    """Energy of position from the places of the links' centres of mass, by the chain alone [J]."""
    rotation, position, energy = np.eye(3), np.zeros(3), 0.0
    for i in range(arm.joint_count):
        position = position + rotation @ arm.chain.translation[i]
        rotation = rotation @ arm.chain.rotation[i]
        if arm.chain.revolute[i] > 0.5:
            rotation = rotation @ Rotation.from_rotvec(arm.chain.axis[i] * q[i]).as_matrix()
        else:
            position = position + rotation @ arm.chain.axis[i] * q[i]
        body = arm.pinocchio_model.inertias[i + 1]
        energy -= body.mass * float(gravity @ (position + rotation @ body.lever))
    return energy


def test_gravity_effort_is_the_slope_of_the_energy(named_arm: SerialArm) -> None:
    generator = np.random.default_rng(1)
    gravity = np.array([1.0, -2.0, -3.0])
    for _ in range(3):
        q = generator.uniform(named_arm.lower, named_arm.upper)
        slope = np.empty(named_arm.joint_count)
        for i, step in enumerate(np.eye(named_arm.joint_count) * 1e-5):
            slope[i] = (_potential(named_arm, q + step, gravity) - _potential(named_arm, q - step, gravity)) / 2e-5
        scale = max(1.0, float(np.max(np.abs(slope))))
        np.testing.assert_allclose(gravity_effort(named_arm, q, gravity), slope, atol=1e-6 * scale)


def test_lagrange_from_the_mass_matrix_gives_the_coriolis_effort(named_arm: SerialArm) -> None:
    """c = dM/dt qd - 1/2 d(qd' M qd)/dq, by finite differences of M."""
    generator, n, h = np.random.default_rng(6), named_arm.joint_count, 1e-6
    q, qd = generator.uniform(named_arm.lower, named_arm.upper), generator.uniform(-1, 1, n)
    slopes = [(mass_matrix(named_arm, q + s) - mass_matrix(named_arm, q - s)) / (2 * h) for s in np.eye(n) * h]
    rate = sum(slope * speed for slope, speed in zip(slopes, qd, strict=True))
    expected = rate @ qd - 0.5 * np.array([qd @ slope @ qd for slope in slopes])
    scale = max(1.0, float(np.max(np.abs(expected))))
    np.testing.assert_allclose(coriolis_effort(named_arm, q, qd), expected, atol=1e-6 * scale)


def forward_dynamics(
    arm: SerialArm,
    positions: Array,
    velocities: Array,
    efforts: Array,
    gravity: Array,
    tip_wrench: Array | None = None,
) -> Array:
    """Joint accelerations (n,) [rad/s2 or m/s2] under `efforts` (n,) of the drives. Arguments as above."""
    net = efforts - friction_effort(arm.friction, velocities)
    if tip_wrench is not None:
        net = net + effort_of_wrench(arm, positions, tip_wrench)
    arm.pinocchio_model.gravity.linear = gravity
    return np.array(pinocchio.aba(arm.pinocchio_model, arm.data, positions, velocities, net))


def test_the_parts_add_up_and_forward_undoes_inverse(named_arm: SerialArm) -> None:
    generator, n = np.random.default_rng(9), named_arm.joint_count
    q = generator.uniform(named_arm.lower, named_arm.upper)
    qd, qdd, wrench = generator.uniform(-0.5, 0.5, n), generator.uniform(-1, 1, n), generator.uniform(-5, 5, 6)
    parts = mass_matrix(named_arm, q) @ qdd + coriolis_effort(named_arm, q, qd) + gravity_effort(named_arm, q, EARTH)
    np.testing.assert_allclose(rigid_effort(named_arm, q, qd, qdd, EARTH), parts, rtol=1e-9, atol=1e-8)
    effort = inverse_dynamics(named_arm, q, qd, qdd, EARTH, wrench)
    np.testing.assert_allclose(forward_dynamics(named_arm, q, qd, effort, EARTH, wrench), qdd, atol=1e-7)


def test_energy_is_kept_while_a_puma_without_friction_falls() -> None:
    puma = load_arm("puma560")
    free = with_motors(puma, puma.motor_inertia, no_friction(6))

    def energy(q: Array, qd: Array) -> float:
        return 0.5 * float(qd @ mass_matrix(free, q) @ qd) + _potential(free, q, EARTH)

    def rate(_time: float, state: Array) -> Array:
        return np.concatenate([state[6:], forward_dynamics(free, state[:6], state[6:], np.zeros(6), EARTH)])

    start = np.concatenate([[0.3, 0.2, -2.0, 0.4, 0.5, 0.1], np.zeros(6)])
    end = solve_ivp(rate, (0.0, 1.0), start, rtol=1e-9, atol=1e-9).y[:, -1]
    assert 0.5 * float(end[6:] @ mass_matrix(free, end[:6]) @ end[6:]) > 5.0
    assert energy(end[:6], end[6:]) == pytest.approx(energy(start[:6], start[6:]), abs=1e-5)


def test_a_tip_force_and_its_joint_efforts_have_one_power(named_arm: SerialArm) -> None:
    generator, n = np.random.default_rng(12), named_arm.joint_count
    q = generator.uniform(named_arm.lower, named_arm.upper)
    wrench, motion = generator.uniform(-10, 10, 6), generator.uniform(-1, 1, n)
    effort = effort_of_wrench(named_arm, q, wrench)
    # power on the tip is power at the joints
    assert float(effort @ motion) == pytest.approx(float(wrench @ forward_kinematics(named_arm, q).jacobian @ motion))


def test_a_payload_weighs_at_the_tip() -> None:
    puma = load_arm("puma560")
    loaded = with_payload(puma, 3.0)
    extra = gravity_effort(loaded, NOMINAL, EARTH) - gravity_effort(puma, NOMINAL, EARTH)
    weight = np.array([0.0, 0.0, -3.0 * 9.81, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(extra, -effort_of_wrench(puma, NOMINAL, weight), atol=1e-9)
    # off the tip's axis, with an inertia of its own: kinetic energy of the body alone
    body, com = np.diag([0.02, 0.03, 0.04]), (0.1, 0.0, 0.2)
    loaded = with_payload(puma, 3.0, com, body)
    q, qd = np.array([0.2, 0.7, -2.4, 0.3, 0.6, 0.4]), np.array([0.3, -0.5, 0.7, 1.0, -1.0, 0.5])
    tip = forward_kinematics(puma, q)
    turn = tip.jacobian[3:] @ qd
    speed = tip.jacobian[:3] @ qd + np.cross(turn, tip.rotation @ com)
    energy = 0.5 * 3.0 * float(speed @ speed) + 0.5 * float(turn @ tip.rotation @ body @ tip.rotation.T @ turn)
    difference = qd @ (mass_matrix(loaded, q) - mass_matrix(puma, q)) @ qd
    assert 0.5 * float(difference) == pytest.approx(energy, rel=1e-9)
    assert np.allclose(gravity_effort(puma, NOMINAL, EARTH)[1], 31.6399, atol=1e-4)  # the arm itself is as it was
    with pytest.raises(InvalidValueError, match="payload"):
        with_payload(puma, -1.0)


def test_an_accelerated_base_is_felt_as_gravity() -> None:
    puma = load_arm("puma560")
    q, qd, qdd = np.array([0.2, 0.7, -2.4, 0.3, 0.6, 0.4]), np.full(6, 0.3), np.full(6, -0.4)
    acceleration = np.array([0.5, -0.3, 0.2])
    moved = inverse_dynamics(puma, q, qd, qdd, EARTH, base=BaseMotion(np.zeros(3), acceleration, np.zeros(3)))
    np.testing.assert_allclose(moved, inverse_dynamics(puma, q, qd, qdd, EARTH - acceleration), atol=1e-9)


def test_a_base_that_turns_like_joint_1_is_joint_1() -> None:
    """The PUMA's waist is upright: a base turning about it is the waist turning, but for its own rotor and friction."""
    puma = load_arm("puma560")
    q = np.array([0.2, 0.7, -2.4, 0.3, 0.6, 0.4])
    qd, qdd = np.array([0.0, 0.2, -0.3, 0.4, 0.1, 0.2]), np.array([0.0, 0.5, 0.3, -0.2, 0.1, 0.3])
    rate, change = 0.6, -0.8
    base = BaseMotion(np.array([0, 0, rate]), np.zeros(3), np.array([0, 0, change]))
    on_base = inverse_dynamics(puma, q, qd, qdd, EARTH, base=base)
    turn, speed_up = np.array([rate, 0, 0, 0, 0, 0]), np.array([change, 0, 0, 0, 0, 0])
    by_joint = inverse_dynamics(puma, q, qd + turn, qdd + speed_up, EARTH)
    np.testing.assert_allclose(on_base[1:], by_joint[1:], atol=1e-9)
    own = puma.motor_inertia[0] * change + friction_effort(puma.friction, turn)[0]
    assert on_base[0] == pytest.approx(by_joint[0] - own, abs=1e-9)


def test_wrong_masses_scale_gravity_and_leave_rotors() -> None:
    puma = load_arm("puma560")
    heavy = with_scaled_masses(puma, np.full(6, 1.2))
    np.testing.assert_allclose(
        gravity_effort(heavy, NOMINAL, EARTH), 1.2 * gravity_effort(puma, NOMINAL, EARTH), atol=1e-9
    )
    rotors = np.diag(puma.motor_inertia)
    np.testing.assert_allclose(
        mass_matrix(heavy, NOMINAL) - rotors, 1.2 * (mass_matrix(puma, NOMINAL) - rotors), atol=1e-9
    )


def test_friction_has_its_three_parts() -> None:
    one = np.ones(1)
    friction = JointFriction(2.0 * one, 5.0 * one, 4.0 * one, 3.0 * one, 0.1 * one)
    assert friction_effort(friction, np.zeros(1))[0] == 0.0
    # breakaway: sliding and what is above it
    assert friction_effort(friction, np.array([0.005]))[0] == pytest.approx(5.0 + 3.0 + 0.01, abs=0.02)
    # Stribeck: at its velocity the excess has faded to 1/e
    assert friction_effort(friction, np.array([0.1]))[0] == pytest.approx(5.0 + 3.0 / math.e + 0.2, rel=1e-9)
    # fast: Coulomb and viscous, backward with its own value
    assert friction_effort(friction, np.array([2.0]))[0] == pytest.approx(9.0, rel=1e-9)
    assert friction_effort(friction, np.array([-2.0]))[0] == pytest.approx(-8.0, rel=1e-9)
    with pytest.raises(InvalidValueError, match="friction viscous"):
        JointFriction(-one, one, one, one, one)


def test_friction_takes_energy_whatever_the_speed() -> None:
    puma = load_arm("puma560")
    for speed in np.linspace(-2, 2, 41):
        assert np.all(friction_effort(puma.friction, np.full(6, speed)) * speed >= 0.0)
    # Corke's figures at the motor's shaft, carried to the joint by the gear
    assert friction_effort(puma.friction, np.full(6, 1.0))[1] == pytest.approx(107.815 * (0.126 + 0.817e-3 * 107.815))
