"""Node of the arm: goals and measurements in, joint references and feed-forward out, by the laws in
`sojourn_mechanics.arm`.
"""

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
from rclpy.context import Context

from sojourn_arm.command import fill_command
from sojourn_arm.goals import GoalDesk
from sojourn_arm.ground import Ground
from sojourn_arm.measurements import Measurements
from sojourn_arm.rover import ODOMETRY, Rover
from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.messages import doubles, joint_state
from sojourn_contract.node import ContractNode
from sojourn_contract.switches import fraction_of
from sojourn_contract.topics import topic
from sojourn_mechanics.arm.goals import ArmGoal
from sojourn_mechanics.arm.model import build_arm_model
from sojourn_mechanics.arm.state import ArmInput, ArmOutput
from sojourn_mechanics.arm.tasks import task_control
from sojourn_mechanics.arm.tasks.requests import TaskRequest

ARM_LOAD = "arm"


class ArmNode(ContractNode):
    """Role arm."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        raw = frozenset({ODOMETRY})
        super().__init__("arm", context=context, overrides=overrides, namespace=namespace, raw_topics=raw)
        scenario = load_scenario(self.scenario_name, self.scenario_overrides)
        self.params = scenario.carried_arm()
        self.model = build_arm_model(scenario.urdf_xml, self.params)
        task_control.warm_up(self.params, self.model)
        self.state = task_control.initial_state(self.params, self.model, scenario.tool)
        self._measurements = Measurements(self.params.joint_names, scenario.urdf_xml, scenario.gravity, self.refuse)
        self._rover = Rover(self.params.interlock, [wheel.joint for wheel in scenario.rover.wheels])
        wheels = [(wheel.joint, wheel.radius + wheel.grouser_height) for wheel in scenario.rover.wheels]
        self._ground = Ground(self.params, scenario.urdf_xml, wheels)
        self._goals = GoalDesk(self.params, self._rover)
        self._powered = True
        self._rated_power = next((load.power_w for load in scenario.bus.loads if load.name == ARM_LOAD), 0.0)
        self._granted = 1.0
        """Share of its power, and of each motor's current, that the power manager lets the arm draw."""
        self._pending: ArmGoal | TaskRequest | None = None
        """A goal that waits for the first period whose measurements can be used."""
        self._output: ArmOutput | None = None
        self._command = joint_state(())
        """Empty until the first measurement says where the arm is: a command of no joint."""

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """One step of the arm's control, with the measurements of this period."""
        switches = inputs.get("/power/switches")
        if switches is not None:
            fraction = fraction_of(status_values(switches).get(ARM_LOAD, "on"))
            self._powered = fraction != 0.0
            self._granted = 1.0 if fraction is None else fraction
        self._rover.hear(inputs)
        self._take_goals(goals)
        self._step(inputs["/joint_states"], inputs["/imu/data"], inputs.get("/wrist/wrench"))
        if is_due(topic("/arm/status"), stamp // stamps.CONTROL_PERIOD_NS):
            values = self._goals.status(self._output)
            level = 1 if values["state"] in ("refused", "failed") else 0
            self.publish(
                "/arm/status",
                status_message(stamp, "arm", values, values["reason"] or values["state"], level),
            )
        self._command.header.stamp = stamps.to_message(stamp)
        self.publish("/arm_command", self._command)

    def _step(self, joints: Any, imu: Any, wrist: Any) -> None:
        """Form the command of this period. Where a measurement cannot be used the arm holds where it was
        last sent.
        """
        measured = self._measurements.read(joints, imu, wrist)
        if measured is None:
            self._command.velocity = doubles(np.zeros(len(self._command.name)))
            return
        if self._pending is not None:
            self._ground.look(joints)
        why_not = self._rover.why_not_allowed if self._powered else "the power manager has switched the arm off"
        goal, task = (None, self._pending) if isinstance(self._pending, TaskRequest) else (self._pending, None)
        request = ArmInput(
            positions=measured.positions,
            velocities=measured.velocities,
            gravity_in_base=measured.gravity,
            goal=goal,
            allowed=not why_not,
            not_allowed_reason=why_not,
            ground=self._ground.plane,
            granted_power=None if self._granted == 1.0 else self._granted * self._rated_power,
            granted_current=self._granted,
        )
        tasks = task_control.TaskInput(request, task, measured.wrench, measured.efforts, measured.tool)
        self.state, self._output, report = task_control.step(
            self.params, self.model, self.state, tasks, stamps.CONTROL_PERIOD_S
        )
        self._goals.note(self._output, report, self._pending is not None)
        self._pending = None
        fill_command(self._command, self.params.joint_names, self._output, self.state)

    def _take_goals(self, goals: list[tuple[str, Any]]) -> None:
        """Keep the goal that takes effect now; of several the last."""
        for name, message in goals:
            try:
                self._pending = self._goals.goal(name, message)
            except RefusedMessageError as refusal:
                self.refuse(name, refusal)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(ArmNode))


if __name__ == "__main__":
    main()
