"""The node of the drive, alone: goals, velocity commands, measurements that cannot be used, a start in mid-run."""

import math
import time
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Path
from node_bench import JOINTS, STEERS, WHEELS, Bench, at, cloud, imu, joints, stamp_of, sun, tick

from ros_messages import ros_time
from sojourn_contract.events import format_tick
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import battery_state
from sojourn_contract.silence import LOST_S, Silence
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import Header
from sojourn_drive.goals import GoalStatus
from sojourn_drive.node import DriveNode
from sojourn_flight.planning.goal import Goal, GoalOutcome

START_X = -1.0
"""Where the scenario puts the rover."""


@pytest.fixture
def drive(bench: Bench) -> DriveNode:
    node = bench.start(DriveNode, "sensors", "drive")
    bench.connect(node)
    return node


def measure(bench: Bench, period: int, joint_states: Any = None, felt: Any = None) -> None:
    """What the sensors say at rest in a period: no Sun, nothing ahead."""
    bench.send("/joint_states", joint_states or joints(period))
    bench.send("/imu/data", felt or imu(period))
    if period % 50 == 0:
        bench.send("/sun_direction", sun(period))
        bench.send("/hazcam/points", cloud(period))


def step(bench: Bench, *periods: int, angles: dict[str, float] | None = None) -> Any:
    """Measurements at rest for these periods, joints at these angles; the last wheel command."""
    for period in periods:
        measure(bench, period, joints(period, angles))
        bench.answer("/odom", period)
        command = bench.answer("/drive_command", period)
    return command


def pose(x: float, y: float, frame: str = "map", stamp: int = 0) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id = frame
    message.header.stamp = ros_time(stamp)
    message.pose.position.x, message.pose.position.y = x, y
    message.pose.orientation.w = 0.0  # any heading
    return message


def twist(x: float, stamp: int = 0) -> TwistStamped:
    message = TwistStamped()
    message.header.stamp = ros_time(stamp)
    message.twist.linear.x = x
    return message


def rates(command: Any) -> list[float]:
    by_name = dict(zip(command.name, command.velocity, strict=True))
    return [by_name[name] for name in WHEELS]


def send_event(bench: Bench, node: DriveNode, name: str, message: Any) -> None:
    """Send a goal and wait until it is there, so that it takes effect in the next period."""
    before = node.events.received.get(name, 0)
    bench.send(name, message)
    bench.until(lambda: node.events.received.get(name, 0) > before, f"{name} has arrived")


def test_odometry_tells_the_rates_of_roll_and_pitch(bench: Bench, drive: DriveNode) -> None:
    """As the gyro measures them: they were always zero."""
    step(bench, 1)
    rocking = imu(2)
    rocking.angular_velocity.x, rocking.angular_velocity.y = 0.02, -0.03
    bench.send("/joint_states", joints(2))
    bench.send("/imu/data", rocking)
    told = bench.answer("/odom", 2).twist.twist.angular
    assert (told.x, told.y) == pytest.approx((0.02, -0.03), abs=1e-12)


def test_a_goal_makes_it_move(bench: Bench, drive: DriveNode) -> None:
    command = step(bench, 1)
    assert set(command.name) == set((*WHEELS, *STEERS)) and rates(command) == [0.0] * 6
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0, stamp=at(4)))
    step(bench, 2, 3)
    assert rates(bench.answer("/drive_command", 3)) == [0.0] * 6, "its stamp has not come yet"
    command = step(bench, *range(4, 51))
    assert min(rates(command)) > 0.1
    status = bench.status("/drive/status", 50)
    assert (status["state"], status["goal_stamp"]) == ("moving", str(at(4)))
    assert float(status["distance_to_go"]) == pytest.approx(3.0, abs=0.05)
    assert [stamp_of(message) for message in bench.received["/drive/status"]] == [at(50)]


def test_a_question_is_answered_and_moves_nothing(bench: Bench, drive: DriveNode) -> None:
    question = Path()
    question.header.frame_id, question.header.stamp = "map", ros_time(at(4))
    question.poses = [pose(2.0, 0.0)]
    step(bench, 1)
    send_event(bench, drive, "/drive/question", question)
    command = step(bench, *range(2, 51))
    status = bench.status("/drive/status", 50)
    assert (status["asked_stamp"], status["asked_state"]) == (str(at(4)), "allowed")
    assert float(status["asked_length_m"]) == pytest.approx(3.0, abs=0.05)
    assert float(status["asked_energy_wh"]) > 0.0 and float(status["asked_time_s"]) > 30.0
    assert rates(command) == [0.0] * 6 and (status["state"], status["goal_stamp"]) == ("idle", "0")
    question.header.frame_id, question.header.stamp = "moon", ros_time(at(52))
    send_event(bench, drive, "/drive/question", question)
    step(bench, *range(51, 101))
    status = bench.status("/drive/status", 100)
    assert (status["asked_stamp"], status["asked_state"]) == (str(at(52)), "refused")
    assert "allowed is one of map, odom, base_link" in status["asked_reason"]
    assert drive.counters.refused == {"/drive/question": 1}


def test_goals_in_the_frame_of_the_machine(bench: Bench, drive: DriveNode) -> None:
    step(bench, 1)
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0, "base_link"))
    step(bench, 2)
    assert drive.state.drive.follower is not None
    assert drive.state.drive.follower.goal.points[-1] == pytest.approx((START_X + 2.0, 0.0), abs=1e-3)


def test_a_goal_too_far_off_is_refused_with_the_reason(bench: Bench, drive: DriveNode) -> None:
    """Wherever the simulated ground ends: the drive does not know."""
    step(bench, *range(1, 48))
    send_event(bench, drive, "/goal_pose", pose(0.0, -300.5, "odom"))
    command = step(bench, 48, 49, 50)
    status = bench.status("/drive/status", 50)
    assert status["state"] == "refused" and "m long, allowed are 200.0 m" in status["reason"]
    assert rates(command) == [0.0] * 6


def test_goals_in_an_unknown_frame_are_refused_with_the_reason(bench: Bench, drive: DriveNode) -> None:
    reason = "header.frame_id = 'moon': allowed is one of map, odom, base_link"
    step(bench, *range(1, 48))
    send_event(bench, drive, "/goal_pose", pose(1.0, 0.0, "moon"))
    command = step(bench, 48, 49, 50)
    status = bench.status("/drive/status", 50)
    assert status["state"] == "refused" and reason in status["reason"]
    assert bench.received["/drive/status"][-1].status[0].level == b"\x01"
    assert drive.counters.refused == {"/goal_pose": 1} and reason in drive.counters.last_refusal
    assert rates(command) == [0.0] * 6


@pytest.mark.parametrize("second", [pose(0.0, -300.5, "odom"), pose(1.0, 0.0, "moon")], ids=["too far", "no frame"])
def test_a_refused_goal_hides_the_one_that_goes_on_for_two_seconds_only(
    bench: Bench, drive: DriveNode, second: PoseStamped
) -> None:
    """It was the last word of the drive: the goal under way was never told of again, nor how it ended."""
    step(bench, 1)
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0, stamp=at(4)))
    step(bench, *range(2, 60))
    second.header.stamp = ros_time(at(60))
    send_event(bench, drive, "/goal_pose", second)
    assert min(rates(step(bench, *range(60, 101)))) > 0.1, "it drives on"
    told = bench.status("/drive/status", 100)
    assert (told["state"], told["goal_stamp"]) == ("refused", str(at(60)))
    assert drive.app.to_keep(drive.state)["goal"] == {"state": "moving", "reason": "", "stamp": at(4)}
    step(bench, *range(101, 201))
    told = bench.status("/drive/status", 200)
    assert (told["state"], told["goal_stamp"], told["reason"]) == ("moving", str(at(4)), "")
    send_event(bench, drive, "/cmd_vel", twist(0.0))
    step(bench, *range(201, 251))
    told = bench.status("/drive/status", 250)
    assert (told["state"], told["goal_stamp"]) == ("stopped", str(at(4)))


def test_a_goal_that_ends_while_another_is_refused_is_told_of() -> None:
    first = GoalStatus().begun(Header(at(4))).noted([])
    second = first.begun(Header(at(60)))
    assert second.noted([], waits=True).under_way == first and second.noted([]).under_way != first
    refused = second.noted([GoalOutcome("refused", "too far", Goal.at(1.0, 0.0, None, second.number), 1.0)])
    over = refused.told(at(60)).noted([GoalOutcome("reached", "", Goal.at(1.0, 0.0, None, first.number), 0.0)])
    assert over.state == "refused" and over.told(at(159)).state == "refused"
    assert (over.told(at(160)).state, over.told(at(160)).stamp) == ("reached", at(4))
    third = over.begun(Header(at(100))).noted([])
    assert third.told(at(300)) == third and third.under_way == third
    set_back = refused.told(at(60)).told(at(5))  # a clock that was wrong
    assert (set_back.state, set_back.stamp) == ("moving", at(4))
    lost = refused.given_up("nothing is measured")
    assert lost.told(at(1)).told(at(900)).state == "failed"


def test_a_goal_that_waits_goes_on_behind_one_that_is_refused() -> None:
    """Both have come before the drive could look at the first; that one was told of as the goal before it, for ever."""
    first = GoalStatus().begun(Header(at(4))).noted([])
    waiting = first.begun(Header(at(60)))
    refused = waiting.refused(Header(at(61)), "no such frame", waits=True)
    assert refused.under_way == first
    seen = refused.noted([], waits=True).noted([GoalOutcome("stopped", "", Goal.at(1.0, 0.0, None, first.number), 1.0)])
    after = seen.told(at(62)).told(at(200))
    assert (after.state, after.stamp) == ("moving", at(60)) and after.under_way == after
    both = refused.noted([GoalOutcome("refused", "too far", Goal.at(1.0, 0.0, None, waiting.number), 1.0)])
    for now in (62, 200, 201):
        both = both.told(at(now))
    assert (both.state, both.reason) == ("refused", "too far")
    assert both.told(at(400)) == first
    again = refused.refused(Header(at(62)), "no such frame", waits=True)
    assert again.goes_on == waiting


def test_a_stop_is_heard_with_the_arm_out_too(bench: Bench, drive: DriveNode) -> None:
    """It stands, as it is asked to: nothing is refused, and how the last goal ended is still told."""
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0))
    step(bench, *range(1, 41))
    out = {"arm_elbow_joint": -2.6}
    step(bench, *range(41, 101), angles=out)
    send_event(bench, drive, "/cmd_vel", twist(0.0))
    step(bench, *range(101, 151), angles=out)
    assert bench.status("/drive/status", 150)["state"] == "stopped" and drive.counters.refused == {}


def test_a_path_without_points_is_refused(bench: Bench, drive: DriveNode) -> None:
    path = Path()
    path.header.frame_id = "map"
    send_event(bench, drive, "/waypoints", path)
    step(bench, *range(1, 51))
    status = bench.status("/drive/status", 50)
    assert status["state"] == "refused" and "at least one pose" in status["reason"]


def test_a_goal_that_is_no_number_does_not_stop_the_lock_step(bench: Bench) -> None:
    """The tick announces one goal; that it is refused must not be waited for for ever."""
    node = bench.start(DriveNode, "sensors", "drive", "operator")
    bench.connect(node)
    bench.send("/operator/tick", tick(5, format_tick({"/goal_pose": 1, "/arm/goal_pose": 3}, False)))
    step(bench, *range(1, 10))
    bench.send("/joint_states", joints(10))
    bench.send("/imu/data", imu(10))
    bench.until(lambda: not node.barrier.missing(), "all but the goal is in")
    bench.spin(0.05)
    assert node.now == at(9), "it waits for the goal that the tick has announced"
    assert node._waits_for() == ("operator", "the goals that its tick announces")
    bench.send("/goal_pose", pose(math.nan, 0.0))
    bench.answer("/drive_command", 10)
    assert node.counters.refused == {"/goal_pose": 1}


def test_a_tick_in_other_words_is_refused(bench: Bench) -> None:
    node = bench.start(DriveNode, "sensors", "drive", "operator")
    bench.connect(node)
    bench.send("/operator/tick", tick(5, "start please"))
    step(bench, *range(1, 11))
    assert node.counters.refused == {"/operator/tick": 1}


def test_velocity_commands_and_their_age(bench: Bench, drive: DriveNode) -> None:
    step(bench, 1)
    send_event(bench, drive, "/cmd_vel", twist(0.03, at(2)))
    assert min(rates(step(bench, *range(2, 11)))) > 0.05
    command = step(bench, *range(11, 52))
    assert rates(command) == [0.0] * 6, "a velocity command that is not followed by another is lost"
    send_event(bench, drive, "/cmd_vel", twist(0.03, at(51) - 500_000_001))
    step(bench, 52)
    assert drive.counters.refused == {"/cmd_vel": 1}
    assert "/cmd_vel.header.stamp" in drive.counters.last_refusal


def test_a_velocity_command_ends_a_goal_that_has_not_begun(bench: Bench, drive: DriveNode) -> None:
    step(bench, *range(1, 49))
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0, stamp=at(49)))
    send_event(bench, drive, "/cmd_vel", twist(0.0, at(49)))
    step(bench, 49, 50)
    status = bench.status("/drive/status", 50)
    assert (status["state"], status["reason"]) == ("stopped", "stopped by operator")
    assert drive.state.drive.follower is None


def test_two_goals_with_one_stamp_are_two_goals(bench: Bench, drive: DriveNode) -> None:
    """The end of the first is not the end of the second: both are stamped zero, as people send them."""
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0))
    step(bench, *range(1, 49))
    send_event(bench, drive, "/goal_pose", pose(3.0, 0.0))
    step(bench, 49, 50)
    assert bench.status("/drive/status", 50)["state"] == "moving"


def test_measurements_that_cannot_be_used_stop_the_wheels(bench: Bench, drive: DriveNode) -> None:
    """For longer than a second, then it goes on; every period is answered, and a goal that came meanwhile counts."""
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0, stamp=at(1)))
    assert min(rates(step(bench, *range(1, 40)))) > 0.1
    for period in range(40, 101):
        bad = joints(period)
        bad.position[3] = math.nan
        measure(bench, period, bad)
        assert rates(bench.answer("/drive_command", period)) == [0.0] * 6
        bench.answer("/odom", period)
        if period == 60:
            send_event(bench, drive, "/goal_pose", pose(0.0, 0.0, stamp=at(61)))
    assert drive.counters.refused == {"/joint_states": 61}
    assert "/joint_states.position[3] = nan" in drive.counters.last_refusal
    bench.until(lambda: bench.heartbeats("drive")[-1].stamp == at(100), "the heartbeat of two seconds")
    beat = bench.heartbeats("drive")[-1]
    assert beat.refused == {"/joint_states": 61}
    assert beat.values["last refusal"] == drive.counters.last_refusal
    command = step(bench, *range(101, 151))
    assert drive.counters.refused == {"/joint_states": 61}
    status = bench.status("/drive/status", 150)
    assert (status["state"], status["goal_stamp"]) == ("moving", str(at(61)))
    assert min(rates(command)) > 0.1


@pytest.mark.parametrize("what", ["names", "rates"])
def test_joint_states_that_lack_something_are_refused(bench: Bench, drive: DriveNode, what: str) -> None:
    step(bench, 1)
    bad = joints(2)
    if what == "names":
        bad.name = ["somebody_elses_joint"] * len(JOINTS)
    else:
        bad.velocity = []
    bench.send("/joint_states", bad)
    bench.send("/imu/data", imu(2))
    assert rates(bench.answer("/drive_command", 2)) == [0.0] * 6
    step(bench, 3)
    assert drive.counters.refused == {"/joint_states": 1}


def test_switches_limit_the_drive(bench: Bench) -> None:
    node = bench.start(DriveNode, "sensors", "drive", "power")
    bench.connect(node)
    send_event(bench, node, "/goal_pose", pose(2.0, 0.0))
    step(bench, *range(1, 5))
    bench.send("/power/switches", status_message(at(5), "switches", {"drive": "0.25", "steer": "on"}))
    step(bench, 5)
    assert node.state.heard.power_limit == 0.25
    bench.send("/power/switches", status_message(at(10), "switches", {"drive": "nonsense"}))
    step(bench, *range(6, 11))
    assert node.state.heard.power_limit == 0.25 and node.counters.refused == {"/power/switches": 1}
    bench.send("/power/switches", status_message(at(15), "switches", {"drive": "off"}))
    step(bench, *range(11, 16))
    assert node.state.heard.power_limit == 0.0


def test_without_its_imu_it_says_who_switched_it_off(bench: Bench) -> None:
    """What an operator reads at night: not that a number was refused, but why there is none."""
    node = bench.start(DriveNode, "sensors", "drive", "power")
    bench.connect(node)
    send_event(bench, node, "/goal_pose", pose(2.0, 0.0))
    step(bench, *range(1, 5))
    bench.send("/power/switches", status_message(at(5), "switches", {"imu": "off", "drive": "on"}))
    step(bench, 5)
    for period in range(6, 181):
        silent = imu(period)
        silent.angular_velocity.x = math.nan
        measure(bench, period, felt=silent)
        if period % 5 == 0:
            bench.send("/power/switches", status_message(at(period), "switches", {"imu": "off", "drive": "on"}))
        if period % 50 == 0:
            bench.send("/battery_state", battery_state(at(period), 28.0, 0.0, 290.0, 0.9, 0.9 * 57600.0, 57600.0))
        bench.answer("/odom", period)
    reason = node.state.asked.last.reason
    assert reason.startswith("no usable /imu/data for 3.") and reason.endswith("switched off imu")


@pytest.mark.parametrize("refuse,state", [("true", "refused"), ("false", "moving")])
def test_a_goal_beyond_the_charge_is_refused_by_default(bench: Bench, refuse: str, state: str) -> None:
    """Seven metres climbing one take more than what is left of 13 % above the reserve of 12.25 %."""
    node = bench.start(DriveNode, "sensors", "drive", "power", overrides=[f"drive.energy.refuse={refuse}"])
    bench.connect(node)
    for period in range(1, 101):
        if period % 5 == 0:
            bench.send("/power/switches", status_message(at(period), "switches", {"drive": "on"}))
        if period % 50 == 0:
            bench.send("/battery_state", battery_state(at(period), 28.0, 4.0, 290.0, 0.13, 0.13 * 57600.0, 57600.0))
        if period == 51:
            goal = pose(START_X + 7.0, 0.0)
            goal.pose.position.z = 1.0
            send_event(bench, node, "/goal_pose", goal)
        step(bench, period)
    status = bench.status("/drive/status", 100)
    assert status["state"] == state
    if state == "refused":
        assert "the charge does not suffice: forecast" in status["reason"] and "climbs +1.00 m" in status["reason"]
        assert "from 13.0 % of charge down to the reserve of 12.2 %" in status["reason"]
        return
    assert float(status["energy_used_wh"]) == pytest.approx(28.0 * 4.0 * 0.98 / 3600.0, rel=0.05)
    assert float(status["energy_forecast_wh"]) > 2.5
    assert float(status["energy_to_go_wh"]) == pytest.approx(float(status["energy_forecast_wh"]), rel=0.02)


def test_started_in_the_middle_of_a_run_in_real_time(bench: Bench) -> None:
    """Stamps are far from zero at once, and the first input may be any of the two."""
    node = bench.start(DriveNode, "sensors", "drive", lockstep=False)
    bench.connect(node, lockstep=False)
    assert not bench.heartbeats("drive") or bench.heartbeats("drive")[-1].stamp == 0
    bench.send("/imu/data", imu(5000))
    assert rates(bench.answer("/drive_command", 5000)) == [0.0] * 6
    step(bench, 5001, 5002)
    send_event(bench, node, "/cmd_vel", twist(0.03))
    command = step(bench, *range(5003, 5012))
    assert min(rates(command)) > 0.05
    assert node.counters.refused == {}


@pytest.mark.parametrize("lockstep", [True, False])
def test_velocities_that_stop_coming_stop_the_rover_within_half_a_second(bench: Bench, lockstep: bool) -> None:
    """From full speed, with commands at 10 Hz until then; the last takes effect in period 100."""
    node = bench.start(DriveNode, "sensors", "drive", lockstep=lockstep)
    bench.connect(node, lockstep=lockstep)
    step(bench, 1)
    for period in range(5, 105, 5):
        send_event(bench, node, "/cmd_vel", twist(0.1))
        command = step(bench, *range(period - 3, period + 2))
    assert min(rates(command)) > 0.7, "full speed at the rim"
    commands = [rates(step(bench, period)) for period in range(102, 122)]
    assert max(commands[7]) > 0.7, "0.18 s after the last it still drives"
    assert commands[18] == [0.0] * 6, "0.4 s after it, it is told to stand: 0.1 s are left for the motors"


def test_in_real_time_an_old_measurement_is_lost(bench: Bench) -> None:
    node = bench.start(DriveNode, "sensors", "drive", lockstep=False)
    bench.connect(node, lockstep=False)
    step(bench, 1)
    send_event(bench, node, "/cmd_vel", twist(0.03))
    assert min(rates(step(bench, *range(2, 12)))) > 0.0
    for period in range(12, 18):  # the encoders are silent, the IMU is not
        bench.send("/imu/data", imu(period))
        command = bench.answer("/drive_command", period)
    assert rates(command) == [0.0] * 6
    bench.send("/imu/data", imu(3))
    bench.until(lambda: node.counters.refused, "a stamp from the past is refused")
    assert node.counters.refused == {"/imu/data": 1} and "header.stamp" in node.counters.last_refusal


def test_in_real_time_it_acts_in_silence_but_not_after_it_was_held_up_itself(bench: Bench) -> None:
    """A process without a core for seconds has what it missed in its queues: it is nobody's silence."""
    node = bench.start(DriveNode, "sensors", "drive", lockstep=False)
    bench.connect(node, lockstep=False)
    step(bench, *range(1, 12))
    now = time.monotonic()
    node._silence = Silence(now - 100.0)
    node.poll()
    assert node.now == at(11)
    for look in range(1, 20):
        node._bear_silence(now + 0.2 * look)
    assert node.now > at(11) + LOST_S * NANOSECONDS, "the sensors have been silent while it looked"


def test_with_the_arm_out_it_refuses_goals_and_velocities_with_the_reason(bench: Bench, drive: DriveNode) -> None:
    out = {"arm_azimuth_joint": 0.0}
    step(bench, *range(1, 48), angles=out)
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0))
    send_event(bench, drive, "/cmd_vel", twist(0.03))
    command = step(bench, 48, 49, 50, angles=out)
    assert rates(command) == [0.0] * 6
    assert drive.counters.refused == {"/goal_pose": 1, "/cmd_vel": 1}
    status = bench.status("/drive/status", 50)
    assert status["state"] == "refused" and "arm_azimuth_joint is 1.57 from 'stow'" in status["reason"]
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0))
    assert min(rates(step(bench, *range(51, 101)))) > 0.1, "stowed, it drives"


def test_it_stops_when_the_arm_leaves_its_driving_pose(bench: Bench, drive: DriveNode) -> None:
    send_event(bench, drive, "/goal_pose", pose(2.0, 0.0))
    assert min(rates(step(bench, *range(1, 41)))) > 0.1
    command = step(bench, *range(41, 101), angles={"arm_elbow_joint": -2.6})
    assert rates(command) == [0.0] * 6 and drive.state.drive.follower is None
    status = bench.status("/drive/status", 100)
    assert status["state"] == "stopped" and "arm_elbow_joint is 0.10 from 'stow'" in status["reason"]


def test_the_interlock_can_be_switched_off(bench: Bench) -> None:
    node = bench.start(DriveNode, "sensors", "drive", overrides=["arm.interlock.enabled=false"])
    bench.connect(node)
    send_event(bench, node, "/goal_pose", pose(2.0, 0.0))
    assert min(rates(step(bench, *range(1, 41), angles={"arm_azimuth_joint": 0.0}))) > 0.1


def test_a_sighting_of_the_sun_corrects_the_heading_once(bench: Bench, drive: DriveNode) -> None:
    """The scenario's Sun stands 30 degrees over the east, straight ahead of a rover with heading 0."""
    step(bench, *range(1, 50))
    bench.send("/joint_states", joints(50))
    bench.send("/imu/data", imu(50))
    low = math.radians(30.0)
    bench.send("/hazcam/points", cloud(50))
    bench.send("/sun_direction", sun(50, math.cos(low), 0.0, math.sin(low)))
    status = bench.status("/drive/status", 50)
    assert (status["sun"], status["sun_fixes"], status["sun_rejected"]) == ("heading fixed", "1", "0")
    assert abs(float(status["sun_deviation_sigma"])) < 0.1
    step(bench, *range(51, 100))
    bench.send("/joint_states", joints(100))
    bench.send("/imu/data", imu(100))
    bench.send("/hazcam/points", cloud(100))
    bench.send("/sun_direction", sun(100, 0.0, math.cos(low), math.sin(low)))
    status = bench.status("/drive/status", 100)
    assert status["sun"].startswith("rejected: heading off by -90.0 deg")
    assert (status["sun_fixes"], status["sun_rejected"]) == ("1", "1")


ROCK_AHEAD = [[2.0 + 0.03 * i, 0.03 * j, -0.47 + (0.35 if abs(j) < 6 and 3 < i < 15 else 0.0)]
              for i in range(-30, 30) for j in range(-30, 31)]  # fmt: skip
"""Points of level ground with a block on it, 2.1 to 2.4 m ahead of base_link [m]."""


def see(bench: Bench, period: int, points: Any) -> None:
    """A whole second with a look of the hazard camera at its end."""
    step(bench, *range(period - 49, period))
    bench.send("/joint_states", joints(period))
    bench.send("/imu/data", imu(period))
    bench.send("/sun_direction", sun(period))
    bench.send("/hazcam/points", cloud(period, points))
    bench.answer("/drive_command", period)


def test_a_goal_in_an_obstacle_that_has_been_seen_is_refused(bench: Bench, drive: DriveNode) -> None:
    see(bench, 50, ROCK_AHEAD)
    send_event(bench, drive, "/goal_pose", pose(START_X + 2.25, 0.0))
    command = step(bench, *range(51, 101))
    status = bench.status("/drive/status", 100)
    assert status["state"] == "refused"
    assert status["reason"].startswith("the goal (1.25, 0.00) lies in an obstacle: step of 0.3")
    assert status["reason"].endswith("limit 0.12 m") and rates(command) == [0.0] * 6


def test_a_velocity_command_is_held_before_an_obstacle_and_says_why(bench: Bench, drive: DriveNode) -> None:
    """The block stands a hand's breadth before the wheels; away from it the rover may go."""
    see(bench, 50, [[x - 1.1, y, z] for x, y, z in ROCK_AHEAD])
    for period in range(51, 101):
        if period % 5 == 1:
            send_event(bench, drive, "/cmd_vel", twist(0.05, at(period)))
        command = step(bench, period)
        assert rates(command) == [0.0] * 6
    status = bench.status("/drive/status", 100)
    assert status["reason"].startswith("stopped before step of 0.35 m at (") and status["obstacle"] in status["reason"]
    send_event(bench, drive, "/cmd_vel", twist(-0.05, at(101)))
    assert max(rates(step(bench, *range(101, 109)))) < 0.0


def test_a_cloud_that_is_no_cloud_is_refused_and_the_period_is_answered(bench: Bench, drive: DriveNode) -> None:
    step(bench, *range(1, 50))
    bad = cloud(50, [[1.0, 0.0, math.nan]])
    bench.send("/joint_states", joints(50))
    bench.send("/imu/data", imu(50))
    bench.send("/sun_direction", sun(50))
    bench.send("/hazcam/points", bad)
    bench.answer("/drive_command", 50)
    assert drive.counters.refused == {"/hazcam/points": 1} and "z[0] = nan" in drive.counters.last_refusal
