"""Bags of several files: what they hold is what one file would, whoever reads them."""

import re
import shutil
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.records import Channel, Message
from rosbags.rosbag2 import Reader

from sojourn_bags import writer as writing
from sojourn_bags.completeness import RECORD, Completeness, Count, why_incomplete
from sojourn_bags.cut_off import check_recorded, unless_cut_off
from sojourn_bags.definitions import RUN_RECORD, ChannelSpec, qos_entry
from sojourn_bags.errors import BagExistsError, ReplayError, UnreadableBagError
from sojourn_bags.heard_script import _said
from sojourn_bags.metadata_file import METADATA_FILE
from sojourn_bags.parts import BagSalvage, counts_in, parts_of
from sojourn_bags.quick_writer import QuickWriter
from sojourn_bags.reading import Bag, bag_file, read_bag
from sojourn_bags.recorded_run import RecordedRun
from sojourn_bags.recovery import examine, recover
from sojourn_bags.writer import Attachment, BagWriter
from sojourn_contract import qos
from sojourn_contract.codecs import encode
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import STANDARD, topic
from sojourn_contract.values import Clock, Header

CLOCK, TICK = topic("/clock"), topic("/operator/tick")
LATE = 60
"""Message with which the second topic begins: in a later file than the first."""


def written(folder: Path, largest: int, count: int = 120, late: int = 0) -> Path:
    """A bag of two topics whose files are to be no larger than so many bytes."""
    rows = (CLOCK, TICK)
    specs = [ChannelSpec(row.name, row.type, qos_entry(qos.profile(row, True, row.publisher))) for row in rows]
    writer = BagWriter(folder, specs, [Attachment("scenario.txt", "text/plain", b"where it was")])
    writer.largest_part = largest
    for number in range(1, count + 1):
        writer.write(0, number, number, encode(CLOCK, Clock(number + late)))
        if number >= LATE:
            writer.write(1, number, number, encode(TICK, Header(number, "a tick that is not quite short " * 3)))
        writer.flush()
    account = Completeness({name: Count(number, number) for name, number in writer.recorded().items()}).as_record()
    writer.close({"account": {"complete": "true"}, RECORD: account})
    return folder


def content(bag: Bag) -> dict[str, tuple[list[int], list[bytes], str]]:
    return {name: (each.log_times, each.data, each.type) for name, each in bag.topics.items()}


@pytest.fixture(autouse=True)
def looks_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the size of its file, after each message."""
    monkeypatch.setattr(writing, "LOOK_AFTER", 0)


@pytest.fixture
def split(tmp_path: Path) -> Path:
    return written(tmp_path / "bag", 4000)


def test_of_several_files_it_is_the_bag_of_one(tmp_path: Path, split: Path) -> None:
    parts, one = read_bag(split), read_bag(written(tmp_path / "one", 1 << 30))
    assert len(parts.parts) > 4 and len(one.parts) == 1
    assert parts.whole and content(parts) == content(one)
    assert parts.attachments == one.attachments and parts.records["account"] == one.records["account"]
    assert parts[TICK.name].offered_qos == one[TICK.name].offered_qos
    assert counts_in(split) == {CLOCK.name: 120, TICK.name: 120 - LATE + 1}
    assert bag_file(split).name == "bag_0.mcap"
    assert max(part.stat().st_size for part in parts.parts) < 4000 + 6000, "and what is told of it at its end"


@pytest.mark.parametrize("wanted", [CLOCK.name, TICK.name, "/nowhere"])
def test_some_topics_alone_are_what_all_of_it_has_of_them(split: Path, wanted: str) -> None:
    """Files that lack the topic, or messages of others before it, are no misfit."""
    salvage = BagSalvage(parts_of(split), {wanted})
    told = list(salvage.records)
    names = {record.id: record.topic for record in told if isinstance(record, Channel)}
    messages = [record for record in told if isinstance(record, Message)]
    log_times, data, _ = content(read_bag(split)).get(wanted, ([], [], ""))
    known = list(zip(data, log_times, strict=True))
    assert [(record.data, record.log_time) for record in messages] == known
    assert {names[record.channel_id] for record in messages} == ({wanted} if known else set())
    assert salvage.whole and not salvage.damage and not salvage.misfit


def test_damage_is_said_where_some_topics_alone_are_read(split: Path) -> None:
    last = parts_of(split)[-2]
    parts_of(split)[-1].unlink()
    last.write_bytes(last.read_bytes()[: last.stat().st_size // 3])
    salvage = BagSalvage(parts_of(split), {TICK.name})
    found = sum(isinstance(record, Message) for record in salvage.records)
    assert not salvage.whole and salvage.damage.startswith(f"{last.name}: ") and 0 < found < 120 - LATE + 1


@settings(max_examples=15, deadline=None)
@given(st.integers(500, 20_000), st.integers(1, 150))
def test_any_size_of_a_file_gives_the_same(tmp_path_factory: pytest.TempPathFactory, largest: int, count: int) -> None:
    folder = tmp_path_factory.mktemp("parts")
    parts, one = written(folder / "many", largest, count), written(folder / "one", 1 << 30, count)
    assert content(read_bag(parts)) == content(read_bag(one))


def test_other_readers_of_ros_bags_take_it_for_one(split: Path) -> None:
    """By rosbag2's metadata, which names the files with what each of them holds."""
    with Reader(split) as reader:
        heard = [(connection.topic, stamp, data) for connection, stamp, data in reader.messages()]
        assert reader.message_count == len(heard)
    own = read_bag(split)
    for name in (CLOCK.name, TICK.name):
        assert [(stamp, data) for heard_on, stamp, data in heard if heard_on == name] == list(
            zip(own[name].log_times, own[name].data, strict=True)
        )
    told = yaml.safe_load((split / METADATA_FILE).read_text())["rosbag2_bagfile_information"]
    assert told["relative_file_paths"] == [part.name for part in own.parts]
    assert sum(file["message_count"] for file in told["files"]) == told["message_count"] == len(heard)
    ends = [
        file["starting_time"]["nanoseconds_since_epoch"] + file["duration"]["nanoseconds"] for file in told["files"]
    ]
    assert ends == sorted(ends) and ends[-1] == 120


def test_a_recorder_that_dies_leaves_the_files_before_whole(tmp_path: Path, split: Path) -> None:
    whole, last = read_bag(split), parts_of(split)[-2]
    parts_of(split)[-1].unlink()
    last.write_bytes(last.read_bytes()[: last.stat().st_size // 3])
    cut = read_bag(split)
    times, before = cut[CLOCK.name].log_times, whole[CLOCK.name].log_times
    assert not cut.whole and 60 < len(times) < 120 and times == before[: len(times)]
    found = examine(split)
    assert found.damage.startswith(f"{last.name}: ") and not found.all_messages and not found.whole
    assert 0 < found.size - found.at < last.stat().st_size
    mended = read_bag(recover(found, tmp_path / "mended"))
    assert mended.whole and content(mended) == content(cut) and mended.attachments == cut.attachments


def test_a_file_that_was_just_begun_is_damage_at_the_end(split: Path) -> None:
    whole = read_bag(split)
    (split / f"bag_{len(whole.parts)}.mcap").write_bytes(b"")
    cut = read_bag(split)
    assert not cut.whole and content(cut) == content(whole)
    salvage = BagSalvage(parts_of(split))
    assert list(salvage.records) and "no MCAP file" in salvage.damage


def test_what_is_not_one_bag_is_refused_in_words(split: Path) -> None:
    parts_of(split)[2].unlink()
    with pytest.raises(UnreadableBagError, match="its part 2 of at least"):
        read_bag(split)
    (split / "another.mcap").write_bytes(b"")
    with pytest.raises(UnreadableBagError, match="name one"):
        read_bag(split)
    alone = read_bag(split / "bag_1.mcap")
    assert len(alone.parts) == 1 and len(alone[CLOCK.name])


def moved(split: Path, change: str, foreign: Path) -> None:
    """Put the files of a bag, or of two, where they do not belong; the folder then still looks like one bag."""
    parts = parts_of(split)
    if change == "missing":
        parts[1].unlink()
        for one in parts[2:]:
            one.rename(split / f"bag_{int(one.stem.removeprefix('bag_')) - 1}.mcap")
    elif change == "last missing":
        parts[-1].unlink()
    elif change == "doubled":
        shutil.copy(parts[1], split / f"bag_{len(parts)}.mcap")
    elif change == "swapped":
        first, second = (parts[number].read_bytes() for number in (1, 2))
        parts[1].write_bytes(second)
        parts[2].write_bytes(first)
    elif change == "of another":
        shutil.copy(parts_of(foreign)[1], parts[1])
    elif change == "another added":
        shutil.copy(parts_of(foreign)[0], split / f"bag_{len(parts)}.mcap")


MISPLACED = {
    "missing": "bag_1.mcap is part 2 of its bag, and stands as part 1",
    "last missing": r"is followed by part \d+, which is missing",
    "doubled": "is part 1 of its bag, and stands as part",
    "swapped": "bag_1.mcap is part 2 of its bag, and stands as part 1",
    "of another": "bag_1.mcap is not of the same bag as bag_0.mcap",
    "another added": "does not say that it goes on|begins with message 1 of /clock, and message 121 is next",
}


@pytest.mark.parametrize("change", MISPLACED)
def test_files_that_are_not_one_bag_are_named(
    split: Path, tmp_path: Path, change: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """They were read as a complete one."""
    moved(split, change, written(tmp_path / "other", 4000, late=1))
    bag = read_bag(split)
    assert not bag.whole and re.search(MISPLACED[change], bag.misfit), bag.misfit
    assert unless_cut_off(0, [bag]) == 1
    assert f"{bag.path} is not what was recorded: {bag.misfit}" in capsys.readouterr().err
    with pytest.raises(ReplayError, match="is not what was recorded"):
        check_recorded(bag)
    found = examine(split)
    assert not found.whole and not found.all_messages and found.damage == bag.misfit


@pytest.mark.parametrize("change", ["missing", "doubled", "swapped"])
def test_so_are_those_that_were_recorded_before_they_said_their_place(
    split: Path, tmp_path: Path, change: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(QuickWriter, "add_metadata", lambda self, name, values: None)
    old = written(tmp_path / "before" / "bag", 4000)
    assert read_bag(old).whole and content(read_bag(old)) == content(read_bag(split))
    moved(old, change, split)
    assert "is next" in read_bag(old).misfit


def test_a_file_of_a_bag_alone_is_not_all_of_it(split: Path) -> None:
    assert read_bag(split / "bag_1.mcap").misfit == "bag_1.mcap is part 1 of its bag, alone"
    assert "is followed by part 1, which is missing" in read_bag(split / "bag_0.mcap").misfit


def test_what_is_mended_of_misplaced_files_is_not_called_complete(split: Path, tmp_path: Path) -> None:
    moved(split, "swapped", split)
    mended = read_bag(recover(examine(split), tmp_path / "mended"))
    assert why_incomplete(mended.records.get(RECORD)) == "bag_1.mcap is part 2 of its bag, and stands as part 1"


def test_a_bag_of_several_files_is_never_written_over(split: Path) -> None:
    with pytest.raises(BagExistsError):
        BagWriter(split, [])


def test_a_scenario_says_how_large_a_file_may_be(tmp_path: Path) -> None:
    run = RecordedRun("flat_drive", ("bag_part_mb=2.5",), ("plant", "recorder"), True)
    assert run.open(tmp_path / "bag", lambda name, error: None).writer.largest_part == 2_500_000


def test_the_plant_is_asked_for_what_it_says_of_the_next_period(tmp_path: Path) -> None:
    """Its truth at its opening was left out of a replay by what it heard, and that at the end was one too many."""
    read = read_bag(written(tmp_path / "whole", 1 << 30))
    read.records[RUN_RECORD] = {"lockstep": "false", "participants": "plant,recorder"}
    clock = read[CLOCK.name]
    clock.data = [encode(CLOCK, Clock(period * CONTROL_PERIOD_NS)) for period in range(1, 121)]
    acted = {period * CONTROL_PERIOD_NS for period in (1, 2, 3)}
    said = _said(read, STANDARD, "plant", acted)[CLOCK.name]
    assert said.data == clock.data[:4]
