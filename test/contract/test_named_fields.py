"""Fields by name from the values of messages: against what the messages hold, and against rotations by another way."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_contract.clouds import point_cloud
from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.heartbeat import status_message
from sojourn_contract.named_fields import fields_of, named_field, unknown_key
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import BatteryState, DiagnosticArray, DiagnosticStatus, JointState, Odometry

STATE = JointState(1, ("left", "right"), np.array([1.0, 2.0]), np.array([3.0, 4.0]), np.array([5.0, 6.0]))
ODOMETRY = Odometry(1, "odom", "base_link", np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, 0.0, 1.0]),
                    np.array([4.0, 5.0, 6.0]), np.array([7.0, 8.0, 9.0]))  # fmt: skip


def values(name: str, message: object) -> list[tuple[str, float | str]]:
    return list(named_field(name, STANDARD).values(message))


def test_each_form_of_a_name_gives_its_values() -> None:
    assert values("/joint_states.effort", STATE) == [("left", 5.0), ("right", 6.0)]
    assert values("/joint_states.velocity[right]", STATE) == values("/joint_states.velocity[1]", STATE) == [("", 4.0)]
    assert values("/odom.pose.pose.position", ODOMETRY) == [("x", 1.0), ("y", 2.0), ("z", 3.0)]
    assert values("/odom.twist.twist.angular.z", ODOMETRY) == [("", 9.0)]
    assert values("/battery_state.percentage", BatteryState(1, percentage=0.5)) == [("", 0.5)]
    assert values("/battery_state.percentage", BatteryState(1)) == []  # not measured
    status = status_message(1, "drive", {"state": "moving", "slip": "0.25"}, level=1)
    assert values("/drive/status.slip", status) == [("", 0.25)]
    assert values("/drive/status.state", status) == [("", "moving")]
    assert values("/drive/status.level", status) == [("", 1.0)]
    points = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], dtype=np.float32)
    assert values("/hazcam/points.y", point_cloud(1, "base_link", points)) == [("0", 2.0), ("1", 5.0)]


def test_of_several_statuses_each_has_its_own() -> None:
    both = DiagnosticArray(1, tuple(DiagnosticStatus(name, (("state", name),)) for name in ("drive", "arm")))
    assert values("/diagnostics.state", both) == [("drive", "drive"), ("arm", "arm")]
    assert values("/diagnostics.state[arm]", both) == [("", "arm")]


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_angles_are_those_of_the_rotation(quaternion: tuple[float, float, float, float]) -> None:
    message = ODOMETRY._replace(orientation=np.array(quaternion))
    rotation = Rotation.from_quat(quaternion)
    ((_, tilt),) = values("/odom.pose.pose.orientation.tilt_deg", message)
    assert np.cos(np.radians(tilt)) == pytest.approx(rotation.apply([0.0, 0.0, 1.0])[2], abs=1e-9)
    yaw, pitch, roll = (dict(values(f"/odom.pose.pose.orientation.{name}_deg", message))[""]
                        for name in ("yaw", "pitch", "roll"))  # fmt: skip
    again = Rotation.from_euler("ZYX", [yaw, pitch, roll], degrees=True)
    if abs(pitch) < 89.0:
        assert (again.inv() * rotation).magnitude() == pytest.approx(0.0, abs=1e-6)


def test_all_fields_of_all_rows_are_found_by_their_names() -> None:
    assert all(named_field(f"{row.name}.{name}", STANDARD).path == name for row in STANDARD for name in fields_of(row))


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("/drive/statsu.state", "/drive/status"),
        ("/battery_state.percent", "/battery_state.percentage"),
        ("/odom.pose.pose.orientation.tilt", "/odom.pose.pose.orientation.tilt_deg"),
        ("battery", "TOPIC.FIELD"),
        ("/plan.poses", "cannot be read"),
    ],
)
def test_a_name_that_no_field_has_is_answered_with_the_nearest(name: str, near: str) -> None:
    with pytest.raises(UnknownFieldNameError) as refusal:
        named_field(name, STANDARD)
    assert near in str(refusal.value)


def test_a_key_that_a_status_lacks_is_answered_with_the_nearest() -> None:
    message = status_message(1, "drive", {"slip": "0", "state": "idle"})
    assert unknown_key(named_field("/drive/status.state", STANDARD), message) is None
    assert "/drive/status.slip" in str(unknown_key(named_field("/drive/status.slp", STANDARD), message))
