"""What is lost between the processes of a lock-step run: it is said again where the run stands still."""

from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import rclpy
from fake_stack import build, run

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.reading import Bag, read_bag
from sojourn_contract import repeats
from sojourn_contract.bundling import REPEATS, pack, unpack
from sojourn_contract.codecs import encode
from sojourn_contract.node import ContractNode
from sojourn_contract.repeats import AFTER_S, KEPT, Repeats
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import RECORDER_LAG, STANDARD, topic
from sojourn_contract.values import Clock, Header

PERIODS = 110


def recorded(folder: Path, prepare: Callable[[Sequence[ContractNode]], None] = lambda nodes: None) -> Bag:
    """A run of stand-ins that hear bundles, as if each were a process."""
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    try:
        nodes = build(folder, PERIODS, bundled=True)
        prepare(nodes)
        assert run(nodes, limit_s=200.0) == 0
    finally:
        rclpy.try_shutdown()
    return read_bag(folder)


@pytest.mark.parametrize("is_late", [False, True], ids=["lost", "late"])
@pytest.mark.parametrize("first", [1, 17])
def test_a_run_goes_on_where_messages_are_lost_and_its_record_is_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, first: int, is_late: bool
) -> None:
    """It stood still until its time was up: a flooded node had lost one message. One that comes late, as the middleware
    sends it again, was refused and written twice.
    """
    monkeypatch.setattr(repeats, "AFTER_S", 0.05)
    lost: list[str] = []

    def losing(node: ContractNode, receive: Callable[[bytes], None], which: int) -> Callable[[bytes], None]:
        heard, held = count(), list[bytes]()

        def hear(data: bytes) -> None:
            # the last ones would be lost where nobody stands still
            if next(heard) == which and node.now < (PERIODS - 2 * RECORDER_LAG) * CONTROL_PERIOD_NS:
                lost.append(node.role)
                held.extend([data] if is_late else [])
                return
            while held:
                receive(held.pop())
            receive(data)

        return hear

    def lose(nodes: Sequence[ContractNode]) -> None:
        """Of each pair one bundle, one after the other."""
        which = count(first)
        for node in nodes:
            for reader in node.endpoints.bundles._readers.values():
                reader.callback = losing(node, reader.callback, next(which))

    whole, lossy = recorded(tmp_path / "whole"), recorded(tmp_path / "lossy", lose)
    result = compare(whole.topics, lossy.topics)
    assert result.verdict is Verdict.IDENTICAL, "\n".join(comparison_lines(result))
    assert len(lost) > 10


def speaker(awaited: Sequence[str] = ()) -> tuple[Any, Repeats, list[bytes], list[tuple[str, bytes]]]:
    """A stand-in of a node, what it says again, and what it takes."""
    said, taken = list[bytes](), list[tuple[str, bytes]]()
    node = SimpleNamespace(
        now=0,
        role="plant",
        table=STANDARD,
        awaited=[topic(name) for name in awaited],
        refused=[],
        create_publisher=lambda *_: SimpleNamespace(publish=said.append),
        create_subscription=lambda kind, name, hear, quality, raw: setattr(node, "hear", hear),
    )
    node.refuse = lambda name, reason: node.refused.append(name)
    return node, Repeats(node, lambda row, data: taken.append((row.name, data))), said, taken


def test_who_acts_says_nothing_again_and_who_stands_still_the_last_periods() -> None:
    node, again, said, _ = speaker()
    wall = 100.0
    for period in range(2 * KEPT):
        node.now, wall = period, wall + 0.9 * AFTER_S
        again.note([("/clock", b"%d" % period), ("/diagnostics", b"d"), ("/truth/odom", b"j%d" % period)])
        again.look(wall)
    assert not said
    for _ in range(2):
        again.look(wall + 0.9 * AFTER_S)
        wall += 1.1 * AFTER_S
        again.look(wall)
    assert len(said) == 2 and said[0] == said[1]
    kept = range(KEPT, 2 * KEPT)
    assert unpack(REPEATS.name, said[0]) == [
        one for period in kept for one in (("/clock", b"%d" % period), ("/truth/odom", b"j%d" % period))
    ]


def test_who_is_halted_for_long_is_told_more_rarely() -> None:
    _, again, said, _ = speaker()
    again.note([("/clock", b"c")])
    for tenth in range(36_000):
        again.look(0.1 * tenth)
    of_evenly = 3600.0 / AFTER_S
    assert 0.01 * of_evenly < len(said) < 0.05 * of_evenly


def test_of_what_is_said_again_a_node_takes_what_it_lacks() -> None:
    node, _, _, taken = speaker(["/clock", "/operator/tick"])
    clock, tick = (encode(topic("/clock"), Clock(4)), encode(topic("/operator/tick"), Header(5)))
    node.lacks = lambda row, stamp: stamp == 5
    node.hear(pack([("/clock", clock), ("/goal_pose", b"g"), ("/operator/tick", tick), ("/unknown", b"u")]))
    assert taken == [("/operator/tick", tick)] and not node.refused
    for garbage in (b"\x00\x01\x00\x00garbage", pack([("/clock", b"c")])):
        node.hear(garbage)
    assert node.refused == [REPEATS.name] * 2 and len(taken) == 1
