"""Bags with flipped bits, or that end too early: refused or judged in words, no memory for what is not there."""

import random
import tracemalloc
from io import BytesIO
from pathlib import Path

import pytest
from mcap.records import Channel, Message
from mcap.writer import CompressionType, Writer

from sojourn_bags import report_command
from sojourn_bags.bag_copy import BagCopy
from sojourn_bags.reading import bag_file, read_bag
from sojourn_bags.salvage import Salvage
from sojourn_bringup import replay as replay_command
from sojourn_bringup.references import references_folder
from sojourn_config.command_errors import CommandError, UsageError

FILE = bag_file(references_folder() / "themes" / "articulated")


def unguarded(folder: Path) -> bytes:
    """The same bag without a check sum and not packed, so that a flipped bit reaches the messages."""
    with BagCopy(folder / "loose.mcap") as copy:
        stream = BytesIO()
        copy.writer = Writer(
            stream, compression=CompressionType.NONE, enable_crcs=False, enable_data_crcs=False, chunk_size=50_000
        )
        copy.writer.start(profile="ros2", library="somebody")
        for record in Salvage(FILE).records:
            copy.take(record)
    return stream.getvalue()


def damaged(seed: int, sound: bytes, unguarded: bytes) -> bytes:
    """Cut off, or with one to a thousand bits flipped, or both."""
    chance = random.Random(seed)
    if seed % 4 == 0:
        return sound[: chance.randrange(len(sound))]
    data = bytearray(sound if seed % 4 == 1 else unguarded)
    for _ in range(chance.choice((1, 3, 20)) if seed % 4 < 3 else chance.choice((100, 1000))):
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    return bytes(data[: chance.randrange(len(data))] if chance.random() < 0.2 else data)


@pytest.fixture(scope="module")
def loose(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return unguarded(tmp_path_factory.mktemp("loose"))


@pytest.mark.parametrize("seed", range(8))
def test_a_damaged_bag_is_refused_or_judged(seed: int, loose: bytes, tmp_path: Path) -> None:
    path = tmp_path / "damaged.mcap"
    path.write_bytes(damaged(seed, FILE.read_bytes(), loose))
    for command, options in (
        (replay_command.main, ["--node", "drive", "--direct"]),
        (report_command.main, ["--out", str(tmp_path / "report.png")]),
    ):
        try:
            assert command([str(path), *options]) in (0, 1)
        except CommandError as refusal:
            assert str(refusal)


def with_nonsense(bag: bytes, number: int) -> bytes:
    """The same bag, in which a tick is still a sound message: of that with this number one bit of its text is another.
    Of these ticks the first announces a goal, the others say again that it was sent.
    """
    begin = -1
    for _ in range(number + 1):
        begin = bag.index(b"/waypoints=1", begin + 1)
    return bag[:begin] + b"/waypoints<1" + bag[begin + len(b"/waypoints<1") :]


def test_a_tick_that_says_nonsense_is_passed_over(loose: bytes, tmp_path: Path) -> None:
    """The nodes refuse it; the replay ended in a traceback of that refusal."""
    path = tmp_path / "damaged.mcap"
    path.write_bytes(with_nonsense(loose, 1))
    assert replay_command.main([str(path), "--node", "drive", "--direct"]) in (0, 1)


def test_a_goal_that_no_tick_announces_any_more_is_named(loose: bytes, tmp_path: Path) -> None:
    path = tmp_path / "damaged.mcap"
    path.write_bytes(with_nonsense(loose, 0))
    with pytest.raises(UsageError, match="nothing tells when drive took it"):
        replay_command.main([str(path), "--node", "drive", "--direct"])


def test_it_takes_no_more_memory_than_twice_that_of_the_sound_one(loose: bytes, tmp_path: Path) -> None:
    def taken(data: bytes) -> int:
        path = tmp_path / "bag.mcap"
        path.write_bytes(data)
        tracemalloc.start()
        try:
            read_bag(path)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    read_bag(FILE)  # what is loaded once
    sound = taken(loose)
    assert max(taken(damaged(seed, FILE.read_bytes(), loose)) for seed in (2, 3, 6, 7)) < 2 * sound


def test_a_topic_whose_type_is_lost_is_set_aside(tmp_path: Path) -> None:
    """Its schema was damaged: reading the stamps raised KeyError."""
    with BagCopy(tmp_path / "untyped.mcap") as copy:
        for record in Salvage(FILE).records:
            if getattr(record, "name", "") == "nav_msgs/msg/Odometry":
                continue
            copy.take(record)
    bag = read_bag(tmp_path / "untyped.mcap")
    assert "/odom" not in bag and len(bag["/joint_states"]) > 10
    assert {unusable.reason for unusable in bag.unusable if unusable.topic == "/odom"} == {
        "its type is '', which is not known"
    }


@pytest.mark.parametrize("seed", [seed for seed in range(40) if seed % 4 < 2])
def test_what_is_read_of_some_topics_is_that_of_all(seed: int, tmp_path: Path) -> None:
    file, topics = tmp_path / "damaged.mcap", ("/odom", "/clock")
    file.write_bytes(damaged(seed, FILE.read_bytes(), b""))

    def read(salvage: Salvage) -> list[Message]:
        channels: dict[int, str] = {}
        found = []
        for record in salvage.records:
            if isinstance(record, Channel):
                channels[record.id] = record.topic
            elif isinstance(record, Message) and channels[record.channel_id] in topics:
                found.append(record)
        return found

    assert read(Salvage(file, topics)) == read(Salvage(file))


def test_other_topics_are_not_read() -> None:
    records = list(Salvage(FILE, ("/odom",)).records)
    wanted = {record.id for record in records if isinstance(record, Channel) and record.topic == "/odom"}
    assert {record.channel_id for record in records if isinstance(record, Message)} == wanted
