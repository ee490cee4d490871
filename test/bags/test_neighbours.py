"""Nodes of one process that hear each other without the middleware: the same bag, and others hear them as always."""

from pathlib import Path
from typing import Any

import pytest
import rclpy
from fake_stack import build
from rclpy.executors import SingleThreadedExecutor

from sojourn_bags.completeness import RECORD
from sojourn_bags.reading import read_bag
from sojourn_contract import process, qos
from sojourn_contract.neighbours import Neighbours
from sojourn_contract.stamps import CONTROL_PERIOD_NS, from_cdr
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class

PERIODS = 110


def run(folder: Path, near: bool, interrupted_at: int = 0) -> list[tuple[str, int]]:
    """A run of stand-in nodes. Returns topic and stamp of what a listener beside them hears of three topics."""
    nodes, stop = build(folder, 1_000_000 if interrupted_at else PERIODS), process.StopFlag()
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
        for _ in range(8):  # one message at a time, of some three a period
            executor.spin_once(timeout_sec=0.0)
        stop.is_set = stop.is_set or 0 < interrupted_at <= period

    plant.before_period = before
    try:
        assert process.spin(nodes, stop, neighbours=Neighbours(nodes) if near else None) == 0
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


def test_the_bag_is_that_of_a_run_over_the_middleware(ros: None, tmp_path: Path) -> None:
    run(tmp_path / "near", near=True)
    run(tmp_path / "far", near=False)
    near, far = content(tmp_path / "near"), content(tmp_path / "far")
    assert [entry[:2] for entry in near] == [entry[:2] for entry in far]
    # heartbeats count what a node has refused and published, which is the same; bytes of the rest are, too
    differing = {one[1] for one, other in zip(near, far, strict=True) if one[2] != other[2]}
    assert not differing


def test_who_listens_beside_them_hears_what_they_say(ros: None, tmp_path: Path) -> None:
    heard = run(tmp_path / "bag", near=True)
    stamps = [stamp for name, stamp in heard if name == "/odom"]
    assert stamps == [period * CONTROL_PERIOD_NS for period in range(1, PERIODS + 1)]
    assert sum(1 for name, _ in heard if name == "/goal_pose") == PERIODS // 25
    assert any(name == "/diagnostics" and stamp for name, stamp in heard)


@pytest.mark.parametrize("period", [33, 41])
def test_one_that_is_interrupted_leaves_a_complete_bag(ros: None, tmp_path: Path, period: int) -> None:
    run(tmp_path / "bag", near=True, interrupted_at=period)
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
