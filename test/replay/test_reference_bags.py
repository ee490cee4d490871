"""Every node, fed with what it heard in the reference run, gives the answers that it gave there.

If a change is meant to alter them: scripts/record_reference renews the bags, and git shows in digest.txt what is new.
"""

import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sojourn_bags.candidate import NodeCandidate
from sojourn_bags.comparison_result import Comparison, FieldDifference, Verdict
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.definitions import CONFIGURATION_NAME
from sojourn_bags.digest import digest
from sojourn_bags.errors import OtherContractError
from sojourn_bags.provenance import run_of
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.replay import Replay, replay
from sojourn_bags.replay_choices import ROLES_TO_REPLAY
from sojourn_bags.replay_harness import ReplaySettings
from sojourn_bags.replay_script import ReplayPeriod
from sojourn_bags.run_configuration import run_configuration
from sojourn_bringup import reference_recording
from sojourn_bringup.process_table import process
from sojourn_bringup.record_reference import DIGEST
from sojourn_bringup.references import REFERENCES, references_folder
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import outputs_of
from sojourn_drive.node import DriveNode

NAMES = [reference.name for reference in REFERENCES]
RENEW = "if this is meant, renew the bags: scripts/record_reference"


@cache
def reference(name: str) -> Bag:
    return read_bag(references_folder() / name)


def replayed(name: str, role: str, node_class: Any, domain: int) -> Replay:
    bag = reference(name)
    with run_configuration(bag) as configuration:
        return replay(bag, role, NodeCandidate(node_class), configuration, ReplaySettings(domain))


@pytest.mark.parametrize("name", NAMES)
def test_bag_does_not_tell_where_the_checkout_stood(name: str) -> None:
    bag = reference(name)
    assert run_of(bag)["scenario"] == f"test/replay/{name}.yaml"
    checkout = str(references_folder().parents[1])
    assert not [file.name for file in bag.path.parent.iterdir() if checkout.encode() in file.read_bytes()]


@pytest.mark.parametrize("name", NAMES)
def test_a_bag_of_another_contract_is_no_longer_the_reference(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It was kept where every value was the same, and then could not be replayed."""
    place, bag = references_folder() / name, reference(name)
    assert reference_recording.changes(place, bag) == []

    def refuse(of: Bag) -> None:
        raise OtherContractError(of.path, "a topic is not in it")

    monkeypatch.setattr(reference_recording, "check_contract", refuse)
    assert "is a bag of another contract" in reference_recording.changes(place, bag)[0]


@pytest.mark.parametrize("role", ROLES_TO_REPLAY)
@pytest.mark.parametrize("name", NAMES)
def test_node_reproduces_its_answers(name: str, role: str, domain: int) -> None:
    """Within tolerance only: another processor may round in another way. On one machine they are equal, see
    test/system/test_replay.py.
    """
    result = replayed(name, role, process(role).load_class(), domain)
    told = "\n".join([*comparison_lines(result.comparison, "recorded", "replayed"), RENEW])
    assert result.comparison.verdict is not Verdict.DIFFERENT, told
    periods = len(reference(name)["/clock"])
    compared = {topic.topic: topic.matched for topic in result.comparison.topics}
    for row in outputs_of(role):
        if not row.is_event:
            assert compared.get(row.name, 0) == periods // row.every, row.name


@pytest.mark.parametrize("name", NAMES)
def test_bag_holds_what_a_reference_should(name: str) -> None:
    bag = reference(name)
    assert bag.whole
    assert {status["state"] for status in bag["/drive/status"].statuses()} == {"moving", "reached"}
    assert {status["state"] for status in bag["/arm/status"].statuses()} == {"idle", "moving", "reached", "refused"}
    switches = bag["/power/switches"].statuses()
    assert switches[0]["actuator_heater"] == "on" and switches[-1]["actuator_heater"] == "off"
    assert any(status["drive"] not in ("on", "off") for status in switches), "the drive's power is limited"


@pytest.mark.parametrize("name", NAMES)
def test_nobody_has_refused_a_message_of_ours(name: str) -> None:
    """The ground that wheels had changed was refused by the sensors for want of a z, and the run went on without it."""
    told = reference(name)["/diagnostics"].statuses()
    assert told and not [values for values in told if any(key.startswith("refused ") for key in values)]


def test_digests_are_those_of_the_bags_and_all_are_small() -> None:
    for name in NAMES:
        assert (references_folder() / name / DIGEST).read_text(encoding="utf-8") == digest(reference(name)), RENEW
    files = [file for file in references_folder().rglob("*") if file.is_file()]
    assert max(file.stat().st_size for file in files) < 2_000_000
    assert sum(file.stat().st_size for file in files) < 20_000_000, "a bag a theme is to be a short one"


class WeakDrive(DriveNode):
    """Its wheels turn slower by a ten-thousandth."""

    def publish(self, topic: str, message: Any) -> None:
        if topic == "/drive_command":
            message = message._replace(velocity=0.9999 * message.velocity)
        super().publish(topic, message)


class LateDrive(DriveNode):
    """Says in /odom what it should have said a period earlier."""

    def __init__(self, **given: Any) -> None:
        self._held: Any = None
        super().__init__(**given)

    def publish(self, topic: str, message: Any) -> None:
        if topic != "/odom":
            super().publish(topic, message)
            return
        before, self._held = self._held, message.position
        place = message.position if before is None else np.array([*before[:2], message.position[2]])
        super().publish(topic, message._replace(position=place))


class ForgetfulDrive(DriveNode):
    """Leaves out one message of /odom in a hundred, and its heartbeat at 3 s."""

    count = 0

    def publish(self, topic: str, message: Any) -> None:
        if topic == "/odom":
            self.count += 1
            if self.count % 100 == 0:
                return
        super().publish(topic, message)

    def _send_heartbeat(self, state: str, stamp: int, *rest: Any, **more: Any) -> None:
        if stamp != 3 * 10**9:
            super()._send_heartbeat(state, stamp, *rest, **more)


class StaleDrive(DriveNode):
    """Stamps its wheel commands a period too early."""

    def publish(self, topic: str, message: Any) -> None:
        if topic == "/drive_command":
            message = message._replace(stamp=message.stamp - 20_000_000)
        super().publish(topic, message)


def beyond(fields: Iterable[FieldDifference]) -> list[FieldDifference]:
    """Those that differ by more than the contract allows: the bag may be of a machine that rounds in another way."""
    return [field for field in fields if field.beyond]


def judged(node_class: Any, domain: int) -> Comparison:
    comparison = replayed("short_goals", "drive", node_class, domain).comparison
    assert comparison.verdict is Verdict.DIFFERENT
    return comparison


def test_a_gain_that_is_off_is_named(domain: int) -> None:
    comparison = judged(WeakDrive, domain)
    (found,) = beyond(comparison.fields)
    assert found.name == "/drive_command.velocity"
    assert found.largest.difference == pytest.approx(1e-4 * abs(found.largest.one))


def test_a_delay_of_one_period_is_named(domain: int) -> None:
    comparison = judged(LateDrive, domain)
    assert {field.name for field in beyond(comparison.fields)} == {
        "/odom.pose.pose.position.x",
        "/odom.pose.pose.position.y",
    }


def test_messages_that_are_left_out_are_named(domain: int) -> None:
    topics = {topic.topic: topic for topic in judged(ForgetfulDrive, domain).topics}
    assert topics["/odom"].missing == tuple(
        range(2 * 10**9, reference("short_goals")["/odom"].log_times[-1] + 1, 2 * 10**9)
    )
    assert len(topics["/odom"].missing) >= 4
    assert topics["/diagnostics"].missing == (3 * 10**9,)
    assert not topics["/drive_command"].missing


def test_a_stale_stamp_is_named(domain: int) -> None:
    topics = {topic.topic: topic for topic in judged(StaleDrive, domain).topics}
    assert topics["/drive_command"].extra == (0,)
    assert len(topics["/drive_command"].missing) == 1
    assert not beyond(topics["/odom"].fields)


class Ear:
    """Keeps all that is said in a replay."""

    def __init__(self) -> None:
        self.periods: list[int] = []
        self.messages: list[tuple[str, int, bytes]] = []

    def sent(self, step: ReplayPeriod) -> None:
        self.periods.append(step.period)

    def heard(self, row: Topic, stamp: int, data: bytes) -> None:
        self.messages.append((row.name, stamp, data))
        assert stamp <= 20_000_000 * (self.periods[-1] if self.periods else 0), "nobody answers before he is asked"


def test_all_that_is_said_is_handed_out(domain: int) -> None:
    bag, ear = reference("short_goals"), Ear()
    with run_configuration(bag) as configuration:
        candidate = NodeCandidate(process("power").load_class())
        result = replay(bag, "power", candidate, configuration, ReplaySettings(domain), ear)
    assert ear.periods == [step.period for step in result.script.steps]
    for name, messages in result.answers.items():
        assert [data for topic, stamp, data in ear.messages if topic == name and stamp] == messages.data
    assert any(topic == "/diagnostics" and stamp == 0 for topic, stamp, _ in ear.messages), "also from before the run"


def test_a_key_that_the_run_did_not_know_makes_no_other_values() -> None:
    """Where it says nothing; one that says something does."""
    bag = reference("short_goals")
    document = json.loads(bag.attachments[CONFIGURATION_NAME])
    for key, otherwise in (("leaps", ()), ("battery_soc", ("scenario",))):
        resolved = {name: values for name, values in document["resolved"]["scenario"].items() if name != key}
        older = json.dumps({**document, "resolved": {**document["resolved"], "scenario": resolved}}).encode()
        attachments = {**bag.attachments, CONFIGURATION_NAME: older}
        with run_configuration(Bag(bag.path, True, bag.topics, attachments, bag.records)) as found:
            assert found.resolved_otherwise == otherwise


def test_configuration_is_that_of_the_run_and_what_differs_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    bag = reference("short_goals")
    changed = Bag(bag.path, True, bag.topics, dict(bag.attachments), bag.records)
    name = "config/machines/explorer/flight.yaml"
    changed.attachments[name] = bag.attachments[name] + b"\n# as it was then\n"
    with run_configuration(changed) as configuration:
        assert configuration.changed == (name,)
        assert "the run's are used: config/machines/explorer/flight.yaml" in configuration.warnings()[0]
        assert (configuration.folder.parent / name).read_bytes().endswith(b"as it was then\n")
        assert not configuration.resolved_otherwise
        folder = configuration.folder
    assert not Path(folder).exists()
