"""A stop reaches drive and arm, also who is found late on a busy machine."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_operator import clock_watch, goal_sending
from sojourn_operator.goal_sending import STATUS_TOPICS, STOP_TOPICS, GoalClient, TwoClocksError


class Busy(GoalClient):
    """In place of the client of a running stack: its roles are found after so many looks.

    Args:
        found: by role, after how many looks. held: roles that run on this machine.
    """

    def __init__(self, found: dict[str, int], held: Sequence[str]) -> None:
        super().__init__(0, "")
        self.link: Any = SimpleNamespace(is_there=False)
        self.found, self.held = found, held
        self.looks = 0
        self.sent: list[str] = []
        self.fields: dict[str, str] = {}
        """Further fields of the statuses."""

    def sender(self, row: Topic) -> Any:
        return SimpleNamespace(topic_name=row.name, publish=lambda _: self.sent.append(row.name))

    def spin(self, wall_s: float) -> None:
        self.looks += 1
        for who in STOP_TOPICS:
            state = "stopped" if STOP_TOPICS[who] in self.sent else "moving"
            if self.looks >= self.found.get(who, 10**9):
                values = {"state": state, "goal_stamp": "0", "reason": "", "distance_to_go": "0", **self.fields}
                self._keep(who)(status_message(20, STATUS_TOPICS[who], values))

    def _listeners(self, sender: Any) -> Any:
        found = any(
            sender.topic_name == name and self.looks >= self.found.get(who, 10**9) for who, name in STOP_TOPICS.items()
        )
        return SimpleNamespace(are_all_there=found, somebody_acts=found)

    def _held(self) -> list[str]:
        return list(self.held)


@pytest.mark.parametrize("found", [{"drive": 40, "arm": 0}, {"drive": 0, "arm": 40}, {"drive": 0, "arm": 0}])
def test_who_is_found_late_is_stopped_too(found: dict[str, int]) -> None:
    """The arm alone had been found, its word was "arm: stopped", the status 0, and the rover drove on."""
    busy = Busy(found, ["drive", "arm"])
    assert busy.halt() == (True, "drive: stopped, arm: stopped")
    assert sorted(busy.sent) == ["/arm/stop", "/cmd_vel"]


def test_where_two_tell_the_time_no_command_is_sent_but_a_stop() -> None:
    """A goal was sent with the stamp of a stranger's clock, refused by the drive, and followed for ever."""
    busy = Busy({"drive": 0, "arm": 0}, ["drive", "arm"])
    busy.now = 20_000_000
    clocks = [2]
    names = SimpleNamespace(count_publishers=lambda name: clocks[0] if name == "/clock" else 0)
    busy._node, busy._clock = names, SimpleNamespace(topic_name="/clock")
    row = topic("/arm/stop")
    with pytest.raises(TwoClocksError, match="2 nodes publish /clock on domain 0: what the simulation time is"):
        busy.sender_to("arm", row)
    assert busy.halt()[0]
    clocks[0] = 1
    assert busy.sender_to("arm", row).topic_name == "/arm/stop"


def test_a_machine_without_an_arm_is_stopped() -> None:
    assert Busy({"drive": 0}, ["plant", "drive"]).halt() == (True, "drive: stopped")


def test_who_never_listens_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(goal_sending, "STOPPED_S", 0.2)
    assert Busy({"arm": 0}, ["drive", "arm"]).halt() == (False, "stop not heard by drive within 0.2 s")


def test_a_drive_that_follows_somebody_s_velocities_does_not_stand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its state is idle, as it has no goal: the stop was told as done, and the rover rolled on."""
    monkeypatch.setattr(goal_sending, "STOPPED_S", 0.2)
    busy = Busy({"drive": 0}, ["drive"])
    busy.fields = {"mode": "cmd_vel", "speed_m_s": "0.050"}
    stands, words = busy.halt()
    assert not stands and "somebody else sends them on /cmd_vel" in words
    assert busy.sent.count("/cmd_vel") > 1, "it is told again"
    busy.fields = {"mode": "idle", "speed_m_s": "0.050"}
    assert busy.halt() == (False, "stop sent, but drive did not say within 0.2 s that it stands")
    busy.fields = {"mode": "idle", "speed_m_s": "0.000"}
    assert busy.halt() == (True, "drive: stopped")


class Following(GoalClient):
    """A client that has sent a goal stamped 7; what the drive tells at each look, as state and stamp, and when."""

    def __init__(self, *looks: Sequence[tuple[str, int, int]]) -> None:
        super().__init__(0, "")
        self.now = self._last_stamp = 7
        self._looks_left = list(looks)

    def spin(self, wall_s: float) -> None:
        for state, stamp, now in self._looks_left.pop(0) if self._looks_left else ():
            self.now = now
            values = {"state": state, "goal_stamp": str(stamp), "reason": "", "distance_to_go": "1.0"}
            self._keep("drive")(status_message(now, "drive", values))


def test_what_a_fast_stack_has_told_between_two_looks_is_not_missed() -> None:
    client = Following([("moving", 3, 20), ("refused", 7, 40), ("moving", 3, 60)])
    assert client.follow("drive", 60.0) == ("refused", "")


def test_a_goal_that_another_was_refused_beside_is_followed_to_its_end() -> None:
    client = Following([("moving", 7, 20)], [("refused", 90, 100)], [("moving", 7, 200)], [("reached", 7, 300)])
    assert client.follow("drive", 60.0) == ("reached", "")


def test_what_another_s_refused_goal_hides_for_two_seconds_does_not_count_as_silence() -> None:
    """A goal of more than ten seconds ago ended with the first word of a refusal of another."""
    s = NANOSECONDS
    client = Following(
        [("moving", 7, 20 * s)], [("refused", 19 * s, 21 * s)], [("moving", 7, 23 * s)], [("reached", 7, 24 * s)]
    )
    assert client.follow("drive", 60.0) == ("reached", "")


def test_a_goal_that_is_nobody_s_any_more_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """It was, for an hour, and without a word."""
    outcome, reason = Following([("moving", 7, 20)], [("moving", 90, 100)]).follow("drive", 60.0)
    assert (outcome, reason) == ("replaced", "the drive has been given something else to do")
    outcome, reason = Following([("moving", 7, 20)], [("idle", 0, 5)]).follow("drive", 60.0)
    assert outcome == "not known" and "gone back: the stack was started anew" in reason
    monkeypatch.setattr(goal_sending, "ANSWER_S", 0.0)
    outcome, reason = Following([("idle", 0, 20)], [("idle", 0, 20_000_000_000)]).follow("drive", 60.0)
    assert outcome == "not known" and "told nothing of it within 10 s of simulation time" in reason


@pytest.mark.parametrize(
    ("task", "shown"), [("pause", "moving, coming to rest"), ("resume", "moving, 100 % done, 0.00 s to go")]
)
def test_of_a_pause_no_progress_is_told(
    task: str, shown: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """While a guided task comes to rest the arm tells the progress of its own way there, which is over."""
    states = iter(["moving", "reached"])

    class Pausing(Busy):
        def spin(self, wall_s: float) -> None:
            values = {"state": next(states), "goal_stamp": "7", "reason": "", "progress": "1.0", "time_to_go": "0.00"}
            self._keep("arm")(status_message(20, STATUS_TOPICS["arm"], values))

    client = Pausing({}, ["arm"])
    client.now = 7
    monkeypatch.setattr(client, "sender_to", lambda _, row: client.sender(row))
    monkeypatch.setattr(client, "has_link", lambda: False)
    monkeypatch.setattr(goal_sending, "SHOW_S", -1.0)
    client.send("arm", "/arm/task", status_message(0, task, {}))
    assert client.follow("task", 600.0) == ("reached", "")
    assert capsys.readouterr().out == f"     0.00 s  {shown}\n"


def test_a_goal_of_a_stack_that_has_ended_is_not_followed_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    """It told ten minutes long that the rover was moving, 8.242 m to go."""

    class Ended(Busy):
        def spin(self, wall_s: float) -> None:
            if self.looks < 3:
                super().spin(wall_s)
                self.now += 20_000_000

    client = Ended({"drive": 0}, ["drive"])
    monkeypatch.setattr(clock_watch, "QUIET_S", 0.01)
    outcome, reason = client.follow("drive", 600.0)
    assert outcome == "not known" and "the simulation time has stood still" in reason
    assert client.looks == 3
