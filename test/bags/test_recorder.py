"""The recorder in a stack of stand-in nodes: what it writes, who opens it, how gaps and kills end."""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
import rclpy
import yaml
from fake_stack import SCENARIO, FakeNode, build, run
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from sojourn_bags.completeness import RECORD
from sojourn_bags.definitions import ChannelSpec
from sojourn_bags.description import Run
from sojourn_bags.errors import BagExistsError, UnreadableBagError, UnwritableBagError
from sojourn_bags.parts import counts_in
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.recorder_node import RecorderNode
from sojourn_bags.writer import FLUSH_REALTIME_S, BagWriter
from sojourn_config.scenario import load_scenario
from sojourn_contract import process
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import MATCHED, STALLED, WAITING_FOR
from sojourn_contract.run_table import table_of
from sojourn_contract.silence import SILENCE_S
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_table import CLOCK
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import TOPICS, topic
from sojourn_contract.values import Clock

PERIODS = 110
HERE = Path(__file__).parent


def record(bag: Path, periods: int = PERIODS, **options: Any) -> int:
    """Record a run on the domain of the environment. Returns the exit status."""
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    try:
        return run(build(bag, periods, **options))
    finally:
        rclpy.try_shutdown()


def due(every: int, periods: int) -> int:
    """Messages of a topic that comes every so many periods."""
    return sum(1 for period in range(1, periods + 1) if period % every == 0)


def values(bag: Bag) -> list[tuple[int, str, str]]:
    """Sequence of (log time, topic, field values) of a whole bag, in the order of the file."""
    with bag.path.open("rb") as stream:
        decoded = make_reader(stream, decoder_factories=[DecoderFactory()]).iter_decoded_messages(log_time_order=False)
        return [(message.log_time, channel.topic, str(content)) for _, channel, message, content in decoded]


def test_bag_is_whole_and_others_open_it(tmp_path: Path) -> None:
    folder = tmp_path / "run_a"
    assert record(folder) == 0

    path = folder / "run_a_0.mcap"
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        counts = {
            summary.channels[number].topic: count for number, count in summary.statistics.channel_message_counts.items()
        }
        assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
        for channel in summary.channels.values():
            assert channel.message_encoding == "cdr"
            qos = yaml.safe_load(channel.metadata["offered_qos_profiles"])
            assert qos[0]["history"] == "keep_last"
        assert {index.compression for index in summary.chunk_indexes} == {"zstd"}
        decoded = {channel.topic: content for _, channel, _, content in reader.iter_decoded_messages()}
    for row in TOPICS:
        if row.logged and not row.is_event and row.publisher != "all":
            assert counts.get(row.name, 0) == due(row.every, PERIODS), row.name
    assert counts["/tf"] == PERIODS
    assert decoded["/truth/odom"].pose.pose.position.x == pytest.approx(0.1 * PERIODS * 0.02)

    with AnyReader([folder]) as bag:
        assert {topic: info.msgcount for topic, info in bag.topics.items()} == counts
        last_stamp = -1
        transforms = []
        for connection, log_time, raw in bag.messages():
            message = bag.deserialize(raw, connection.msgtype)
            assert log_time >= last_stamp
            last_stamp = log_time
            if connection.topic == "/tf":
                transforms.append((log_time, message))
            elif hasattr(message, "header") and connection.topic != "/diagnostics":
                assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == log_time
    assert [link.header.frame_id + ">" + link.child_frame_id for link in transforms[0][1].transforms] == [
        "map>odom",
        "odom>base_link",
    ]
    assert transforms[-1][0] == PERIODS * CONTROL_PERIOD_NS


def test_bag_tells_where_it_is_from_and_what_it_holds(tmp_path: Path) -> None:
    assert record(tmp_path / "bag", 60) == 0
    bag = read_bag(tmp_path / "bag")
    assert bag.whole
    assert bag.attachments[f"config/scenarios/{SCENARIO}.yaml"].startswith(b"#")
    assert {"python", "numpy", "mcap", "commit"} <= json.loads(bag.attachments["versions.json"]).keys()
    described = Run.of_bag(bag)
    assert described.name == SCENARIO
    assert described.resolved["scenario"]["seed"] == described.scenario.seed
    assert described.terrain().heights.shape == described.scenario.terrain.node_counts

    account = bag.records[RECORD]
    assert account["complete"] == "true"
    topics = json.loads(account["topics"])
    assert topics["/drive_command"] == {"published": 60, "recorded": 60, "due": 60}
    # seven nodes a heartbeat in the one full second; their farewells are no part of the record
    assert topics["/diagnostics"]["published"] == topics["/diagnostics"]["recorded"] == 7
    metadata = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert metadata["version"] == 9
    assert json.loads(metadata["custom_data"][RECORD]) == account
    assert metadata["message_count"] == sum(len(messages) for messages in bag.topics.values())


def test_two_runs_give_the_same_file_content(tmp_path: Path) -> None:
    for name in ("first", "second"):
        assert record(tmp_path / name) == 0
    first, second = values(read_bag(tmp_path / "first")), values(read_bag(tmp_path / "second"))
    assert len(first) > 900
    assert first == second
    order = [row.name for row in table_of(load_scenario(SCENARIO))]
    ranks = [(log_time, order.index(topic)) for log_time, topic, _ in first if topic != "/tf"]
    assert ranks == sorted(ranks)


def test_lost_message_is_named_and_fails(tmp_path: Path) -> None:
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    nodes = build(tmp_path / "bag", 60, lockstep=False)
    plant = nodes[0]
    assert isinstance(plant, FakeNode)
    plant.forget.add(("/truth/contacts", 7))
    try:
        assert run(nodes) == 1
    finally:
        rclpy.try_shutdown()
    account = read_bag(tmp_path / "bag").records[RECORD]
    assert account["complete"] == "false"
    assert account["gaps"] == "/truth/contacts: 59 recorded of 60 published"


def test_in_real_time_it_stalls_only_where_the_clock_stays_away(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    nodes = build(tmp_path / "bag", 150, lockstep=False)  # 1.5 s or more
    recorder, heard, silences = nodes[-1], [time.monotonic()], list[float]()
    receive, say = recorder._receive, recorder._send_heartbeat

    def receiving(row: Topic, message: bytes) -> None:
        if row.name == CLOCK:
            heard.append(time.monotonic())
        receive(row, message)

    def saying(state: str, *others: Any) -> None:
        if state == STALLED:
            silences.append(time.monotonic() - heard[-1])
        say(state, *others)

    monkeypatch.setattr(recorder, "_receive", receiving)
    monkeypatch.setattr(recorder, "_send_heartbeat", saying)
    try:
        assert run(nodes) == 0
    finally:
        rclpy.try_shutdown()
    assert all(silence >= SILENCE_S for silence in silences), silences


def test_after_a_strangers_clock_it_says_that_it_could_begin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before the run: it has acted on that clock, and is not ready as it would be otherwise."""
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    own = {"participants": ["recorder"], "scenario": SCENARIO, "bag": str(tmp_path / "bag"), "lockstep": False}
    recorder, said = RecorderNode(overrides=own), list[tuple[str, dict[str, str]]]()
    monkeypatch.setattr(recorder, "_send_heartbeat", lambda state, _, __="", extra=None: said.append((state, extra)))
    clock, stranger = topic(CLOCK), RecorderNode._receive
    assert recorder.recording.writer.flush_s == FLUSH_REALTIME_S
    try:
        stranger(recorder, clock, encode(clock, Clock(1_000_000_000_000)))
        assert recorder.now
        monkeypatch.setattr(recorder._silence, "until", lambda now: SILENCE_S)
        recorder.poll()
    finally:
        recorder.destroy_node()
        rclpy.try_shutdown()
    state, extra = said[-1]
    assert state == STALLED and extra == {WAITING_FOR: "plant", MATCHED: "yes"}


def test_without_a_drive_node_base_link_hangs_under_map(tmp_path: Path) -> None:
    assert record(tmp_path / "bag", 10, roles=("plant", "sensors", "arm")) == 0
    bag = read_bag(tmp_path / "bag")
    links = bag["/tf"].decode(9).transforms
    assert [(link.header.frame_id, link.child_frame_id) for link in links] == [("map", "base_link")]
    assert links[0].transform.translation.x == pytest.approx(0.1 * 10 * 0.02)


def test_killed_recorder_leaves_a_bag_that_opens(tmp_path: Path) -> None:
    folder = tmp_path / "killed"
    process = subprocess.Popen([sys.executable, str(HERE / "fake_stack.py"), str(folder), "1000000"], env=os.environ)
    try:
        path = folder / "killed_0.mcap"
        deadline = time.monotonic() + 600.0
        while time.monotonic() < deadline and not (path.exists() and _count(path) > 50):
            assert process.poll() is None
            time.sleep(0.05)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    bag = read_bag(folder)
    assert not bag.whole
    assert len(bag["/truth/odom"]) > 50
    assert bag["/truth/odom"].times[0] == 0.02
    assert Run.of_bag(bag).name == SCENARIO
    assert yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]["version"] == 9


def _count(path: Path) -> int:
    """Messages of /truth/odom in a growing bag, also of a chunk that is being written."""
    try:
        bag = read_bag(path)
    except UnreadableBagError:  # it has just been made
        return 0
    return len(bag["/truth/odom"]) if "/truth/odom" in bag else 0


def start_recorder(bag: str) -> subprocess.CompletedProcess[str]:
    """The recorder's own process."""
    command = [sys.executable, "-m", "sojourn_bags", "--ros-args", "-p", f"scenario:={SCENARIO}"]
    return subprocess.run([*command, "-p", f"bag:={bag}"], capture_output=True, text=True, timeout=600)


def test_folder_that_cannot_be_written_is_an_error_at_the_start(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    found = start_recorder(str(tmp_path / "file" / "bag"))
    assert found.returncode == 1
    assert found.stderr.splitlines()[-1].startswith(f"recorder: the bag {tmp_path / 'file' / 'bag'} cannot be written")
    assert "Traceback" not in found.stderr


def test_disk_that_is_full_ends_the_run_with_an_error(tmp_path: Path) -> None:
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        nodes = build(tmp_path / "bag", 1_000_000)
        size = (tmp_path / "bag" / "bag_0.mcap").stat().st_size
        resource.setrlimit(resource.RLIMIT_FSIZE, (size + 1000, limits[1]))
        with pytest.raises(UnwritableBagError, match=f"the bag {tmp_path / 'bag'} cannot be written"):
            run(nodes)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        rclpy.try_shutdown()
    bag = read_bag(tmp_path / "bag")
    assert not bag.whole
    there = {name: len(messages) for name, messages in bag.topics.items()}
    recorder = nodes[-1]
    assert isinstance(recorder, RecorderNode)
    assert recorder.recording.writer.recorded() == there, "what counts is what is on the disk"
    metadata = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert metadata["message_count"] <= sum(there.values())


@pytest.mark.parametrize("periods", [33, 41, 52])
def test_a_run_that_is_interrupted_leaves_a_complete_bag(tmp_path: Path, periods: int) -> None:
    """Ctrl-C in the middle of a period: who owes something for it still says it, and the plant begins no other."""
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    nodes, stop = build(tmp_path / "bag", 1_000_000), process.StopFlag()
    plant = nodes[0]
    step = plant.step

    def interrupted_step() -> None:
        step()
        stop.is_set = stop.is_set or plant.period >= periods

    plant.step = interrupted_step
    try:
        assert process.spin(nodes, stop) == 0
    finally:
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown()
    bag = read_bag(tmp_path / "bag")
    assert bag.whole and bag.records[RECORD]["complete"] == "true", bag.records[RECORD]["gaps"]
    assert len(bag["/drive_command"]) == len(bag["/truth/odom"]) >= periods


def test_a_bag_that_is_removed_while_it_is_written_is_noticed_at_once(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag", [])
    shutil.rmtree(tmp_path / "bag")
    writer._last_flush -= 10.0
    with pytest.raises(UnwritableBagError, match="has been removed"):
        writer.flush_if_due()


def test_what_is_older_than_the_writer_may_hold_is_on_the_disk(tmp_path: Path) -> None:
    row = topic(CLOCK)
    writer = BagWriter(tmp_path / "bag", [ChannelSpec(row.name, row.type, {})])
    writer.flush_s = 1000.0
    writer.write(0, 1, 1, encode(row, Clock(1)))
    size = writer.path.stat().st_size
    writer.flush_if_due()
    assert writer.path.stat().st_size == size, "nothing is written before its time"
    writer._last_flush -= writer.flush_s
    writer.flush_if_due()
    assert writer.path.stat().st_size > size
    assert counts_in(writer.path) == {CLOCK: 1}


def test_bag_is_never_written_over(tmp_path: Path) -> None:
    (tmp_path / "bag_0.mcap").write_bytes(b"precious")
    with pytest.raises(BagExistsError, match="bags are never written over"):
        BagWriter(tmp_path, [])
    assert (tmp_path / "bag_0.mcap").read_bytes() == b"precious"
