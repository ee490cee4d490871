"""Sensors that are late, slow and lossy: one record in every layout, the contract kept, and no number of another sensor
changed.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import LAYOUTS, PATIENT, PATIENT_BENCH, SHORT_RUN, Program
from verdicts import require_same

from domains import domain_to_keep
from sojourn_bags.comparison import compare, stamps_of
from sojourn_bags.contract_version import table_of_bag
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import topic

TIMINGS = {
    "imu.timing": "{latency: 0.06, jitter: 0.03, dropped: 0.02}",
    "joint_timing": "{latency: 0.02, dropped: 0.02}",
    "hazcam.timing": "{rate: 5.0, phase: 0.04, latency: 0.1, jitter: 0.1}",
    "bus.timing": "{rate: 2.0, latency: 0.07, dropped: 0.1}",
}
TIMED = [part for key, timing in TIMINGS.items() for part in ("--set", f"sensors.{key}={timing}")]
STILL = ["--without", "arm", "--set", "steps=[{wait_s: 2.0}]"]
"""A machine that stands, with nobody to hold its arm, does not move by what it measures."""
ALONE = {"still": (), "still_imu": ("--set", "sensors.imu.timing={latency: 0.1, jitter: 0.1, dropped: 0.2}")}
LATE = ("/imu/data", "/joint_states", "/hazcam/points", "/bus/state")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Path]]:
    base = tmp_path_factory.mktemp("timed")
    wanted = {name: [*TIMED, *options] for name, options in LAYOUTS.items()}
    wanted |= {name: ["--direct", *STILL, *options] for name, options in ALONE.items()}
    programs: list[Program] = []
    try:
        for name, options in wanted.items():
            given = [str(SHORT_RUN), *PATIENT, "--domain", str(domain_to_keep()), *options]
            programs.append(Program("start", [*given, "--run-dir", str(base / name)], base / f"{name}.log"))
        for program in programs:
            assert program.wait() == 0, program.text
        yield {name: base / name for name in wanted}
    finally:
        for program in programs:
            program.end()


@pytest.fixture(scope="module")
def direct(runs: dict[str, Path]) -> Bag:
    return read_bag(runs["direct"])


def test_every_field_is_the_same_in_every_layout(runs: dict[str, Path], direct: Bag) -> None:
    require_same(direct, read_bag(runs["processes"]))


def test_messages_are_filed_when_they_leave(direct: Bag) -> None:
    table = table_of_bag(direct)
    for name in LATE:
        delivery, messages = table.topic(name).delivery, direct[name]
        assert delivery is not None
        stamps, filed = (np.array(times) // CONTROL_PERIOD_NS for times in (stamps_of(messages), messages.log_times))
        assert stamps.tolist() == list(delivery.departures(int(filed[-1]))), name
        assert np.all(np.diff(filed) >= 0)
        late = (filed - stamps) * CONTROL_PERIOD_NS
        assert late.min() >= delivery.latency and late.max() < delivery.latency + delivery.jitter + CONTROL_PERIOD_NS
    assert len(direct["/imu/data"]) < len(direct["/clock"]) - 4


def test_the_contract_is_kept_and_nothing_else_accepted(direct: Bag) -> None:
    report, _ = judge_bag(direct)
    assert not list(report.lines())
    lacking = replace(direct, topics=dict(direct.topics))
    del lacking.topics["/imu/data"]
    report, _ = judge_bag(lacking)
    assert {group.topic for group in report.groups if group.rule == "answer"} == {"/imu/data"}
    early = replace(direct, topics=dict(direct.topics))
    messages = early.topics["/imu/data"]
    later = [time + 2 * CONTROL_PERIOD_NS for time in messages.log_times]
    early.topics["/imu/data"] = replace(messages, log_times=later)
    report, _ = judge_bag(early)
    assert {(group.topic, group.rule) for group in report.groups} == {("/imu/data", "stamp")}


def test_the_goals_are_reached_all_the_same(direct: Bag) -> None:
    believed = direct["/odom"].column("pose.pose.position.x")
    assert believed[-1] == pytest.approx(0.25, abs=0.05)
    assert np.all(np.isfinite(believed))


def test_no_other_sensor_measures_anything_else(runs: dict[str, Path]) -> None:
    plain, late = read_bag(runs["still"]), read_bag(runs["still_imu"])
    for name in ("/joint_states", "/bus/state", "/sun_direction", "/hazcam/points", "/truth/odom"):
        result = compare({name: plain[name]}, {name: late[name]})
        assert not [found for found in result.topics if found.missing or found.extra or found.fields], name
    told = dict(zip(stamps_of(plain["/imu/data"]), plain["/imu/data"].column("angular_velocity.z"), strict=True))
    heard = dict(zip(stamps_of(late["/imu/data"]), late["/imu/data"].column("angular_velocity.z"), strict=True))
    assert 0.5 * len(told) < len(heard) < len(told)
    assert all(told[stamp] == value for stamp, value in heard.items())


def test_the_run_without_a_timing_has_the_table_of_every_machine(runs: dict[str, Path]) -> None:
    table = table_of_bag(read_bag(runs["still"]))
    assert table.topic("/imu/data") == topic("/imu/data") and table.topic("/clock") == topic("/clock")


@pytest.mark.parametrize("node", ["sensors", "drive", "power"])
def test_each_node_answers_in_a_replay_as_it_did(runs: dict[str, Path], tmp_path: Path, node: str) -> None:
    given = ["--node", node, "--exact", *PATIENT_BENCH, "--domain", str(domain_to_keep())]
    program = Program("replay", [str(runs["processes"]), *given], tmp_path / "replay.log")
    try:
        assert program.wait() == 0, program.text
    finally:
        program.end()
    assert "identical" in program.text
