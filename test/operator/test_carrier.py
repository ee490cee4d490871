"""What becomes of a goal of an action between its client and the contract, with neither of them there."""

from types import SimpleNamespace
from typing import Any

import pytest

from sojourn_contract.heartbeat import status_message
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message, PoseStamped
from sojourn_operator.actions.carrier import Carrier
from sojourn_operator.actions.watch import ABORTED, CANCELED, SUCCEEDED, Ending
from sojourn_operator.goal_sending import STATUS_TOPICS, GoalClient, TwoClocksError

SENT = 7_000_000_000
GOAL = PoseStamped(0, "map", (1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class Beside(GoalClient):
    """In place of a client beside a stack that everybody of it has been found of."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(0, "")
        self.link: Any = SimpleNamespace(is_there=False)
        self.now, self.clocks = SENT, 1
        self.sent: list[tuple[str, Message]] = []
        self._node = SimpleNamespace(count_publishers=lambda _: self.clocks)
        self._clock = SimpleNamespace(topic_name="/clock")
        monkeypatch.setattr("sojourn_operator.goal_sending.encode", lambda _, message: message)

    def sender(self, row: Topic) -> Any:
        return SimpleNamespace(topic_name=row.name, publish=lambda message: self.sent.append((row.name, message)))

    def spin(self, wall_s: float) -> None:
        pass

    def _is_heard(self, sender: Any) -> bool:
        return True

    def tell(self, role: str, state: str, goal_stamp: int) -> None:
        """A status of a role, at the time that it is."""
        values = {"state": state, "goal_stamp": str(goal_stamp), "reason": ""}
        self._keep(role)(status_message(self.now, STATUS_TOPICS[role].removeprefix("/"), values))


class Served:
    """In place of the server of an action of a role, with one goal taken. `ended` holds its end."""

    def __init__(self, role: str, topic: str) -> None:
        pursuit = SimpleNamespace(
            goal=GOAL, feedback=str, breach=lambda _: "", final=lambda ending, _: ending, result=str
        )
        self.kind = SimpleNamespace(role=role, topic=topic, begin=lambda _: pursuit)
        self.name = "action"
        self.goal = SimpleNamespace(is_cancel_requested=False, request=None, publish_feedback=lambda _: None)
        self._waiting: list[Any] = [self.goal]
        self.ended: list[Ending] = []
        self.over: list[Any] = []

    def take(self) -> None:
        """One more goal comes before the next look."""
        self._waiting.append(SimpleNamespace(**vars(self.goal)))

    def taken(self) -> list[Any]:
        waiting, self._waiting = self._waiting, []
        return waiting

    def end(self, goal: Any, ending: Ending, result: Any) -> None:
        self.ended.append(ending)
        self.over.append(goal)


@pytest.mark.parametrize(
    ("role", "topic", "stop", "told"),
    [("drive", "/goal_pose", "/cmd_vel", SENT), ("arm", "/arm/goal_pose", "/arm/stop", 0)],
)
def test_a_goal_is_taken_back_by_a_stop_that_is_never_too_old(
    role: str, topic: str, stop: str, told: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It had the time of the adapter, who is behind a stack that is faster than the world: the drive refused it as too
    old, drove on, and the goal that had been taken back was reached.
    """
    client, server = Beside(monkeypatch), Served(role, topic)
    carrier = Carrier(client, server, {})  # type: ignore[arg-type]
    carrier.step()
    client.tell(role, "moving", SENT)
    carrier.step()
    server.goal.is_cancel_requested = True
    carrier.step()
    assert [(name, message.stamp) for name, message in client.sent] == [(topic, SENT), (stop, 0)]
    client.now += 1
    client.tell(role, "stopped", told)
    carrier.step()
    assert [ending.word for ending in server.ended] == [CANCELED]


def test_a_stop_goes_out_whoever_tells_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    client, server = Beside(monkeypatch), Served("drive", "/goal_pose")
    carrier = Carrier(client, server, {})  # type: ignore[arg-type]
    carrier.step()
    client.clocks, server.goal.is_cancel_requested = 2, True
    carrier.step()
    assert [name for name, _ in client.sent] == ["/goal_pose", "/cmd_vel"]


def test_a_goal_that_cannot_be_sent_ends_and_the_adapter_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a second node told the time, the adapter ended with a goal half begun."""
    client, server = Beside(monkeypatch), Served("drive", "/goal_pose")
    client.clocks = 2
    carrier = Carrier(client, server, {})  # type: ignore[arg-type]
    carrier.step()
    assert not client.sent and [ending.word for ending in server.ended] == [ABORTED]
    assert "2 nodes publish /clock" in server.ended[0].reason
    with pytest.raises(TwoClocksError):
        client.send("drive", "/goal_pose", GOAL)


def test_of_two_goals_that_cannot_be_sent_each_has_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second, taken in the same look, was dropped without a result, and its client waited for ever."""
    client, server = Beside(monkeypatch), Served("drive", "/goal_pose")
    client.clocks = 2
    server.take()
    Carrier(client, server, {}).step()  # type: ignore[arg-type]
    assert [ending.word for ending in server.ended] == [ABORTED, ABORTED]
    assert server.over[0] is server.goal and server.over[1] is not server.goal
    assert all("2 nodes publish /clock" in ending.reason for ending in server.ended)


def test_a_goal_behind_one_that_cannot_be_sent_goes_out(monkeypatch: pytest.MonkeyPatch) -> None:
    client, server = Beside(monkeypatch), Served("drive", "/goal_pose")
    server.take()
    answers = iter([TwoClocksError("2 nodes publish /clock"), None])
    send = client.send

    def sends(*given: Any) -> int:
        if (error := next(answers)) is not None:
            raise error
        return send(*given)

    monkeypatch.setattr(client, "send", sends)
    carrier = Carrier(client, server, {})  # type: ignore[arg-type]
    carrier.step()
    assert [name for name, _ in client.sent] == ["/goal_pose"] and len(server.ended) == 1
    client.tell("drive", "reached", SENT)
    carrier.step()
    assert [ending.word for ending in server.ended] == [ABORTED, SUCCEEDED]
