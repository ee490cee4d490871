"""To whom a fast run speaks as often as they look: consoles, where nobody else hears a topic."""

from functools import partial
from itertools import count
from types import SimpleNamespace
from typing import Any

import pytest
import rclpy
from node_bench import Bench
from rclpy.qos import QoSProfile, ReliabilityPolicy

from sojourn_contract import onlookers, qos
from sojourn_contract.bundling import unpack
from sojourn_contract.codecs import decode
from sojourn_contract.onlookers import ASK_S, LOOK_S, Onlookers, looks_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Clock, Path
from sojourn_drive.node import DriveNode

ROW = topic("/clock")


class Graph:
    """A node that says one topic, and who hears it and its looks, as the ROS library tells it."""

    topic_name, role = ROW.name, "plant"

    def __init__(self, *listeners: Any, reached: int = 2) -> None:
        self.listeners, self.reached = listeners, reached
        self.asked, self.asked_of_looks, self.senders = 0, 0, 0
        self.published: list[list[int]] = []
        """Of each message to onlookers the stamps in it."""

    @property
    def counts(self) -> dict[str, int]:
        return {ROW.name: len(self.listeners)}

    def get_subscriptions_info_by_topic(self, name: str) -> tuple[Any, ...]:
        if name == looks_of(self.role).name:
            self.asked_of_looks += 1
            return tuple(reader(number, LISTENS.qos_profile) for number in CONSOLES)
        assert name == self.topic_name
        self.asked += 1
        return self.listeners

    def resolve_topic_name(self, name: str) -> str:
        return f"/{name}"

    def create_publisher(self, kind: Any, name: str, quality: QoSProfile) -> Any:
        assert name == "_looks/plant" and quality.reliability is ReliabilityPolicy.RELIABLE
        self.senders += 1
        return SimpleNamespace(publish=self._hear, get_subscription_count=lambda: self.reached)

    def _hear(self, data: bytes) -> None:
        said = unpack(looks_of("plant").name, data)
        assert {name for name, _ in said} == {ROW.name}
        self.published.append([decode(ROW, content).stamp for _, content in said])


def reader(participant: int, profile: QoSProfile) -> Any:
    """One of a participant, of which each has a number of its own."""
    return SimpleNamespace(endpoint_gid=[*[participant] * 12, *next(NUMBERS).to_bytes(4)], qos_profile=profile)


NUMBERS = count()
CONSOLES = 1, 2
LOOKS = reader(1, qos.looking())
LISTENS = reader(2, qos.profile(ROW, lockstep=True))
STRANGER = reader(3, qos.looking())


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    now = [100.0]
    monkeypatch.setattr(onlookers.time, "monotonic", lambda: now[0])
    return now


def spoken(graph: Graph, clock: list[float], seconds: float) -> list[int]:
    """Stamps of the messages that are sent on the topic itself, of one a millisecond."""
    watch = Onlookers(graph, {ROW.name: ROW}, {ROW.name: graph})
    aloud = []
    for stamp in range(round(seconds * 1000.0)):
        clock[0] += 1e-3
        watch.look(graph.counts)
        if not watch.takes(ROW.name, Clock(stamp)):
            aloud.append(stamp)
    watch.looks.send()
    return aloud


def test_who_looks_is_told_the_newest_as_often_as_it_looks(clock: list[float]) -> None:
    graph = Graph(LOOKS, LOOKS)
    assert not spoken(graph, clock, 3.0)
    assert len(graph.published) == pytest.approx(3.0 / LOOK_S, abs=4)
    assert all(len(stamps) == 1 for stamps in graph.published) and graph.published[-1] == [2999]
    assert graph.asked <= 3.0 / ASK_S + 2 and graph.senders == 1


def test_who_wants_everything_is_told_everything_as_often_as_it_looks(clock: list[float]) -> None:
    graph = Graph(LOOKS, LISTENS)
    assert not spoken(graph, clock, 3.0)
    assert len(graph.published) == pytest.approx(3.0 / LOOK_S, abs=4)
    assert [stamp for stamps in graph.published for stamp in stamps] == list(range(3000))


@pytest.mark.parametrize("besides", [STRANGER, reader(4, LISTENS.qos_profile)])
def test_whoever_listens_besides_hears_everything_and_at_once(clock: list[float], besides: Any) -> None:
    graph = Graph(LOOKS, besides)
    assert spoken(graph, clock, 1.0) == list(range(1000))
    assert not graph.published


def test_where_nobody_listens_nobody_asks_who_looks(clock: list[float]) -> None:
    graph = Graph()
    assert spoken(graph, clock, 1.0) == list(range(1000))
    assert not graph.asked and not graph.asked_of_looks and not graph.senders


def test_a_console_that_is_not_reached_yet_hears_the_topic(clock: list[float]) -> None:
    graph = Graph(LOOKS, reached=1)
    assert spoken(graph, clock, 1.0) == list(range(1000)) and not graph.published


def test_who_begins_to_listen_in_an_onlookers_place_is_seen(clock: list[float]) -> None:
    """As many hear the topic, and others; what waited comes before what is sent from then on."""
    graph = Graph(LISTENS)
    watch = Onlookers(graph, {ROW.name: ROW}, {ROW.name: graph})
    watch.look(graph.counts)
    assert [watch.takes(ROW.name, Clock(stamp)) for stamp in (1, 2, 3)] == [True] * 3
    assert graph.published == [[1]]
    graph.listeners = (STRANGER,)
    clock[0] += 1.01 * ASK_S
    watch.look(graph.counts)
    assert graph.published == [[1], [2, 3]]
    assert not watch.takes(ROW.name, Clock(4)) and not watch.takes("/odom", Clock(4))


def test_what_waits_is_sent_without_another_message(clock: list[float]) -> None:
    """A run that stands still shows its last period."""
    graph = Graph(LOOKS)
    watch = Onlookers(graph, {ROW.name: ROW}, {ROW.name: graph})
    watch.look(graph.counts)
    for stamp in (1, 2):
        watch.takes(ROW.name, Clock(stamp))
    clock[0] += 1.01 * LOOK_S
    watch.look(graph.counts)
    assert graph.published == [[1], [2]]


def test_one_node_of_a_process_sends_for_all(clock: list[float]) -> None:
    graphs = Graph(LISTENS), Graph(LISTENS)
    first, second = (Onlookers(graph, {ROW.name: ROW}, {ROW.name: graph}) for graph in graphs)
    second.looks = first.looks
    for watch, graph in zip((first, second), graphs, strict=True):
        watch.look(graph.counts)
    first.takes(ROW.name, Clock(0))
    for stamp in range(1, 5):
        assert (first, second)[stamp % 2].takes(ROW.name, Clock(stamp))
    clock[0] += 1.01 * LOOK_S
    second.takes(ROW.name, Clock(5))
    assert graphs[0].published == [[0], [1, 2, 3, 4, 5]] and not graphs[1].senders


def test_a_reader_with_best_effort_is_best_effort() -> None:
    profile = qos.looking()
    assert profile.reliability is ReliabilityPolicy.BEST_EFFORT and profile.depth == 1


def test_a_node_of_a_run_in_processes_tells_a_console_once(bench: Bench) -> None:
    """What no companion hears goes in no bundle of theirs, and was sent on its topic besides."""
    node = bench.start(DriveNode, "plant", "drive", companions=["plant", "drive"])
    plan, looks, message = node.endpoints.outputs["/plan"], looks_of("drive"), Path(CONTROL_PERIOD_NS, "map", ())
    assert node.endpoints.bundles.listeners and not node.endpoints.bundles.carries(plan, message)
    console = rclpy.create_node("page", context=bench.context, enable_rosout=False, start_parameter_services=False)
    bench.executor.add_node(console)
    heard = list[str]()
    for row, profile in ((looks, onlookers.quality(looks)), (plan, LISTENS.qos_profile)):
        hear = partial(lambda name, _data: heard.append(name), row.name)
        console.create_subscription(message_class(row.type), row.name.lstrip("/"), hear, profile, raw=True)
    bench.until(lambda: node.endpoints.onlookers._in_full, "the console is seen")
    node.endpoints.send(plan.name, message)
    bench.until(lambda: heard, "it is told")
    bench.spin(0.5)
    console.destroy_node()
    assert heard == [looks.name]
