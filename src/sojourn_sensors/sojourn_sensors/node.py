"""Node of the sensors: truth in, measurements out, from the emulators of `sojourn_mechanics.sensors`."""

import sys
from collections.abc import Mapping
from typing import Any

from rclpy.context import Context

from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.clouds import point_cloud
from sojourn_contract.messages import quaternion, wrench_stamped
from sojourn_contract.node import ContractNode
from sojourn_contract.topics import topic
from sojourn_mechanics.sensors import suite
from sojourn_sensors.motion import ImuMotion
from sojourn_sensors.readings import ReadingMessages, bus_message
from sojourn_sensors.sun import SunReadings
from sojourn_sensors.truth import TruthReader
from sojourn_sensors.view import HazardView

STORE = "battery"
BUS, SUN, CLOUD = topic("/bus/state"), topic("/sun_direction"), topic("/hazcam/points")


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
        self._truth = TruthReader(self._motion)
        self._sun = SunReadings(scenario)
        self._view = HazardView(scenario)
        suite.warm_up(self.params, self._gravity)
        self.state: suite.SensorSuiteState | None = None
        """None until the first truth says which joints there are and how the machine stands."""
        self._readings = ReadingMessages(())
        self._last = 0
        self._wrist_frame = scenario.rover.wrench_sensor_link or ""

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Measure the truth of this period."""
        odometry, joints = inputs["/truth/odom"], inputs["/truth/joint_states"]
        if odometry is None or joints is None:  # refused: nothing to measure
            return
        dt = (stamp - self._last) * 1e-9 if self.state is not None else stamps.CONTROL_PERIOD_S
        self._last = stamp
        truth = self._truth.read(inputs, dt)
        if self.state is None:
            self.state = self._first_state(odometry, joints, truth)
        self.state, measured = suite.step(self.params, self.state, truth, dt)
        period = stamp // stamps.CONTROL_PERIOD_NS
        if inputs.get("/truth/electrical") is not None and is_due(BUS, period):
            self.publish("/bus/state", bus_message(stamp, measured))
        self.publish("/joint_states", self._readings.joints(stamp, measured))
        if self.gives("/wrist/wrench"):
            self.publish("/wrist/wrench", wrench_stamped(stamp, self._wrist_frame, measured.wrist_wrench))
        if is_due(SUN, period):
            self.publish("/sun_direction", self._sun.message(stamp, odometry))
        self.publish("/imu/data", self._readings.imu(stamp, measured.imu))
        if is_due(CLOUD, period):
            self.publish("/hazcam/points", point_cloud(stamp, "base_link", self._view.look(odometry)))

    def _first_state(self, odometry: Any, joints: Any, truth: suite.SensorTruth) -> suite.SensorSuiteState:
        state = suite.initial_state(
            self.params,
            self._seed,
            tuple(joints.name),
            truth.joint_position,
            (STORE,),
            self._motion.orientation_imu_in_map(quaternion(odometry.pose.pose.orientation)),
            self._gravity,
            truth.motor_position,
        )
        self._readings = ReadingMessages(state.layout.joint_names)
        return state


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(SensorsNode))


if __name__ == "__main__":
    main()
