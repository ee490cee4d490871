"""Node of the plant: the simulated machine and its ground. It owns /clock and, in lock-step, the pace of everybody.

The start: it waits until all participants say that they are ready, then publishes the truth of the first period. At each
period it waits for the commands stamped with it (lock-step) or for the wall clock (real time), steps the machine, and
publishes the truth of the next.
"""

import sys
import time
from collections.abc import Mapping
from typing import Any

from rclpy.context import Context

from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.checks import check_message, check_names
from sojourn_contract.errors import DomainInUseError, SilentNodeError
from sojourn_contract.events import parse_tick
from sojourn_contract.heartbeat import READY, STALLED, read_heartbeats, status_values
from sojourn_contract.node import ContractNode
from sojourn_contract.topics import Topic
from sojourn_mechanics.plant.state import PlantState
from sojourn_mechanics.plant.step import step
from sojourn_plant.commands import CommandBuffer
from sojourn_plant.start import build_plant
from sojourn_plant.truth import TruthMessages

FREE_RUN_S = 0.02
"""Wall time for which a plant that nobody answers runs between two looks at its messages."""


class PlantNode(ContractNode):
    """Role plant."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        super().__init__("plant", context=context, overrides=overrides, namespace=namespace, every_period=True)
        scenario = load_scenario(self.scenario_name, self.scenario_overrides)
        self.model, self.state = build_plant(scenario)
        self.ends_the_run = True
        self._commands = CommandBuffer(self.model)
        self._commands.hold(self.state.joints[0])
        self._truth = TruthMessages(self.model)
        self._ready: set[str] = set()
        self._stalled: dict[str, str] = {}
        self._begun = False
        self._waiting_since = time.monotonic()
        self._trigger = ""
        self._timer: Any = None
        self._reported: set[str] = set()

    def on_heartbeat(self, message: Any) -> None:
        """Keep who is ready, and who says that it waits for whom."""
        for beat in read_heartbeats(message):
            if beat.state == READY:
                self._ready.add(beat.role)
            if beat.state == STALLED:
                self._stalled[beat.role] = beat.values.get("waiting for role", "")

    def poll(self) -> None:
        """Begin the run when everybody is ready; say who is silent when somebody is."""
        super().poll()
        if self.finished:
            return
        if not self._begun:
            self._begin_when_ready()
        elif self.lockstep and not self._awaited:
            until = time.monotonic() + FREE_RUN_S
            while time.monotonic() < until:
                self.act(self.now + stamps.CONTROL_PERIOD_NS, {})
        elif self.lockstep and time.monotonic() - self._waiting_since > self.timeout_s:
            self._stop_for_silence()

    def check(self, row: Topic, message: Any) -> None:
        """Refuse commands with unknown joints, and in real time those older than what has come already."""
        check_message(row.name, message)
        if row.type == "sensor_msgs/JointState":
            check_names(row.name, message.name, self.model.joint_index)
        if row.name == "/power/switches":
            self._commands.check_switches(row.name, status_values(message))
        if not self.lockstep and row.type != "std_msgs/Header":
            stamp = stamps.from_message(message.header.stamp)
            self._commands.check_order(row, stamp, self.now)

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Take the commands of this period, step the machine, publish the truth of the next."""
        self._waiting_since = time.monotonic()
        tick = inputs.get("/operator/tick")
        if tick is not None and parse_tick(tick.frame_id)[1]:
            self.finished = True
            return
        self._commands.take(inputs)
        self.state, output = step(self.model, self.state, self._commands.at(stamp))
        self._report_events(self.state)
        self._publish(self._truth.messages(stamp + stamps.CONTROL_PERIOD_NS, self.state, output))

    def heartbeat_values(self) -> dict[str, str]:
        """Events of the machine and lost commands."""
        return {
            "rolled over": str(self.state.rolled_over).lower(),
            "off the terrain": str(self.state.off_terrain).lower(),
            "lost commands": ", ".join(self._commands.lost),
        }

    def _begin_when_ready(self) -> None:
        if self.count_publishers(self._senders["/clock"].topic_name) > 1:
            self._fail(DomainInUseError(str(self.context.get_domain_id()), self._senders["/clock"].topic_name))
            return
        missing = set(self.participants) - self._ready - {self.role}
        if self.unmatched() or missing:
            if time.monotonic() - self._waiting_since > 3 * self.timeout_s and missing:
                self._fail(SilentNodeError(sorted(missing)[0], "/diagnostics", 0.0, 3 * self.timeout_s))
            return
        self._begun = True
        self._waiting_since = self._last_progress = time.monotonic()
        self._publish(self._truth.first(stamps.CONTROL_PERIOD_NS, self.state))
        if not self.lockstep:
            self._timer = self.create_timer(stamps.CONTROL_PERIOD_S, self._act_in_real_time)

    def _act_in_real_time(self) -> None:
        self.act(self.now + stamps.CONTROL_PERIOD_NS, self._latest)

    def _stop_for_silence(self) -> None:
        """Name the node at the root: the one that is missing and does not say that it waits for another."""
        missing = self.barrier.missing()
        row = missing[0]
        role, seen = row.publisher, set()
        while role in self._stalled and role not in seen and self._stalled[role]:
            seen.add(role)
            role = self._stalled[role]
        self._fail(SilentNodeError(role, row.name, stamps.seconds(self.barrier.stamp), self.timeout_s))

    def _fail(self, error: Exception) -> None:
        self.get_logger().error(str(error))
        self.exit_status = 1
        self.finished = True
        self.failure = str(error)

    def _report_events(self, state: PlantState) -> None:
        for flag, text in (("rolled_over", "the rover has rolled over"), ("off_terrain", "the rover has left the terrain")):
            if getattr(state, flag) and flag not in self._reported:
                self._reported.add(flag)
                self.get_logger().error(f"{text} at {stamps.seconds(self.now):.2f} s")

    def _publish(self, messages: list[tuple[str, Any]]) -> None:
        for topic, message in messages:
            self.publish(topic, message)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(PlantNode))


if __name__ == "__main__":
    main()
