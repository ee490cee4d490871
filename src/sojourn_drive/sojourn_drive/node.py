"""Node of the drive: goals and measurements in, odometry and wheel commands out, by the laws in
`sojourn_mechanics.steering`.
"""

import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from rclpy.context import Context

from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import status_values
from sojourn_contract.node import ContractNode
from sojourn_contract.topics import topic
from sojourn_drive.arm_interlock import ArmInterlock
from sojourn_drive.charge import ChargeGauge
from sojourn_drive.clouds import Clouds, eye_of
from sojourn_drive.goals import GoalDesk
from sojourn_drive.measurements import WheelMeasurements
from sojourn_drive.reports import OdometryReport, drive_report
from sojourn_drive.sun import SunSightings
from sojourn_mechanics.errors import MechanicsError
from sojourn_mechanics.steering.drive import LONGEST_PERIOD, DriveModel
from sojourn_mechanics.steering.drive_types import DriveOutput, TwistCommand
from sojourn_mechanics.steering.goal import Goal
from sojourn_mechanics.steering.kinematics import PlanarTwist


class DriveNode(ContractNode):
    """Role drive."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        super().__init__("drive", context=context, overrides=overrides, namespace=namespace)
        scenario = load_scenario(self.scenario_name, self.scenario_overrides)
        start = scenario.config.start
        self.model = DriveModel(
            scenario.drive, scenario.steering, eye_of(scenario), scenario.terrain.bounds, scenario.wheel_loads()
        )
        self.model.warm_up()
        self.state = self.model.initial_state(start.x, start.y, start.yaw)
        self._measurements = WheelMeasurements(scenario.rover, scenario.urdf_xml)
        self._sun = SunSightings(scenario)
        self._clouds = Clouds()
        self._charge = ChargeGauge(scenario.power_manager)
        self._goals = GoalDesk(scenario.terrain)
        self._interlock = ArmInterlock(scenario.arm)
        self._twist: tuple[int, PlanarTwist] | None = None
        self._power_limit = 1.0
        self._last: int | None = None
        self._pending: Goal | None = None
        """A goal that waits for the first period whose measurements can be used."""
        self._output = self.model.at_rest(self.state)
        self._odometry = OdometryReport()

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """One step of the drive, with the measurements of this period."""
        switches = inputs.get("/power/switches")
        if switches is not None:
            self._power_limit = self._measurements.power_limit(status_values(switches), self._power_limit)
        self._interlock.hear(inputs["/joint_states"], driving=self.state.mode != "idle")
        self._charge.hear(inputs.get("/battery_state"))
        self._take_goals(goals)
        output = self._step(stamp, inputs)
        self._goals.note(output.outcomes)
        self.publish("/wheel_command", self._measurements.command(stamp, output))  # first: the plant waits for it
        self.publish("/odom", self._odometry.message(stamp, output, self._measurements.tilt_rates))
        if is_due(topic("/drive/status"), stamp // stamps.CONTROL_PERIOD_NS):
            self.publish("/drive/status", drive_report(stamp, self._goals.status(self.state), output))

    def _step(self, stamp: int, inputs: Mapping[str, Any]) -> DriveOutput:
        """The drive's answer to this period. Where a measurement cannot be used the wheels stop and the
        steering holds.
        """
        joints, imu = inputs["/joint_states"], inputs["/imu/data"]
        if joints is not None and imu is not None:  # None: refused on arrival
            try:
                sun = self._sun.sighting(stamp, inputs.get("/sun_direction"))
                measured = self._measurements.drive_input(
                    joints, imu, self._twist_command(stamp), self._pending, self._power_limit, sun
                )
                cloud = self._clouds.points(inputs.get("/hazcam/points"))
                measured = replace(measured, supply=self._charge.supply, cloud=cloud)
                if self._interlock.reason:
                    measured = replace(measured, goal=None, stop=True, stop_reason=self._interlock.reason)
                if self._last is None and stamp > stamps.CONTROL_PERIOD_NS and self.model.slip is not None:
                    self.state = replace(self.state, slip=self.model.slip.initial_state(at_rest=False))
                self.state, self._output = self.model.step(self.state, measured, self._since_last(stamp))
                self._last, self._pending = stamp, None
                return self._output
            except (MechanicsError, RefusedMessageError) as error:
                self.refuse("/joint_states", error)
        return replace(
            self._output,
            wheel_rates=np.zeros_like(self._output.wheel_rates),
            steer_rates=np.zeros_like(self._output.steer_rates),
            outcomes=(),
        )

    def _since_last(self, stamp: int) -> float:
        """Time since the last period with measurements [s]: of a node that has just started one period, of
        a gap its end.
        """
        if self._last is None:
            return stamps.CONTROL_PERIOD_S
        return min((stamp - self._last) * 1e-9, LONGEST_PERIOD)

    def _take_goals(self, goals: list[tuple[str, Any]]) -> None:
        """Keep the goal that takes effect now; of several the last."""
        for name, message in goals:
            if self._interlock.reason:
                self.refuse(name, self._goals.refused(name, message, self._interlock.reason))
                continue
            if name == "/cmd_vel":
                linear, angular = message.twist.linear, message.twist.angular
                stamp = stamps.from_message(message.header.stamp) or self.now
                self._twist = (stamp, PlanarTwist(linear.x, linear.y, angular.z))
                self._goals.pre_empted(stamp, unseen=self._pending is not None)
                self._pending = None
                continue
            try:
                self._pending = self._goals.goal(name, message, self.state.odometry)
            except RefusedMessageError as refusal:
                self.refuse(name, refusal)

    def _twist_command(self, stamp: int) -> TwistCommand | None:
        if self._twist is None:
            return None
        sent, twist = self._twist
        return TwistCommand(twist, max(stamp - sent, 0) * 1e-9)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(DriveNode))


if __name__ == "__main__":
    main()
