"""Readings of the sensors as messages of the contract."""

from dataclasses import replace

import numpy as np

from sojourn_contract.messages import battery_state
from sojourn_contract.values import NOT_MEASURED, BatteryState, Imu, JointState
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.imu import ImuReading
from sojourn_physics.sensors.suite import SensorMeasurements


def joints_message(stamp: int, names: tuple[str, ...], measured: SensorMeasurements) -> JointState:
    """/joint_states of the joints of these names."""
    return JointState(stamp, names, measured.joint_position, measured.joint_velocity, measured.joint_effort)


def imu_message(stamp: int, reading: ImuReading) -> Imu:
    """/imu/data."""
    return Imu(
        stamp,
        "imu_link",
        reading.orientation,
        reading.angular_velocity,
        reading.specific_force,
        _covariance(reading.orientation_variance),
        _covariance(reading.angular_velocity_variance),
        _covariance(reading.specific_force_variance),
    )


def _covariance(variance: FloatArray) -> FloatArray:
    """Row by row, (9,), of three variances that have nothing to do with each other."""
    covariance = np.zeros(9)
    covariance[::4] = variance
    return covariance


def dead_imu(reading: ImuReading) -> ImuReading:
    """The reading of an IMU without power: none of its numbers is one."""
    none = np.full(3, NOT_MEASURED)
    return replace(reading, orientation=np.full(4, NOT_MEASURED), angular_velocity=none, specific_force=none)


def bus_message(stamp: int, measured: SensorMeasurements) -> BatteryState:
    """/bus/state."""
    voltage, current, temperature = measured.bus_voltage[0], measured.bus_current[0], measured.bus_temperature[0]
    return battery_state(stamp, voltage, current, temperature, NOT_MEASURED, NOT_MEASURED, NOT_MEASURED)
