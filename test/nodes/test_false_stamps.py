"""A message that is stamped by another clock is refused, and its node goes on as if it had not come."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, NamedTuple

import pytest
from node_bench import HIGHEST_STAMP_S, Bench, at, battery, imu, joints, loads, odometry, tick, wrist

from sojourn_arm.node import ArmNode
from sojourn_contract import node
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_drive.node import DriveNode
from sojourn_power.node import PowerNode
from sojourn_sensors.node import SensorsNode

FIFTH = 5
"""Periods between two messages of a topic at 10 Hz."""
MESSAGES: dict[str, tuple[int, Callable[[int], Any]]] = {
    "/joint_states": (1, joints),
    "/imu/data": (1, imu),
    "/wrist/wrench": (1, wrist),
    "/truth/odom": (1, odometry),
    "/truth/joint_states": (1, joints),
    "/truth/motor_states": (1, joints),
    "/truth/electrical": (FIFTH, battery),
    "/truth/loads": (FIFTH, lambda period: loads(period, imu=12.0, cameras=9.0)),
    "/bus/state": (FIFTH, battery),
    "/operator/tick": (FIFTH, tick),
}
"""Every how many periods, and the message of a period."""


class Case(NamedTuple):
    """A node, who runs with it, what it is fed, which topic answers the last of that."""

    node: Any
    participants: tuple[str, ...]
    inputs: tuple[str, ...]
    answer: str


MEASURED = ("/joint_states", "/imu/data")
CASES = {
    "drive": Case(DriveNode, ("sensors", "drive", "operator"), ("/operator/tick", *MEASURED), "/drive_command"),
    "arm": Case(
        ArmNode, ("sensors", "arm", "operator"), ("/operator/tick", "/wrist/wrench", *MEASURED), "/arm_command"
    ),
    "sensors": Case(
        SensorsNode,
        ("plant", "sensors"),
        ("/truth/odom", "/truth/joint_states", "/truth/motor_states", "/truth/electrical", "/truth/loads"),
        "/imu/data",
    ),
    "power": Case(PowerNode, ("sensors", "power"), ("/bus/state",), "/power/switches"),
}
SPOKEN = [(role, topic) for role, case in CASES.items() for topic in case.inputs]


@pytest.fixture
def still_wall(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wall clock that stands for the nodes, so that nothing depends on how fast the test runs."""
    monkeypatch.setattr(node, "time", SimpleNamespace(monotonic=lambda: 1000.0))


class Fed:
    """A node that is fed period by period, in real time what it acts on last."""

    def __init__(self, bench: Bench, role: str, lockstep: bool) -> None:
        self.bench, self.case, self.lockstep = bench, CASES[role], lockstep
        self.node = bench.start(self.case.node, *self.case.participants, lockstep=lockstep)
        bench.connect(self.node, lockstep=lockstep)

    @property
    def refusals(self) -> int:
        """How many messages have been refused."""
        return sum(self.node.counters.refused.values())

    def say(self, topic: str, seconds: float) -> None:
        """A message that is good but for its stamp."""
        self.bench.send(topic, MESSAGES[topic][1](round(seconds / CONTROL_PERIOD_S)))

    def feed(self, period: int) -> None:
        """All that is due in a period, in real time one after the other."""
        due = [name for name in self.case.inputs if period % MESSAGES[name][0] == 0]
        for name in sorted(due, key=lambda name: name == self.node._trigger):
            refused = self.refusals
            self.bench.send(name, MESSAGES[name][1](period))
            if not self.lockstep:
                self.bench.until(
                    lambda name=name, refused=refused: (
                        self.node.latest.stamp_of(name) == at(period) or self.refusals > refused
                    ),
                    f"{name} is taken or refused",
                )

    def go_on(self, first: int, last: int) -> None:
        """Feed periods, each answered once."""
        every = min(MESSAGES[name][0] for name in self.case.inputs)
        for period in range(first, last + 1):
            self.feed(period)
            if period % every == 0:
                self.bench.answer(self.case.answer, period)


@pytest.mark.parametrize("seconds", [HIGHEST_STAMP_S, 1.4, -5.0])
@pytest.mark.parametrize(("role", "topic"), SPOKEN)
def test_one_false_stamp_blinds_nobody(bench: Bench, still_wall: None, role: str, topic: str, seconds: float) -> None:
    """1.4 s is a second ahead of the time at which it comes."""
    fed = Fed(bench, role, lockstep=False)
    fed.go_on(1, 20)
    fed.say(topic, seconds)
    bench.until(lambda: fed.node.counters.refused, "it is refused")
    fed.go_on(21, 90)
    assert fed.node.counters.refused == {topic: 1} and not fed.node.finished


@pytest.mark.parametrize(("role", "topic"), SPOKEN)
def test_a_false_first_stamp_is_got_over(bench: Bench, still_wall: None, role: str, topic: str) -> None:
    fed = Fed(bench, role, lockstep=False)
    fed.say(topic, HIGHEST_STAMP_S)
    bench.until(lambda: fed.node.latest.stamp_of(topic), "it is there")
    for period in range(1, 3 * FIFTH + 1):
        fed.feed(period)
    assert 0 < fed.node.latest.timeline.now <= at(3 * FIFTH), "the time is known"
    fed.go_on(3 * FIFTH + 1, 40)


@pytest.mark.parametrize(("role", "topic"), SPOKEN)
def test_in_lock_step_a_false_stamp_is_refused(bench: Bench, role: str, topic: str) -> None:
    fed = Fed(bench, role, lockstep=True)
    fed.go_on(1, 20)
    fed.say(topic, HIGHEST_STAMP_S)
    bench.until(lambda: fed.node.counters.refused, "it is refused")
    fed.go_on(21, 45)
    assert fed.node.counters.refused == {topic: 1}
