"""Node of the power and battery manager: telemetry in, switches and charge out, by the law in
`sojourn_mechanics.power`.
"""

import sys
from collections.abc import Mapping
from typing import Any

from rclpy.context import Context

from sojourn_config.scenario import load_scenario
from sojourn_contract import process
from sojourn_contract.barrier import is_due
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import battery_readings, battery_state
from sojourn_contract.node import ContractNode
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_contract.topics import topic
from sojourn_mechanics.power import manager

SWITCHES = "/power/switches"
PERIOD_S = topic(SWITCHES).every * CONTROL_PERIOD_S


class PowerNode(ContractNode):
    """Role power."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        super().__init__("power", context=context, overrides=overrides, namespace=namespace)
        self.params = load_scenario(self.scenario_name, self.scenario_overrides).power_manager
        manager.warm_up(self.params)
        self.state = manager.initial_state(self.params)
        self._last: int | None = None
        self._telemetry: manager.PowerManagerInput | None = None

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Estimate the charge and set the switches from the telemetry of this period."""
        bus = inputs["/bus/state"]
        if bus is not None:  # refused: the last good telemetry counts
            self._telemetry = manager.PowerManagerInput(*battery_readings(bus))
        if self._telemetry is None:  # nothing is known yet: leave every switch as it is
            self.publish(SWITCHES, status_message(stamp, "switches", {}))
            return
        telemetry = self._telemetry
        # A node that is started again in the middle of a run has not seen what went before.
        dt = (stamp - self._last) * 1e-9 if self._last is not None else PERIOD_S
        self._last = stamp
        self.state, output = manager.step(self.params, self.state, telemetry, dt)
        switches = {
            switch.name: switch.mode if switch.mode != "limit" else repr(float(switch.fraction))
            for switch in output.switches
        }
        self.publish(SWITCHES, status_message(stamp, "switches", switches))
        if is_due(topic("/battery_state"), stamp // CONTROL_PERIOD_NS):
            capacity = self.params.battery.charge_capacity
            self.publish(
                "/battery_state",
                battery_state(
                    stamp,
                    telemetry.voltage,
                    telemetry.current,
                    telemetry.temperature,
                    output.soc,
                    output.soc * capacity,
                    capacity,
                ),
            )
            self.publish("/power/status", self._status(stamp, output))

    def _status(self, stamp: int, output: manager.PowerManagerOutput) -> Any:
        shed = [switch for switch in output.switches if switch.mode == "off"]
        values = {
            "state": "shedding" if output.shed_level else "limiting" if output.drive_fraction < 1.0 else "normal",
            "soc": f"{output.soc:.4f}",
            "energy_remaining_wh": f"{output.energy_remaining_wh:.1f}",
            "time_to_empty_s": f"{output.time_to_empty:.0f}",
            "drive_fraction": f"{output.drive_fraction:.3f}",
            "correcting": str(output.correcting).lower(),
            "shed": ",".join(switch.name for switch in shed),
            "reason": "; ".join([*output.warnings, *(f"{switch.name}: {switch.reason}" for switch in shed)]),
        }
        return status_message(stamp, "power", values, values["reason"] or values["state"], 1 if values["reason"] else 0)


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(PowerNode))


if __name__ == "__main__":
    main()
