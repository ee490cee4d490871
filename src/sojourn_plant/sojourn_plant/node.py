"""Node of the plant: the simulated machine and its ground. It owns /clock, see `pacing`.

At each period it takes the commands stamped with it (lock-step) or the latest (real time), steps the machine, and
publishes the truth of the next.
"""

import sys
from collections.abc import Iterable, Mapping
from typing import Any

from rclpy.context import Context

from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.events import parse_tick
from sojourn_contract.topic_types import Topic
from sojourn_mechanics.plant.faults import MotorFaults
from sojourn_mechanics.plant.state import PlantState
from sojourn_mechanics.plant.step import step
from sojourn_plant.commands import COMMANDS, CommandBuffer
from sojourn_plant.pacing import PacingNode
from sojourn_plant.start import build_plant
from sojourn_plant.truth import TruthMessages


class PlantNode(PacingNode):
    """Role plant."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        super().__init__("plant", context=context, overrides=overrides, namespace=namespace)
        scenario = load_scenario(self.scenario_name, self.scenario_overrides)
        self.model, self.state = build_plant(scenario)
        self._commands = CommandBuffer(self.model)
        self._commands.hold(self.state.motor_angles)
        self._faults = MotorFaults(self.model, scenario.config.faults)
        self._truth = TruthMessages(self.model)
        self._reported: set[str] = set()

    def check(self, row: Topic, message: Any) -> None:
        """Refuse commands that the machine cannot follow."""
        super().check(row, message)
        if row.name in COMMANDS:
            self._commands.check(row, message)

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Take the commands of this period, step the machine, publish the truth of the next."""
        tick = inputs.get("/operator/tick")
        if tick is not None and parse_tick(tick.frame_id)[1]:
            self.finished = True
            return
        self._commands.take(inputs)
        command = self._faults.on(self._commands.at(stamp), self.state.joints[0], stamps.seconds(stamp))
        self.state, output = step(self.model, self.state, command)
        self._report_events(self.state)
        self.publish_all(self._truth.messages(stamp + stamps.CONTROL_PERIOD_NS, self.state, output))

    def heartbeat_values(self) -> dict[str, str]:
        """Events of the machine, motors that have failed by the scenario, and lost commands."""
        faults = [f"{fault.joint} {fault.kind}" for fault in self._faults.acting(stamps.seconds(self.now))]
        return {
            "faults": ", ".join(faults),
            "rolled over": str(self.state.rolled_over).lower(),
            "off the terrain": str(self.state.off_terrain).lower(),
            "lost commands": ", ".join(self._commands.lost),
        }

    def _report_events(self, state: PlantState) -> None:
        for flag, text in (
            ("rolled_over", "the rover has rolled over"),
            ("off_terrain", "the rover has left the terrain"),
        ):
            if getattr(state, flag) and flag not in self._reported:
                self._reported.add(flag)
                self.get_logger().error(f"{text} at {stamps.seconds(self.now):.2f} s")

    def first_messages(self, stamp: int) -> Iterable[tuple[str, Any]]:
        """Truth of the machine as it stands."""
        return self._truth.first(stamp, self.state)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(PlantNode))


if __name__ == "__main__":
    main()
