"""The node of the plant, alone: the start, commands that cannot be followed, silence and whom it blames, the end."""

import math
import time
from collections.abc import Callable
from typing import Any

import pytest
from node_bench import ARM, STEERS, WHEELS, Bench, at, command, imu, joints, stamp_of, tick

from ros_messages import ros_time, serialized
from sojourn_contract.checkpoint_topic import KEPT
from sojourn_contract.events import format_tick
from sojourn_contract.handing_over import reader
from sojourn_contract.heartbeat import (
    MATCHED,
    READY,
    STALLED,
    WAITING_FOR,
    Counters,
    heartbeat_message,
    read_heartbeats,
    status_message,
)
from sojourn_contract.silence import Silence
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import outputs_of, topic
from sojourn_contract.values import Header
from sojourn_drive.node import DriveNode
from sojourn_plant.node import PlantNode
from sojourn_plant.roster import Roster
from sojourn_sensors.node import SensorsNode

DRIVEN = (*WHEELS, *STEERS)


pytestmark = pytest.mark.usefixtures("quick_start")


def begin(bench: Bench, *participants: str, **parameters: Any) -> PlantNode:
    """A plant whose run has begun: the peer says that all others are ready."""
    plant = bench.start(PlantNode, *participants, **parameters)
    bench.connect(plant, parameters.get("lockstep", True))
    bench.say_ready(*(role for role in participants if role != "plant"))
    bench.until(lambda: bench.received["/truth/joint_states"], "the truth of the first period")
    return plant


def drive(bench: Bench, first: int, last: int, make: Callable[[int], Any]) -> None:
    """Answer periods with a command, in lock-step."""
    for period in range(first, last + 1):
        bench.answer("/truth/joint_states", period)
        bench.send("/drive_command", make(period))
    bench.answer("/truth/joint_states", last + 1)


def wheel_rates(message: Any) -> list[float]:
    by_name = dict(zip(message.name, message.velocity, strict=True))
    return [by_name[name] for name in WHEELS]


def test_begins_when_all_are_ready(bench: Bench) -> None:
    plant = bench.start(PlantNode, "plant", "drive", "arm")
    bench.connect(plant)
    bench.say_ready("drive")
    bench.until(lambda: len(bench.heartbeats("plant")) > 5, "heartbeats before the run")
    assert not bench.received["/clock"] and {beat.stamp for beat in bench.heartbeats("plant")} == {0}
    bench.say_ready("arm")
    bench.answer("/clock", 1)
    bench.answer("/truth/odom", 1)
    bench.send("/drive_command", command(DRIVEN, 1))
    bench.spin(0.1)
    assert len(bench.received["/clock"]) == 1, "it waits for the arm"
    bench.send("/arm_command", command(ARM, 1))
    bench.answer("/truth/odom", 2)
    assert [stamp_of(message) for message in bench.received["/truth/odom"]] == [at(1), at(2)]


def test_nothing_acts_before_the_run(bench: Bench) -> None:
    plant = bench.start(PlantNode, "plant", "drive", "arm")
    bench.connect(plant)
    bench.send("/drive_command", command(DRIVEN, 1))
    bench.send("/arm_command", command(ARM, 1))
    bench.until(lambda: plant.barrier.is_complete(), "the commands have come")
    bench.spin(0.1)
    assert plant.now == 0 and not bench.received["/clock"]


def test_who_never_shows_up_is_named(bench: Bench) -> None:
    plant = bench.start(PlantNode, "plant", "sensors", "drive", "arm", lockstep_timeout_s=0.3)
    bench.listen("/diagnostics")
    bench.speak("/diagnostics", "/arm_command", "/drive_command")
    for role in ("arm", "drive"):
        bench.send("/diagnostics", heartbeat_message(role, "waiting for other nodes", 0, Counters(), "no publisher"))
    bench.until(lambda: plant.finished, "the plant gives up")
    assert "node 'sensors' is not ready" in plant.failure and plant.exit_status == 1


def spoilt(period: int, stamp: int) -> Any:
    """A bad command in place of the good one of some periods; the sixth is one too many, from the past."""
    message = command(DRIVEN, stamp, rate=0.2)
    if period == 3:
        message.velocity[0] = math.nan
    elif period == 4:
        message.velocity[1] = math.inf
    elif period == 5:
        message.name[2] = "wheel_seventh_joint"
    elif period == 6:
        message.velocity = message.velocity[:3]
    elif period == 7:
        message.name[0] = "rocker_left_joint"
    elif period == 8:
        message.velocity[0] = 1e200
    elif period == 9:
        message.position = []
    elif period == 10:
        message.name[1] = message.name[0]
    return message


REASONS = {
    3: "/drive_command.velocity[0] = nan: allowed is a finite number",
    4: "/drive_command.velocity[1] = inf",
    5: "/drive_command.name = wheel_seventh_joint: allowed is one of ",
    6: "/drive_command.velocity = 3 numbers",
    7: "/drive_command.name = rocker_left_joint: allowed is one of ",
    8: "/drive_command.velocity = 1e+200: allowed is -200 to 200 rad/s",
    9: "/drive_command.position = 0 numbers: allowed is one for steer_",
    10: "allowed is each joint once",
}


def test_commands_that_cannot_be_followed_are_refused_and_shown(bench: Bench) -> None:
    plant = begin(bench, "plant", "drive")
    seen = {}
    for period in range(1, 51):
        bench.answer("/truth/joint_states", period)
        if period == 20:  # two from the past, and one off the grid, besides the good one
            for stamp in (at(2), at(19), at(20) + 1):
                late = command(DRIVEN, 1)
                late.header.stamp = ros_time(stamp)
                bench.send("/drive_command", late)
        bench.send("/drive_command", spoilt(period, period))
        bench.answer("/truth/joint_states", period + 1)
        seen[period] = plant.counters.last_refusal
    for period, reason in REASONS.items():
        assert reason in seen[period]
    assert "/drive_command.header.stamp" in seen[20]
    assert plant.counters.refused == {"/drive_command": len(REASONS) + 3}
    bench.until(lambda: bench.heartbeats("plant")[-1].stamp == at(50), "the heartbeat of the first second")
    beat = bench.heartbeats("plant")[-1]
    assert beat.values["refused /drive_command"] == "11"
    assert beat.values["last refusal"] == seen[20]
    final = bench.answer("/truth/joint_states", 51)
    assert all(map(math.isfinite, (*final.position, *final.velocity, *final.effort)))
    assert wheel_rates(final) == pytest.approx([0.2] * 6, abs=0.05)


def test_a_last_good_command_ages_out_in_lock_step(bench: Bench) -> None:
    plant = begin(bench, "plant", "drive")
    drive(bench, 1, 30, lambda period: command(DRIVEN, period, rate=0.3))
    assert min(wheel_rates(bench.answer("/truth/joint_states", 31))) > 0.2

    def no_number(period: int) -> Any:
        return command(DRIVEN, period, rate=math.nan)

    drive(bench, 31, 38, no_number)
    assert min(wheel_rates(bench.answer("/truth/joint_states", 39))) > 0.2, "not too old yet"
    drive(bench, 39, 70, no_number)
    assert wheel_rates(bench.answer("/truth/joint_states", 71)) == pytest.approx([0.0] * 6, abs=0.01)
    assert plant.heartbeat_values()["lost commands"] == "/drive_command"
    drive(bench, 71, 100, lambda period: command(DRIVEN, period, rate=0.3))
    assert min(wheel_rates(bench.answer("/truth/joint_states", 101))) > 0.2
    assert plant.heartbeat_values()["lost commands"] == ""


def test_a_joint_that_is_no_longer_named_stops(bench: Bench) -> None:
    begin(bench, "plant", "drive")
    drive(bench, 1, 25, lambda period: command(DRIVEN, period, rate=0.3))
    drive(bench, 26, 60, lambda period: command(WHEELS[:1], period, rate=0.3))
    rates = wheel_rates(bench.answer("/truth/joint_states", 61))
    assert rates[0] > 0.05 and rates[2:] == pytest.approx([0.0] * 4, abs=0.05)


def test_switches_cut_the_power_and_are_checked(bench: Bench) -> None:
    plant = begin(bench, "plant", "power")
    for period in range(1, 21):
        bench.answer("/truth/joint_states", period)
        if period % 5 == 0:
            values = {5: {"drive": "off", "arm": "0.5"}, 10: {"oven": "on"}, 15: {"drive": "2.0"}, 20: {"drive": "on"}}
            bench.send("/power/switches", status_message(at(period), "switches", values[period]))
    bench.answer("/truth/joint_states", 21)
    places = {load.name: place for place, load in enumerate(plant.app.model.loads)}
    fractions = plant.state.commands.fractions
    assert (fractions[places["drive"]], fractions[places["arm"]]) == (1.0, 0.5)
    assert plant.counters.refused == {"/power/switches": 2}
    assert "status.values.drive = 2.0: allowed is on, off, or a fraction" in plant.counters.last_refusal


def test_in_real_time_old_commands_stop_the_wheels(bench: Bench) -> None:
    plant = begin(bench, "plant", "drive", lockstep=False)
    answered = 0
    ahead = command(DRIVEN, 1, rate=5.0)
    ahead.header.stamp.sec = 1_700_000_000
    bench.send("/drive_command", ahead)
    bench.until(lambda: plant.counters.refused, "a stamp of the wall clock is refused: it would never age")
    assert "allowed is simulation time" in plant.counters.last_refusal

    def follow() -> bool:
        nonlocal answered
        newest = stamp_of(bench.received["/truth/joint_states"][-1]) // at(1)
        if newest > answered:
            answered = newest
            bench.send("/drive_command", command(DRIVEN, newest, rate=0.3))
        return answered >= 25 and min(wheel_rates(bench.received["/truth/joint_states"][-1])) > 0.2

    bench.until(follow, "the wheels turn")
    silent_from = plant.now
    bench.until(lambda: plant.now > silent_from + at(30), "30 periods of silence")
    assert wheel_rates(bench.received["/truth/joint_states"][-1]) == pytest.approx([0.0] * 6, abs=0.01)
    bench.until(lambda: bench.heartbeats("plant")[-1].values["lost commands"] == "/drive_command", "it says so")
    before = plant.counters.refused["/drive_command"]
    bench.send("/drive_command", command(DRIVEN, 2, rate=0.3))
    bench.until(lambda: plant.counters.refused["/drive_command"] > before, "a stamp from the past is refused")
    assert "/drive_command.header.stamp = 0.040 s" in plant.counters.last_refusal


def silent(bench: Bench, plant: PlantNode) -> str:
    """What the plant says when it stops."""
    bench.until(lambda: plant.finished, "the plant stops")
    assert plant.exit_status == 1
    return plant.failure


MEASURED = [row.name for row in outputs_of("sensors", ("plant", "sensors", "drive")) if "drive" in row.subscribers]
"""What the drive hears from the sensors."""


def chain(bench: Bench, *nodes: Any) -> PlantNode:
    """A plant with these real nodes; the peer speaks for the rest of plant, sensors and drive."""
    roles = ("plant", "sensors", "drive")
    plant = bench.start(PlantNode, *roles, lockstep_timeout_s=1.0)
    for node_class in nodes:
        bench.start(node_class, *roles, lockstep_timeout_s=1.0)
    bench.listen(*plant.endpoints.outputs)
    bench.speak("/diagnostics")
    return plant


def chain_with_drive(bench: Bench) -> PlantNode:
    """A plant with a real drive; the peer speaks for the sensors, which are ready."""
    plant = chain(bench, DriveNode)
    bench.speak(*MEASURED)
    bench.listen("/drive_command", "/odom")
    bench.met()
    bench.say_ready("sensors")
    return plant


def test_who_is_silent_from_the_first_period_on_is_named(bench: Bench) -> None:
    """The drive's command is missing, but the drive has had nothing to act on: the sensors are to blame."""
    plant = chain_with_drive(bench)
    assert "node 'sensors' did not answer: /drive_command stamped 0.02 s" in silent(bench, plant)


def test_who_falls_silent_later_is_named(bench: Bench) -> None:
    plant = chain_with_drive(bench)
    for period in range(1, 11):
        bench.answer("/truth/joint_states", period)
        bench.send("/joint_states", joints(period))
        bench.send("/imu/data", imu(period))
    assert "node 'sensors' did not answer: /drive_command stamped 0.22 s" in silent(bench, plant)


def test_held_up_itself_it_takes_nobody_for_silent(bench: Bench) -> None:
    """Stopped for longer than its patience and set going again, it has the answers in its queues."""
    plant = chain_with_drive(bench)
    bench.answer("/truth/joint_states", 1)
    plant.timeout_s = 50.0
    plant._silence_of_others = Silence(time.monotonic() - 100.0)
    plant.poll()
    assert plant.barrier.missing() and not plant.finished


@pytest.mark.parametrize("answered", [0, 5])
def test_the_last_of_the_chain_is_named_itself(bench: Bench, answered: int) -> None:
    plant = chain(bench, SensorsNode)
    bench.speak("/drive_command")
    bench.listen(*MEASURED)
    bench.met()
    bench.say_ready("drive")
    for period in range(1, answered + 1):
        bench.answer("/joint_states", period)
        bench.send("/drive_command", command(DRIVEN, period))
    assert "node 'drive' did not answer" in silent(bench, plant)


def test_an_old_word_of_waiting_does_not_excuse(bench: Bench) -> None:
    """The drive waited for the sensors once, went on, and is silent now: it is the drive."""
    plant = chain(bench)
    bench.speak("/drive_command", "/joint_states", "/imu/data")
    bench.until(lambda: bench.received["/diagnostics"], "the plant is heard")
    bench.say_ready("drive", "sensors")
    bench.listen("/joint_states", "/imu/data")
    bench.until(lambda: not plant.unmatched() or plant.finished, "all have met")
    bench.answer("/clock", 1)
    stalled = heartbeat_message("drive", STALLED, at(1), Counters(), "waiting", {WAITING_FOR: "sensors"})
    bench.send("/diagnostics", stalled)
    bench.until(lambda: plant.roster.heard.get("drive") and plant.roster.heard["drive"].state == STALLED, "it is heard")
    assert plant.roster.waits_for("drive") == "sensors"
    assert plant.roster.waits_for("sensors") == "" and plant.roster.heard["sensors"].state == READY
    assert "node 'drive' did not answer" in silent(bench, plant)


def test_nobody_answers_in_the_first_periods(bench: Bench) -> None:
    """With only the recorder to wait for nothing is due at first, and no message would begin the run."""
    plant = begin(bench, "plant", "recorder")
    bench.answer("/clock", 30)
    bench.spin(0.1)
    assert plant.barrier.period == 30 and len(bench.received["/clock"]) == 30
    for period in (5, 10):
        bench.send("/recorder/tick", tick(period))
    bench.answer("/clock", 40)


def test_the_operator_ends_the_run(bench: Bench) -> None:
    plant = begin(bench, "plant", "operator")
    bench.answer("/clock", 10)
    bench.send("/operator/tick", tick(5, format_tick({}, False)))
    bench.answer("/clock", 15)
    bench.send("/operator/tick", tick(10, format_tick({"/goal_pose": 1}, True)))
    bench.until(lambda: plant.finished, "the run ends")
    assert (plant.exit_status, plant.failure) == (0, "")
    assert stamp_of(bench.received["/clock"][-1]) == at(15)


def test_a_second_plant_on_the_same_domain_is_told_so(bench: Bench) -> None:
    first = begin(bench, "plant", "drive")
    second = bench.start(PlantNode, "plant")
    bench.until(lambda: second.finished, "the second plant gives up")
    assert second.exit_status == 1
    assert "domain" in second.failure and "already in use by another plant" in second.failure
    assert "--namespace" in second.failure and "/clock" in second.failure
    assert not second._begun and not first.finished
    other = bench.start(PlantNode, "plant", "drive", namespace="/other")
    bench.listen("/clock", namespace="/other")
    bench.until(lambda: other.roster.heard, "its own heartbeat has come")
    assert not other.finished
    drive(bench, 1, 3, lambda period: command(DRIVEN, period))
    assert first.now == at(3)


@pytest.mark.parametrize("ahead_s", [2e9, 1.0])
def test_in_real_time_a_tick_of_another_clock_ends_no_run(bench: Bench, ahead_s: float) -> None:
    """The next one that fits does."""
    plant = begin(bench, "plant", "operator", lockstep=False)
    bench.until(lambda: plant.now > at(5), "it runs")
    false = tick(0, format_tick({}, True))
    false.stamp = ros_time(plant.now + round(ahead_s * NANOSECONDS))
    plant._receive(topic("/operator/tick"), serialized(false))
    assert plant.counters.refused == {"/operator/tick": 1} and "simulation time" in plant.counters.last_refusal
    reached = plant.now // at(1)
    bench.until(lambda: plant.now > at(reached + 20), "it goes on")
    assert not plant.finished
    bench.send("/operator/tick", tick(reached, format_tick({}, True)))
    bench.until(lambda: plant.finished, "the run is ended")
    assert plant.counters.refused == {"/operator/tick": 1}


class Counting:
    """In place of a keeper: counts what it is asked."""

    def __init__(self) -> None:
        self.asked, self.answered = 0, 0

    def may_act(self, stamp: int) -> bool:
        return True

    def acted(self, stamp: int) -> None:
        self.answered = stamp if self.asked else 0

    def ask(self) -> None:
        self.asked += 1


def test_whoever_asks_for_checkpoints_without_end_gets_one_in_ten_seconds(bench: Bench) -> None:
    plant, keeper = begin(bench, "plant", "drive"), Counting()
    answers: list[Header] = []
    plant.keep_with(keeper)
    reader(bench.peer, KEPT, answers.append)
    bench.until(lambda: plant._answers.get_subscription_count(), "somebody hears the answers")
    for _ in range(2000):
        plant._hear_asking(Header(7))
    assert keeper.asked == 1, "all are answered by the one that is to come"
    keeper.answered = at(1)
    plant._hear_asking(Header(7))
    assert keeper.asked == 1
    bench.until(lambda: answers, "an answer")
    assert answers[0].stamp == 7
    assert "0.00 s after the last one: allowed is one in 10 s of simulation" in answers[0].frame
    plant.now += 10 * NANOSECONDS
    plant._hear_asking(Header(7))
    assert keeper.asked == 2


def test_what_becomes_of_a_checkpoint_that_is_asked_for_is_in_no_heartbeat(bench: Bench) -> None:
    """It was: the run that went on from there lacked it, and was another one than the unbroken one."""
    plant, keeper = begin(bench, "plant", "drive"), Counting()
    plant.keep_with(keeper)
    plant._hear_asking(Header(0))
    before = plant.heartbeat_values()
    keeper.answered = at(1)
    for _ in range(2000):
        plant._hear_asking(Header(0))
    assert keeper.answered and plant.heartbeat_values() == before and not plant.counters.refused


def test_who_asks_for_a_checkpoint_and_is_met_late_is_answered_all_the_same(bench: Bench) -> None:
    plant, keeper = begin(bench, "plant", "drive"), Counting()
    plant.keep_with(keeper)
    plant._hear_asking(Header(0))
    drive(bench, 1, 1, lambda period: command(DRIVEN, period))
    answers: list[Header] = []
    reader(bench.peer, KEPT, answers.append)
    bench.until(lambda: answers, "the last answer")
    assert (answers[0].stamp, answers[0].frame) == (keeper.answered, "")


def test_a_node_that_has_heard_a_strangers_clock_before_the_run_is_ready_all_the_same() -> None:
    """The recorder acted on it, never said that it was ready, and the plant waited for it until the start timed out."""
    roster = Roster("plant", ("plant", "recorder", "drive"), 10.0)

    def says(role: str, state: str, **values: str) -> None:
        roster.hear(read_heartbeats(heartbeat_message(role, state, 0, Counters(), extra=values)))

    says("drive", READY)
    says("recorder", STALLED, **{WAITING_FOR: "plant"})
    assert roster.missing() == ["recorder"], "it has not met all others yet"
    says("recorder", STALLED, **{WAITING_FOR: "plant", MATCHED: "yes"})
    assert not roster.missing()


def test_in_real_time_it_keeps_on_though_its_timer_waits_behind_messages(bench: Bench) -> None:
    """A flood that an overloaded machine cannot hear as fast as it comes: only its chores have their turn."""
    plant = begin(bench, "plant", "drive", lockstep=False)
    before, end = plant.now, time.monotonic() + 600.0
    while plant.now < before + 5 * CONTROL_PERIOD_NS and time.monotonic() < end:
        plant.poll()
    assert plant.now >= before + 5 * CONTROL_PERIOD_NS
