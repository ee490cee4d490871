"""Mending a bag: whatever byte it ends at, exactly the whole messages are in the new one, and the loss is said."""

import random
import struct
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from rclpy.qos import QoSProfile
from rosbags.highlevel import AnyReader
from synthetic import PERIOD, SyntheticRun

from sojourn_bags.completeness import RECORD
from sojourn_bags.definitions import definition, qos_entry, type_hash
from sojourn_bags.errors import BagExistsError, NothingToRecoverError, UnreadableBagError
from sojourn_bags.reading import read_bag
from sojourn_bags.recovery import RECOVERY_RECORD, examine, recover, recovered_folder
from sojourn_bags.salvage import Salvage
from sojourn_contract.heartbeat import Counters, heartbeat_message

TYPE = "std_msgs/msg/String"
HASH = type_hash(TYPE)


@dataclass(repr=False)
class Foreign:
    """A file, its messages, and whether they lie in it as they are."""

    path: Path
    messages: list[bytes]
    plain: bool


def text_message(number: int, length: int) -> bytes:
    """CDR of a String that no other message equals."""
    text = f"{number:06d}" + "".join(random.Random(number).choices("abcdefghijklmnop", k=length))
    return b"\0\1\0\0" + struct.pack("<I", len(text) + 1) + text.encode() + b"\0"


def write_file(path: Path, lengths: list[int], compression: CompressionType, chunk_size: int) -> list[bytes]:
    """A foreign bag of two topics and one attachment. Returns its messages in order."""
    messages = [text_message(number, length) for number, length in enumerate(lengths)]
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=chunk_size, compression=compression)
        writer.start(profile="ros2", library="somebody else")
        writer.add_attachment(3, 4, "notes.txt", "text/plain", b"of another robot")
        schema = writer.register_schema(TYPE, "ros2msg", definition(TYPE).encode())
        profile = yaml.safe_dump([qos_entry(QoSProfile(depth=7))])
        channels = [
            writer.register_channel(name, "cdr", schema, {"offered_qos_profiles": profile, "topic_type_hash": HASH})
            for name in ("/left", "/right")
        ]
        for number, data in enumerate(messages):
            writer.add_message(channels[number % 2], 1000 + number, data, 900 + number, number // 2)
        writer.finish()
    return messages


def messages_of(file: Path) -> list[tuple[str, int, int, int, bytes]]:
    """What the mcap library reads: topic, times, number and bytes, in the order of the times."""
    with file.open("rb") as stream:
        return [
            (channel.topic, message.log_time, message.publish_time, message.sequence, message.data)
            for _, channel, message in make_reader(stream, validate_crcs=True).iter_messages()
        ]


def expected_rows(messages: list[bytes]) -> list[tuple[str, int, int, int, bytes]]:
    return [
        (("/left", "/right")[number % 2], 1000 + number, 900 + number, number // 2, data)
        for number, data in enumerate(messages)
    ]


@pytest.fixture(scope="module", params=[CompressionType.NONE, CompressionType.ZSTD, CompressionType.LZ4])
def foreign(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Foreign:
    """A bag of another recorder."""
    path = tmp_path_factory.mktemp("foreign") / "theirs.mcap"
    lengths = [random.Random(number).choice([0, 1, 40, 900]) for number in range(80)]
    return Foreign(path, write_file(path, lengths, request.param, 3000), request.param is CompressionType.NONE)


def mend(path: Path, folder: Path) -> list[tuple[str, int, int, int, bytes]] | None:
    """Messages of the mended bag, None where there is nothing to recover; with all that must hold for any."""
    before = path.read_bytes()
    try:
        found = examine(path)
        if found.whole:
            return messages_of(path)
        file = recover(found, folder)
    except (UnreadableBagError, NothingToRecoverError):
        assert not folder.exists()
        return None
    assert path.read_bytes() == before
    assert read_bag(file).whole
    with AnyReader([folder]) as reader:
        assert reader.message_count == found.total == sum(1 for _ in reader.messages())
    return messages_of(file)


@settings(max_examples=25, deadline=None)
@given(place=st.floats(0.0, 1.0), data=st.data())
@example(place=1.0, data=None)
def test_cut_at_any_byte_gives_the_messages_before_the_cut(
    foreign: Foreign, tmp_path_factory: pytest.TempPathFactory, place: float, data: object
) -> None:
    path, messages, plain = foreign.path, foreign.messages, foreign.plain
    whole = path.read_bytes()
    cut = len(whole) - 1 if data is None else round(place * (len(whole) - 1))
    folder = tmp_path_factory.mktemp("cut")
    damaged = folder / "cut.mcap"
    damaged.write_bytes(whole[:cut])
    found = mend(damaged, folder / "new")
    count = len(found or [])
    assert (found or []) == expected_rows(messages)[:count]
    if plain:  # then a message is whole if all of its bytes are there
        assert count == sum(whole.index(message) + len(message) <= cut for message in messages)
    else:  # at least what is in whole chunks
        assert count >= _in_whole_chunks(whole[:cut])


def _in_whole_chunks(data: bytes) -> int:
    """Messages in whole chunks, counted by the indices that follow each: 16 bytes an entry (MCAP specification)."""
    place, count = 8, 0
    while place + 9 <= len(data):
        opcode, length = struct.unpack_from("<BQ", data, place)
        if opcode == 0x07 and place + 9 + length <= len(data):
            count += (length - 6) // 16
        place += 9 + length
    return count


@settings(max_examples=15, deadline=None)
@given(place=st.floats(0.02, 1.0), shorter=st.integers(0, 3000))
def test_zeros_to_the_end_are_no_messages(
    foreign: Foreign, tmp_path_factory: pytest.TempPathFactory, place: float, shorter: int
) -> None:
    """Zeroed from any byte on, to the old end or to an earlier one, as a file system leaves it."""
    path, messages = foreign.path, foreign.messages
    whole = path.read_bytes()
    begin = round(place * (len(whole) - 1))
    end = max(begin + 512, len(whole) - shorter)
    folder = tmp_path_factory.mktemp("zeros")
    damaged = folder / "zeros.mcap"
    damaged.write_bytes(whole[:begin] + bytes(end - begin))
    found = mend(damaged, folder / "new") or []
    assert found == expected_rows(messages)[: len(found)]
    assert len(found) >= _in_whole_chunks(whole[:begin])


def test_file_that_grows_is_read_as_it_was_at_the_start(foreign: Foreign, tmp_path: Path) -> None:
    whole = foreign.path.read_bytes()
    ends, place = [], 8
    while place + 9 <= len(whole):
        place += 9 + struct.unpack_from("<BQ", whole, place)[1]
        ends.append(place)
    for cut in [end + more for end in ends[3:12] for more in (0, 5, 9)]:
        path = tmp_path / "growing.mcap"
        path.write_bytes(whole[:cut])
        salvage = Salvage(path)
        records = salvage.records
        found = [next(records)]
        path.write_bytes(whole)
        found += list(records)
        path.write_bytes(whole[:cut])
        assert len(found) == len(list(Salvage(path).records)) and not salvage.whole


def test_large_chunk_is_unpacked_as_far_as_it_goes(tmp_path: Path) -> None:
    path = tmp_path / "large.mcap"
    messages = write_file(path, [20_000] * 60, CompressionType.ZSTD, 10_000_000)  # one chunk of 1.2 MB
    whole = path.read_bytes()
    assert _in_whole_chunks(whole) == 60
    path.write_bytes(whole[: len(whole) // 2])
    found = mend(path, tmp_path / "new")
    assert found == expected_rows(messages)[: len(found or [])]
    # half of the bytes, less the block of 128 kB that is cut: letters of 16 kinds pack evenly
    assert len(found or []) >= 30 - 128 * 1024 // 20_000 - 2


def test_damage_in_the_middle_costs_that_chunk_alone(foreign: Foreign, tmp_path: Path) -> None:
    path, messages, plain = foreign.path, foreign.messages, foreign.plain
    damaged = bytearray(path.read_bytes())
    mark = b"zstd" if b"zstd" in damaged else b"lz4"  # stands in the head of each chunk
    middle = damaged.index(messages[40]) + 12 if plain else damaged.index(mark, len(damaged) // 2) + 60
    damaged[middle : middle + 4] = bytes(byte ^ 0xFF for byte in damaged[middle : middle + 4])
    (tmp_path / "bad.mcap").write_bytes(damaged)
    found = mend(tmp_path / "bad.mcap", tmp_path / "new") or []
    assert 40 < len(found) < 80 and set(found) < set(expected_rows(messages))


def test_mended_bag_has_what_the_old_one_had(foreign: Foreign, tmp_path: Path) -> None:
    path = foreign.path
    cut = tmp_path / "run" / "theirs.mcap"
    cut.parent.mkdir()
    cut.write_bytes(path.read_bytes()[: -path.stat().st_size // 8])
    found = examine(cut)
    assert recovered_folder(cut) == tmp_path / "run" / "theirs_recovered"
    file = recover(found, tmp_path / "new")
    with file.open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary is not None
        schemas = [(schema.name, schema.encoding, schema.data) for schema in summary.schemas.values()]
        assert schemas == [(TYPE, "ros2msg", definition(TYPE).encode())]
        assert {channel.topic for channel in summary.channels.values()} == {"/left", "/right"}
        assert all(channel.metadata["topic_type_hash"] == HASH for channel in summary.channels.values())
        attached = [(item.create_time, item.log_time, item.name, item.data) for item in reader.iter_attachments()]
        assert attached == [(3, 4, "notes.txt", b"of another robot")]
    information = yaml.safe_load((tmp_path / "new" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert information["message_count"] == found.total > 40
    assert information["topics_with_message_count"][0]["topic_metadata"]["offered_qos_profiles"][0]["depth"] == 7
    assert found.heartbeat is None and not found.lost
    with pytest.raises(BagExistsError):
        recover(found, tmp_path / "new")


def write_run(folder: Path) -> Path:
    """A killed recorder: 100 periods in two chunks, one heartbeat, and no end."""
    run = SyntheticRun(folder, "flat_drive")
    counters = Counters()
    for period in range(1, 101):
        stamp = period * PERIOD
        run.truth(stamp, (0.01 * period, 0.0, 0.0, 0.0), {"wheel_front_left_joint": 0.1 * period}, 1.0)
        counters.count_published("/truth/odom")
        if period == 50:
            counters.published["/truth/odom"] += 3  # sent before the heartbeat, lost on the way into the bag
            counters.published["/recorder/tick"] = 9  # which no bag holds
            run.write("/diagnostics", stamp, heartbeat_message("plant", "running", stamp, counters))
        if period in (60, 100):
            run.writer.flush()
    run.writer._stream.close()
    return run.writer.path


def test_killed_run_is_mended_and_the_loss_is_counted(tmp_path: Path) -> None:
    path = write_run(tmp_path / "bag")
    path.write_bytes(path.read_bytes()[:-100])  # into the last index: no message
    found = examine(tmp_path)
    assert not found.whole and found.counts["/truth/odom"] == 100 and not found.lost
    data = path.read_bytes()
    second_chunk = [place for place in range(len(data)) if data.startswith(b"zstd", place)][1]
    path.write_bytes(data[: second_chunk - 20])
    found = examine(tmp_path)
    assert found.counts["/truth/odom"] == 60 and found.last["/clock"] == 60 * PERIOD
    assert found.heartbeat == 50 * PERIOD and found.lost == {}
    assert recovered_folder(found.path) == tmp_path / "bag_recovered"
    mended = read_bag(recover(found, recovered_folder(found.path)))
    assert mended.whole and mended.records[RECORD]["complete"] == "false"
    assert mended.records[RECOVERY_RECORD]["messages"] == str(found.total)
    assert set(mended.attachments) == set(read_bag(path).attachments)


def test_messages_that_were_sent_and_are_not_there_are_certainly_lost(tmp_path: Path) -> None:
    path = write_run(tmp_path / "bag")
    data = bytearray(path.read_bytes())
    _, second = (place for place in range(len(data)) if data.startswith(b"zstd", place))
    data[second + 40 : second + 44] = b"\xff\xff\xff\xff"
    path.write_bytes(data)
    found = examine(path)
    assert found.counts["/truth/odom"] == 60 and not found.lost  # sent after the heartbeat: nobody knows
    run = SyntheticRun(tmp_path / "other", "flat_drive")
    counters = Counters(published={"/odom": 70, "/truth/odom": 2, "/recorder/tick": 9})
    run.truth(PERIOD, (0.0, 0.0, 0.0, 0.0), {"wheel_front_left_joint": 0.0}, 0.0)
    run.write("/diagnostics", PERIOD, heartbeat_message("plant", "running", PERIOD, counters))
    run.writer.flush()
    run.writer._stream.close()
    assert examine(run.writer.path).lost == {"/odom": 70, "/truth/odom": 1}


def test_whole_bag_needs_no_mending_and_no_bag_cannot_be_mended(tmp_path: Path) -> None:
    path = tmp_path / "whole.mcap"
    write_file(path, [5], CompressionType.ZSTD, 1000)
    assert examine(path).whole
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(NothingToRecoverError, match="no whole message"):
        recover(examine(path), tmp_path / "new")
    for content in (b"", b"\x89MCAP0\r\n", b"\0" * 4000, b"not a bag"):
        path.write_bytes(content)
        with pytest.raises(UnreadableBagError, match="it is no MCAP file"):
            examine(path)
