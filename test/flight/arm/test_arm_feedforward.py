"""Feed-forward efforts against energy: potential energy, power balance, and other libraries' rotations."""

from typing import Any

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_flight.arm.dynamics import gravity_effort, rigid_effort
from sojourn_flight.arm.feedforward import (
    feedforward_effort,
    friction_effort,
    gravity_in_body,
)
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.trajectory import at_rest, point_to_point
from sojourn_machine.errors import InvalidValueError

SEEDS = st.integers(min_value=0, max_value=2**32 - 1)


def _potential_energy(model: Any, posture: Any, gravity: Any) -> float:
    """Sum of -m g . c over the moving links, from their placements."""
    pinocchio.forwardKinematics(model.pinocchio_model, model.data, posture)
    energy = 0.0
    for i in range(1, model.pinocchio_model.njoints):
        inertia = model.pinocchio_model.inertias[i]
        energy -= inertia.mass * float(gravity @ model.data.oMi[i].act(inertia.lever))
    return energy


@given(seed=SEEDS)
@settings(max_examples=25, deadline=None)
def test_gravity_effort_is_the_slope_of_the_potential_energy(small: Any, explorer: Any, seed: int) -> None:
    generator = np.random.default_rng(seed)
    for arm in (small, explorer):
        posture = arm.random_posture(generator)
        gravity = gravity_in_body(Rotation.from_rotvec(generator.uniform(-0.5, 0.5, 3)).as_quat(), 3.71)
        slope = np.empty(5)
        for i in range(5):
            step = np.zeros(5)
            step[i] = 1e-5
            ahead = _potential_energy(arm.model, posture + step, gravity)
            slope[i] = (ahead - _potential_energy(arm.model, posture - step, gravity)) / 2e-5
        np.testing.assert_allclose(gravity_effort(arm.model, posture, gravity), slope, atol=1e-6)


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_power_of_the_efforts_is_the_growth_of_the_energy(explorer: Any, seed: int) -> None:
    generator = np.random.default_rng(seed)
    model, gravity = explorer.model, np.array([0.3, -0.2, -1.6])
    path = point_to_point(model, at_rest(explorer.random_posture(generator)), explorer.random_posture(generator))

    def energy(t: float) -> float:
        q, qd, _ = path.sample(t)
        mass = pinocchio.crba(model.pinocchio_model, model.data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        return 0.5 * float(qd @ mass @ qd) + _potential_energy(model, q, gravity)

    for fraction in (0.2, 0.5, 0.8):
        t, h = fraction * path.duration, 1e-4
        q, qd, qdd = path.sample(t)
        power = float(rigid_effort(model, q, qd, qdd, gravity) @ qd)
        assert power == pytest.approx((energy(t + h) - energy(t - h)) / (2.0 * h), abs=1e-5)


def test_reflected_inertia_adds_its_torque(small: Any, small_urdf: str, small_values: dict[str, Any]) -> None:
    geared = ArmParams(**{**small_values, "reflected_inertia": (3.0, 2.0, 1.0, 0.5, 0.25)})
    model = build_arm_model(small_urdf, geared)
    posture, rates, accelerations = np.full(5, 0.3), np.full(5, 0.2), np.array([1.0, -1.0, 0.5, 0.4, -0.8])
    gravity = np.array([0.0, 0.0, -9.81])
    difference = rigid_effort(model, posture, rates, accelerations, gravity) - rigid_effort(
        small.model, posture, rates, accelerations, gravity
    )
    np.testing.assert_allclose(difference, np.array([3.0, -2.0, 0.5, 0.2, -0.2]), atol=1e-9)


@given(seed=SEEDS)
@settings(max_examples=25, deadline=None)
def test_gravity_direction_follows_the_attitude(seed: int) -> None:
    rotation = Rotation.from_quat(np.random.default_rng(seed).normal(size=4))
    expected = rotation.inv().apply([0.0, 0.0, -1.62])
    np.testing.assert_allclose(gravity_in_body(rotation.as_quat(), 1.62), expected, atol=1e-12)


def test_nose_up_tilts_gravity_backward() -> None:
    # REP 103: pitch about +y is nose down, so nose up by 0.2 rad is a rotation of -0.2 rad.
    gravity = gravity_in_body(Rotation.from_euler("y", -0.2).as_quat(), 1.62)
    assert gravity[0] == pytest.approx(-1.62 * np.sin(0.2))
    assert gravity[2] == pytest.approx(-1.62 * np.cos(0.2))


@pytest.mark.parametrize(
    ("quaternion", "gravity", "text"),
    [
        ([0.0, 0.0, 0.0, 0.0], 1.62, "unit quaternion"),
        ([np.nan, 0.0, 0.0, 1.0], 1.62, "finite"),
        ([0.0, 0.0, 0.0, 1.0], -1.0, "gravity"),
    ],
)
def test_bad_attitude_or_gravity_is_refused(quaternion: list[float], gravity: float, text: str) -> None:
    with pytest.raises(InvalidValueError, match=text):
        gravity_in_body(np.array(quaternion), gravity)


def test_friction_is_odd_and_bounded(small_values: dict[str, Any]) -> None:
    params = ArmParams(**{**small_values, "coulomb_friction": (2.0,) * 5, "viscous_friction": (10.0,) * 5})
    rates = np.array([0.0, 0.5, -0.5, 0.005, -0.005])
    effort = friction_effort(params, rates)
    np.testing.assert_allclose(effort[1], 2.0 + 5.0, atol=1e-9)
    np.testing.assert_allclose(effort[2], -effort[1])
    np.testing.assert_allclose(effort[3], 2.0 * np.tanh(1.0) + 0.05)
    assert effort[0] == 0.0


def test_feedforward_is_cut_to_the_urdf_limits(small: Any) -> None:
    rigid = rigid_effort(small.model, np.zeros(5), np.zeros(5), np.full(5, 1e4), np.array([0.0, 0.0, -9.81]))
    effort = feedforward_effort(small.params, small.model, np.zeros(5), rigid)
    assert float(np.max(np.abs(effort))) <= 80.0
