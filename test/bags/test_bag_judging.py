"""Bags judged by the contract: clean, broken, cut off, of another contract, or no bag of a run at all."""

import json
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from clean_run import PERIODS, CleanRun, explorer, kinds
from rclpy.qos import QoSProfile, ReliabilityPolicy
from recorded_run import write
from synthetic import CHANNELS, PERIOD, cdr

from sojourn_bags.contract_version import check_contract
from sojourn_bags.definitions import ChannelSpec, offered_entries, qos_entry
from sojourn_bags.errors import OtherContractError
from sojourn_bags.judging import UnjudgeableBagError, endpoints_of, judge_bag, machine_of
from sojourn_bags.provenance import CONTRACT_NAME, contract_attachment
from sojourn_bags.reading import read_bag
from sojourn_bags.replay_script import script_of
from sojourn_bags.writer import Attachment, BagWriter
from sojourn_contract import qos
from sojourn_contract.description import contract_data
from sojourn_contract.topics import ROLES, TOPICS


def judged(folder: Path, **wishes: Any) -> tuple[set[tuple[str, str, str]], list[str]]:
    report, run = judge_bag(read_bag(folder), **wishes)
    return kinds(report), run.notes


def test_a_clean_bag(tmp_path: Path) -> None:
    folder = write(tmp_path / "bag", CleanRun(), contract=contract_attachment())
    report, run = judge_bag(read_bag(folder))
    assert not list(report.lines())
    assert sum(report.messages.values()) == len(CleanRun().entries)
    assert run.lockstep and run.participants == ROLES and not run.notes


def test_the_rover_is_that_of_the_bag(tmp_path: Path) -> None:
    folder = write(tmp_path / "bag", CleanRun(), contract=contract_attachment())
    found, known = machine_of(read_bag(folder)), explorer()
    assert (found.drive, found.steer, found.arm, found.held) == (known.drive, known.steer, known.arm, known.held)
    assert (found.loads, found.poses, found.contacts) == (known.loads, known.poses, known.contacts)
    assert {name: joint.upper for name, joint in found.joints.items()} == {
        name: joint.upper for name, joint in known.joints.items()
    }


def test_a_broken_bag(tmp_path: Path) -> None:
    run = CleanRun()
    run.one("/odom").header.frame_id = "map"
    run.drop("/imu/data", lambda entry: entry.stamp == 30 * PERIOD)
    found, _ = judged(write(tmp_path / "bag", run, contract=contract_attachment()))
    assert found == {
        ("frame", "/odom", "header.frame_id"),
        ("answer", "/imu/data", "header.stamp"),
        ("counter", "/diagnostics", "status.values.published /imu/data"),
    }


def test_one_role_alone(tmp_path: Path) -> None:
    run = CleanRun()
    run.one("/odom").header.frame_id = "map"
    folder = write(tmp_path / "bag", run, contract=contract_attachment())
    assert judged(folder, roles=("arm",))[0] == set()
    assert judged(folder, roles=("drive",))[0] == {("frame", "/odom", "header.frame_id")}


def test_another_type_and_another_quality_of_service(tmp_path: Path) -> None:
    run = CleanRun()
    for entry in run.of("/battery_state"):
        entry.message = run.one("/imu/data")
    folder = write(
        tmp_path / "bag",
        run,
        contract=contract_attachment(),
        types={"/battery_state": "sensor_msgs/Imu"},
        offered={"/odom": "best_effort"},
    )
    found, _ = judged(folder)
    assert found == {("endpoint", "/battery_state", "type"), ("endpoint", "/odom", "qos.reliability")}


def test_a_bag_says_what_its_publishers_offer(tmp_path: Path) -> None:
    """The profiles asked at the first message, history and depth as the table has them."""
    row = TOPICS[0]
    nominal = qos_entry(qos.profile(row, True))
    loose = QoSProfile(depth=3, reliability=ReliabilityPolicy.BEST_EFFORT)
    tight = QoSProfile(depth=3)
    entries = offered_entries(nominal, [loose, tight, loose])
    assert [entry["reliability"] for entry in entries] == ["best_effort", "reliable"]
    assert {entry["depth"] for entry in entries} == {10}
    writer = BagWriter(tmp_path / "bag", [ChannelSpec(row.name, row.type, nominal)], (), lambda spec: entries)
    writer.write(0, PERIOD, PERIOD, cdr(CleanRun().one("/clock")))
    writer.close()
    told = read_bag(tmp_path / "bag")["/clock"]
    assert [endpoint.reliability for endpoint in endpoints_of(told)] == ["best_effort", "reliable"]


def test_a_message_that_cannot_be_decoded(tmp_path: Path) -> None:
    run = CleanRun()
    entry = run.of("/joint_states")[40]
    entry.message = b"\0\1\0\0" + b"\xff" * 40
    found, _ = judged(write(tmp_path / "bag", run, contract=contract_attachment()))
    assert ("type", "/joint_states", "message") in found


def test_a_bag_cut_off_is_judged_as_far_as_it_goes(tmp_path: Path) -> None:
    run = CleanRun()
    run.one("/odom", 5).header.frame_id = "map"
    whole = read_bag(write(tmp_path / "bag", run, contract=contract_attachment()))
    specs = [ChannelSpec(row.name, row.type, qos_entry(qos.profile(row, True))) for row in TOPICS]
    attachments = [Attachment(name, "text/plain", data) for name, data in whole.attachments.items()]
    chunked = BagWriter(tmp_path / "cut", specs, attachments)
    half = PERIODS // 2
    for entry in sorted(run.entries, key=lambda entry: entry.stamp):
        if entry.stamp == half * PERIOD:
            chunked.flush()
        chunked.write(CHANNELS[entry.topic], entry.stamp, entry.stamp, cdr(entry.message))
    chunked.flush()  # and no end: as after a crash
    data = chunked.path.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: len(data) - 40])
    found, notes = judged(cut)
    assert found == {("frame", "/odom", "header.frame_id")}
    assert any("cut off" in note for note in notes)


def test_a_bag_of_another_contract_is_refused_with_the_difference(tmp_path: Path) -> None:
    data = contract_data()
    data["topics"]["/odom"]["type"] = "geometry_msgs/PoseStamped"
    data["topics"]["/imu/data"]["fields"][1]["unit"] = "deg/s"
    data["digest"] = "0123456789ab"
    other = Attachment(CONTRACT_NAME, "application/json", json.dumps(data).encode())
    folder = write(tmp_path / "bag", CleanRun(), contract=other)
    words = r"0123456789ab.*/imu/data: units is \{\"angular_velocity\": \"deg/s[^,]*, ours.*/odom: type.*PoseStamped"
    for use in (judge_bag, check_contract, partial(script_of, role="drive")):
        with pytest.raises(OtherContractError, match=words):
            use(read_bag(folder))


def test_an_unreadable_contract_is_refused(tmp_path: Path) -> None:
    folder = write(tmp_path / "bag", CleanRun(), contract=Attachment(CONTRACT_NAME, "application/json", b"{"))
    with pytest.raises(OtherContractError, match=r"contract\.json cannot be read"):
        judge_bag(read_bag(folder))


def test_a_bag_of_somebody_else(tmp_path: Path) -> None:
    """Log times of the wall clock, no description: judged by /clock, for the rover that is named."""
    run = CleanRun()
    for place, entry in enumerate(sorted(run.entries, key=lambda entry: entry.stamp)):
        entry.logged = 1_700_000_000_000_000_000 + place
    folder = write(tmp_path / "bag", run, described=False)
    with pytest.raises(UnjudgeableBagError, match="does not describe its rover"):
        judge_bag(read_bag(folder))
    found, notes = judged(folder, machine=explorer())
    assert {kind for kind in found if kind[0] != "counter"} == set()
    assert any("does not say under which contract" in note for note in notes)


def test_a_role_that_took_no_part(tmp_path: Path) -> None:
    run = CleanRun()
    folder = write(tmp_path / "bag", run, described=True)  # no record of the run: whoever has spoken took part
    with pytest.raises(UnjudgeableBagError, match="'recorder' took no part"):
        judge_bag(read_bag(folder), roles=("recorder",))


def test_a_bag_without_messages_of_the_contract(tmp_path: Path) -> None:
    writer = BagWriter(
        tmp_path / "bag", [ChannelSpec("/chatter", "std_msgs/Header", qos_entry(qos.profile(TOPICS[0], True)))]
    )
    writer.write(0, PERIOD, PERIOD, cdr(CleanRun().one("/operator/tick")))
    writer.close()
    with pytest.raises(UnjudgeableBagError, match="holds no message of the contract"):
        judge_bag(read_bag(tmp_path / "bag"))
