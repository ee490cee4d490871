"""The energy of the joints' rotors and springs against the sum that it is."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_physics.actuators.joint_drive import ANGLE, MOTOR_RATE, SPRING_REST, SPRING_STIFFNESS
from sojourn_physics.plant.energy import mechanical_energy


@given(seed=st.integers(0, 2**32 - 1))
def test_rotors_and_springs_add_to_the_links(flat: Any, seed: int) -> None:
    model, state, numbers = flat.model, flat.start, np.random.default_rng(seed)
    velocity = numbers.normal(size=state.velocity.shape)
    joints = state.joints + numbers.normal(size=state.joints.shape)
    table, still = model.joints.parameters, np.zeros_like(state.joints)
    still[ANGLE] = table[:, SPRING_REST]
    links = mechanical_energy(model, state.configuration, np.zeros_like(velocity), still)
    moving = mechanical_energy(model, state.configuration, velocity, joints)
    kinetic = mechanical_energy(model, state.configuration, velocity, still) - links
    stretch = joints[ANGLE] - table[:, SPRING_REST]
    springs = 0.5 * np.sum(table[:, SPRING_STIFFNESS] * stretch**2)
    rotors = 0.5 * np.sum(model.joints.rotors * joints[MOTOR_RATE] ** 2)
    assert moving - links == pytest.approx(kinetic + springs + rotors, rel=1e-9)
    assert kinetic >= 0.5 * np.sum(model.joints.armature * velocity**2)
