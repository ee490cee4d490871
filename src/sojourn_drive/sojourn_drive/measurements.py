"""Measured joints and IMU as the drive's input, and its output as a command to the joints."""

import math
from collections.abc import Sequence

from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.switches import fraction_of
from sojourn_contract.values import Imu, JointState
from sojourn_flight.mobility.mobility import NOT_MEASURED, InertialMeasurement, MobilityJoints, Triple
from sojourn_flight.supervision.drive_types import DriveInput, DriveOutput
from sojourn_machine.machine import MachineParams
from sojourn_machine.mounting import IMU_LINK, mounting
from sojourn_machine.params import FloatArray


class JointMeasurements:
    """Maps the joints of messages to those of the mobility and back.

    Args:
        machine: whose drives say which loads feed them. joints: of the mobility, in its order.
        urdf_xml: the machine, with a link `imu_link`.
    """

    def __init__(self, machine: MachineParams, joints: Sequence[str], urdf_xml: str) -> None:
        self._joints = tuple(joints)
        self._places = JointPlaces("/joint_states", self._joints)
        self.loads = machine.loads_of(self._joints)
        """Without which the rover does not move."""
        self._imu_to_base, self._imu_lever = mounting(urdf_xml, IMU_LINK)

    def drive_input(self, joints: JointState, imu: Imu) -> DriveInput:
        """Input of the drive's step. Raises RefusedMessageError if a joint is missing."""
        places = self._places.places(joints)
        effort = joints.effort[places] if len(joints.effort) else NOT_MEASURED
        measured = MobilityJoints(joints.position[places], joints.velocity[places], effort)
        gyro, force = self._felt(imu)
        felt = InertialMeasurement(gyro, force, self._roll_pitch(imu.orientation), float(self._imu_lever[0]))
        return DriveInput(measured, felt)

    def command(self, stamp: int, output: DriveOutput) -> JointState:
        """The references of all joints that move the machine."""
        return JointState(stamp, self._joints, *output.references)

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
