"""Bag files that ask for more than they hold: no memory is taken for what a file only says."""

import random
import shutil
import struct
import tracemalloc
import zlib
from pathlib import Path

import pytest
import zstandard

from sojourn_bags.completeness import RECORD
from sojourn_bags.description import COMPOSED_NAME
from sojourn_bags.errors import BagsError
from sojourn_bags.judging import UnjudgeableBagError, judge_bag, machine_of
from sojourn_bags.reading import read_bag
from sojourn_bags.salvage import LARGEST_CHUNK, MAGIC, MOST_PACKED, Salvage
from sojourn_bags.summary import summarise

REFERENCE = Path(__file__).parents[1] / "replay" / "short_goals" / "bag"
MEMORY = 100_000_000
"""Bytes that reading a small file may take at most."""


def record(opcode: int, content: bytes, length: int | None = None) -> bytes:
    return struct.pack("<BQ", opcode, len(content) if length is None else length) + content


def text(value: bytes) -> bytes:
    return struct.pack("<I", len(value)) + value


HEADER = MAGIC + record(1, text(b"ros2") + text(b"nobody"))


def chunk(compression: bytes, packed: bytes, size: int, crc: int = 0) -> bytes:
    head = struct.pack("<QQQI", 0, 0, size, crc) + text(compression) + struct.pack("<Q", len(packed))
    return record(6, head + packed)


def zeros(size: int) -> bytes:
    """So many zeros packed by zstd, as a stream that does not say how many."""
    packer = zstandard.ZstdCompressor(level=1).compressobj()
    piece = bytes(1 << 22)
    return b"".join(packer.compress(piece) for _ in range(size // len(piece))) + packer.flush()


@pytest.mark.parametrize(
    ("content", "damage"),
    [
        (chunk(b"zstd", zeros(1 << 30), 1 << 33), "a chunk says that it holds 8589934592 bytes"),
        (chunk(b"zstd", zeros(1 << 30), 1 << 30), "a chunk says that it holds 1073741824 bytes"),
        (chunk(b"zstd", zeros(1 << 30), 1000), "does not match its check sum"),
        (chunk(b"zstd", zstandard.compress(bytes(1 << 28)), 1000), "does not match its check sum"),
        (chunk(b"zstd", zeros(1 << 24), 1 << 24) * 40, "a chunk says that it holds 16777216 bytes"),
        (chunk(b"", b"", 1 << 40), "a chunk says that it holds"),
        (chunk(b"lz4", bytes(100), 1 << 25), "does not match its check sum"),
        (record(9, b"", 1 << 40), "it ends before its time"),
        (record(6, b"", (1 << 64) - 1), "it ends before its time"),
    ],
)
def test_no_memory_is_taken_for_what_a_file_says(tmp_path: Path, content: bytes, damage: str) -> None:
    path = tmp_path / "small.mcap"
    path.write_bytes(HEADER + content + record(15, bytes(4)) + record(2, bytes(20)) + MAGIC)
    tracemalloc.start()
    try:
        salvage = Salvage(path)
        found = len(list(salvage.records))
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert found >= 1 and damage in salvage.damage
    assert most < MEMORY


def test_a_sparse_file_of_one_record_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "sparse.mcap"
    with path.open("wb") as file:
        file.write(HEADER + struct.pack("<BQ", 9, 1 << 33))
        file.truncate((1 << 33) + 100)
        file.seek(0, 2)
        file.write(b"end")
    salvage = Salvage(path)
    assert len(list(salvage.records)) == 1 and "says that it is 8589934592 bytes long" in salvage.damage


def test_bags_as_they_are_recorded_are_far_from_the_limits() -> None:
    """The limits are no burden."""
    bag = read_bag(REFERENCE)
    content = sum(len(data) for messages in bag.topics.values() for data in messages.data)
    assert 10 * content < MOST_PACKED * bag.path.stat().st_size and 10 * content < LARGEST_CHUNK


def test_the_check_sum_is_still_heeded(tmp_path: Path) -> None:
    content = bytes(1000)
    path = tmp_path / "crc.mcap"
    for crc, sound in ((zlib.crc32(content), True), (1, False)):
        path.write_bytes(HEADER + chunk(b"zstd", zstandard.compress(content), 1000, crc) + record(2, bytes(20)) + MAGIC)
        salvage = Salvage(path)
        list(salvage.records)
        assert salvage.whole is sound


def test_a_bag_whose_rover_is_damaged_is_not_judged_by_half_of_it(tmp_path: Path) -> None:
    """A bit of the URDF of rover and arm was another: it was left out, that of the rover alone taken in its place, and
    the judge ended with a traceback over the arm's joints.
    """
    bag = tmp_path / "bag"
    shutil.copytree(REFERENCE, bag)
    content = bytearray((bag / "bag_0.mcap").read_bytes())
    content[content.index(b"<joint", content.index(text(COMPOSED_NAME.encode())))] ^= 1
    (bag / "bag_0.mcap").write_bytes(content)
    damaged = read_bag(bag)
    assert not damaged.whole and COMPOSED_NAME not in damaged.attachments
    with pytest.raises(UnjudgeableBagError, match=f"has no {COMPOSED_NAME} attached"):
        machine_of(damaged)


@pytest.mark.parametrize("seed", range(6))
def test_a_damaged_bag_is_refused_or_judged(tmp_path: Path, seed: int) -> None:
    """Bits flipped at places by chance, and cut off in half of the cases: words, no other error."""
    generator = random.Random(seed)
    content = bytearray((REFERENCE / "bag_0.mcap").read_bytes())
    if seed % 2:
        del content[generator.randrange(len(content) // 2, len(content)) :]
    for _ in range((1, 4, 20)[seed // 2]):
        content[generator.randrange(len(content))] ^= 1 << generator.randrange(8)
    path = tmp_path / "bag_0.mcap"
    path.write_bytes(content)
    bag = read_bag(path)
    assert not bag.whole
    try:
        report, _ = judge_bag(bag)
    except BagsError as refusal:
        assert str(path) in str(refusal)
    else:
        assert sum(report.messages.values()) > 0


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b'{"/clock": {"published"', b'{"/clock": {"published\x00'),
        (b'{"/clock": {"published"', b'{"/clock": {"publishes"'),
        (b'{"/clock": {"published": ', b'{"/clock": {"published":"'),
    ],
)
def test_an_account_that_cannot_be_read_is_none(tmp_path: Path, before: bytes, after: bytes) -> None:
    """No check sum guards a metadata record: the report ended with a traceback over it."""
    content = (REFERENCE / "bag_0.mcap").read_bytes()
    place = content.rindex(before)
    path = tmp_path / "bag_0.mcap"
    path.write_bytes(content[:place] + after + content[place + len(before) :])
    bag = read_bag(path)
    assert bag.whole and bag.records[RECORD]["complete"] == "true"
    summary = summarise(bag)
    assert not summary["complete"]
    assert all(count["published"] is None for count in summary["messages"].values())
    assert summary["messages"]["/clock"]["recorded"] > 0
