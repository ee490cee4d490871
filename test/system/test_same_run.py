"""One scenario and seed gives one record: run after run, in one process and in many, on a busy machine too."""

import json
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from programs import PATIENT, SHORT_RUN, Program
from rosbags.highlevel import AnyReader
from verdicts import require_same

from domains import domain_to_keep
from sojourn_bags.comparison import compare, until
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_contract.stamps import CONTROL_PERIOD_NS
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
            arguments = [str(SHORT_RUN), *PATIENT, "--seed", SEED, "--domain", str(domain_to_keep()), *options]
            programs[name] = Program("start", [*arguments, "--run-dir", str(base / name)], base / f"{name}.log")
        for program in programs.values():
            assert program.wait() == 0, program.text
            assert not program.processes()
        yield {name: base / name for name in KINDS}
    finally:
        for program in programs.values():
            program.end()


@pytest.fixture(scope="module")
def composed(runs: dict[str, Path]) -> Bag:
    return read_bag(runs["composed"])


def messages_of(bag: Bag) -> int:
    return sum(len(messages) for messages in bag.topics.values())


@pytest.mark.parametrize("other", ["again", "processes"])
def test_every_field_of_every_message_is_the_same(runs: dict[str, Path], composed: Bag, other: str) -> None:
    require_same(composed, read_bag(runs[other]))


def test_compare_says_so(runs: dict[str, Path], start: Callable[..., Program]) -> None:
    program = start("compare", "--exact", runs["composed"], runs["processes"])
    assert program.wait() == 0
    assert "\nidentical: " in program.text and program.text.endswith("every field equal\n")


def test_every_topic_of_the_table_is_in_the_record(composed: Bag) -> None:
    counts = Counter({name: len(messages) for name, messages in composed.topics.items()})
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
    tmp_path: Path, composed: Bag, start: Callable[..., Program], domain: int
) -> None:
    run = tmp_path / "run"
    short = [*PATIENT, "--composed", "--seed", "8", "--set", "steps=[{wait_s: 1.0}]", "--domain", domain]
    assert start("start", SHORT_RUN, *short, "--run-dir", run).wait() == 0
    ours = read_bag(run)
    end = (len(ours["/clock"]) + 1) * CONTROL_PERIOD_NS
    result = compare(until(ours.topics, end), until(composed.topics, end))
    assert result.verdict is Verdict.DIFFERENT
    divergence = result.divergence()
    assert divergence is not None and (divergence.topic, divergence.stamp) == ("/joint_states", CONTROL_PERIOD_NS)


def test_the_bag_opens_with_rosbags(runs: dict[str, Path], composed: Bag) -> None:
    with AnyReader([runs["processes"] / "bag"]) as reader:
        assert reader.message_count == messages_of(composed)
        transforms = [connection for connection in reader.connections if connection.topic == "/tf"]
        _, _, data = next(reader.messages(connections=transforms))
        frames = {
            transform.child_frame_id for transform in reader.deserialize(data, "tf2_msgs/msg/TFMessage").transforms
        }
    assert {"base_link", "odom"} <= frames


def test_the_bag_opens_with_mcap_and_is_complete(runs: dict[str, Path], composed: Bag) -> None:
    (file,) = (runs["processes"] / "bag").glob("*.mcap")
    with file.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        assert sum(1 for _ in reader.iter_decoded_messages()) == messages_of(composed)
        proof = {record.name: record.metadata for record in reader.iter_metadata()}["sojourn_completeness"]
    assert (proof["complete"], proof["gaps"]) == ("true", "")
    for topic, count in json.loads(proof["topics"]).items():
        assert len(composed.topics.get(topic, ())) == count["recorded"] == count["published"], topic
