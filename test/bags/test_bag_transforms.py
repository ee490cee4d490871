"""/tf: the algebra against Pinocchio, the bytes against the type store, and the meaning of the two links."""

import math
from typing import Any

import numpy as np
import pinocchio
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from synthetic import cdr

from sojourn_bags.definitions import typestore
from sojourn_bags.transforms import Transform, TransformSource, pose_of_odometry

coordinates = st.floats(-100.0, 100.0)


@st.composite
def transforms(draw: Any) -> Transform:
    """Any pose."""
    parts = np.array([draw(st.floats(-1.0, 1.0)) for _ in range(4)])
    parts = parts / np.linalg.norm(parts) if np.linalg.norm(parts) > 0.1 else np.array([0.0, 0.0, 0.0, 1.0])
    x, y, z, w = (float(part) for part in parts)
    return Transform((draw(coordinates), draw(coordinates), draw(coordinates)), (x, y, z, w))


def matrix(transform: Transform) -> np.ndarray:
    """Homogeneous matrix by Pinocchio."""
    return pinocchio.XYZQUATToSE3([*transform.translation, *transform.rotation]).homogeneous


def odometry(transform: Transform, frame: str) -> bytes:
    """CDR of an Odometry at a pose."""
    message = Odometry(child_frame_id="base_link")
    message.header.frame_id = frame
    position, orientation = message.pose.pose.position, message.pose.pose.orientation
    position.x, position.y, position.z = transform.translation
    orientation.x, orientation.y, orientation.z, orientation.w = transform.rotation
    return cdr(message)


@settings(max_examples=50, deadline=None)
@given(transforms(), transforms())
def test_product_and_inverse_are_those_of_rigid_motion(first: Transform, second: Transform) -> None:
    np.testing.assert_allclose(matrix(first @ second), matrix(first) @ matrix(second), atol=1e-10)
    np.testing.assert_allclose(matrix(first.inverse()), np.linalg.inv(matrix(first)), atol=1e-10)


@settings(max_examples=30, deadline=None)
@given(transforms(), transforms(), st.text("abcdefgh/", max_size=9), st.integers(1, 10**12))
def test_base_link_stands_in_map_at_the_truth(truth: Transform, belief: Transform, frame: str, stamp: int) -> None:
    assert pose_of_odometry(odometry(truth, frame)) == truth
    data = TransformSource().message(stamp, odometry(truth, frame), odometry(belief, "odom"))
    assert data is not None
    message = typestore().deserialize_cdr(data, "tf2_msgs/msg/TFMessage")
    found = []
    for link in message.transforms:  # type: ignore[attr-defined]
        assert link.header.stamp.sec * 10**9 + link.header.stamp.nanosec == stamp
        move, turn = link.transform.translation, link.transform.rotation
        found.append(Transform((move.x, move.y, move.z), (turn.x, turn.y, turn.z, turn.w)))
    assert found[1] == belief
    np.testing.assert_allclose(matrix(found[0]) @ matrix(found[1]), matrix(truth), atol=1e-9)


def test_one_odometry_alone_gives_one_link() -> None:
    source = TransformSource()
    pose = Transform((1.0, 2.0, 3.0), (0.0, 0.0, math.sin(0.2), math.cos(0.2)))
    frames = []
    for truth, belief in ((odometry(pose, "map"), None), (None, odometry(pose, "odom"))):
        data = source.message(20, truth, belief)
        assert data is not None
        [link] = typestore().deserialize_cdr(data, "tf2_msgs/msg/TFMessage").transforms  # type: ignore[attr-defined]
        frames.append((link.header.frame_id, link.child_frame_id, link.transform.translation.y))
    assert frames == [("map", "base_link", 2.0), ("odom", "base_link", 2.0)]
    assert source.message(20, None, None) is None
