"""A run in one process beside somebody who says garbage on every topic: it ends as if he were not there, and its bag,
which holds what he said, can be read.
"""

import math
import random
import struct
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
import rclpy
from fake_stack import build
from rclpy._rclpy_pybind11 import RCLError

from sojourn_bags import compare_command as compare
from sojourn_bags import plot_command as plot
from sojourn_bags import reading
from sojourn_bags import recover_command as recover
from sojourn_bags import report_command as report
from sojourn_bags.completeness import RECORD
from sojourn_bags.condensed import BATCH
from sojourn_bags.reading import read_bag
from sojourn_bags.summary import summarise
from sojourn_bags.summary_reading import read_for_summary
from sojourn_bringup import contract_tool
from sojourn_contract import process, qos
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.timeline import PERSISTING_S
from sojourn_contract.topics import TOPICS
from sojourn_contract.types import message_class

sys.path.insert(0, str(Path(__file__).parents[1] / "contract"))

from hostile_bytes import GARBAGE, whole

PERIODS, SILENT_FROM = 160, 80


def garbage(number: int) -> list[tuple[str, bytes]]:
    """Something for every topic, another thing each time."""
    noise = random.Random(number)
    said = []
    for row in TOPICS:
        cut = bytearray(whole(row))
        for _ in range(4):
            cut[noise.randrange(len(cut))] = noise.choice((0, 1, 7, 127, 128, 255))
        when = struct.pack("<iI", noise.choice((-1, 0, 1, 3, 2_000_000_000)), noise.randrange(NANOSECONDS))
        cut[4:12] = when
        said.append((row.name, noise.choice([*GARBAGE.values(), b"\0\1\0\0", bytes(cut), noise.randbytes(40)])))
    return said


def record(bag: Path, lockstep: bool) -> int:
    """A whole stack, and the one who says garbage. Returns the exit status; 99 if it hangs."""
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    try:
        nodes = build(bag, PERIODS, lockstep)
        rogue = rclpy.create_node("rogue", enable_rosout=False, start_parameter_services=False)
        senders = {
            row.name: rogue.create_publisher(
                message_class(row.type), row.name.lstrip("/"), qos.profile(row, lockstep, "recorder")
            )
            for row in TOPICS
        }
        deadline, stepped = time.monotonic() + 200.0, 0.0
        plant, drive = nodes[0], nodes[2]

        def speak(period: int) -> None:
            """Before every eighth period, whatever this machine's speed."""
            nonlocal stepped
            stepped = time.monotonic()
            if period < SILENT_FROM and period % 8 == 0:
                for name, data in garbage(period):
                    with suppress(RCLError):  # more than any message of the type can have is not sent
                        senders[name].publish(data)

        def wait() -> bool:
            """Hold a real-time plant to what this machine can do: it waits for the drive, a while."""
            keeps_up = drive.now >= (plant.period - 1) * CONTROL_PERIOD_NS or time.monotonic() - stepped > 1.0
            plant.next_at = 0.0 if keeps_up else math.inf
            return time.monotonic() > deadline

        plant.before_period = speak
        try:
            status = process.spin(nodes, process.StopFlag(), wait)
        finally:
            for node in (*nodes, rogue):
                node.destroy_node()
        assert all(node.counters.refused for node in nodes if node.role != "sensors")
        return status if time.monotonic() < deadline else 99
    finally:
        rclpy.try_shutdown()


@pytest.mark.parametrize("lockstep", [True, False])
def test_a_run_survives_garbage_and_its_bag_can_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lockstep: bool
) -> None:
    folder = tmp_path / "bag"
    monkeypatch.chdir(tmp_path)
    assert record(folder, lockstep) == 0
    bag = read_bag(folder)
    assert bag.whole and bag.records[RECORD]["complete"] == "true"
    assert bag.unusable and {entry.topic for entry in bag.unusable} > {"/odom", "/truth/contacts"}
    stamps = bag["/odom"].times
    assert stamps.max() < 10.0
    late = {round(stamp / 0.02) for stamp in stamps if stamp > SILENT_FROM * 0.02 + PERSISTING_S + 0.1}
    assert len(late) >= 0.9 * (PERIODS - SILENT_FROM) - 15, "once he is silent all goes on as before"
    if lockstep:
        assert {round(stamp / 0.02) for stamp in stamps} >= set(range(1, PERIODS + 1))

    for pieces in (BATCH, 7):
        monkeypatch.setattr(reading, "BATCH", pieces)
        assert summarise(read_for_summary(folder)) == summarise(bag)

    page = str(tmp_path / "page.html")
    assert report.main([str(folder), "--html", "--out", page]) == 0
    assert report.main([str(folder), "--out", str(tmp_path / "report.png")]) == 0
    fields = [f"{name}.{field}" for name, field in (("/odom", "pose.pose.position.x"), ("/imu/data", "orientation"))]
    assert plot.main([str(folder), "/joint_states.position", "/truth/contacts.sinkage", *fields]) == 0
    assert compare.main([str(folder), str(folder)]) == 0
    assert recover.main([str(folder)]) == 0
    assert contract_tool.main(["check", "--bag", str(folder)]) == 1, "the judge says what is wrong"
