"""Goals of actions as goals of the contract, without a server: test/system/test_actions.py has one."""

import sys
from array import array
from collections.abc import Iterator
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped as RosPose
from hypothesis import given
from hypothesis import strategies as st
from trajectory_msgs.msg import JointTrajectory as RosTrajectory
from trajectory_msgs.msg import JointTrajectoryPoint as RosPoint

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import JointState, Odometry
from sojourn_operator.action_command import main
from sojourn_operator.actions.adapter import installed
from sojourn_operator.actions.follow_joint_trajectory import COMMAND, MEASURED, FollowJointTrajectory
from sojourn_operator.actions.kind import LastHeard
from sojourn_operator.actions.navigate_to_pose import NavigateToPose
from sojourn_operator.actions.tolerances import Tolerance, breach
from sojourn_operator.actions.watch import ABORTED, BREACH, CANCELED, REPLACED, SILENT, SUCCEEDED, Ending, GoalWatch
from sojourn_operator.steps.step import FINAL_STATES, GoalReport

SENT = 7 * NANOSECONDS
NAMES = ("shoulder", "elbow")


@pytest.fixture
def packages(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Classes of the fields that are used, in place of the packages that ROS would have."""

    def fields(**values: Any) -> type:
        return type("Message", (SimpleNamespace,), {"__init__": lambda self: self.__dict__.update(made(values))})

    def made(values: dict[str, Any]) -> dict[str, Any]:
        return {name: value() if callable(value) else value for name, value in values.items()}

    time = fields(sec=0, nanosec=0)
    feedback = fields(
        current_pose=RosPose, navigation_time=time, estimated_time_remaining=time, number_of_recoveries=0,
        distance_remaining=0.0,
    )  # fmt: skip
    result = fields(error_code=0)
    result.UNKNOWN = 9000  # type: ignore[attr-defined]
    header = fields(stamp=time)
    arm_result = fields(error_code=0, error_string="")
    for name, number in (("INVALID_GOAL", -1), ("PATH_TOLERANCE_VIOLATED", -4), ("GOAL_TOLERANCE_VIOLATED", -5)):
        setattr(arm_result, name, number)
    arm_feedback = fields(header=header, joint_names=list, desired=None, actual=None, error=None)
    for package, action, its in (
        ("nav2_msgs", "NavigateToPose", SimpleNamespace(Feedback=feedback, Result=result)),
        ("control_msgs", "FollowJointTrajectory", SimpleNamespace(Feedback=arm_feedback, Result=arm_result)),
    ):
        module = ModuleType(f"{package}.action")
        setattr(module, action, its)
        monkeypatch.setitem(sys.modules, package, ModuleType(package))
        monkeypatch.setitem(sys.modules, module.__name__, module)
    yield


def drive_request(x: float = 1.0, frame: str = "map", tree: str = "") -> SimpleNamespace:
    pose = RosPose()
    pose.header.frame_id, pose.pose.position.x = frame, x
    return SimpleNamespace(pose=pose, behavior_tree=tree)


def tolerance(name: str, position: float = 0.0, velocity: float = 0.0) -> SimpleNamespace:
    return SimpleNamespace(name=name, position=position, velocity=velocity)


def arm_request(**others: Any) -> SimpleNamespace:
    trajectory = RosTrajectory(joint_names=list(NAMES), points=[RosPoint(positions=array("d", (0.1, 0.2)))])
    trajectory.points[0].time_from_start.sec = 4
    usual = {
        "trajectory": trajectory, "path_tolerance": [], "goal_tolerance": [],
        "goal_time_tolerance": SimpleNamespace(sec=0, nanosec=0),
    }  # fmt: skip
    return SimpleNamespace(**usual | others)


def heard(now: int = SENT, status: dict[str, str] | None = None, **messages: JointState | Odometry) -> LastHeard:
    names = {"odom": "/odom", "command": COMMAND, "measured": MEASURED}
    return LastHeard(now, SENT, status or {}, {names[name]: message for name, message in messages.items()})


def joints(
    position: tuple[float, float], rate: tuple[float, float] = (0.0, 0.0), names: tuple[str, ...] = NAMES
) -> JointState:
    return JointState(SENT, names, np.array(position), np.array(rate))


# The watch


@given(st.sampled_from(FINAL_STATES), st.booleans(), st.text(max_size=5))
def test_a_goal_ends_as_its_role_says(state: str, is_stopped: bool, reason: str) -> None:
    watch = GoalWatch("drive", SENT, stop=SENT + 1 if is_stopped else None)
    _, ending = watch.step(GoalReport(state, SENT, reason), SENT, SENT)
    assert ending is not None and (ending.cause, ending.reason) == (state, reason)
    assert (ending.word == SUCCEEDED) == (state == "reached")
    assert (ending.word == CANCELED) == (state == "stopped" and is_stopped)


def test_reports_of_what_was_before_end_nothing() -> None:
    watch = GoalWatch("drive", SENT)
    for report in (None, GoalReport("reached", SENT - 1), GoalReport("idle", 0), GoalReport("moving", SENT)):
        after, ending = watch.step(report, SENT + 1, SENT + 1)
        assert ending is None and after.is_known == (report is not None and report.goal_stamp == SENT)


def test_what_was_given_by_others_takes_its_place() -> None:
    later = GoalReport("moving", SENT + 5)
    unstamped = GoalReport("moving", 0)
    assert GoalWatch("drive", SENT).step(unstamped, SENT, SENT)[1] is None  # may be older
    for watch, report in ((GoalWatch("drive", SENT), later), (GoalWatch("drive", SENT, is_known=True), unstamped)):
        _, ending = watch.step(report, SENT, SENT)
        assert ending is not None and (ending.word, ending.cause) == (ABORTED, REPLACED)


def test_what_was_refused_to_others_does_not_take_its_place() -> None:
    watch, ending = GoalWatch("drive", SENT).step(GoalReport("moving", SENT), SENT + 60 * NANOSECONDS, SENT)
    now = SENT + 69 * NANOSECONDS
    assert ending is None and watch.step(GoalReport("refused", SENT + 5), now, now) == (watch, None)
    _, ending = watch.step(GoalReport("refused", SENT + 5), now + 2 * NANOSECONDS, now)
    assert ending is not None and ending.cause == SILENT


def test_an_arm_tells_of_a_stop_as_of_a_goal() -> None:
    """Also where it has never told of the goal, which was taken back before its next word."""
    for is_known in (False, True):
        watch = GoalWatch("arm", SENT, is_known, stop=SENT + 3)
        assert watch.step(GoalReport("moving", 0), SENT + 4, SENT + 4)[1] is None
        _, ending = watch.step(GoalReport("stopped", 0, "stop asked for"), SENT + 5, SENT + 5)
        assert ending == Ending(CANCELED, "stopped", "stop asked for")


def test_what_an_arm_told_before_a_stop_is_no_answer_to_it() -> None:
    watch = GoalWatch("arm", SENT, stop=SENT + 3)
    assert watch.step(GoalReport("stopped", 0, "stop asked for"), SENT + 4, SENT + 2) == (watch, None)


def test_a_role_that_never_tells_of_it() -> None:
    watch = GoalWatch("drive", SENT)
    assert watch.step(None, SENT + 10 * NANOSECONDS, 0)[1] is None
    _, ending = watch.step(None, SENT + 10 * NANOSECONDS + 1, 0)
    assert ending is not None and ending.cause == SILENT and "drive has told nothing" in ending.reason


# The drive


@pytest.mark.usefixtures("packages")
def test_a_pose_goes_on_as_it_is() -> None:
    goal = NavigateToPose().begin(drive_request(1.5, "base_link")).goal
    assert (goal.stamp, goal.frame, goal.position.tolist()) == (0, "base_link", [1.5, 0.0, 0.0])  # type: ignore[attr-defined]


@pytest.mark.usefixtures("packages")
@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (drive_request(float("nan")), "pose.position.x = nan: allowed is a finite number"),
        (drive_request(frame="moon"), "header.frame_id = 'moon': allowed is one of map, odom, base_link"),
        (drive_request(tree="other.xml"), "behavior_tree = 'other.xml': allowed is none"),
    ],
)
def test_poses_that_cannot_be_had(request_: Any, words: str) -> None:
    with pytest.raises(RefusedMessageError, match=words):
        NavigateToPose().begin(request_)


@pytest.mark.usefixtures("packages")
def test_what_is_told_of_a_drive() -> None:
    pursuit = NavigateToPose().begin(drive_request())
    status = {"distance_to_go": "0.6", "speed_m_s": "0.05", "detours": "2"}
    here = Odometry(
        SENT, "odom", "base_link", np.array((1.0, 2.0, 3.0)), np.array((0.0, 0.0, 0.6, 0.8)), np.zeros(3), np.zeros(3)
    )
    said = pursuit.feedback(heard(SENT + 2_500_000_000, status, odom=here))
    assert (said.navigation_time.sec, said.navigation_time.nanosec) == (2, 500_000_000)
    assert said.estimated_time_remaining.sec == 12
    assert (said.distance_remaining, said.number_of_recoveries) == (0.6, 2)
    assert (said.current_pose.header.frame_id, said.current_pose.pose.position.y) == ("odom", 2.0)
    assert said.current_pose.pose.orientation.w == 0.8
    standing = pursuit.feedback(heard(SENT, status | {"speed_m_s": "0.001"}))
    assert standing.estimated_time_remaining.sec == 0
    assert [pursuit.result(Ending(word, "", "")).error_code for word in (SUCCEEDED, CANCELED, ABORTED)] == [0, 0, 9000]


# The arm


@pytest.mark.usefixtures("packages")
@pytest.mark.parametrize(
    ("others", "words"),
    [
        ({"trajectory": RosTrajectory()}, "trajectory.points = none: allowed is at least one"),
        ({"multi_dof_trajectory": SimpleNamespace(points=[1])}, "multi_dof_trajectory = 1 points: allowed is none"),
        ({"component_goal_tolerance": [1, 2]}, "component_goal_tolerance = 2 of them"),
        ({"path_tolerance": [tolerance("knee")]}, "path_tolerance.name = knee: allowed is one of shoulder, elbow"),
    ],
)
def test_trajectories_that_cannot_be_had(others: dict[str, Any], words: str) -> None:
    with pytest.raises(RefusedMessageError, match=words):
        FollowJointTrajectory().begin(arm_request(**others))


@pytest.mark.usefixtures("packages")
def test_an_arm_that_leaves_its_path_is_stopped() -> None:
    pursuit = FollowJointTrajectory().begin(arm_request(path_tolerance=[tolerance("elbow", position=0.05)]))
    command = joints((0.0, 1.0))
    assert not pursuit.breach(heard(command=command))  # nothing measured yet
    assert not pursuit.breach(heard(command=command, measured=joints((9.0, 1.04))))
    why = pursuit.breach(heard(command=command, measured=joints((9.0, 1.06))))
    assert why.startswith("elbow is 0.0600 from where it should be, tolerance 0.05")
    result = pursuit.result(Ending(ABORTED, BREACH, why))
    assert (result.error_code, result.error_string) == (-4, why)


@pytest.mark.usefixtures("packages")
def test_a_goal_is_judged_by_its_own_tolerances() -> None:
    late = SimpleNamespace(sec=1, nanosec=500_000_000)
    pursuit = FollowJointTrajectory().begin(
        arm_request(goal_tolerance=[tolerance("shoulder", position=0.01)], goal_time_tolerance=late)
    )
    reached = Ending(SUCCEEDED, "reached", "")
    assert pursuit.final(reached, heard(measured=joints((0.109, 0.9)))) == reached
    off = pursuit.final(reached, heard(measured=joints((0.111, 0.2))))
    assert (off.word, off.cause, pursuit.result(off).error_code) == (ABORTED, BREACH, -5)
    assert not pursuit.breach(heard(SENT + 5_500_000_000))
    assert pursuit.breach(heard(SENT + 5_500_000_001)).startswith("not there after 5.5 s")
    assert pursuit.result(Ending(ABORTED, "refused", "")).error_code == -1
    assert pursuit.result(Ending(CANCELED, "stopped", "")).error_code == 0


@pytest.mark.usefixtures("packages")
def test_what_is_told_of_an_arm_is_in_the_order_of_its_goal() -> None:
    pursuit = FollowJointTrajectory().begin(arm_request())
    said = pursuit.feedback(
        heard(
            command=joints((0.5, 0.25), (0.1, 0.2), NAMES[::-1]),
            measured=joints((0.125, 0.25), names=("shoulder", "elbow")),
        )
    )
    assert list(said.joint_names) == list(NAMES)
    assert list(said.desired.positions) == [0.25, 0.5] and list(said.desired.velocities) == [0.2, 0.1]
    assert list(said.actual.positions) == [0.125, 0.25] and list(said.error.positions) == [0.125, 0.25]


@given(st.floats(0.0, 10.0), st.floats(0.0, 10.0))
def test_tolerances_above_zero_alone_are_limits(off: float, rate: float) -> None:
    wanted, measured = {"elbow": (0.0, 0.0)}, JointState(0, ("elbow",), np.array([off]), np.array([-rate]))
    for limits in ((0.0, 0.0), (-1.0, -1.0)):
        assert not breach((Tolerance("elbow", *limits),), wanted, measured)
    assert bool(breach((Tolerance("elbow", 3.0, 4.0),), wanted, measured)) == (off > 3.0 or rate > 4.0)


# The command


def test_without_the_packages_it_says_which(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from sojourn_config.command_errors import UsageError

    for package in ("nav2_msgs", "control_msgs"):
        monkeypatch.setitem(sys.modules, f"{package}.action", None)
    with pytest.raises(UsageError, match="nav2_msgs and control_msgs are not installed: source a ROS 2 Jazzy") as error:
        main(["--domain", "7"])
    assert error.value.exit_status == 2


@pytest.mark.usefixtures("packages")
def test_one_package_serves_alone(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "control_msgs.action", None)
    kinds = [(NavigateToPose(), "a"), (FollowJointTrajectory(), "b")]
    assert [name for _, name in installed(kinds)] == ["a"]
    assert "control_msgs is not installed" in capsys.readouterr().out
