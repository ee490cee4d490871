"""Node of the sensors: truth in, measurements out, from the emulators of `sojourn_mechanics.sensors`."""

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
from rclpy.context import Context
from sensor_msgs.msg import Imu

from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.clouds import point_cloud
from sojourn_contract.messages import (
    battery_readings,
    battery_state,
    fill_joint_state,
    joint_state,
    numbers,
    quaternion,
    set_quaternion,
    set_xyz,
    wrench_stamped,
    wrench_values,
)
from sojourn_contract.node import ContractNode
from sojourn_contract.topics import topic
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.sensors import suite
from sojourn_sensors.motion import ImuMotion
from sojourn_sensors.sun import SunReadings
from sojourn_sensors.view import HazardView

STORE = "battery"
NOT_MEASURED = float("nan")


class SensorsNode(ContractNode):
    """Role sensors."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        super().__init__("sensors", context=context, overrides=overrides, namespace=namespace)
        scenario = load_scenario(self.scenario_name, self.scenario_overrides)
        self.params = scenario.sensors
        self._seed = scenario.config.seed
        self._gravity = scenario.gravity
        self._motion = ImuMotion(scenario.urdf_xml, scenario.gravity)
        self._sun = SunReadings(scenario)
        self._view = HazardView(scenario)
        suite.warm_up(self.params, self._gravity)
        self.state: suite.SensorSuiteState | None = None
        """None until the first truth says which joints there are and how the machine stands."""
        self._electrical = (0.0, 0.0, 293.15)
        self._last = 0
        self._motor_places: list[int] | None = None
        self._joints = joint_state(())
        self._imu = Imu()
        self._imu.header.frame_id = "imu_link"
        self._wrist_frame = scenario.rover.wrench_sensor_link or ""

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Measure the truth of this period."""
        odometry, joints = inputs["/truth/odom"], inputs["/truth/joint_states"]
        if odometry is None or joints is None:  # refused: nothing to measure
            return
        electrical = inputs.get("/truth/electrical")
        if electrical is not None:
            self._electrical = battery_readings(electrical)
        dt = (stamp - self._last) * 1e-9 if self.state is not None else stamps.CONTROL_PERIOD_S
        self._last = stamp
        motion = self._motion.update(odometry, dt)
        positions = numbers(joints.position)
        motors = self._motor_positions(joints, positions, inputs.get("/truth/motor_states"))
        wrist = inputs.get("/truth/wrist_wrench")
        if self.state is None:
            self.state = self._first_state(odometry, joints, motors)
        voltage, current, temperature = self._electrical
        truth = suite.SensorTruth(
            joint_position=positions,
            joint_effort=numbers(joints.effort),
            angular_velocity_imu_in_imu=motion.angular_velocity,
            specific_force_imu_in_imu=motion.specific_force,
            bus_voltage=np.array([voltage]),
            bus_current=np.array([current]),
            bus_temperature=np.array([temperature]),
            motor_position=motors,
            wrist_wrench=None if wrist is None else wrench_values(wrist),
        )
        self.state, measured = suite.step(self.params, self.state, truth, dt)
        if electrical is not None and is_due(topic("/bus/state"), stamp // stamps.CONTROL_PERIOD_NS):
            self.publish(
                "/bus/state",
                battery_state(
                    stamp,
                    measured.bus_voltage[0],
                    measured.bus_current[0],
                    measured.bus_temperature[0],
                    NOT_MEASURED,
                    NOT_MEASURED,
                    NOT_MEASURED,
                ),
            )
        self.publish(
            "/joint_states",
            fill_joint_state(
                self._joints, stamp, measured.joint_position, measured.joint_velocity, measured.joint_effort
            ),
        )
        if self.gives("/wrist/wrench"):
            self.publish("/wrist/wrench", wrench_stamped(stamp, self._wrist_frame, measured.wrist_wrench))
        if is_due(topic("/sun_direction"), stamp // stamps.CONTROL_PERIOD_NS):
            self.publish("/sun_direction", self._sun.message(stamp, odometry))
        self.publish("/imu/data", self._imu_message(stamp, measured.imu))
        if is_due(topic("/hazcam/points"), stamp // stamps.CONTROL_PERIOD_NS):
            self.publish("/hazcam/points", point_cloud(stamp, "base_link", self._view.look(odometry)))

    def _motor_positions(self, joints: Any, positions: FloatArray, motors: Any) -> FloatArray | None:
        """Angle of each joint's motor over its gear [rad], the joint's own where nothing is said; None if of none."""
        if motors is None or not motors.name:
            return None
        if self._motor_places is None:
            names = list(joints.name)
            self._motor_places = [names.index(name) for name in motors.name]
        found = positions.copy()
        found[self._motor_places] = motors.position
        return found

    def _first_state(self, odometry: Any, joints: Any, motors: FloatArray | None) -> suite.SensorSuiteState:
        state = suite.initial_state(
            self.params,
            self._seed,
            tuple(joints.name),
            numbers(joints.position),
            (STORE,),
            self._motion.orientation_imu_in_map(quaternion(odometry.pose.pose.orientation)),
            self._gravity,
            motors,
        )
        self._joints = joint_state(state.layout.joint_names)
        return state

    def _imu_message(self, stamp: int, reading: Any) -> Imu:
        imu = self._imu
        imu.header.stamp = stamps.to_message(stamp)
        set_quaternion(imu.orientation, reading.orientation)
        set_xyz(imu.angular_velocity, reading.angular_velocity)
        set_xyz(imu.linear_acceleration, reading.specific_force)
        imu.orientation_covariance = np.diag(reading.orientation_variance).ravel()
        imu.angular_velocity_covariance = np.diag(reading.angular_velocity_variance).ravel()
        imu.linear_acceleration_covariance = np.diag(reading.specific_force_variance).ravel()
        return imu


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(SensorsNode))


if __name__ == "__main__":
    main()
