"""Clouds of points: there and back, and what is refused on arrival."""

import math
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2, PointField

from ros_messages import ros_message, value_of
from sojourn_contract.arrival import check_input
from sojourn_contract.clouds import point_cloud, points_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topics import topic

TOPIC = "/hazcam/points"
POINTS = np.array([[1.0, -0.5, 0.25], [2.0, 3.0, -4.0]], dtype=np.float32)


def test_points_go_there_and_back() -> None:
    sent = point_cloud(60_000_000, "base_link", POINTS)
    got = ros_message(sent)
    assert (got.header.frame_id, got.header.stamp.nanosec, got.is_dense) == ("base_link", 60_000_000, True)
    assert len(got.data) == 24, "three floats a point"
    np.testing.assert_array_equal(points_of(TOPIC, value_of(got)), POINTS)
    assert points_of(TOPIC, point_cloud(0, "base_link", POINTS[:0])).shape == (0, 3)


def test_clouds_of_other_cameras_are_read() -> None:
    """Double precision, big-endian, in another order, with a colour beside it."""
    dtype = np.dtype([("rgb", ">u4"), ("z", ">f8"), ("y", ">f8"), ("x", ">f8")])
    raw = np.zeros(2, dtype=dtype)
    for column, name in enumerate("xyz"):
        raw[name] = POINTS[:, column]
    cloud = PointCloud2(height=2, width=1, point_step=dtype.itemsize, is_bigendian=True)
    cloud.fields = [PointField(name="rgb", offset=0, datatype=PointField.UINT32, count=1)] + [
        PointField(name=name, offset=offset, datatype=PointField.FLOAT64, count=1)
        for name, offset in (("z", 4), ("y", 12), ("x", 20))
    ]
    cloud.data = array("B", raw.tobytes())
    np.testing.assert_array_equal(points_of(TOPIC, value_of(cloud)), POINTS)


def set_field(place: int, name: str, value: Any) -> Callable[[Any], None]:
    return lambda cloud: setattr(cloud.fields[place], name, value)


def put_nan(cloud: Any) -> None:
    points = POINTS.copy()
    points[1, 2] = math.nan
    cloud.data = array("B", points.tobytes())


def put(name: str, value: Any) -> Callable[[Any], None]:
    return lambda cloud: setattr(cloud, name, value)


@pytest.mark.parametrize(
    "spoil,field,words",
    [
        (put_nan, "z[1]", "nan: allowed is a finite number"),
        (put("data", array("B", b"12")), "data", "2 bytes: allowed is 2 points of 12 bytes"),
        (put("width", 3), "data", "24 bytes: allowed is 3 points"),
        (set_field(2, "name", "depth"), "fields", "x y depth: allowed is x y z among them"),
        (set_field(1, "datatype", PointField.INT16), "fields.y", "one float64 or float32"),
        (set_field(1, "count", 2), "fields.y", "one float64 or float32"),
        (set_field(2, "offset", 10), "fields.z", "one float64 or float32"),
    ],
)
def test_what_no_node_may_take(spoil: Callable[[Any], None], field: str, words: str) -> None:
    cloud = ros_message(point_cloud(0, "base_link", POINTS))
    spoil(cloud)
    with pytest.raises(RefusedMessageError) as refusal:
        check_input(topic(TOPIC), value_of(cloud))
    assert refusal.value.field == field and words in str(refusal.value)
