"""A sequence beside a stack that ends, is started anew, or is fast; and where nobody can type."""

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import STANDARD
from sojourn_operator.sequence.desk import SequenceDesk
from sojourn_operator.sequence.file import SequenceConfig
from sojourn_operator.sequence.runner import SequenceRunner
from sojourn_operator.steps.step import RunFacts

DRIVE: dict[str, object] = {"drive_to": {"x": 1.0, "y": 0.0}}
VELOCITY: dict[str, object] = {"drive_velocity": {"forward": 0.05, "seconds": 2.0}}
PATIENCE_S = 200.0
"""Wall time after which nobody doubts that a sequence would wait for ever."""


class Wall:
    """In place of the wall clock."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 1000.0
        monkeypatch.setattr(time, "monotonic", lambda: self.now)


class Beside(SequenceDesk):
    """In place of a desk beside a stack.

    Args:
        wall: its clock. tells: simulation time [ns] so long after the beginning [s]. steps: of the sequence.

    Attributes:
        sees: called with the wall time since the beginning [s] whenever something comes.
    """

    def __init__(self, wall: Wall, tells: Callable[[float], int], *steps: dict[str, object]) -> None:
        config = SequenceConfig.model_validate({"steps": list(steps)})
        super().__init__((0, ""), SequenceRunner(config, STANDARD, RunFacts()), STANDARD, "anna")
        self.wall, self.tells, self.begun = wall, tells, wall.now
        self.sees: Callable[[float], None] = lambda _: None
        self.now = tells(0.0)
        self.sent: list[str] = []
        self._executor: Any = SimpleNamespace(spin_once=self._spin_once)

    def prepare(self) -> None:
        """Nobody is to be found."""

    def spin(self, wall_s: float) -> None:
        end = self.wall.now + wall_s
        while self.wall.now < end:
            self._spin_once(end - self.wall.now)

    def _spin_once(self, timeout_sec: float) -> None:
        """A word of the clock comes 1 ms of wall time after the one before."""
        self.wall.now += min(timeout_sec, 0.001)
        after = self.wall.now - self.begun
        assert after < PATIENCE_S, "it waits for ever"
        self.now = self.tells(after) // CONTROL_PERIOD_NS * CONTROL_PERIOD_NS
        self.sees(after)

    def _send_now(self, goals: Any) -> None:
        self.sent += [goal.topic for goal in goals]


def at_speed(speed: float, until_s: float = 1e9) -> Callable[[float], int]:
    """A stack so much faster than the wall clock, which stands after so long [s]."""
    return lambda after: NANOSECONDS + round(speed * min(after, until_s) * NANOSECONDS)


@pytest.fixture
def wall(monkeypatch: pytest.MonkeyPatch) -> Wall:
    return Wall(monkeypatch)


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], None]]:
    """Types a line at the input of the program, which stays open."""
    out, into = os.pipe()
    with os.fdopen(out) as stdin, os.fdopen(into, "w", buffering=1) as typing:
        monkeypatch.setattr("sys.stdin", stdin)
        yield lambda line: print(line, file=typing)


@pytest.fixture
def no_input(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    with Path(os.devnull).open(encoding="utf-8") as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        yield


def test_it_ends_with_its_stack(wall: Wall, terminal: object) -> None:
    desk = Beside(wall, at_speed(1.0, until_s=5.0), {**DRIVE, "timeout_s": 200.0})
    assert not desk.run()
    assert "the simulation time has stood still for 30 s" in desk.state.history[-1].reason
    assert desk.sent == ["/goal_pose", "/cmd_vel"]  # it may stand but for a while


def test_it_ends_where_the_stack_is_started_anew_and_leaves_the_new_one_alone(wall: Wall, terminal: object) -> None:
    desk = Beside(wall, lambda after: round((after + 1.0) * NANOSECONDS) % (20 * NANOSECONDS), DRIVE)
    assert not desk.run()
    assert wall.now < desk.begun + 20.0
    assert "started anew" in desk.state.history[-1].reason and desk.sent == ["/goal_pose"]


def test_where_nobody_can_type_nothing_waits_for_a_word(wall: Wall, no_input: None) -> None:
    desk = Beside(wall, at_speed(1.0), {**DRIVE, "timeout_s": 1.0}, DRIVE)
    assert not desk.run()
    assert [entry.outcome for entry in desk.state.history] == ["timed out", "aborted"]
    assert "nobody can type" in desk.state.history[-1].reason
    asks = Beside(wall, at_speed(1.0), {"wait_s": 1.0}, {**DRIVE, "hold": True})
    assert not asks.run()
    assert [entry.outcome for entry in asks.state.history] == ["waited", "aborted"]


def test_where_nobody_can_type_what_waits_for_no_word_comes_to_its_end(wall: Wall, no_input: None) -> None:
    assert Beside(wall, at_speed(1.0), {"wait_s": 1.0}, {"wait_s": 1.0, "after_s": 1.0}).run()


def test_it_is_held_for_as_long_as_somebody_at_the_terminal_wants(wall: Wall, terminal: Callable[[str], None]) -> None:
    desk = Beside(wall, at_speed(1.0), {"wait_s": 1.0}, {"wait_s": 1.0})
    words = {0.5: "h", 120.0: "r"}

    def types(after: float) -> None:
        for at in [at for at in words if at <= after]:
            terminal(words.pop(at))

    desk.sees = types
    assert desk.run()
    assert wall.now > desk.begun + 120.0


def test_a_velocity_is_said_at_each_word_of_the_clock(wall: Wall, terminal: object) -> None:
    """Twenty looks a second of wall time: of 0.25 m at 8 times real time it drove 0.020, which was told as good."""
    desk = Beside(wall, at_speed(8.0), VELOCITY)
    assert desk.run()
    assert len(desk.sent) > 90  # in 2 s, of which 0.2 s may lie between two


def test_a_velocity_that_comes_too_late_for_the_machine_fails(wall: Wall, terminal: object) -> None:
    desk = Beside(wall, at_speed(300.0), {**VELOCITY, "on_failure": "abort"})
    assert not desk.run()
    (entry,) = desk.state.history
    assert entry.outcome == "failed" and "start it with --realtime" in entry.reason
    assert desk.sent[-1] == "/cmd_vel"
