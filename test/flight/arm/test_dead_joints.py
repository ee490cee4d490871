"""Joints that do not do as they are told: what is left of the arm without them, on five arms; how they are found."""

from dataclasses import replace

import numpy as np
import pinocchio
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.contact_guard import Before, Felt, touched, yielding_rates
from sojourn_flight.arm.controller import step
from sojourn_flight.arm.dead_joints import DeadJoint, arm_without, known_dead, run_away, stands_still, tried_again
from sojourn_flight.arm.goals import HELD_WITHIN, ArmGoal, JointGoal, NamedGoal, PoseGoal
from sojourn_flight.arm.inverse_search import POINTING, POSITION
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.phases import Holding, Moving
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.redundancy import joint_centring
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmInput, ArmState, initial_state
from sojourn_flight.arm.tip_plan import task_of
from sojourn_flight.arm.trajectory import at_rest
from sojourn_flight.arm.ways import Departure
from sojourn_machine.params import FloatArray

ARMS = ("explorer_arm", "puma560", "ssrms", "cylindrical", "scara")
LEVEL = np.array([0.0, 0.0, -9.81])
PERIOD = 0.02


def arm(machine: str) -> tuple[ArmParams, ArmModel]:
    scenario = load_scenario(f"{machine}_course")
    return scenario.arm, build_arm_model(scenario.urdf_xml, scenario.arm)


@pytest.fixture(scope="module", name="explorer")
def explorer_arm() -> tuple[ArmParams, ArmModel]:
    return arm("explorer_arm")


def dead(model: ArmModel, joint: int, position: float, holds: bool = True) -> tuple[DeadJoint, ...]:
    return known_dead((), model, joint, position, holds)


def tip_by_pinocchio(params: ArmParams, model: ArmModel, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Place and rotation of the tip of the whole arm: by another library than the chain's kinematics."""
    rigid, data = model.pinocchio_model, model.pinocchio_model.createData()
    pinocchio.framesForwardKinematics(rigid, data, q)
    frame = data.oMf[rigid.getFrameId(params.tip_link)]
    return np.array(frame.translation), np.array(frame.rotation)


def postures(params: ArmParams, model: ArmModel, seed: int, joint: int) -> tuple[FloatArray, FloatArray]:
    """Two postures that collide with nothing and have one joint at the same place."""
    generator, found = np.random.default_rng(seed), list[FloatArray]()
    held = model.lower[joint] + generator.uniform(0.2, 0.8) * (model.upper[joint] - model.lower[joint])
    while len(found) < 2:
        q = model.lower + generator.uniform(0.1, 0.9, model.joint_count) * (model.upper - model.lower)
        q[joint] = held
        if check_posture(params, model, q, None) is None:
            found.append(q)
    return found[0], found[1]


@pytest.mark.parametrize("machine", ARMS)
def test_what_is_left_of_an_arm_is_the_whole_one_with_a_joint_that_stays(machine: str) -> None:
    params, model = arm(machine)
    generator = np.random.default_rng(3)
    for joint in range(model.joint_count):
        q = model.lower + generator.random(model.joint_count) * (model.upper - model.lower)
        left = arm_without(model, dead(model, joint, float(q[joint])))
        whole, tip = forward_kinematics(model, q), forward_kinematics(left, q)
        place, rotation = tip_by_pinocchio(params, model, q)
        np.testing.assert_allclose(tip.position, place, atol=1e-9)
        np.testing.assert_allclose(tip.rotation, rotation, atol=1e-9)
        assert not np.any(tip.jacobian[:, joint])
        others = np.arange(model.joint_count) != joint
        np.testing.assert_allclose(tip.jacobian[:, others], whole.jacobian[:, others], atol=1e-9)
        assert left.unit(joint) == model.unit(joint) and left.moving_count == model.joint_count - 1


@pytest.mark.parametrize("machine", ARMS)
@pytest.mark.parametrize("seed", range(5))
def test_a_place_that_the_others_reach_is_planned_with_them(machine: str, seed: int) -> None:
    params, model = arm(machine)
    joint = seed % model.joint_count
    start, there = postures(params, model, 10 * seed + 1, joint)
    left = arm_without(model, dead(model, joint, float(start[joint])))
    place = tip_by_pinocchio(params, model, there)[0]
    free = params.model_copy(update={"preferred_direction": None})
    plan = plan_goal(free, left, PoseGoal((place[0], place[1], place[2])), Departure(at_rest(start), start))
    low, high = plan.path.extremes()[:2]
    assert low[joint] == high[joint] == start[joint]
    reached = tip_by_pinocchio(params, model, plan.path.sample(plan.path.duration)[0])[0]
    assert float(np.linalg.norm(reached - place)) < 2.0 * params.inverse_kinematics.position_tolerance


def test_a_goal_that_is_not_reached_so_is_refused_and_the_joint_named(
    explorer: tuple[ArmParams, ArmModel],
) -> None:
    params, model = explorer
    unfold = np.array(params.named_poses["unfold"])
    turned = unfold.copy()
    turned[0] = 1.2
    held = dead(model, 0, 1.2)
    state = holding(params, model, turned, held)
    for goal in (PoseGoal((1.2, 0.0, -0.1)), NamedGoal("unfold"), JointGoal(model.joint_names, tuple(unfold))):
        after, output = step(params, model, state, asked(turned, goal), PERIOD)
        assert output.status == "refused", goal
        assert "arm_azimuth_joint does not move: held at 1.200 rad" in output.reason
        assert after.reference is state.reference, "nothing moves"


def test_a_named_pose_that_has_the_joint_where_it_is_is_taken(explorer: tuple[ArmParams, ArmModel]) -> None:
    params, model = explorer
    unfold = np.array(params.named_poses["unfold"])
    here = unfold.copy()
    here[2] += 0.5 * HELD_WITHIN
    start = here.copy()
    start[0] = 0.6
    state = holding(params, model, start, dead(model, 2, float(here[2])))
    after, output = step(params, model, state, asked(start, NamedGoal("unfold")), PERIOD)
    assert output.status == "moving" and isinstance(after.phase, Moving)
    np.testing.assert_array_equal(after.target.joints[[0, 1, 3, 4]], unfold[[0, 1, 3, 4]])
    assert after.target.joints[2] == here[2]


def test_no_motion_is_planned_with_a_joint_that_moves_by_itself(explorer: tuple[ArmParams, ArmModel]) -> None:
    params, model = explorer
    here = np.array(params.named_poses["unfold"])
    state = holding(params, model, here, dead(model, 1, float(here[1]), holds=False))
    after, output = step(params, model, state, asked(here, PoseGoal((1.1, 0.1, -0.1))), PERIOD)
    assert output.status == "refused" and "arm_elevation_joint moves by itself" in output.reason
    after, output = step(params, model, after, asked(here, JointGoal(("arm_elevation_joint",), (-0.9,))), PERIOD)
    assert output.status == "moving" and not output.failed_joints, "a goal for the joint alone is another try"


def test_a_joint_is_found_only_where_it_alone_stands_still_and_contacts_are_felt(
    explorer: tuple[ArmParams, ArmModel],
) -> None:
    params, model = explorer
    limit = params.following_error_limit
    rest, behind = np.zeros(5), np.array([0.0, 0.0, 1.01 * limit, 0.0, 0.0])
    assert stands_still(params, model, behind, rest)
    moving = np.array([0.0, 0.0, 0.5 * model.max_velocity[2], 0.0, 0.0])
    assert not stands_still(params, model, behind, moving)
    assert not stands_still(params, model, behind + 0.6 * limit, rest), "the whole arm stays behind"
    for feels in (True, False):
        output = None
        start = np.array(params.named_poses["unfold"])
        state = holding(params, model, start, ())
        request: ArmGoal | None = JointGoal(("arm_elbow_joint",), (1.0,))
        for _ in range(400):
            state, output = step(params, model, state, replace(asked(start, request), feels=feels), PERIOD)
            request = None
        assert output is not None and output.status == "stopped"
        found = output.failed_joints
        assert found.startswith("arm_elbow_joint does not move: held at 1.90") if feels else not found


def test_a_joint_that_leaves_its_place_at_rest_moves_by_itself(explorer: tuple[ArmParams, ArmModel]) -> None:
    params, model = explorer
    here, limit = np.array(params.named_poses["unfold"]), params.following_error_limit
    off = np.array([0.0, 1.01 * limit, 0.0, 0.0, 0.0])
    (found,) = run_away(params, model, (), off, here - off)
    assert (found.name, found.holds) == ("arm_elevation_joint", False)
    assert run_away(params, model, (), off + 0.6 * limit, here) == (), "the whole arm sags: it has no power"
    known = dead(model, 2, float(here[2]))
    slipped = here.copy()
    slipped[2] += 1.01 * HELD_WITHIN
    assert run_away(params, model, known, np.zeros(5), here) is known
    assert not run_away(params, model, known, np.zeros(5), slipped)[0].holds
    assert tried_again(known, JointGoal(("arm_elbow_joint",), (0.0,))) == ()
    assert tried_again(known, JointGoal(model.joint_names, (0.0,) * 5)) == known


def test_what_a_dead_joint_bears_is_no_contact_and_it_does_not_give_way(
    explorer: tuple[ArmParams, ArmModel],
) -> None:
    params, model = explorer
    here = np.array(params.named_poses["unfold"])
    left = arm_without(model, dead(model, 2, float(here[2])))
    torque = np.array([0.0, 0.0, 45.0, 0.0, 0.0])
    known, felt = Before(0.0, np.zeros(5)), Felt(None, torque)
    assert "arm_elbow_joint" in touched(params.contact, model, forward_kinematics(model, here), known, felt)
    assert not touched(params.contact, left, forward_kinematics(left, here), known, felt)
    assert yielding_rates(params.contact, left, forward_kinematics(left, here), felt)[2] == 0.0


def test_an_arm_with_a_joint_less_is_asked_for_less(explorer: tuple[ArmParams, ArmModel]) -> None:
    params, model = explorer
    here = np.array(params.named_poses["unfold"])
    left = arm_without(model, dead(model, 3, float(here[3])))
    assert task_of(params, model, False) == POINTING and task_of(params, left, False) == POSITION
    assert np.isfinite(joint_centring(left)(here))


def asked(positions: FloatArray, goal: ArmGoal | None) -> ArmInput:
    return ArmInput(positions, np.zeros(len(positions)), LEVEL, goal=goal, feels=True)


def holding(params: ArmParams, model: ArmModel, positions: FloatArray, found: tuple[DeadJoint, ...]) -> ArmState:
    """At rest, with joints that are known to be dead."""
    state, _ = step(params, model, initial_state(params), asked(positions, None), PERIOD)
    assert isinstance(state.phase, Holding)
    return replace(state, dead=found)


def test_refusals_are_of_the_arms_own_kind() -> None:
    params, model = arm("explorer_arm")
    here = np.array(params.named_poses["unfold"])
    left = arm_without(model, dead(model, 0, float(here[0])))
    with pytest.raises(GoalRefusedError, match=r"pose 'stow': arm_azimuth_joint = 1.5700 rad, but it is at 0.0000"):
        plan_goal(params, left, NamedGoal("stow"), Departure(at_rest(here), here))
