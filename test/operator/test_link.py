"""The link on both of its ends, without a machine: what goes up when, what the Earth knows of it, and when."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.run_table import row_named
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import topic
from sojourn_contract.values import UPRIGHT, Header, Message, Odometry
from sojourn_operator.app import OperatorApp, OperatorState
from sojourn_operator.goal_messages import drive_goal, route_goal, stop_messages
from sojourn_operator.link.commands import KEPT
from sojourn_operator.link.length import bits
from sojourn_operator.scenario_steps import prepare_scenario

LOOK = 5
GOAL = drive_goal(0, (1.0, 0.0), None)


def truth(stamp: int) -> Odometry:
    three, covariance = np.zeros(3), np.zeros(36)
    return Odometry(stamp, "map", "base_link", three, UPRIGHT, three, three, covariance, covariance)


class Bench:
    """An operator with a link, period after period, and a drive of a few words.

    Args:
        link: as a scenario has it. steps: of the script.
    """

    def __init__(self, link: str, steps: str = "[]") -> None:
        limits = ["duration_limit_s=1000.0", f"steps={steps}"]
        self.app = OperatorApp(load_scenario("flat_drive", [f"link={link}", *limits]))
        self.state: OperatorState = self.app.initial_state()
        self.period = 0
        self.said: list[tuple[float, str, Message]] = []
        self.status = {"state": "idle", "goal_stamp": "0", "reason": ""}

    def run(self, seconds: float, goals: Sequence[tuple[str, Message]] = ()) -> None:
        """Go on for a while; goals: sent by hand at its beginning."""
        for _ in range(round(seconds * NANOSECONDS) // CONTROL_PERIOD_NS):
            self.period += 1
            stamp = self.period * CONTROL_PERIOD_NS
            inputs: dict[str, Any] = {"/truth/odom": truth(stamp)}
            if self.period % 5 == 0:
                inputs["/odom"] = truth(stamp)._replace(position=np.array((0.0, 0.0, 1e-3 * self.period)))
            if self.period % 50 == 0:
                inputs["/drive/status"] = status_message(stamp, "drive", self.status)
            self.state, answer = self.app.step(self.state, Period(stamp, inputs, goals))
            goals = ()
            for name, message in answer.messages:
                self.said.append((stamp / NANOSECONDS, name, message))
                if name == "/goal_pose":  # it stands there at once
                    self.status = {"state": "reached", "goal_stamp": str(message.stamp), "reason": "near"}

    def of(self, name: str) -> list[tuple[float, Message]]:
        return [(time, message) for time, said, message in self.said if said == name]

    def commands(self) -> dict[str, dict[str, str]]:
        """The last word on each."""
        _, status = self.of("/link/status")[-1]
        return {one.name: dict(one.values) for one in status.status[1:]}

    def known(self, state: str) -> float:
        """When the Earth said for the first time that the first command is in a state [s]."""
        return next(time for time, said in self.of("/link/status") for one in said.status[1:2] if one.message == state)


def test_a_goal_arrives_one_light_time_later_and_its_end_is_known_after_another() -> None:
    bench = Bench("{light_time_s: 10.0}")
    bench.run(30.0, [("/earth/goal_pose", GOAL)])
    ((time, goal),) = bench.of("/goal_pose")
    assert time == pytest.approx(10.1) and goal.stamp == pytest.approx(10.2e9)  # sent at the first look, at 0.1 s
    assert (bench.known("sent"), bench.known("executed")) == (1.0, 21.0)
    (values,) = bench.commands().values()
    assert values["outcome"] == "reached" and values["topic"] == "/goal_pose"
    assert float(values["received_s"]) == pytest.approx(10.1) and float(values["executed_s"]) == pytest.approx(11.0)
    telemetry = [(time, message.stamp / 1e9) for time, message in bench.of("/earth/drive/status")]
    assert telemetry and all(time == pytest.approx(stamp + 10.0) for time, stamp in telemetry)


def test_the_script_goes_by_what_the_earth_knows() -> None:
    bench = Bench("{light_time_s: 10.0}", "[{drive_to: {x: 1.0, y: 0.0}}, {wait_s: 1.0}]")
    bench.run(30.0)
    first, _ = bench.state.script.results
    assert (first.outcome, first.start_s) == ("reached", 0.1) and first.end_s == pytest.approx(21.0)


def test_who_looks_at_the_ground_from_earth_sees_it_from_where_the_machine_was() -> None:
    link = "{light_time_s: 4.0, telemetry: [{topic: /odom, every_s: 1}]}"
    bench = Bench(link, "[{arm_to_ground: {x: 1.0, y: 0.0}}]")
    bench.run(20.0)
    ((time, goal),) = bench.of("/arm/goal_pose")
    assert time == pytest.approx(8.2, abs=0.11)  # the first pose, of 0.1 s, comes down; what is sent then goes up
    assert goal.position[2] == pytest.approx(-5e-3)  # level ground at 0, seen from the height that /odom had at 0.1 s


def test_who_looks_at_the_ground_from_earth_has_to_hear_where_the_machine_is() -> None:
    steps, link = "steps=[{arm_to_ground: {x: 1.0, y: 0.0}}]", "{light_time_s: 4.0}"
    with pytest.raises(ConfigError, match=r"(?s)steps.0.*by the /odom that has come down.*link.telemetry"):
        prepare_scenario("flat_drive", [f"link={link}", steps])
    heard = "{light_time_s: 4.0, telemetry: [{topic: /odom}]}"
    assert prepare_scenario("flat_drive", [f"link={heard}", steps])
    assert prepare_scenario("flat_drive", [steps])


def test_what_is_sent_outside_a_window_waits_for_it() -> None:
    bench = Bench("{light_time_s: 2.0, windows: [{kind: times, from_s: 30.0, to_s: 40.0}]}")
    bench.run(29.9, [("/earth/goal_pose", GOAL)])
    assert not bench.of("/goal_pose") and bench.commands()["command 1"]["state"] == "sent"  # it gets there at 30 s
    bench.run(10.0)
    assert [time for time, _ in bench.of("/goal_pose")] == [pytest.approx(30.0)]
    assert bench.known("executed") == pytest.approx(33.0)


def test_what_has_expired_is_never_given_out_and_the_script_fails_with_it() -> None:
    link = "{light_time_s: 2.0, expires_s: 20.0, windows: [{kind: times, from_s: 30.0, to_s: 400.0}]}"
    bench = Bench(link, "[{drive_to: {x: 1.0, y: 0.0}}]")
    bench.run(100.0)
    assert not bench.of("/goal_pose") and bench.commands()["command 1"]["state"] == "expired"
    (result,) = bench.state.script.results
    assert result.outcome == "failed" and result.end_s == pytest.approx(18.2, abs=0.2)
    assert "expired on the way: not there by 20.10 s" in result.reason


def test_what_waits_can_be_cancelled_and_what_has_left_cannot() -> None:
    bench = Bench("{light_time_s: 5.0, up: {bit_s: 100.0}}")
    bench.run(1.0, [("/earth/goal_pose", GOAL), ("/earth/waypoints", route_goal(0, [(2.0, 0.0)], None))])
    bench.run(1.0, [("/earth/cancel", Header(0, ""))])
    bench.run(40.0)
    assert len(bench.of("/goal_pose")) == 1 and not bench.of("/waypoints")
    states = [values["state"] for values in bench.commands().values()]
    assert states == ["executed", "cancelled"]


def test_one_of_several_is_cancelled_by_its_number() -> None:
    bench = Bench("{light_time_s: 1.0, windows: [{kind: times, from_s: 20.0, to_s: 400.0}]}")
    goals = [("/earth/goal_pose", drive_goal(0, (x, 0.0), None)) for x in (1.0, 2.0, 3.0)]
    bench.run(1.0, goals)
    bench.run(1.0, [("/earth/cancel", Header(0, "2"))])
    bench.run(40.0)
    assert [goal.position[0] for _, goal in bench.of("/goal_pose")] == [1.0, 3.0]
    first, second = (goal.stamp for _, goal in bench.of("/goal_pose"))
    assert second == first + CONTROL_PERIOD_NS  # by its stamp a goal is told from the other
    states = [values["state"] for values in bench.commands().values()]
    assert states == ["superseded", "cancelled", "executed"]


def test_a_goal_for_later_does_not_keep_others_back() -> None:
    bench = Bench("{light_time_s: 1.0}")
    later = drive_goal(1000 * NANOSECONDS, (2.0, 0.0), None)
    bench.run(3.0, [("/earth/goal_pose", later), ("/earth/goal_pose", GOAL)])
    assert [goal.stamp / NANOSECONDS for _, goal in bench.of("/goal_pose")] == [1000.0, pytest.approx(1.2)]


def test_a_stop_goes_before_what_waits() -> None:
    bench = Bench("{light_time_s: 1.0, up: {bit_s: 200.0}}")
    route = route_goal(0, [(float(x), 0.0) for x in range(1, 20)], None)
    stop = next(message for name, message in stop_messages(0) if name == "/arm/stop")
    bench.run(30.0, [("/earth/goal_pose", GOAL), ("/earth/waypoints", route), ("/earth/arm/stop", stop)])
    order = [name for _, name, _ in bench.said if name in ("/goal_pose", "/waypoints", "/arm/stop")]
    assert order[0] == "/arm/stop"


def test_a_stop_takes_back_the_goals_that_wait_for_whoever_it_stops() -> None:
    """Sent in a closed window after them it goes up first: they would set the machine in motion behind it."""
    bench = Bench("{light_time_s: 1.0, windows: [{kind: times, from_s: 20.0, to_s: 400.0}]}")
    tip = drive_goal(0, (0.9, 0.0), None, "base_link", 0.2)
    goals = [("/earth/goal_pose", GOAL), ("/earth/waypoints", route_goal(0, [(2.0, 0.0)], None))]
    question = ("/earth/drive/question", route_goal(0, [(3.0, 0.0)], None))
    bench.run(1.0, [*goals, ("/earth/arm/goal_pose", tip), question])
    bench.run(1.0, [("/earth/cmd_vel", stop_messages(0)[0][1])])
    bench.run(1.0, [("/earth/goal_pose", drive_goal(0, (5.0, 0.0), None))])
    bench.run(40.0)
    assert [goal.position[0] for _, goal in bench.of("/goal_pose")] == [5.0] and not bench.of("/waypoints")
    assert len(bench.of("/cmd_vel")) == len(bench.of("/arm/goal_pose")) == len(bench.of("/drive/question")) == 1
    assert bench.of("/cmd_vel")[0][0] <= bench.of("/goal_pose")[0][0]
    first = bench.commands()["command 1"]
    assert (first["state"], first["reason"]) == ("cancelled", "/cmd_vel was sent after it")


def test_a_lost_command_is_never_acknowledged() -> None:
    bench = Bench("{light_time_s: 1.0, up: {loss: 1.0}}")
    bench.run(60.0, [("/earth/goal_pose", GOAL)])
    assert not bench.of("/goal_pose") and bench.commands()["command 1"]["state"] == "sent"
    assert "1 lost" in bench.app.heartbeat_values(bench.state, 0)["uplink"]


def test_telemetry_goes_by_its_priority_within_the_bandwidth() -> None:
    """Of a status of 100 bytes once a second only as many come down as the bandwidth lets through, the newest."""
    size = bits(status_message(0, "drive", {"state": "idle", "goal_stamp": "0", "reason": ""}))
    bench = Bench(f"{{light_time_s: 0.0, down: {{bit_s: {size / 4.0}}}}}")
    bench.run(100.0)
    times = [time for time, _ in bench.of("/earth/drive/status")]
    assert len(times) == 24 or len(times) == 25
    assert np.diff(times) == pytest.approx(4.0, abs=0.11)


def test_velocities_by_hand_are_superseded_while_they_wait() -> None:
    _, stop = stop_messages(0)[0]
    bench = Bench("{light_time_s: 1.0, windows: [{kind: times, from_s: 20.0, to_s: 400.0}]}")
    for _ in range(50):
        bench.run(0.1, [("/earth/cmd_vel", stop)])
    bench.run(30.0)
    assert len(bench.of("/cmd_vel")) == 1 and not bench.commands()


def test_velocities_do_not_push_out_what_is_known_of_a_command() -> None:
    """Of one before a drive by hand the Earth heard neither receipt nor end."""
    bench = Bench("{light_time_s: 10.0}")
    _, stop = stop_messages(0)[0]
    request = status_message(0, "request", {"cameras": "off"})
    bench.run(0.1, [("/earth/power/request", request), ("/earth/arm/goal_pose", GOAL)])
    for _ in range(100):
        bench.run(0.1, [("/earth/cmd_vel", stop)])
    bench.run(20.0)
    assert [values["state"] for values in bench.commands().values()] == ["received"] * 2
    log = bench.state.link.log if bench.state.link is not None else ()
    assert [one.number for one in log] == sorted(one.number for one in log)
    assert len(log) == 2 + KEPT and all(one.given for one in log), "by it reports tell of which velocity they are"


def test_a_command_that_is_not_over_is_told_of_however_many_come_after_it() -> None:
    bench = Bench("{light_time_s: 1.0}")
    bench.run(1.0, [("/earth/arm/goal_pose", GOAL)])
    bench.run(10.0, [("/earth/goal_pose", GOAL)] * 40)
    told = bench.commands()
    assert list(told) == ["command 1", *(f"command {number}" for number in range(26, 42))]
    assert told["command 1"]["state"] == "received" and told["command 41"]["state"] == "executed"


@pytest.mark.parametrize(
    "message", [("/goal_pose", GOAL), ("/waypoints", route_goal(0, [(1.0, 2.0)] * 40, 0.3)), ("/truth/odom", truth(5))]
)
def test_a_message_is_about_as_long_as_its_bytes(message: tuple[str, Message]) -> None:
    name, value = message
    row = row_named(name) or topic(name)
    assert bits(value) == pytest.approx(8 * len(encode(row, value)), rel=0.1)


def test_a_link_does_not_grow_with_what_is_sent() -> None:
    """Ten thousand commands that never leave: the last are kept, and told to have been dropped."""
    bench = Bench("{light_time_s: 1.0, windows: [{kind: times, from_s: 900.0, to_s: 901.0}]}")
    for _ in range(10):
        bench.run(0.1, [("/earth/goal_pose", GOAL)] * 1000)
    assert bench.state.link is not None and len(bench.state.link.up.waiting) <= 64 >= len(bench.state.link.log)


def names(messages: Iterable[tuple[float, str, Message]]) -> set[str]:
    return {name for _, name, _ in messages}


def test_the_status_tells_window_and_light_time() -> None:
    bench = Bench("{light_time_s: 3.0, windows: [{kind: times, from_s: 10.0, to_s: 20.0}]}")
    bench.run(25.0)
    told = [status_values(message) for _, message in bench.of("/link/status")]
    assert [one["window"] for one in told] == ["closed"] * 9 + ["open"] * 10 + ["closed"] * 6
    assert {one["light_time_s"] for one in told} == {"3.000"}
    assert "/operator/tick" in names(bench.said)
