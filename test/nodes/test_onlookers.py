"""To whom a fast run does not say everything: consoles that look on, and nobody else."""

from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy

from sojourn_console.live_feed import ROLE
from sojourn_contract import onlookers, qos
from sojourn_contract.onlookers import ASK_S, LOOK_S, Onlookers
from sojourn_contract.topics import topic


class Graph:
    """Who hears a topic, as the ROS library tells it."""

    topic_name = "/truth/contacts"

    def __init__(self) -> None:
        self.listeners: list[Any] = []
        self.asked = 0

    @property
    def counts(self) -> dict[str, int]:
        return {"contacts": len(self.listeners)}

    def get_subscriptions_info_by_topic(self, name: str) -> list[Any]:
        assert name == self.topic_name
        self.asked += 1
        return self.listeners


def listener(name: str, profile: QoSProfile) -> Any:
    return SimpleNamespace(node_name=name, qos_profile=profile)


LOOKS = listener(ROLE, qos.looking())
LISTENS = listener(ROLE, qos.profile(topic("/truth/contacts"), lockstep=True))
STRANGER = listener("rviz", qos.looking())


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(onlookers.time, "monotonic", lambda: now[0])
    return now


def said(graph: Graph, clock: list[float], seconds: float) -> int:
    """Of a message a millisecond."""
    watch = Onlookers(graph, {"contacts": graph})
    count = 0
    for _ in range(round(seconds * 1000.0)):
        clock[0] += 1e-3
        watch.look(graph.counts)
        count += not watch.rests("contacts")
    return count


def test_onlookers_alone_are_told_as_often_as_they_look(clock: list[float]) -> None:
    graph = Graph()
    graph.listeners = [LOOKS, LOOKS]
    assert said(graph, clock, 3.0) == pytest.approx(3.0 / LOOK_S, abs=4)
    assert graph.asked <= 3.0 / ASK_S + 2


@pytest.mark.parametrize("besides", [LISTENS, STRANGER, listener("drive", LISTENS.qos_profile)])
def test_whoever_listens_besides_hears_everything(clock: list[float], besides: Any) -> None:
    graph = Graph()
    graph.listeners = [LOOKS, besides]
    assert said(graph, clock, 1.0) == 1000


def test_who_begins_to_listen_in_an_onlookers_place_is_seen(clock: list[float]) -> None:
    """A page that plots what it looked at before: as many hear the topic, and others."""
    graph = Graph()
    graph.listeners = [LOOKS]
    watch = Onlookers(graph, {"contacts": graph})
    watch.look(graph.counts)
    assert [watch.rests("contacts") for _ in range(2)] == [False, True]
    graph.listeners = [LISTENS]
    clock[0] += 1.01 * ASK_S
    watch.look(graph.counts)
    assert [watch.rests("contacts") for _ in range(2)] == [False, False]
    assert not watch.rests("another"), "of a topic that is no periodic one of this node nothing is left out"


def test_a_reader_with_best_effort_is_best_effort() -> None:
    profile = qos.looking()
    assert profile.reliability is ReliabilityPolicy.BEST_EFFORT and profile.depth == 1
