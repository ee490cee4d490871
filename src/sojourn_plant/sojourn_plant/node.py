"""Node of the plant: the simulated machine and its ground. It owns /clock and, in lock-step, the pace of
everybody.

The start: it waits until all participants say that they are ready, then publishes the truth of the first
period. At each period it waits for the commands stamped with it (lock-step) or for the wall clock (real
time), steps the machine, and publishes the truth of the next.
"""

import sys
import time
from collections.abc import Iterable, Mapping
from typing import Any

from rclpy.context import Context

from sojourn_config.scenario import load_scenario
from sojourn_contract import process, stamps
from sojourn_contract.errors import DomainInUseError, SilentNodeError
from sojourn_contract.events import parse_tick
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.node import ContractNode
from sojourn_contract.topic_types import Topic
from sojourn_mechanics.plant.faults import MotorFaults
from sojourn_mechanics.plant.state import PlantState
from sojourn_mechanics.plant.step import step
from sojourn_plant.commands import COMMANDS, CommandBuffer
from sojourn_plant.roster import Roster
from sojourn_plant.start import build_plant
from sojourn_plant.truth import TruthMessages

DISCOVERY_S = 0.5
"""Wall time after its creation before which a plant does not begin: another one on its domain may not be
seen yet.
"""
AHEAD_S = 1.0
"""In real time a command stamped further ahead of the plant's own clock than this is refused: it would
never age.
"""
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
        self._created = time.monotonic()
        super().__init__("plant", context=context, overrides=overrides, namespace=namespace, every_period=True)
        scenario = load_scenario(self.scenario_name, self.scenario_overrides)
        self.model, self.state = build_plant(scenario)
        self.ends_the_run = True
        self._commands = CommandBuffer(self.model)
        self._commands.hold(self.state.motor_angles)
        self._faults = MotorFaults(self.model, scenario.config.faults)
        self._truth = TruthMessages(self.model)
        self.roster = Roster(self.role, self.participants, self.timeout_s)
        self._begun = False
        self._waiting_since = time.monotonic()
        self._trigger = ""
        self._timer: Any = None
        self._reported: set[str] = set()

    def on_heartbeat(self, message: Any) -> None:
        """Keep who is ready, and who says that it waits for whom."""
        self.roster.hear(read_heartbeats(message))

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
        """Refuse commands that the machine cannot follow."""
        super().check(row, message)
        if row.name in COMMANDS:
            self._commands.check(row, message)

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Take the commands of this period, step the machine, publish the truth of the next."""
        self._waiting_since = time.monotonic()
        tick = inputs.get("/operator/tick")
        if tick is not None and parse_tick(tick.frame_id)[1]:
            self.finished = True
            return
        self._commands.take(inputs)
        command = self._faults.on(self._commands.at(stamp), self.state.joints[0], stamps.seconds(stamp))
        self.state, output = step(self.model, self.state, command)
        self._report_events(self.state)
        self._publish(self._truth.messages(stamp + stamps.CONTROL_PERIOD_NS, self.state, output))

    def heartbeat_values(self) -> dict[str, str]:
        """Events of the machine, motors that have failed by the scenario, and lost commands."""
        faults = [f"{fault.joint} {fault.kind}" for fault in self._faults.acting(stamps.seconds(self.now))]
        return {
            "faults": ", ".join(faults),
            "rolled over": str(self.state.rolled_over).lower(),
            "off the terrain": str(self.state.off_terrain).lower(),
            "lost commands": ", ".join(self._commands.lost),
        }

    def _begin_when_ready(self) -> None:
        if self.count_publishers(self._senders["/clock"].topic_name) > 1:
            self._fail(DomainInUseError(str(self.context.get_domain_id()), self._senders["/clock"].topic_name))
            return
        waited = time.monotonic() - self._waiting_since
        unmatched = self.unmatched()
        if unmatched or self.roster.missing():
            if waited > 3 * self.timeout_s:
                self._fail(self.roster.not_ready(unmatched, waited))
            return
        if time.monotonic() - self._created < DISCOVERY_S:
            return
        self._begun = True
        self._waiting_since = self._last_progress = time.monotonic()
        self._publish(self._truth.first(stamps.CONTROL_PERIOD_NS, self.state))
        if not self.lockstep:
            self._timer = self.create_timer(stamps.CONTROL_PERIOD_S, self._act_in_real_time)
        self._advance()  # where nobody answers in the first period, no message would begin the run

    def _act_in_real_time(self) -> None:
        stamp = self.now + stamps.CONTROL_PERIOD_NS
        self.act(stamp, self._inputs_realtime(stamp))

    def _stop_for_silence(self) -> None:
        """Name the node at the root: the one that is missing and does not say that it waits for another."""
        row = self.barrier.missing()[0]
        role = self.roster.root_of_silence(row.publisher)
        self._fail(SilentNodeError(role, row.name, stamps.seconds(self.barrier.stamp), self.timeout_s))

    def _refusal_realtime(self, row: Topic, stamp: int) -> str | None:
        latest = self.now + int(AHEAD_S * stamps.NANOSECONDS)
        if stamp > latest:
            return f"simulation time, {stamps.seconds(latest):.3f} s at most"
        return super()._refusal_realtime(row, stamp)

    def _advance(self) -> None:
        if self._begun:
            super()._advance()

    def _fail(self, error: Exception) -> None:
        self.get_logger().error(str(error))
        self.exit_status = 1
        self.finished = True
        self.failure = str(error)

    def _report_events(self, state: PlantState) -> None:
        for flag, text in (
            ("rolled_over", "the rover has rolled over"),
            ("off_terrain", "the rover has left the terrain"),
        ):
            if getattr(state, flag) and flag not in self._reported:
                self._reported.add(flag)
                self.get_logger().error(f"{text} at {stamps.seconds(self.now):.2f} s")

    def _publish(self, messages: Iterable[tuple[str, Any]]) -> None:
        for topic, message in messages:
            if self.gives(topic):
                self.publish(topic, message)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(PlantNode))


if __name__ == "__main__":
    main()
