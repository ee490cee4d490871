"""The arm on a base that floats: places in space, and a base that does not move as it is believed to."""

from functools import lru_cache

import numpy as np
import pinocchio as pin
import pytest

from sojourn_arm.afloat import MOST_CORRECTIONS, Afloat, SpaceGoal
from sojourn_arm.goals import GoalReader
from sojourn_arm.rover import Rover
from sojourn_config.flight import FlightScenario
from sojourn_config.scenario import load_flight
from sojourn_contract.state_tree import packed, unpacked
from sojourn_contract.values import Imu, Path
from sojourn_flight.arm.floating_base import FloatingBase
from sojourn_flight.arm.goal_events import GoalEvent
from sojourn_flight.arm.goals import PoseGoal, pose_target
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.planning import solve_pose
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmOutput
from sojourn_machine.params import FloatArray

PLACE = PoseGoal((0.45, 0.25, 1.2), orientation=(0.0, 1.0, 0.0, 0.0))


@lru_cache
def servicer() -> FlightScenario:
    return load_flight("servicer_course")


@lru_cache
def model() -> ArmModel:
    return build_arm_model(servicer().urdf_xml, servicer().carried_arm())


def imu(rotation: FloatArray) -> Imu:
    turn = np.array(pin.Quaternion(rotation).coeffs())
    nothing = np.zeros(3)
    return Imu(0, "imu_link", turn, nothing, nothing, np.zeros(9), np.zeros(9), np.zeros(9))


def ended(event: str) -> ArmOutput:
    zero = np.zeros(6)
    place = np.zeros(3)
    return ArmOutput(zero, zero, zero, "holding", 1.0, 0.0, "", place, place, 0.0, 0.0, (GoalEvent(event),))  # type: ignore[arg-type]


def carried_out(lighter: float) -> tuple[list[GoalEvent], float, int]:
    """An arm that takes every posture at once, on a base that has a part of the mass that is believed.

    Each correction is given after the state has been kept and read, as in a run that goes on from a checkpoint.

    Returns:
        what is told of the goal, how far the hand is off its place in truth [m], and after how many corrections.
    """
    params = servicer().carried_arm()
    inertia = 'ixx="{0:g}" ixy="0" ixz="0" iyy="{0:g}" iyz="0" izz="{0:g}"'
    urdf = servicer().urdf_xml.replace('<mass value="500"', f'<mass value="{500 * lighter:g}"')
    urdf = urdf.replace(inertia.format(120), inertia.format(120 * lighter))
    truth, arm = FloatingBase(urdf, params), Afloat(params, model(), servicer().urdf_xml)
    joints, base, goal = np.array(params.named_poses["unfold"]), pin.SE3.Identity(), None
    request: PoseGoal | None = PLACE
    while request is not None:
        now = arm.attitude(joints, imu(base.rotation))
        goal, asked = arm.taken(goal, request, now)
        assert isinstance(asked, PoseGoal)
        posture = solve_pose(params, model(), *pose_target(asked), joints).solutions[0]
        base, joints = base * truth.foretold(joints, posture), posture
        goal, output = arm.followed(goal, asked, arm.attitude(joints, imu(base.rotation)), ended("reached"))
        goal, request = unpacked(packed((goal, goal.correction), "arm"), "arm")
    hand = base.act(forward_kinematics(model(), joints).position)
    return list(output.events), float(np.linalg.norm(hand - PLACE.position)), goal.corrections


def test_a_base_that_is_as_believed_needs_no_correction() -> None:
    events, off, corrections = carried_out(1.0)
    assert [event.outcome for event in events] == ["reached"] and corrections == 0
    assert off < 1e-3


@pytest.mark.parametrize("lighter", [0.5, 3.0])
def test_a_base_that_is_not_as_believed_is_made_up_for(lighter: float) -> None:
    events, off, corrections = carried_out(lighter)
    assert [event.outcome for event in events] == ["reached"]
    assert 1 <= corrections <= MOST_CORRECTIONS and off < 6e-3


def test_a_hand_that_never_gets_there_says_how_far_it_is_off() -> None:
    arm, joints = (
        Afloat(servicer().carried_arm(), model(), servicer().urdf_xml),
        np.array([0.0, 0.8, -2.6, 0.0, -1.3, 0.0]),
    )
    now = arm.attitude(joints, imu(np.eye(3)))
    goal, asked = arm.taken(None, PLACE, now)
    for _ in range(MOST_CORRECTIONS):  # it says that it has come to rest, and has not moved
        goal, output = arm.followed(goal, asked, now, ended("reached"))
        assert output.events == () and goal.correction is not None
        goal, asked = arm.taken(goal, goal.correction, now)
    goal, output = arm.followed(goal, asked, now, ended("reached"))
    assert (
        output.events[0].outcome == "failed" and "off its place in space after 5 corrections" in output.events[0].reason
    )
    assert goal.place is None and goal.correction is None


def test_a_correction_that_cannot_be_is_a_failure_and_a_stop_ends_it() -> None:
    arm, joints = Afloat(servicer().carried_arm(), model(), servicer().urdf_xml), np.zeros(6)
    now = arm.attitude(joints, imu(np.eye(3)))
    begun = SpaceGoal(now, PLACE, PLACE, 1)
    goal, output = arm.followed(begun, PLACE, now, ended("refused"))
    assert output.events[0].outcome == "failed" and "given way" in output.events[0].reason and goal.place is None
    goal, _ = arm.followed(SpaceGoal(now, PLACE), None, now, ended("stopped"))
    assert goal.place is None


def test_a_line_of_the_hand_is_refused_in_words() -> None:
    reader = GoalReader(servicer().carried_arm(), floats=True)
    with pytest.raises(GoalRefusedError, match="floats free and gives way"):
        reader.request("/arm/path", Path(0, "base_link", ()), 0, Rover("", None))
