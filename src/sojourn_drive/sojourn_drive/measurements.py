"""Measured joints and IMU as the drive's input, and its output as a wheel command."""

import math

import numpy as np

from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.switches import fraction_of
from sojourn_contract.values import Imu, JointState
from sojourn_flight.odometry.heading_fix import SunSighting
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive_types import DriveInput, DriveOutput, TwistCommand
from sojourn_machine.machine import MachineParams
from sojourn_machine.mounting import IMU_LINK, mounting
from sojourn_machine.params import FloatArray

Triple = tuple[float, float, float]
"""Along x, y, z."""


class WheelMeasurements:
    """Maps the joints of messages to wheels and back.

    Args:
        machine: its wheels and tracks are in the order of the steering geometry.
        urdf_xml: the machine, with a link `imu_link`.
    """

    def __init__(self, machine: MachineParams, urdf_xml: str) -> None:
        self._drive_joints = [wheel.joint for wheel in machine.rolling]
        self._steer_joints = list(machine.steer_joints)
        turned_by = [wheel.steer_joint for wheel in machine.rolling]
        self._steered = [place for place, joint in enumerate(turned_by) if joint is not None]
        self._first_of_joint = [turned_by.index(joint) for joint in self._steer_joints]
        self._drive_places = JointPlaces("/joint_states", self._drive_joints)
        self._steer_places = JointPlaces("/joint_states", [joint for joint in turned_by if joint is not None])
        self._commanded = (*self._drive_joints, *self._steer_joints)
        self.loads = machine.loads_of(self._commanded)
        """Without which the rover does not move."""
        self._imu_to_base, self._imu_lever = mounting(urdf_xml, IMU_LINK)

    def drive_input(
        self,
        joints: JointState,
        imu: Imu,
        twist: TwistCommand | None,
        goal: Goal | None,
        power_limit: float,
        sun: SunSighting | None = None,
    ) -> DriveInput:
        """Input of the drive's step. Raises RefusedMessageError if a wheel's joint is missing."""
        drive, steer = self._drive_places.places(joints), self._steer_places.places(joints)
        position = joints.position
        angles = np.zeros(len(drive))
        angles[self._steered] = position[steer]
        gyro, force = self._felt(imu)
        return DriveInput(
            wheel_positions=position[drive],
            wheel_rates=joints.velocity[drive],
            steer_angles=angles,
            wheel_efforts=joints.effort[drive] if len(joints.effort) else None,
            gyro=gyro,
            specific_force=force,
            accelerometer_ahead=float(self._imu_lever[0]),
            roll_pitch=self._roll_pitch(imu.orientation),
            sun=sun,
            twist=twist,
            goal=goal,
            power_limit=power_limit,
        )

    def command(self, stamp: int, output: DriveOutput) -> JointState:
        """Wheel command: rates of the drive joints, angles and rates of the steering joints."""
        count = len(self._drive_joints)
        position = np.zeros(count + len(self._steer_joints))
        velocity = np.empty_like(position)
        velocity[:count] = output.wheel_rates
        position[count:] = output.steer_angles[self._first_of_joint]
        velocity[count:] = output.steer_rates[self._first_of_joint]
        return JointState(stamp, self._commanded, position, velocity)

    def power_limit(self, switches: dict[str, str], present: float) -> float:
        """Factor on all speeds from the power manager's switches; `present` where they do not name the
        drive.
        """
        fractions = (fraction_of(switches[load]) for load in self.loads if load in switches)
        return min((fraction for fraction in fractions if fraction is not None), default=present)

    def _felt(self, imu: Imu) -> tuple[Triple, Triple]:
        """Angular velocity [rad/s] and specific force [m/s^2] of base_link, in base_link."""
        rate = self._imu_to_base @ imu.angular_velocity
        along, square = float(rate @ self._imu_lever), float(rate @ rate)
        x, y, z = rate.tolist()
        lever_x, lever_y, lever_z = self._imu_lever.tolist()
        force_x, force_y, force_z = (self._imu_to_base @ imu.linear_acceleration).tolist()
        centripetal = x * along - lever_x * square, y * along - lever_y * square, z * along - lever_z * square
        return (x, y, z), (force_x - centripetal[0], force_y - centripetal[1], force_z - centripetal[2])

    def _roll_pitch(self, orientation_imu_in_map: FloatArray) -> tuple[float, float]:
        x, y, z, w = orientation_imu_in_map.tolist()
        up = 2.0 * z * x - 2.0 * y * w, 2.0 * z * y + 2.0 * x * w, 1.0 - (2.0 * x * x + 2.0 * y * y)  # in the IMU
        x_up, y_up, z_up = (row[0] * up[0] + row[1] * up[1] + row[2] * up[2] for row in self._imu_to_base.tolist())
        return math.atan2(y_up, z_up), math.asin(min(max(-x_up, -1.0), 1.0))
