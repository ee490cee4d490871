"""The topic table as data: every row is complete, consistent with the others and with the ROS types it names."""

from dataclasses import replace

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.qos import HistoryPolicy, ReliabilityPolicy
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from sojourn_contract import qos
from sojourn_contract.clouds import POINT_FIELDS
from sojourn_contract.errors import UnknownRoleError, UnknownTopicError
from sojourn_contract.messages import CONTACT_FIELDS
from sojourn_contract.topic_types import Reliability, Topic
from sojourn_contract.topics import RECORDER_LAG, ROLES, TOPICS, inputs_of, outputs_of, topic
from sojourn_contract.types import message_class

WATCH = "console"
"""Whoever watches a run beside it: no role of it."""

every_row = pytest.mark.parametrize("row", TOPICS, ids=lambda row: row.name)

FILLED = {
    "nav_msgs/Path": Path(poses=[PoseStamped()]),
    "trajectory_msgs/JointTrajectory": JointTrajectory(points=[JointTrajectoryPoint()]),
    "diagnostic_msgs/DiagnosticArray": DiagnosticArray(status=[DiagnosticStatus(values=[KeyValue()])]),
}
"""Messages whose fields lie in lists, with one element."""


def field_at(message: object, path: str) -> object:
    """The field at a dotted path; of a list its first element."""
    for name in path.split("."):
        if isinstance(message, list):
            message = message[0]
        message = getattr(message, name)
    return message


@every_row
def test_row_is_complete(row: Topic) -> None:
    message = message_class(row.type)()
    assert row.name.startswith("/") and row.meaning
    assert row.publisher in (*ROLES, "all", WATCH)
    assert set(row.subscribers) <= set(ROLES) and row.publisher not in row.subscribers
    assert 50 % row.every == 0 or row.every % 50 == 0 if row.every else row.publisher in ("operator", WATCH)
    assert row.max_age_s > 0.0
    if not row.is_event:  # it must not be lost between two of its own messages
        assert row.max_age_s > row.every * 0.02
        assert row.lag % row.every == 0
    has_stamp = hasattr(message, "header") or hasattr(message, "stamp") or row.name == "/clock"
    assert has_stamp, "every message is stamped"


@every_row
def test_field_paths_exist_and_ranges_are_ranges(row: Topic) -> None:
    for rule in row.fields:
        assert rule.low < rule.high and rule.tolerance >= 0.0
        if row.type == "sensor_msgs/PointCloud2":
            fields = CONTACT_FIELDS if row.name == "/truth/contacts" else POINT_FIELDS
            assert tuple(name for other in row.fields for name in other.path.split()) == fields
            continue
        if row.name == "/power/switches":  # the key stands for each load
            assert rule.path == "status.values"
            continue
        assert field_at(FILLED.get(row.type, message_class(row.type)()), rule.path) is not None


def test_names_are_unique_and_found() -> None:
    assert len({row.name for row in TOPICS}) == len(TOPICS)
    for row in TOPICS:
        assert topic(row.name) is row


def test_whoever_listens_is_spoken_to() -> None:
    for role in ROLES:
        for row in inputs_of(role):
            assert row.publisher in ROLES or row.publisher == "all"
            assert any(row in outputs_of(other) for other in ROLES)
    assert {row.name for row in inputs_of("recorder")} == {row.name for row in TOPICS if row.logged}


def test_rows_stand_in_the_order_of_the_flow() -> None:
    """Plant, sensors, then the nodes: a node's inputs stand before the outputs that it makes of them."""
    place = {row.name: index for index, row in enumerate(TOPICS)}
    for role in ("sensors", "drive", "arm", "power"):
        inputs = [row for row in inputs_of(role) if not row.is_event and row.lag == 0]
        outputs = [row for row in outputs_of(role) if row.publisher == role]
        assert max(place[row.name] for row in inputs) < min(place[row.name] for row in outputs)


def test_unknown_names_are_answered_with_the_known_ones() -> None:
    with pytest.raises(UnknownTopicError, match=r"/nowhere.*/drive_command"):
        topic("/nowhere")
    with pytest.raises(UnknownRoleError, match=r"pilot.*plant, sensors"):
        inputs_of("pilot")
    with pytest.raises(UnknownRoleError):
        outputs_of("all")


@every_row
@pytest.mark.parametrize("lockstep", [True, False])
def test_quality_of_service(row: Topic, lockstep: bool) -> None:
    profile = qos.profile(row, lockstep)
    loose = row.name == "/clock" and not lockstep
    assert profile.history == HistoryPolicy.KEEP_LAST
    assert profile.depth == (1 if loose else 10)
    assert profile.reliability == (ReliabilityPolicy.BEST_EFFORT if loose else ReliabilityPolicy.RELIABLE)
    recorder = qos.profile(row, lockstep, "recorder")
    assert recorder.reliability == profile.reliability, "the recorder must be compatible with the publisher"
    assert recorder.depth > RECORDER_LAG


def test_pictures_and_clouds_are_best_effort() -> None:
    row = replace(topic("/odom"), reliability=Reliability.BEST_EFFORT)
    assert qos.profile(row, True).reliability == ReliabilityPolicy.BEST_EFFORT
