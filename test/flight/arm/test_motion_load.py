"""Torque and power of planned motions: the law against that of the plant's drives, and the limits in planning."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm import motion_load
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.goals import ArmGoal, JointGoal, NamedGoal, TrajectoryGoal
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.trajectory import JointReference, at_rest
from sojourn_flight.arm.ways import Departure

MOON = np.array([0.0, 0.0, -1.625])


@pytest.fixture(scope="module")
def explorer() -> tuple[ArmParams, ArmModel]:
    scenario = load_scenario("flat_drive")
    return scenario.carried_arm(), build_arm_model(scenario.urdf_xml, scenario.carried_arm())


@settings(max_examples=100, deadline=None)
@given(rigid=st.floats(-60.0, 60.0), rate=st.floats(-0.3, 0.3).filter(lambda rate: abs(rate) > 1e-6))
def test_the_motors_torque_gives_the_joints_through_the_plants_friction(rigid: float, rate: float) -> None:
    """joint_drive: friction F_0 + (1 - n)|tau_m| against the motion, and b qd; what is left turns the joint."""
    params = load_scenario("flat_drive").carried_arm()
    motor = motion_load.motor_efforts(params, np.full((1, 5), rigid), np.full((1, 5), rate))[0]
    friction = np.array(params.coulomb_friction) + (1.0 - np.array(params.gear_efficiency)) * np.abs(motor)
    left = motor - friction * np.sign(rate) - np.array(params.viscous_friction) * rate
    assert left == pytest.approx(np.full(5, rigid), abs=1e-9)


def test_power_is_that_of_motor_and_winding(explorer: Any) -> None:
    """RE 25 on 2000:1: 46.8 N m/A, so 23.4 N m are 0.5 A, 0.58 W in 2.32 ohm; and 23.4 N m at 0.1 rad/s are 2.34 W."""
    params, _ = explorer
    motor = np.array([[23.4, -23.4, 0.0, 0.0, 0.0]])
    rates = np.array([[0.1, 0.1, 0.2, 0.0, 0.0]])
    assert motion_load.power_drawn(params, motor, rates) == pytest.approx([2.34 + 2.32 * 0.25], rel=1e-6)


@pytest.mark.parametrize("watts", [2.0, 0.8])
def test_a_motion_that_would_draw_too_much_is_slower(explorer: Any, watts: float) -> None:
    params, arm = explorer
    start = np.array(params.named_poses["unfold"])
    goal = JointGoal(params.joint_names, tuple(start + 0.6))
    free = plan_goal(params, arm, goal, Departure(at_rest(start), start), gravity=MOON)
    tight = params.model_copy(update={"power_limit": watts})
    plan = plan_goal(tight, arm, goal, Departure(at_rest(start), start), gravity=MOON)
    assert plan.path.duration > 1.2 * free.path.duration
    assert "slower, or the arm would draw" in plan.note and f"its limit is {watts:.1f} W" in plan.note
    times = np.linspace(0.0, plan.path.duration, 700)
    q, qd, qdd = (np.array(column) for column in zip(*(plan.path.sample(t) for t in times), strict=True))
    rigid = np.array([rigid_effort(arm, *row, MOON) for row in zip(q, qd, qdd, strict=True)])
    assert motion_load.power_drawn(params, motion_load.motor_efforts(params, rigid, qd), qd).max() <= 1.01 * watts


def test_what_no_slowness_can_mend_is_refused_with_the_reason(explorer: Any) -> None:
    params, arm = explorer
    start = np.array(params.named_poses["unfold"])
    goal = JointGoal((params.joint_names[0],), (0.5,))
    weak = params.model_copy(update={"motor_effort": (1.0,) * 5})
    with pytest.raises(GoalRefusedError, match=r"arm_\w+ would need .* N m, .* of what it can give, however slowly"):
        plan_goal(weak, arm, goal, Departure(at_rest(start), start), gravity=10.0 * MOON)
    poor = params.model_copy(update={"power_limit": 1e-3})
    with pytest.raises(GoalRefusedError, match=r"would draw .* W, its limit is 0.0 W, however slowly"):
        plan_goal(poor, arm, goal, Departure(at_rest(start), start), gravity=MOON)


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_limits_hold_in_every_sample_from_rest_and_on_the_way(explorer: Any, data: st.DataObject) -> None:
    params, arm = explorer
    params = params.model_copy(update={"power_limit": data.draw(st.sampled_from([2.5, 20.0]))})
    reference, present = at_rest(np.array(params.named_poses["unfold"])), np.array(params.named_poses["unfold"])
    joints = st.tuples(*(st.floats(low, high) for low, high in zip(arm.lower, arm.upper, strict=True)))
    for _ in range(2):
        goal: ArmGoal = data.draw(
            st.one_of(
                joints.map(lambda q: JointGoal(params.joint_names, q)),
                st.lists(joints, min_size=2, max_size=4).map(
                    lambda points: TrajectoryGoal(params.joint_names, (), tuple(points))
                ),
                st.just(NamedGoal("stow")),
            )
        )
        try:
            plan = plan_goal(params, arm, goal, Departure(reference, present), gravity=MOON)
        except GoalRefusedError:
            continue
        times = np.linspace(0.0, plan.path.duration, 120)
        q, qd, qdd = (np.array(column) for column in zip(*(plan.path.sample(t) for t in times), strict=True))
        assert (q >= arm.lower - 1e-5).all() and (q <= arm.upper + 1e-5).all()
        assert (np.abs(qd) <= arm.max_velocity * 1.00001).all()
        assert (np.abs(qdd) <= arm.max_acceleration * 1.00001).all()
        rigid = np.array([rigid_effort(arm, *row, MOON) for row in zip(q, qd, qdd, strict=True)])
        motor = motion_load.motor_efforts(params, rigid, qd)
        assert (np.abs(motor) <= np.minimum(arm.max_effort, params.motor_effort) * 1.01).all()
        assert motion_load.power_drawn(params, motor, qd).max() <= 1.02 * (params.power_limit or np.inf)
        reference = JointReference(*plan.path.sample(0.4 * plan.path.duration))
        present = plan.target
