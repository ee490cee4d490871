"""Mounting of a sensor, against the chain of the URDF written out by hand."""

import math

import numpy as np
import pytest

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.mounting import mounting

URDF = """<robot name="r">
  <link name="base_link"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="mast"/><link name="imu_link"/>
  <joint name="a" type="fixed"><parent link="base_link"/><child link="mast"/>
    <origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="b" type="fixed"><parent link="mast"/><child link="imu_link"/>
    <origin xyz="0.5 0 0.2" rpy="0.1 0 0"/></joint>
</robot>"""


def test_chain_of_fixed_joints() -> None:
    rotation, position = mounting(URDF, "imu_link")
    np.testing.assert_allclose(position, (1.0, 0.5, 0.2), atol=1e-12)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    c, s = math.cos(0.1), math.sin(0.1)
    np.testing.assert_allclose(rotation, turn @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]), atol=1e-12)


def test_unknown_link_is_refused_by_name() -> None:
    with pytest.raises(InvalidValueError, match="gyro_link"):
        mounting(URDF, "gyro_link")
