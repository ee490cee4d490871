"""The clock of a run as its growing bag tells it."""

import shutil
import threading
from pathlib import Path

import pytest
from mcap.writer import CompressionType, Writer

from sojourn_bags.reading import read_bag
from sojourn_bringup.references import references_folder
from sojourn_config.command_errors import CommandError
from sojourn_studies import bag_clock
from sojourn_studies.bag_clock import BagClock, Reading


def chunks(path: Path, stamps: list[int]) -> list[bytes]:
    """A file of one chunk for each stamp [ns], in pieces of which each ends with one."""
    pieces, written = [], 0
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=1, compression=CompressionType.NONE)
        writer.start("ros2")
        schema = writer.register_schema("text", "", b"")
        channel = writer.register_channel("/clock", "cdr", schema)
        for stamp in stamps:
            writer.add_message(channel, stamp, b"x" * 100, stamp)
            stream.flush()
            pieces.append(path.read_bytes()[written:])
            written += len(pieces[-1])
        writer.finish()  # type: ignore[no-untyped-call]
    return pieces


def grow(path: Path, piece: bytes) -> None:
    with path.open("ab") as stream:
        stream.write(piece)


def test_it_reads_the_end_of_the_newest_whole_chunk(tmp_path: Path) -> None:
    pieces = chunks(tmp_path / "whole.mcap", [10**9, 2 * 10**9, 5 * 10**9])
    (tmp_path / "bag").mkdir()
    clock, bag = BagClock(tmp_path), tmp_path / "bag" / "run_0.mcap"
    assert clock._look() == 0
    grow(bag, pieces[0])
    assert clock._look() == 10**9
    whole = 9 + int.from_bytes(pieces[1][1:9], "little")  # of the chunk; its index comes after it
    for begin in range(0, len(pieces[1]), 7):
        part = pieces[1][begin : begin + 7]
        grow(bag, part)
        assert clock._look() == (2 if begin + len(part) >= whole else 1) * 10**9
    assert clock._look() == 2 * 10**9
    later = threading.Timer(0.2, grow, (bag, pieces[2]))
    later.start()
    try:
        found = clock.read()
    finally:
        later.join()
    assert found.simulated == 5.0
    assert Reading(found.wall - 2.0, 1.0).pace(found) == 2.0


def test_its_time_is_that_of_the_run(tmp_path: Path) -> None:
    reference = references_folder() / "themes" / "detour" / "bag"
    shutil.copytree(reference, tmp_path / "bag")
    bag = read_bag(reference)
    assert BagClock(tmp_path)._look() == max(max(bag[topic].log_times) for topic in bag.topics)


def test_it_goes_on_in_the_next_file(tmp_path: Path) -> None:
    (tmp_path / "bag").mkdir()
    clock = BagClock(tmp_path)
    for number, stamp in enumerate((3 * 10**9, 4 * 10**9)):
        file = tmp_path / "bag" / f"run_{number}.mcap"
        chunks(file, [stamp])
        assert clock._look() == stamp


def test_a_bag_that_does_not_grow_is_no_clock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bag_clock, "LONGEST_S", 0.05)
    with pytest.raises(CommandError, match="has not grown"):
        BagClock(tmp_path).read()
