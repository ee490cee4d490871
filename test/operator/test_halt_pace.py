"""A stop of stacks that are slower and faster than the world: its own zero moves a drive by velocity, for a moment."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_types import Topic
from sojourn_operator import clock_watch, goal_sending
from sojourn_operator.goal_sending import GoalClient

BRAKES_S = 0.3
BEGIN_S = 100.0


class WallClock:
    def __init__(self) -> None:
        self.now = BEGIN_S

    def monotonic(self) -> float:
        return self.now


class Paced(GoalClient):
    """A client beside a drive that is under way, and tells a status once a simulated second.

    Args:
        rate: simulated seconds in one of the world. timeout: of a velocity [s]. phase: of the first status [s].
        others: whether somebody else sends velocities all the time.
    """

    def __init__(self, wall: WallClock, rate: float, timeout: float, phase: float, others: bool = False) -> None:
        super().__init__(0, "")
        self.link: Any = SimpleNamespace(is_there=False)
        self.wall, self.rate, self.timeout, self.others = wall, rate, timeout, others
        self.zeros: list[float] = []
        self.due = phase

    def sender(self, row: Topic) -> Any:
        def publish(_: Any) -> None:
            if row.name == "/cmd_vel":
                self.zeros.append(self.simulated)

        return SimpleNamespace(topic_name=row.name, publish=publish)

    @property
    def simulated(self) -> float:
        return (self.wall.now - BEGIN_S) * self.rate

    def spin(self, wall_s: float) -> None:
        self.wall.now += wall_s + 0.001
        while self.due <= self.simulated:
            self._tell(self.due)
            self.due += 1.0
        self.now = round(self.simulated * NANOSECONDS) + 1

    def _tell(self, at: float) -> None:
        is_fresh = self.others or (bool(self.zeros) and at - self.zeros[-1] <= self.timeout)
        rolls = self.others or not self.zeros or at - self.zeros[0] < BRAKES_S
        values = {
            "state": "stopped" if self.zeros else "moving", "goal_stamp": "0", "reason": "",
            "mode": "cmd_vel" if is_fresh else "idle" if self.zeros else "goal", "speed_m_s": "0.1" if rolls else "0.0",
        }  # fmt: skip
        self._keep("drive")(status_message(round(at * NANOSECONDS), "drive", values))

    def _listeners(self, sender: Any) -> Any:
        is_drive = sender.topic_name == "/cmd_vel"
        return SimpleNamespace(are_all_there=is_drive, somebody_acts=is_drive)

    def _held(self) -> list[str]:
        return ["drive"]


@pytest.fixture(scope="module")
def wall() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        clock = WallClock()
        patch.setattr(goal_sending, "time", clock)
        patch.setattr(clock_watch, "time", clock)
        yield clock


@given(st.sampled_from((0.1, 0.15, 0.25, 0.5, 1.0, 2.0, 8.0, 60.0)), st.sampled_from((0.2, 0.5)), st.floats(0.01, 1.0))
def test_a_drive_that_stands_is_told_to_stand(wall: WallClock, rate: float, timeout: float, phase: float) -> None:
    wall.now = BEGIN_S
    client = Paced(wall, rate, timeout, phase)
    assert client.halt() == (True, "drive: stopped")
    assert len(client.zeros) <= 3 and wall.now - BEGIN_S < max(1.0, 4.0 / rate)


@pytest.mark.parametrize("rate", [0.1, 1.0, 60.0])
def test_velocities_of_somebody_else_are_named_at_any_pace(wall: WallClock, rate: float) -> None:
    wall.now = BEGIN_S
    stands, words = Paced(wall, rate, 0.2, 0.5, others=True).halt()
    assert not stands and "somebody else sends them on /cmd_vel" in words
