"""Node of the scripted operator: sends the goals of a scenario over the topics that any operator uses.

In lock-step it looks at the machine every fifth period, stamps its goals five periods ahead and then says with a tick
how many it has sent; drive, arm and plant wait for that tick, and so a scripted run is the same every time.
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.serialization import deserialize_message
from std_msgs.msg import Header

from sojourn_bringup.goal_messages import goal_message, report_of
from sojourn_bringup.ground import ground_point
from sojourn_bringup.operator_script import (
    Action,
    ArmGround,
    ArmTo,
    OperatorScript,
    Report,
    StepResult,
    results_as_data,
    results_from_data,
)
from sojourn_bringup.scenario_steps import script_steps
from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.events import format_tick
from sojourn_contract.heartbeat import status_values
from sojourn_contract.messages import quaternion, xyz
from sojourn_contract.node import ContractNode
from sojourn_contract.topics import topic

_STATUSES = {"/drive/status": "drive", "/arm/status": "arm"}
_LOOK_NS = topic("/operator/tick").every * stamps.CONTROL_PERIOD_NS


class OperatorNode(ContractNode):
    """Role operator. Parameter `result_file`: where to write what became of each step ("" for nowhere)."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        super().__init__(
            "operator",
            context=context,
            overrides=overrides,
            namespace=namespace,
            raw_topics=frozenset({"/truth/odom"}),
        )
        self._result_file: str = self.declare_parameter("result_file", "").value
        scenario = load_scenario(self.scenario_name, self.scenario_overrides)
        self.script = OperatorScript(script_steps(scenario), scenario.config.duration_limit_s, self._earlier_results())
        needs_ground = any(isinstance(action, ArmGround) for action, _ in self.script.steps)
        self._terrain = scenario.height_field() if needs_ground else None
        self._truth = b""
        self._reports: dict[str, Report] = {}
        self._sent: dict[str, int] = {}
        self._looked = 0
        self._said_end = False
        self.drive_status: dict[str, str] = {}
        """Latest status of the drive, for whoever shows the progress."""

    @property
    def results(self) -> list[StepResult]:
        """What became of the steps so far."""
        return self.script.results

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Keep the latest reports; at every fifth period let the script look at them."""
        truth = inputs.get("/truth/odom")
        if truth is not None:
            self._truth = truth
        for name, who in _STATUSES.items():
            status = inputs.get(name)
            if status is not None:
                self._reports[who] = report_of(status)
                if who == "drive":
                    self.drive_status = status_values(status)
        if stamp // _LOOK_NS == self._looked // _LOOK_NS:
            return
        self._looked = stamp
        if self._said_end:
            return
        known = len(self.results)
        goal = self.script.look(stamp, self._reports)
        if goal is not None:
            self.publish(goal.topic, goal_message(self._looked_up(goal.action), goal.stamp))
            self._sent[goal.topic] = self._sent.get(goal.topic, 0) + 1
        if len(self.results) > known:
            self._write_results()
        if self.script.finished and not self.script.succeeded:
            self.exit_status = 1
        self._said_end = self.script.finished
        tick = format_tick(self._sent, self._said_end)
        self.publish("/operator/tick", Header(stamp=stamps.to_message(stamp), frame_id=tick))

    def heartbeat_values(self) -> dict[str, str]:
        """Where in the script it is."""
        return {"step": self.script.position, "steps done": f"{len(self.results)} of {len(self.script.steps)}"}

    def _looked_up(self, action: Action) -> Action:
        """The action with its place in numbers.

        The ground is looked up in the scenario's terrain from the true pose, as a person would pick a target in the
        picture of the stereo cameras.
        """
        if not isinstance(action, ArmGround) or self._terrain is None:
            return action
        here = deserialize_message(self._truth, Odometry).pose.pose
        x, y, z = ground_point(self._terrain, xyz(here.position), quaternion(here.orientation), action)
        return ArmTo(x, y, z)

    def _earlier_results(self) -> list[StepResult]:
        """Steps that an operator of this run had finished before it died."""
        file = Path(self._result_file)
        if not self._result_file or not file.is_file():
            return []
        return results_from_data(json.loads(file.read_text(encoding="utf-8")))

    def _write_results(self) -> None:
        if self._result_file:
            file = Path(self._result_file)
            fresh = file.with_suffix(".new")
            fresh.write_text(json.dumps(results_as_data(self.results), indent=2) + "\n", encoding="utf-8")
            fresh.replace(file)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(OperatorNode))


if __name__ == "__main__":
    main()
