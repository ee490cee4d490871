"""The power and battery manager without ROS: telemetry in, switches and charge out, by the law in
`sojourn_flight.power_manager`.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.app import Answer, App, Period
from sojourn_contract.barrier import is_due
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import battery_readings, battery_state
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_contract.topics import topic
from sojourn_flight.power_manager import law
from sojourn_flight.power_manager.law import PowerManagerInput, PowerManagerOutput, PowerManagerState
from sojourn_machine.errors import MachineError

BUS, SWITCHES = "/bus/state", "/power/switches"
PERIOD_S = topic(SWITCHES).every * CONTROL_PERIOD_S


@dataclass(frozen=True, slots=True)
class PowerState:
    """What the role remembers."""

    manager: PowerManagerState
    telemetry: PowerManagerInput | None = None
    """The last good one; None until it has come."""
    stepped_at: int | None = None
    """Stamp of the last step [ns]; None where it is not known."""


class PowerApp(App[PowerState]):
    """Role power."""

    role = "power"

    def __init__(self, scenario: LoadedScenario) -> None:
        self.params = scenario.as_believed().power_manager

    def warm_up(self) -> None:
        """Those of the manager's law."""
        law.warm_up(self.params)

    def initial_state(self) -> PowerState:
        """As the manager's file has it."""
        return PowerState(law.initial_state(self.params))

    def step(self, state: PowerState, period: Period) -> tuple[PowerState, Answer]:
        """Estimate the charge and set the switches from the telemetry of this period."""
        bus, refusals = period.inputs[BUS], list[tuple[str, Exception]]()
        if bus is not None:
            try:
                return self._stepped(state, period.stamp, PowerManagerInput(*battery_readings(bus)), refusals)
            except MachineError as error:
                refusals.append((BUS, error))
        if state.telemetry is None:  # nothing is known yet: leave every switch as it is
            return state, Answer([(SWITCHES, status_message(period.stamp, "switches", {}))], refusals)
        # of telemetry that was refused the last good one counts
        return self._stepped(state, period.stamp, state.telemetry, refusals)

    def _stepped(
        self, state: PowerState, stamp: int, telemetry: PowerManagerInput, refusals: list[tuple[str, Exception]]
    ) -> tuple[PowerState, Answer]:
        # A manager that is started again in the middle of a run has not seen what went before.
        dt = PERIOD_S if state.stepped_at is None else (stamp - state.stepped_at) * 1e-9
        manager, output = law.step(self.params, state.manager, telemetry, dt)
        return PowerState(manager, telemetry, stamp), Answer(self._messages(stamp, telemetry, output), refusals)

    def on_new_time(self, state: PowerState) -> PowerState:
        """The time since the last telemetry is not known."""
        return replace(state, stepped_at=None)

    def _messages(
        self, stamp: int, telemetry: PowerManagerInput, output: PowerManagerOutput
    ) -> Iterator[tuple[str, Any]]:
        switches = {
            switch.name: switch.mode if switch.mode != "limit" else repr(float(switch.fraction))
            for switch in output.switches
        }
        yield SWITCHES, status_message(stamp, "switches", switches)
        if is_due(topic("/battery_state"), stamp // CONTROL_PERIOD_NS):
            capacity = self.params.battery.charge_capacity
            measured = (telemetry.voltage, telemetry.current, telemetry.temperature)
            yield "/battery_state", battery_state(stamp, *measured, output.soc, output.soc * capacity, capacity)
            yield "/power/status", _status(stamp, output)


def _status(stamp: int, output: PowerManagerOutput) -> Any:
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
