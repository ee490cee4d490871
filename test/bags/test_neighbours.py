"""Nodes of one process that hear each other without the middleware, and nodes of many that hear each other in bundles:
the same bag, and others hear them as always.
"""

from pathlib import Path
from typing import Any

import pytest
import rclpy
from fake_stack import FakePlant, build
from fake_stack import run as run_stack
from rclpy.executors import SingleThreadedExecutor

from sojourn_bags.completeness import RECORD
from sojourn_bags.reading import read_bag
from sojourn_contract import process, qos
from sojourn_contract.neighbours import Neighbours
from sojourn_contract.stamps import CONTROL_PERIOD_NS, from_cdr
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class

PERIODS = 110


FAR, NEAR, BUNDLED = "far", "near", "bundled"
"""How nodes hear each other: topic by topic, without the middleware, in bundles."""


LATE = 20
"""Periods: more than the recorder waits for a heartbeat."""


class LateSender:
    """A sender of heartbeats; those of the run leave it so many periods late, as on a machine under load."""

    def __init__(self, node: Any, sender: Any, periods: int = LATE) -> None:
        self.node, self.sender, self.periods = node, sender, periods
        self.kept: list[tuple[int, bytes]] = []

    def publish(self, data: bytes) -> None:
        """Keep a heartbeat of the run."""
        if from_cdr(data):
            self.kept.append((self.node.now + self.periods * CONTROL_PERIOD_NS, data))
        else:
            self.sender.publish(data)

    def look(self) -> None:
        """Send what has been kept for long enough."""
        while self.kept and self.kept[0][0] <= self.node.now:
            self.sender.publish(self.kept.pop(0)[1])

    def __getattr__(self, name: str) -> Any:
        return getattr(self.sender, name)


def run(
    folder: Path, how: str, interrupted_at: int = 0, late: bool = False, foreign: tuple[str, ...] = ()
) -> list[tuple[str, int]]:
    """A run of stand-in nodes. Returns topic and stamp of what a listener beside them hears of three topics."""
    nodes = build(folder, 1_000_000 if interrupted_at else PERIODS, bundled=how == BUNDLED, foreign=foreign)
    senders = [LateSender(node, node.endpoints.senders["/diagnostics"]) for node in nodes if late]
    for sender in senders:
        sender.node.endpoints.senders["/diagnostics"] = sender
    stop = process.StopFlag()
    listener, heard = rclpy.create_node("listener"), []
    for name in ("/odom", "/goal_pose", "/diagnostics"):
        row = topic(name)

        def hear(data: bytes, name: str = name) -> None:
            heard.append((name, from_cdr(data)))

        kind = message_class(row.type)
        listener.create_subscription(kind, name, hear, qos.profile(row, True), raw=True)
    executor = SingleThreadedExecutor()
    executor.add_node(listener)
    plant: Any = nodes[0]

    def before(period: int) -> None:
        for sender in senders:
            sender.look()
        for _ in range(8):  # one message at a time, of some three a period
            executor.spin_once(timeout_sec=0.0)
        stop.is_set = stop.is_set or 0 < interrupted_at <= period

    plant.before_period = before
    try:
        assert process.spin(nodes, stop, neighbours=Neighbours(nodes) if how == NEAR else None) == 0
        for _ in range(4 * PERIODS):
            executor.spin_once(timeout_sec=0.0)
    finally:
        executor.remove_node(listener)
        for node in (*nodes, listener):
            node.destroy_node()
    return heard


def content(folder: Path) -> list[tuple[int, str, bytes]]:
    bag = read_bag(folder)
    assert bag.whole and bag.records[RECORD]["complete"] == "true", bag.records[RECORD]["gaps"]
    entries = [
        (at, name, data)
        for name, messages in bag.topics.items()
        for at, data in zip(messages.log_times, messages.data, strict=True)
    ]
    return sorted(entries)


@pytest.mark.parametrize("how", [NEAR, BUNDLED])
def test_the_bag_is_that_of_a_run_over_the_middleware(ros: None, tmp_path: Path, how: str) -> None:
    run(tmp_path / how, how)
    run(tmp_path / FAR, FAR)
    near, far = content(tmp_path / how), content(tmp_path / FAR)
    assert [entry[:2] for entry in near] == [entry[:2] for entry in far]
    # heartbeats count what a node has refused and published, which is the same; bytes of the rest are, too
    differing = {one[1] for one, other in zip(near, far, strict=True) if one[2] != other[2]}
    assert not differing


@pytest.mark.parametrize("how", [{"late": True}, {"foreign": ("drive",)}, {"foreign": ("sensors", "recorder")}])
def test_so_it_is_with_heartbeats_that_are_late_on_their_topic_and_with_nodes_that_are_not_ours(
    ros: None, tmp_path: Path, how: dict[str, Any]
) -> None:
    run(tmp_path / BUNDLED, BUNDLED, **how)
    run(tmp_path / FAR, FAR)
    assert content(tmp_path / BUNDLED) == content(tmp_path / FAR)


def test_who_comes_late_hears_all_from_then_on(ros: None, tmp_path: Path) -> None:
    nodes, stop = build(tmp_path / "bag", 20_000, bundled=True), process.StopFlag()
    listener, heard = rclpy.create_node("listener"), []
    executor = SingleThreadedExecutor()
    executor.add_node(listener)
    row, plant = topic("/odom"), nodes[0]
    assert isinstance(plant, FakePlant)

    def before(period: int) -> None:
        if period == 40:
            quality = qos.profile(row, True, "recorder")
            kind = message_class(row.type)
            listener.create_subscription(kind, row.name, lambda data: heard.append(from_cdr(data)), quality, raw=True)
        for _ in range(4):
            executor.spin_once(timeout_sec=0.0)
        stop.is_set = len(heard) >= 50

    plant.before_period = before
    try:
        assert process.spin(nodes, stop) == 0
    finally:
        executor.remove_node(listener)
        for node in (*nodes, listener):
            node.destroy_node()
    assert len(heard) >= 50 and heard[0] >= 40 * CONTROL_PERIOD_NS
    assert heard == list(range(heard[0], heard[-1] + 1, CONTROL_PERIOD_NS))


@pytest.mark.parametrize("how", [NEAR, BUNDLED])
def test_who_listens_beside_them_hears_what_they_say(ros: None, tmp_path: Path, how: str) -> None:
    heard = run(tmp_path / "bag", how)
    stamps = [stamp for name, stamp in heard if name == "/odom"]
    assert stamps == [period * CONTROL_PERIOD_NS for period in range(1, PERIODS + 1)]
    assert sum(1 for name, _ in heard if name == "/goal_pose") == PERIODS // 25
    assert any(name == "/diagnostics" and stamp for name, stamp in heard)


@pytest.mark.parametrize(("how", "period"), [(NEAR, 33), (NEAR, 41), (BUNDLED, 33)])
def test_one_that_is_interrupted_leaves_a_complete_bag(ros: None, tmp_path: Path, how: str, period: int) -> None:
    run(tmp_path / "bag", how, interrupted_at=period)
    bag = read_bag(tmp_path / "bag")
    assert bag.whole and bag.records[RECORD]["complete"] == "true", bag.records[RECORD]["gaps"]
    assert len(bag["/drive_command"]) == len(bag["/truth/odom"]) >= period


def test_what_one_says_at_a_rate_has_no_reader_of_the_middleware(ros: None, tmp_path: Path) -> None:
    nodes = build(tmp_path / "bag", PERIODS)
    try:
        Neighbours(nodes)
        drive = next(node for node in nodes if node.role == "drive")
        assert all(topic(name).is_event or topic(name).publisher == "all" for name in drive.endpoints.readers)
    finally:
        for node in nodes:
            node.destroy_node()


def test_with_nobody_else_to_hear_it_a_bundled_topic_is_not_sent_by_itself(ros: None, tmp_path: Path) -> None:
    nodes = build(tmp_path / "bag", PERIODS, bundled=True)
    sent: list[str] = []

    class Counting:
        """A sender that notes what it sends."""

        def __init__(self, name: str, sender: Any) -> None:
            self.name, self.sender = name, sender

        def publish(self, data: bytes) -> None:
            sent.append(self.name)
            self.sender.publish(data)

        def __getattr__(self, name: str) -> Any:
            return getattr(self.sender, name)

    for node in nodes:
        senders = node.endpoints.senders
        senders.update({name: Counting(name, sender) for name, sender in senders.items()})
    assert run_stack(nodes) == 0
    assert {name for name in sent if not topic(name).is_event and topic(name).every == 1} == set()
    assert "/diagnostics" in sent and "/bus/state" in sent and "/goal_pose" in sent
