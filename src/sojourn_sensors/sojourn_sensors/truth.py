"""What the plant's messages say of a period, as the emulators take it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.messages import battery_readings, wrench_of
from sojourn_contract.values import JointState
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.suite import SensorTruth
from sojourn_sensors.motion import ImuMotion, MotionBefore


@dataclass(frozen=True, slots=True)
class TruthBefore:
    """What is remembered: the motion of the period before, and the last word of what comes less than once a period."""

    motion: MotionBefore | None = None
    electrical: tuple[float, float, float] = (0.0, 0.0, 293.15)
    """Voltage [V], current [A], temperature [K] of the battery."""


class TruthReader:
    """Reads the truth.

    Args:
        motion: what an ideal IMU feels, from the motion of the base.
    """

    def __init__(self, motion: ImuMotion) -> None:
        self._motion = motion
        self._motors: tuple[tuple[str, ...], JointPlaces] | None = None
        """Names and places of the motors: looked up again when the names change, so no memory of the run."""

    def read(self, before: TruthBefore, inputs: Mapping[str, Any], dt: float) -> tuple[TruthBefore, SensorTruth]:
        """Truth at the end of a period of `dt` [s], from /truth/odom, /truth/joint_states and what came with them."""
        odometry, joints = inputs["/truth/odom"], inputs["/truth/joint_states"]
        electrical, wrist = inputs.get("/truth/electrical"), inputs.get("/truth/wrist_wrench")
        known = before.electrical if electrical is None else battery_readings(electrical)
        voltage, current, temperature = known
        moved, motion = self._motion.felt(before.motion, odometry, dt)
        positions = joints.position
        truth = SensorTruth(
            joint_position=positions,
            joint_effort=joints.effort,
            angular_velocity_imu_in_imu=motion.angular_velocity,
            specific_force_imu_in_imu=motion.specific_force,
            bus_voltage=np.array([voltage]),
            bus_current=np.array([current]),
            bus_temperature=np.array([temperature]),
            motor_position=self._motor_positions(joints, positions, inputs.get("/truth/motor_states")),
            wrist_wrench=None if wrist is None else wrench_of(wrist),
        )
        return TruthBefore(moved, known), truth

    def _motor_positions(
        self, joints: JointState, positions: FloatArray, motors: JointState | None
    ) -> FloatArray | None:
        """Angle of each joint's motor over its gear [rad], the joint's own where nothing is said; None if of none."""
        if motors is None or not motors.names:
            return None
        if self._motors is None or self._motors[0] != motors.names:
            self._motors = (motors.names, JointPlaces("/truth/joint_states", motors.names))
        found = positions.copy()
        found[self._motors[1].places(joints)] = motors.position
        return found
