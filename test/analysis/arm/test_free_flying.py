"""An arm on a spacecraft that floats free: its analysis against closed forms, and against the plant that moves it."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from sojourn_analysis.arm.free_flying import free_flying_arm, manipulability, momentum
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.params import SimulationParams
from sojourn_physics.plant.state import PlantState, zeros_command
from sojourn_physics.plant.step import initial_state, step

ANGLES = st.floats(-math.pi, math.pi)
MASSES = (40.0, 4.0, 3.0)
"""Of a planar spacecraft, its upper arm, its forearm [kg]."""
INERTIAS = (6.667, 0.333, 0.25)
BEFORE = (0.5, 0.5)
"""From the joint to the centre of mass of a link [m]."""
BEYOND = (0.5, 0.5, 0.5)
"""From the centre of mass to the next joint, or to the tip [m]."""
PLANAR = np.ix_([0, 1], [0, 1])


@lru_cache
def planar() -> pin.Model:
    model = pin.Model()
    at, joint, place = 0, pin.JointModelFreeFlyer(), np.zeros(3)
    for link in range(3):
        at = model.addJoint(at, joint, pin.SE3(np.eye(3), place), f"joint_{link}")
        centre = np.array([BEFORE[link - 1] if link else 0.0, 0.0, 0.0])
        inertia = pin.Inertia(MASSES[link], centre, np.diag([0.1, INERTIAS[link], INERTIAS[link]]))
        model.appendBodyToJoint(at, inertia, pin.SE3.Identity())
        joint, place = pin.JointModelRZ(), centre + np.array([BEYOND[link], 0.0, 0.0])
    model.addFrame(pin.Frame("tip", at, 0, pin.SE3(np.eye(3), place), pin.FrameType.OP_FRAME))
    return model


def planar_closed_form(first: float, second: float) -> FloatArray:
    """Generalised Jacobian of the tip in the plane, by barycentric vectors (Papadopoulos & Dubowsky 1993): (2, 2)."""
    m0, m1, m2 = MASSES
    total, (l1, l2), (r0, r1, r2) = sum(MASSES), BEFORE, BEYOND
    lengths = np.array([m0 * r0, l1 * m0 + r1 * (m0 + m1), l2 * (m0 + m1) + r2 * total]) / total
    d00 = INERTIAS[0] + m0 * (m1 + m2) / total * r0**2
    d11 = INERTIAS[1] + (m0 * m1 * l1**2 + m1 * m2 * r1**2 + m0 * m2 * (l1 + r1) ** 2) / total
    d22 = INERTIAS[2] + m2 * (m0 + m1) / total * l2**2
    d01 = r0 / total * (l1 * m0 * (m1 + m2) + r1 * m0 * m2) * math.cos(first)
    d12 = (l1 * l2 * m0 * m2 + r1 * l2 * m2 * (m0 + m1)) / total * math.cos(second)
    d02 = m0 * m2 / total * r0 * l2 * math.cos(first + second)
    shares = np.array([d00 + d01 + d02, d01 + d11 + d12, d02 + d12 + d22])  # momentum for the rate of each link
    of_joint = np.array([shares[1] + shares[2], shares[2]])
    base = -of_joint / shares.sum()
    angles = np.array([0.0, first, first + second])
    of_link = lengths * np.array([-np.sin(angles), np.cos(angles)])  # tip over the common centre of mass
    return np.column_stack([
        of_link.sum(axis=1) * base[0] + of_link[:, 1] + of_link[:, 2],
        of_link.sum(axis=1) * base[1] + of_link[:, 2],
    ])  # fmt: skip


def planar_arm(first: float, second: float) -> FloatArray:
    posture = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, first, second])
    return free_flying_arm(planar(), posture, "tip").generalised_jacobian[PLANAR]


@given(ANGLES, ANGLES)
def test_two_links_in_a_plane_move_their_tip_as_the_closed_form_says(first: float, second: float) -> None:
    np.testing.assert_allclose(planar_arm(first, second), planar_closed_form(first, second), atol=1e-12)


def test_a_dynamic_singularity_is_where_the_arm_on_the_ground_has_none() -> None:
    # beside the stretched arm the determinant changes its sign where sin(second) is not zero
    first = 1.2
    second = brentq(lambda angle: np.linalg.det(planar_closed_form(first, angle)), -0.4, 0.4, xtol=1e-14)
    assert abs(math.sin(second)) > 0.02
    found = free_flying_arm(planar(), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, first, second]), "tip")
    assert manipulability(found.generalised_jacobian[PLANAR]) < 1e-10
    assert manipulability(found.fixed_jacobian[PLANAR]) == pytest.approx(abs(math.sin(second)), rel=1e-9)


@given(ANGLES, ANGLES, st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)))
def test_the_reaction_of_the_base_leaves_no_momentum(first: float, second: float, rates: tuple[float, float]) -> None:
    posture = np.array([1.0, -2.0, 0.5, 0.0, 0.6, 0.0, 0.8, first, second])
    reaction = free_flying_arm(planar(), posture, "tip").reaction @ rates
    np.testing.assert_allclose(momentum(planar(), posture, np.array([*reaction, *rates])), 0.0, atol=1e-12)


class Float(NamedTuple):
    """An arm that was moved from rest on a base that floats free."""

    model: PlantModel
    states: list[PlantState]

    @property
    def last(self) -> PlantState:
        return self.states[-1]

    def momentum(self, base: bool = True) -> FloatArray:
        """At the end; without the base's motion: what the arm alone would have."""
        velocity = self.last.velocity.copy()
        velocity[:6] *= base
        return momentum(self.model.multibody, self.last.configuration, velocity)


@lru_cache
def station() -> LoadedScenario:
    return load_scenario("srms_course")


def floating(physics_step: float, rates: FloatArray, seconds: float = 2.0) -> Float:
    """The arm of the shuttle on a plate that is not held, in orbit: its motors follow rates [rad/s]."""
    scenario = station()
    site = Site(scenario.height_field(), list(scenario.soils.values()), scenario.gravity_field)
    model = PlantModel(
        scenario.urdf_xml, scenario.machine.model_copy(update={"fixed_base": False}), site, scenario.power,
        SimulationParams(physics_step=physics_step, settle_time=0.0),
    )  # fmt: skip
    state = initial_state(model, 0.0, 0.0, 0.0, 0.8, scenario.arm_pose("unfold"))
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    states, period = [state], model.simulation.control_period
    for number in range(round(seconds / period)):
        command.reference[1] = rates * min(2.0 * number * period / seconds, 1.0)
        command.reference[0] += command.reference[1] * period
        state, _ = step(model, state, command)
        states.append(state)
    return Float(model, states)


@settings(max_examples=5, deadline=None)
@given(st.lists(st.floats(0.01, 0.03), min_size=6, max_size=6), st.sampled_from([-1.0, 1.0]))
def test_a_moving_arm_pushes_its_base_and_momentum_is_kept(rates: list[float], sign: float) -> None:
    asked = np.array(rates) * [1.0, sign, 1.0, sign, -1.0, sign]
    coarse, fine = floating(0.004, asked), floating(0.002, asked)
    assert np.abs(fine.last.velocity[:6]).max() > 1e-3
    alone = fine.momentum(base=False)
    for rows in (slice(0, 3), slice(3, 6)):
        given_up = np.linalg.norm(alone[rows])
        assert np.linalg.norm(coarse.momentum()[rows]) < 1e-3 * given_up
        ratio = np.linalg.norm(coarse.momentum()[rows]) / np.linalg.norm(fine.momentum()[rows])
        assert ratio == pytest.approx(2.0, abs=0.3)  # what is left is of the method, of first order


def test_the_tip_moves_in_the_plant_as_the_generalised_jacobian_says() -> None:
    run = floating(0.002, np.array([0.02, -0.015, 0.02, 0.03, -0.03, 0.03]))
    multibody, tip = run.model.multibody, run.model.multibody.frames[-1].name
    data, frame = multibody.createData(), multibody.getFrameId(tip)

    def place(state: PlantState) -> FloatArray:
        pin.framesForwardKinematics(multibody, data, state.configuration)
        return np.array(data.oMf[frame].translation)

    before, now, after = run.states[-3:]
    found = (place(after) - place(before)) / (2.0 * run.model.simulation.control_period)
    arm = free_flying_arm(multibody, now.configuration, tip)
    rates = (after.configuration[7:] - before.configuration[7:]) / (2.0 * run.model.simulation.control_period)
    speed = np.linalg.norm(found)
    assert np.linalg.norm(arm.generalised_jacobian[:3] @ rates - found) < 2e-3 * speed
    assert np.linalg.norm(arm.fixed_jacobian[:3] @ rates - found) > 0.1 * speed


def test_a_base_that_is_not_free_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="free-flying base"):
        free_flying_arm(pin.buildModelFromXML(station().urdf_xml), np.zeros(6), "tool")
    with pytest.raises(InvalidValueError, match="frame"):
        free_flying_arm(planar(), pin.neutral(planar()), "hand")
