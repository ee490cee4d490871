"""A stop reaches drive and arm, also who is found late on a busy machine."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from sojourn_contract.heartbeat import status_message
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_operator import goal_sending
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

    def sender(self, row: Topic) -> Any:
        return SimpleNamespace(topic_name=row.name, publish=lambda _: self.sent.append(row.name))

    def spin(self, wall_s: float) -> None:
        self.looks += 1
        for who in STOP_TOPICS:
            state = "stopped" if STOP_TOPICS[who] in self.sent else "moving"
            if self.looks >= self.found.get(who, 10**9):
                values = {"state": state, "goal_stamp": "0", "reason": "", "distance_to_go": "0"}
                self.statuses[who] = status_message(20, STATUS_TOPICS[who], values)

    def _is_heard(self, sender: Any) -> bool:
        return any(
            sender.topic_name == name and self.looks >= self.found.get(who, 10**9) for who, name in STOP_TOPICS.items()
        )

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
            self.statuses["arm"] = status_message(20, STATUS_TOPICS["arm"], values)

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
    monkeypatch.setattr(goal_sending, "QUIET_S", 0.01)
    outcome, reason = client.follow("drive", 600.0)
    assert outcome == "not known" and "the simulation time has stood still" in reason
    assert client.looks == 3
