"""Readings of the sensors as messages of the contract."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from sensor_msgs.msg import BatteryState, Imu, JointState

from sojourn_contract import stamps
from sojourn_contract.messages import battery_state, fill_joint_state, joint_state, set_quaternion, set_xyz
from sojourn_physics.sensors.imu import ImuReading
from sojourn_physics.sensors.suite import SensorMeasurements

NOT_MEASURED = float("nan")


class ReadingMessages:
    """Keeps its message objects, which are filled anew each time."""

    def __init__(self) -> None:
        self._joints = joint_state(())
        self._imu = Imu()
        self._imu.header.frame_id = "imu_link"

    def joints(self, stamp: int, names: Sequence[str], measured: SensorMeasurements) -> JointState:
        """/joint_states of the joints of these names."""
        if len(self._joints.name) != len(names):
            self._joints = joint_state(names)
        return fill_joint_state(
            self._joints, stamp, measured.joint_position, measured.joint_velocity, measured.joint_effort
        )

    def imu(self, stamp: int, reading: ImuReading) -> Imu:
        """/imu/data."""
        imu = self._imu
        imu.header.stamp = stamps.to_message(stamp)
        set_quaternion(imu.orientation, reading.orientation)
        set_xyz(imu.angular_velocity, reading.angular_velocity)
        set_xyz(imu.linear_acceleration, reading.specific_force)
        imu.orientation_covariance = np.diag(reading.orientation_variance).ravel()
        imu.angular_velocity_covariance = np.diag(reading.angular_velocity_variance).ravel()
        imu.linear_acceleration_covariance = np.diag(reading.specific_force_variance).ravel()
        return imu


def dead_imu(reading: ImuReading) -> ImuReading:
    """The reading of an IMU without power: none of its numbers is one."""
    none = np.full(3, NOT_MEASURED)
    return replace(reading, orientation=np.full(4, NOT_MEASURED), angular_velocity=none, specific_force=none)


def bus_message(stamp: int, measured: SensorMeasurements) -> BatteryState:
    """/bus/state."""
    voltage, current, temperature = measured.bus_voltage[0], measured.bus_current[0], measured.bus_temperature[0]
    return battery_state(stamp, voltage, current, temperature, NOT_MEASURED, NOT_MEASURED, NOT_MEASURED)
