"""The node of the arm, alone: goals of every kind, refusals with their reasons, measurements that cannot be used."""

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Path
from node_bench import ARM, WHEELS, Bench, at, cloud, imu, joints, odometry, stamp_of, wrist
from node_bench import command as wheel_command
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from ros_messages import ros_time
from sojourn_arm.node import ArmNode
from sojourn_contract.heartbeat import status_message
from sojourn_flight.arm.state import EVERYTHING, Granted
from sojourn_machine.tools import TOOL_JOINT

COMMANDED = (*ARM, TOOL_JOINT)
"""The explorer's arm and its scoop."""


class ArmBench:
    """An arm that is where it was told to be one period before."""

    def __init__(self, bench: Bench, *others: str) -> None:
        self.bench = bench
        self.node = bench.start(ArmNode, "sensors", "arm", "power", *others)
        self.with_drive = "drive" in others
        self.here = odometry(0)
        bench.connect(self.node)
        self.period = 0
        self.force = (0.0, 0.0, -3.25)
        """On the wrist's sensor [N]: the turret hangs."""
        self.points = np.zeros((0, 3))
        """What the hazard camera sees."""
        self.angles = dict(zip(ARM, self.node.app.params.named_poses["unfold"], strict=True))

    def step(self, periods: int = 1, spoil: str = "", switch: str = "on", rate: float = 0.0) -> JointState:
        """Go on, the wheels told to turn at `rate`; the last command."""
        for _ in range(periods):
            self.period += 1
            message = joints(self.period, self.angles)
            if spoil == "NaN":
                message.position[0] = math.nan
            elif spoil == "names":
                message.name = [f"other_{name}" for name in message.name]
            if self.period % 5 == 0:
                switches = status_message(at(self.period), "switches", {"arm": switch})
                self.bench.send("/power/switches", switches)
            self.bench.send("/joint_states", message)
            attitude = imu(self.period)
            if spoil == "attitude":
                attitude.orientation.w = 0.0
            if self.period % 50 == 0:
                self.bench.send("/hazcam/points", cloud(self.period, self.points))
            self.bench.send("/wrist/wrench", wrist(self.period, self.force))
            self.bench.send("/imu/data", attitude)
            if self.with_drive:
                self.here.header.stamp = ros_time(at(self.period))
                self.bench.send("/odom", self.here)
                self.bench.send("/drive_command", wheel_command(WHEELS, self.period, rate))
            command = self.bench.answer("/arm_command", self.period)
            if command.name:
                self.angles = dict(zip(command.name, command.position, strict=True))
        return command

    def goal(self, name: str, message: Any) -> dict[str, str]:
        """Send a goal; the status at the end of the second in which it takes effect."""
        before = self.node.events.received.get(name, 0)
        self.bench.send(name, message)
        self.bench.until(lambda: self.node.events.received.get(name, 0) > before, f"{name} has arrived")
        return self.status()

    def status(self) -> dict[str, str]:
        """The next status."""
        self.step(50 - self.period % 50)
        return self.bench.status("/arm/status", self.period)


@pytest.fixture
def arm(bench: Bench) -> ArmBench:
    return ArmBench(bench)


def joint_goal(names: tuple[str, ...], positions: list[float], pose: str = "") -> JointState:
    message = JointState(name=list(names), position=positions)
    message.header.frame_id = pose
    return message


def pose_goal(x: float, y: float, z: float, frame: str = "base_link") -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = frame
    message.header.stamp = ros_time(at(1))
    message.pose.position.x, message.pose.position.y, message.pose.position.z = x, y, z
    return message


def test_holds_where_it_is_and_answers_every_period(arm: ArmBench) -> None:
    start = dict(arm.angles)
    command = arm.step(50)
    assert tuple(command.name) == COMMANDED
    assert list(command.position) == pytest.approx([*start.values(), 0.0], abs=1e-6)
    assert list(command.velocity) == [0.0] * len(COMMANDED)
    assert abs(command.effort[1]) > 1.0, "feed-forward carries the arm's weight"
    assert [stamp_of(message) for message in arm.bench.received["/arm_command"]] == [at(p) for p in range(1, 51)]
    status = arm.bench.status("/arm/status", 50)
    assert (status["state"], status["goal_stamp"]) == ("idle", "0")


def test_a_joint_goal_is_reached(arm: ArmBench) -> None:
    arm.step()
    target = arm.angles["arm_azimuth_joint"] + 0.1
    status = arm.goal("/arm/joint_goal", joint_goal(("arm_azimuth_joint",), [target]))
    assert status["state"] in ("moving", "reached")
    for _ in range(8):
        if status["state"] == "reached":
            break
        status = arm.status()
    assert status["state"] == "reached" and status["goals_accepted"] == "1"
    assert arm.angles["arm_azimuth_joint"] == pytest.approx(target, abs=1e-3)


def test_named_pose_and_stop(arm: ArmBench) -> None:
    arm.step()
    assert arm.goal("/arm/joint_goal", joint_goal((), [], "stow"))["state"] == "moving"
    moving = arm.step()
    assert max(map(abs, moving.velocity)) > 0.0
    status = arm.goal("/arm/stop", Header())
    while status["state"] == "moving":
        status = arm.status()
    assert status["state"] == "stopped"
    assert list(arm.step().velocity) == [0.0] * len(COMMANDED)


def test_a_pose_goal_starts_a_motion(arm: ArmBench) -> None:
    arm.step()
    tip = [float(value) for value in arm.status()["tip_in_base_m"].split()]
    status = arm.goal("/arm/goal_pose", pose_goal(tip[0], tip[1] + 0.03, tip[2]))
    assert status["state"] in ("moving", "reached"), status["reason"]
    assert status["goal_stamp"] == str(at(1))


def tip_path(*points: tuple[float, float, float], arc: int = -1, frame: str = "base_link") -> Path:
    """A path through points, that of index `arc` gone by on an arc."""
    message = Path()
    message.header.frame_id = frame
    message.header.stamp = ros_time(at(1))
    for k, (x, y, z) in enumerate(points):
        message.poses.append(pose_goal(x, y, z, "arc" if k == arc else frame))
    return message


@pytest.mark.parametrize("frame", ["base_link", "map"])
def test_a_path_of_the_tip_is_followed_to_its_end(bench: Bench, frame: str) -> None:
    arm = ArmBench(bench, *(("drive",) if frame == "map" else ()))
    arm.here.pose.pose.position.x = 2.0 if frame == "map" else 0.0
    arm.step()
    x, y, z = (float(value) for value in arm.status()["tip_in_base_m"].split())
    x += arm.here.pose.pose.position.x
    corners = (x, y + 0.04, z), (x + 0.02, y + 0.06, z), (x + 0.04, y + 0.04, z)
    status = arm.goal("/arm/path", tip_path(*corners, arc=1, frame=frame))
    assert status["state"] == "moving", status["reason"]
    places = [np.array([float(value) for value in status["tip_in_base_m"].split()])]
    while status["state"] == "moving":
        status = arm.status()
        places.append(np.array([float(value) for value in status["tip_in_base_m"].split()]))
    assert status["state"] == "reached" and float(status["error_m"]) < 1e-3
    assert status["goal_stamp"] == str(at(1)) and status["goals_accepted"] == "1"
    for tip in places:  # on the line or on the arc about its middle, or within the rounding of the corner
        line = math.hypot(tip[0] - places[-1][0] + 0.04, tip[2] - z)
        bow = abs(math.hypot(tip[0] - places[-1][0] + 0.02, tip[1] - y - 0.04) - 0.02) + abs(tip[2] - z)
        assert min(line, bow) < 0.006


def jog(linear: tuple[float, float, float], frame: str = "base_link", stamp: int = 0) -> TwistStamped:
    message = TwistStamped()
    message.header.frame_id = frame
    message.header.stamp = ros_time(stamp)
    message.twist.linear.x, message.twist.linear.y, message.twist.linear.z = linear
    return message


def send_jog(arm: ArmBench, message: TwistStamped) -> None:
    before = arm.node.events.received.get("/arm/cmd_vel", 0)
    arm.bench.send("/arm/cmd_vel", message)
    arm.bench.until(lambda: arm.node.events.received.get("/arm/cmd_vel", 0) > before, "the jog has arrived")


def test_jogging_moves_the_tip_while_commands_come_and_stops_after(bench: Bench) -> None:
    arm = ArmBench(bench, "drive")
    turned = np.array(pin.Quaternion(pin.utils.rpyToMatrix(0.0, 0.0, 0.5 * math.pi)).coeffs())
    q = arm.here.pose.pose.orientation
    q.x, q.y, q.z, q.w = (float(value) for value in turned)
    start = np.array([float(value) for value in arm.status()["tip_in_base_m"].split()])
    for frame, linear, way in (
        ("base_link", (0.0, 0.04, 0.0), (0.0, 1.0, 0.0)),
        ("map", (0.04, 0.0, 0.0), (0.0, -1.0, 0.0)),  # the rover looks along the map's y
        ("arm_tip_link", (0.0, 0.0, -0.04), (0.0, 0.0, 1.0)),
    ):
        while arm.period % 50 < 40:
            send_jog(arm, jog(linear, frame, at(arm.period + 1)))
            arm.step(5)
        status = arm.status()
        assert (status["task"], status["state"]) == ("jog", "moving")
        status = arm.status()
        while status["state"] == "moving":
            status = arm.status()
        assert status["state"] == "stopped" and "older than 0.20 s" in status["reason"]
        end = np.array([float(value) for value in status["tip_in_base_m"].split()])
        gone = end - start
        assert np.linalg.norm(gone) > 0.01 and float(gone @ way) > 0.999 * np.linalg.norm(gone)
        start = end
    arm.step(rate=0.3)
    send_jog(arm, jog((0.0, 0.04, 0.0), stamp=at(arm.period + 1)))
    arm.step(50 - arm.period % 50, rate=0.3)
    status = arm.bench.status("/arm/status", arm.period)
    assert status["state"] == "refused" and "the rover drives" in status["reason"]


def trajectory(names: tuple[str, ...], *points: list[float]) -> JointTrajectory:
    return JointTrajectory(joint_names=list(names), points=[JointTrajectoryPoint(positions=point) for point in points])


REFUSED = {
    "unreachable": ("/arm/goal_pose", pose_goal(4.0, 0.0, 0.0), r"reach"),
    "wrong frame": (
        "/arm/goal_pose",
        pose_goal(1.0, 0.0, 0.0, "map"),
        "header.frame_id = 'map': allowed is base_link: there is no /odom",
    ),
    "unknown joint": (
        "/arm/joint_goal",
        joint_goal(("elbow",), [0.0]),
        "unknown joint elbow: this arm has arm_azimuth",
    ),
    "out of limits": ("/arm/joint_goal", joint_goal(("arm_elbow_joint",), [9.0]), "arm_elbow_joint = 9.0000 is out of"),
    "no positions": ("/arm/joint_goal", joint_goal(ARM, []), "0 values, needed are 5"),
    "unknown pose": ("/arm/joint_goal", joint_goal((), [], "wave"), "wave"),
    "too fast a jog": ("/arm/cmd_vel", jog((0.0, 0.5, 0.0)), "linear velocity of 0.500 m/s: allowed is at most 0.04"),
    "a jog in an unknown frame": (
        "/arm/cmd_vel",
        jog((0.0, 0.01, 0.0), "camera"),
        "header.frame_id = 'camera': allowed is one of base_link, map, odom, arm_tip_link",
    ),
    "a path of no points": ("/arm/path", tip_path(), "at least one"),
    "a path out of reach": ("/arm/path", tip_path((3.0, 0.0, 0.0)), "of the path the arm stays behind"),
    "an arc without an end": ("/arm/path", tip_path((1.2, 0.0, 0.0), arc=0), "its end is to follow"),
    "a path in an unknown frame": (
        "/arm/path",
        tip_path((1.2, 0.0, 0.0), frame="map"),
        "/arm/path.header.frame_id = 'map': allowed is base_link: there is no /odom",
    ),
    "no points": ("/arm/joint_trajectory", trajectory(ARM), "at least one"),
}


@pytest.mark.parametrize("topic,message,reason", REFUSED.values(), ids=REFUSED.keys())
def test_goals_that_cannot_be_are_refused_with_the_reason(arm: ArmBench, topic: str, message: Any, reason: str) -> None:
    arm.step()
    before = list(arm.step().position)
    status = arm.goal(topic, message)
    assert status["state"] == "refused"
    assert reason in status["reason"]
    said = arm.node.counters.last_refusal
    assert not said or (said.startswith(topic) and reason in said), "what never comes to be planned is counted"
    assert said.count("allowed is") <= 1, "the reason is said once"
    assert list(arm.step().position) == before
    assert arm.bench.received["/arm/status"][-1].status[0].level == b"\x01"


@pytest.mark.parametrize(
    "topic,message",
    [("/arm/joint_goal", joint_goal((), [], "nowhere")), ("/arm/goal_pose", pose_goal(9.0, 0.0, 0.0))],
    ids=["no such pose", "out of reach"],
)
def test_a_refused_goal_hides_the_one_that_goes_on_for_two_seconds_only(
    arm: ArmBench, topic: str, message: Any
) -> None:
    """It was the last word of the arm: of the goal under way it was never told how it ended."""
    arm.step()
    first = joint_goal((), [], "stow")
    first.header.stamp = ros_time(at(3))
    moving = arm.goal("/arm/joint_goal", first)
    assert (moving["state"], moving["goal_stamp"]) == ("moving", str(at(3)))
    message.header.stamp = ros_time(at(arm.period + 2))
    refused = arm.goal(topic, message)
    assert (refused["state"], refused["goal_stamp"]) == ("refused", str(stamp_of(message)))
    assert max(map(abs, arm.step().velocity)) > 0.0, "it goes on"
    arm.step(99)
    told = arm.status()
    assert (told["state"], told["goal_stamp"], told["goals_refused"]) == (
        "moving",
        str(at(3)),
        refused["goals_refused"],
    )
    for _ in range(60):
        arm.step(50)
        if (told := arm.status())["state"] != "moving":
            break
    assert (told["state"], told["goal_stamp"]) == ("reached", str(at(3)))


@pytest.mark.parametrize(
    "topic,message,field",
    [
        ("/arm/joint_goal", joint_goal(ARM, [0.0]), "position = 1 numbers"),
        ("/arm/joint_goal", joint_goal(ARM[:1], [math.nan]), "position[0] = nan"),
        ("/arm/goal_pose", pose_goal(math.inf, 0.0, 0.0), "pose.position.x = inf"),
        ("/arm/joint_trajectory", trajectory(ARM, [0.0] * 4), "points[0].positions = 4 numbers"),
    ],
    ids=["wrong length", "no number", "infinite", "trajectory of wrong length"],
)
def test_goals_with_bad_numbers_are_refused_and_counted(arm: ArmBench, topic: str, message: Any, field: str) -> None:
    arm.step()
    arm.goal(topic, message)
    assert arm.node.counters.refused == {topic: 1}
    assert f"{topic}.{field}" in arm.node.counters.last_refusal
    arm.bench.until(lambda: arm.bench.heartbeats("arm")[-1].stamp == at(50), "the heartbeat of the first second")
    assert arm.bench.heartbeats("arm")[-1].refused == {topic: 1}


@pytest.mark.parametrize(
    ("spoil", "topic"), [("NaN", "/joint_states"), ("names", "/joint_states"), ("attitude", "/imu/data")]
)
def test_measurements_that_cannot_be_used_hold_the_arm(arm: ArmBench, spoil: str, topic: str) -> None:
    """Every period is answered all the same, and the goal that came meanwhile is not forgotten."""
    arm.step(2)
    assert arm.goal("/arm/joint_goal", joint_goal((), [], "stow"))["state"] == "moving"
    last = list(arm.step().position)
    for _ in range(10):
        command = arm.step(spoil=spoil)
        assert list(command.position) == last and list(command.velocity) == [0.0] * len(COMMANDED)
    assert arm.node.counters.refused == {topic: 10}
    before = arm.node.events.received["/arm/joint_goal"]
    arm.bench.send("/arm/joint_goal", joint_goal((), [], "unfold"))
    arm.bench.until(lambda: arm.node.events.received["/arm/joint_goal"] > before, "the goal has arrived")
    arm.step(spoil=spoil)
    arm.step()
    assert arm.status()["goals_accepted"] == "2"


def test_before_anything_is_measured_it_commands_nothing(arm: ArmBench) -> None:
    command = arm.step(50, spoil="NaN")
    assert list(command.name) == [] and list(command.position) == []
    assert arm.bench.status("/arm/status", 50)["state"] == "idle"
    assert tuple(arm.step().name) == COMMANDED


@pytest.mark.parametrize("text", ["off", "0.0"])
def test_without_power_a_goal_is_refused(arm: ArmBench, text: str) -> None:
    arm.step(5, switch=text)
    before = arm.node.events.received.get("/arm/joint_goal", 0)
    arm.bench.send("/arm/joint_goal", joint_goal((), [], "stow"))
    arm.bench.until(lambda: arm.node.events.received.get("/arm/joint_goal", 0) > before, "the goal has arrived")
    arm.step(45, switch=text)
    status = arm.bench.status("/arm/status", 50)
    assert status["state"] == "refused" and "power manager has switched the arm off" in status["reason"]


def test_while_the_rover_drives_a_goal_is_refused_and_a_motion_stops(bench: Bench) -> None:
    arm = ArmBench(bench, "drive")
    arm.step()
    before = arm.node.events.received.get("/arm/joint_goal", 0)
    bench.send("/arm/joint_goal", joint_goal((), [], "stow"))
    bench.until(lambda: arm.node.events.received.get("/arm/joint_goal", 0) > before, "the goal has arrived")
    arm.step(49, rate=0.01)
    status = bench.status("/arm/status", 50)
    assert status["state"] == "refused" and "the rover drives: wheel_front_left_joint is told 0.010" in status["reason"]
    assert arm.goal("/arm/joint_goal", joint_goal((), [], "stow"))["state"] == "moving"
    assert max(map(abs, arm.step().velocity)) > 0.0
    command = arm.step(99, rate=0.01)
    status = bench.status("/arm/status", arm.period)
    assert status["state"] == "stopped" and "the rover drives" in status["reason"]
    assert list(command.velocity) == [0.0] * len(COMMANDED)


def test_a_goal_on_the_ground_is_found_from_where_the_rover_stands(bench: Bench) -> None:
    """Turned by a quarter and tilted: the point asked for in odom is the same point of space."""
    arm = ArmBench(bench, "drive")
    attitude = pin.Quaternion(pin.rpy.rpyToMatrix(0.1, -0.15, math.pi / 2))
    base_in_odom = pin.SE3(attitude, np.array([3.0, -2.0, 0.5]))
    pose = arm.here.pose.pose
    pose.position.x, pose.position.y, pose.position.z = base_in_odom.translation.tolist()
    pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = attitude.coeffs().tolist()
    arm.step()
    tip = np.array([float(value) for value in arm.status()["tip_in_base_m"].split()])
    wanted = tip + np.array([0.0, 0.03, 0.02])
    status = arm.goal("/arm/goal_pose", pose_goal(*base_in_odom.act(wanted).tolist(), "odom"))
    assert status["state"] in ("moving", "reached"), status["reason"]
    assert arm.node.state.tasks.arm.target.tip == pytest.approx(wanted, abs=1e-4)
    status = arm.goal("/arm/goal_pose", pose_goal(*wanted.tolist(), "camera"))
    assert "header.frame_id = 'camera': allowed is one of base_link, map, odom" in status["reason"]


def task(name: str, **numbers: str) -> Any:
    return status_message(at(1), name, numbers)


UNKNOWN_TASKS = {
    "unknown task": (task("wave"), "unknown task 'wave': there are dig, drill, dump"),
    "unknown key": (task("guarded_move", sped="0.01"), "unknown key 'sped' (there are preempt, direction, speed"),
    "no number": (task("guarded_move", force="much"), "force = 'much'"),
    "out of range": (task("guarded_move", force="1000"), "force = '1000'"),
    "no target": (task("place"), "position is missing"),
    "no length": (task("guarded_move", direction="0 0 0"), "allowed is a vector that has a length"),
    "beyond reach": (task("guarded_move", direction="1 0 0", distance="0.5"), "the arm can follow"),
    "nothing": (DiagnosticArray(), "0 statuses: allowed is one"),
}


@pytest.mark.parametrize("message,reason", UNKNOWN_TASKS.values(), ids=UNKNOWN_TASKS.keys())
def test_tasks_that_cannot_be_are_refused_with_what_is_allowed(arm: ArmBench, message: Any, reason: str) -> None:
    arm.step()
    before = list(arm.step().position)
    status = arm.goal("/arm/task", message)
    assert status["state"] == "refused" and reason in status["reason"]
    assert list(arm.step().position) == before


def test_a_guarded_move_ends_where_the_wrist_feels_the_ground(arm: ArmBench) -> None:
    arm.step()
    status = arm.goal("/arm/task", task("guarded_move", force="8", distance="0.1"))
    assert (status["state"], status["task"]) == ("moving", "guarded_move")
    assert float(status["contact_force_n"]) == pytest.approx(0.0, abs=0.1)
    assert 0.0 < float(status["progress"]) < 1.0 and 0.0 < float(status["time_to_go"]) < 10.0
    second = arm.goal("/arm/task", task("stow"))
    assert second["state"] == "refused" and "guarded_move is under way" in second["reason"]
    arm.force = (0.0, 0.0, 5.0)  # 8.25 N from below
    status = arm.status()
    assert float(status["overshoot_n"]) == pytest.approx(0.25, abs=0.1)
    still = arm.step().position
    arm.step(25)
    assert list(arm.step().position) == pytest.approx(list(still), abs=1e-3)
    arm.force = (0.0, 0.0, -3.25)
    assert arm.goal("/arm/task", task("unfold", preempt="true"))["state"] in ("moving", "reached")


def test_without_a_wrist_sensor_tasks_that_feel_are_refused(arm: ArmBench) -> None:
    arm.force = (math.nan, math.nan, math.nan)
    arm.step()
    status = arm.goal("/arm/task", task("guarded_move"))
    assert status["state"] == "refused" and "feels no forces" in status["reason"]
    assert arm.goal("/arm/task", task("stow"))["state"] == "moving"


def test_in_real_time_it_acts_without_the_drive(bench: Bench) -> None:
    """A drive that is down and started again does not keep the arm from holding."""
    node = bench.start(ArmNode, "sensors", "drive", "arm", lockstep=False)
    bench.connect(node, lockstep=False)
    for period in (1, 2):
        bench.send("/joint_states", joints(period))
        bench.until(lambda period=period: node.latest.stamp_of("/joint_states") == at(period), "joints are there")
        bench.send("/imu/data", imu(period))
    assert tuple(bench.answer("/arm_command", 2).name) == COMMANDED


def test_in_real_time_any_input_may_come_first(bench: Bench) -> None:
    node = bench.start(ArmNode, "sensors", "arm", lockstep=False)
    bench.connect(node, lockstep=False)
    bench.send("/imu/data", imu(3000))
    assert list(bench.answer("/arm_command", 3000).name) == []
    for period in (3001, 3002):
        bench.send("/joint_states", joints(period))
        bench.until(lambda period=period: node.latest.stamp_of("/joint_states") == at(period), "joints are there")
        bench.send("/imu/data", imu(period))
    assert tuple(bench.answer("/arm_command", 3002).name) == COMMANDED


def test_a_goal_under_the_ground_is_refused_as_such(arm: ArmBench) -> None:
    """The rover's wheels tell where the ground is: 0.47 m under base_link."""
    arm.step()
    status = arm.goal("/arm/goal_pose", pose_goal(1.2, 0.0, -0.75))
    assert status["state"] == "refused"
    assert "below the plane on which the machine stands" in status["reason"]


def test_a_pause_ends_as_reached_and_resuming_carries_the_motion_on(arm: ArmBench) -> None:
    arm.step()
    assert arm.goal("/arm/joint_goal", joint_goal((), [], "stow"))["state"] == "moving"
    status = arm.goal("/arm/task", task("pause"))
    while status["state"] == "moving":
        status = arm.status()
    assert status["state"] == "reached" and "paused at" in status["reason"] and 0.0 < float(status["progress"]) < 1.0
    assert list(arm.step(10).velocity) == [0.0] * len(COMMANDED)
    status = arm.goal("/arm/task", task("resume"))
    while status["state"] == "moving":
        status = arm.status()
    assert (status["state"], status["reason"]) == ("reached", "")
    assert [arm.angles[name] for name in ARM] == pytest.approx(arm.node.app.params.named_poses["stow"], abs=1e-3)


def test_a_share_of_its_power_limits_what_the_arm_plans(arm: ArmBench) -> None:
    """The load has 80 W, and the plant gives each motor that share of its current. It used to count as all of it."""
    arm.step(6, switch="0.02")
    status = arm.goal("/arm/joint_goal", joint_goal((), [], "stow"))
    assert status["state"] == "refused" and "of what it can give, however slowly it moves" in status["reason"]
    arm.step(10, switch="0.25")
    arm.goal("/arm/joint_goal", joint_goal((), [], "stow"))
    granted = arm.node.state.tasks.arm
    assert granted.granted == EVERYTHING, "the bench switches it on again"
    arm.step(1, switch="0.25")
    arm.step(10, switch="0.25")
    granted = arm.node.state.tasks.arm
    assert granted.granted == Granted(20.0, 0.25)
    assert granted.phase.pace == 1.0 and granted.status == "moving"


def test_a_place_in_a_rock_that_the_camera_sees_is_refused(bench: Bench) -> None:
    """A rock of 0.2 m in front of the rover: a goal over it is taken, one in it or below the ground refused."""
    arm = ArmBench(bench, "drive")
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(0.6, 2.0, 0.02), np.arange(-0.6, 0.6, 0.02)))
    rock = np.hypot(x - 1.2, y) < 0.2
    arm.points = np.column_stack([x, y, np.where(rock, -0.27, -0.47)])
    arm.step(50)
    refused = arm.goal("/arm/goal_pose", pose_goal(1.2, 0.0, -0.40))
    assert refused["state"] == "refused"
    assert "130 mm below the ground that the camera has seen: at most 25 mm" in refused["reason"], refused["reason"]
    beside = arm.goal("/arm/goal_pose", pose_goal(1.2, 0.45, -0.56))
    assert beside["state"] == "refused" and "90 mm below the ground that the camera" in beside["reason"]
    behind = arm.goal("/arm/goal_pose", pose_goal(-0.9, 0.0, -0.60))
    assert behind["state"] == "refused" and "below the plane on which the machine stands" in behind["reason"]
    assert arm.goal("/arm/goal_pose", pose_goal(1.2, 0.0, -0.26))["state"] in ("moving", "reached")
