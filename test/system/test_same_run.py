"""One scenario and seed gives one record: run after run, in one process and in many, on a busy machine too."""

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from programs import PATIENT, SHORT_RUN, Program, next_domain
from rosbags.highlevel import AnyReader
from run_files import Record, first_difference, records

from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import read_bag
from sojourn_contract.topics import TOPICS

KINDS = {"composed": ("--composed",), "again": ("--composed",), "processes": ()}
SEED = "7"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Path]]:
    """Folders of three runs that have gone on at the same time, each in a domain of its own."""
    base = tmp_path_factory.mktemp("same_run")
    programs: dict[str, Program] = {}
    try:
        for name, options in KINDS.items():
            arguments = [str(SHORT_RUN), *PATIENT, "--seed", SEED, "--domain", str(next_domain()), *options]
            programs[name] = Program("start", [*arguments, "--run-dir", str(base / name)], base / f"{name}.log")
        for program in programs.values():
            assert program.wait() == 0, program.text
            assert not program.processes()
        yield {name: base / name for name in KINDS}
    finally:
        for program in programs.values():
            program.end()


@pytest.fixture(scope="module")
def composed(runs: dict[str, Path]) -> list[Record]:
    return records(runs["composed"])


@pytest.mark.parametrize("other", ["again", "processes"])
def test_every_field_of_every_message_is_the_same(runs: dict[str, Path], composed: list[Record], other: str) -> None:
    assert not first_difference(composed, records(runs[other]))


def test_every_topic_of_the_table_is_in_the_record(composed: list[Record]) -> None:
    counts = Counter(topic for topic, _, _ in composed)
    periods = counts["/clock"]
    for row in TOPICS:
        if row.logged and not row.is_event and row.publisher not in ("all", "operator"):
            assert counts[row.name] == periods // row.every, row.name
    assert counts["/goal_pose"] == counts["/arm/joint_goal"] == 1
    assert counts["/tf"] == periods


@pytest.mark.parametrize("kind", KINDS)
def test_every_run_keeps_the_contract(runs: dict[str, Path], kind: str) -> None:
    report, run = judge_bag(read_bag(runs[kind]))
    assert not list(report.lines())
    assert run.lockstep and not run.notes and len(report.messages) > 20


def test_another_seed_gives_another_record(
    tmp_path: Path, composed: list[Record], start: Callable[..., Program], domain: int
) -> None:
    run = tmp_path / "run"
    short = [*PATIENT, "--composed", "--seed", "8", "--set", "steps=[{wait_s: 1.0}]", "--domain", domain]
    assert start("start", SHORT_RUN, *short, "--run-dir", run).wait() == 0
    ours = [record for record in records(run) if record[0] == "/imu/data"]
    theirs = [record for record in composed if record[0] == "/imu/data"]
    assert ours and first_difference(ours, theirs[: len(ours)])


def test_the_bag_opens_with_rosbags(runs: dict[str, Path], composed: list[Record]) -> None:
    with AnyReader([runs["processes"] / "bag"]) as reader:
        assert reader.message_count == len(composed)
        transforms = [connection for connection in reader.connections if connection.topic == "/tf"]
        _, _, data = next(reader.messages(connections=transforms))
        frames = {
            transform.child_frame_id for transform in reader.deserialize(data, "tf2_msgs/msg/TFMessage").transforms
        }
    assert {"base_link", "odom"} <= frames


def test_the_bag_opens_with_mcap_and_is_complete(runs: dict[str, Path], composed: list[Record]) -> None:
    (file,) = (runs["processes"] / "bag").glob("*.mcap")
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        assert sum(1 for _ in reader.iter_decoded_messages()) == len(composed)
        proof = {record.name: record.metadata for record in reader.iter_metadata()}["sojourn_completeness"]
    assert (proof["complete"], proof["gaps"]) == ("true", "")
    counts = Counter(topic for topic, _, _ in composed)
    for topic, count in json.loads(proof["topics"]).items():
        assert counts[topic] == count["recorded"] == count["published"], topic


def test_a_drive_of_somebody_else_takes_the_place_of_ours(
    tmp_path: Path, start: Callable[..., Program], domain: int
) -> None:
    program = Path(__file__).parent / "stand_in_drive.py"
    run = tmp_path / "run"
    command = f"drive={sys.executable} {program}"
    replaced = start("start", SHORT_RUN, *PATIENT, "--replace", command, "--domain", domain, "--run-dir", run)
    assert replaced.wait() == 0, replaced.text
    record = records(run)
    status = [str(values) for topic, _, values in record if topic == "/drive/status"]
    assert "stand-in" in status[-1]
    assert not list(judge_bag(read_bag(run))[0].lines()), "the least that the contract asks is enough"
    assert not replaced.processes()
