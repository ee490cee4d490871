"""The power and battery manager without ROS: telemetry in, switches and charges out, by the law in
`sojourn_flight.power_manager`.
"""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any

from sojourn_config.expected_heat import heat_at_start
from sojourn_config.expected_light import expected_light, light_at_start
from sojourn_config.flight import FlightScenario
from sojourn_contract.app import Answer, FlightApp, Period, Refusal
from sojourn_contract.barrier import is_due
from sojourn_contract.errors import NotCarriedOutError
from sojourn_contract.heartbeat import status_message
from sojourn_contract.kept_data import Kept
from sojourn_contract.messages import battery_readings, battery_state
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_contract.topics import topic
from sojourn_contract.values import BatteryState
from sojourn_flight.power_manager import law
from sojourn_flight.power_manager.faults import Fault
from sojourn_flight.power_manager.forecast import Forecaster, Known, PowerForecast, nothing_foreseen
from sojourn_flight.power_manager.law import PowerManagerInput, PowerManagerOutput
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.errors import MachineError
from sojourn_machine.evolution import replace
from sojourn_machine.thermal.machine_heat import HeatState
from sojourn_power.forecast_message import forecast_message
from sojourn_power.memory import PowerState
from sojourn_power.requests import LastRequest, switches_of
from sojourn_power.restart import kept_values, started_again

UNKNOWN, OVERHEAT, DEAD, UNSPECIFIED_FAILURE, COLD = 0, 2, 3, 5, 6
"""Of the enumeration POWER_SUPPLY_HEALTH in sensor_msgs/BatteryState."""
HEALTH_OF = {"too hot": OVERHEAT, "frozen": COLD, "too cold to charge": COLD, "too cold to discharge": COLD}
END_OF_LIFE = 0.8
"""Part of its nominal capacity below which a battery counts as worn out [1]."""
BUS, SWITCHES, CHARGE, FORECAST = "/bus/state", "/power/switches", "/battery_state", "/power/forecast"
PERIOD_S = topic(SWITCHES).every * CONTROL_PERIOD_S


class PowerApp(FlightApp[PowerState]):
    """Role power."""

    role = "power"

    def __init__(self, known: FlightScenario) -> None:
        self.params = known.power_manager
        light = light_at_start(known)
        around, warmth = expected_light(known, light), heat_at_start(known, light)
        self._forecaster = Forecaster(self.params, known.activities, around, warmth)
        self._heat = None if warmth is None else warmth.heat.initial_state()
        table = table_of(known)
        self._stores = tuple(row.name for row in table.each(BUS))
        self._charges = tuple(row.name for row in table.each(CHARGE))

    def warm_up(self) -> None:
        """Those of the manager's law and of the network that it believes in."""
        law.warm_up(self.params)
        self._forecaster.warm_up()

    def initial_state(self) -> PowerState:
        """As the manager's file has it."""
        return PowerState(law.initial_state(self.params), (None,) * len(self._stores))

    def to_keep(self, state: PowerState) -> dict[str, Any]:
        """What was asked of it, and what it believes and would not find again soon."""
        return kept_values(self.params, state)

    def started_again(self, state: PowerState, stamp: int, kept: Kept | None) -> PowerState:
        """As the process before has left the loads; where that is not known they come back in stages."""
        return started_again(self.params, self._heat, state, stamp, kept)

    def heartbeat_values(self, state: PowerState, stamp: int) -> dict[str, str]:
        """Its alarm."""
        return {"alarm": state.alarm} if state.alarm else {}

    def step(self, state: PowerState, period: Period) -> tuple[PowerState, Answer]:
        """Estimate the charges and set the switches from the telemetry of this period."""
        refusals = list[Refusal]()
        state, telemetry = self._take_requests(state, period, refusals), list(state.telemetry)
        for place, name in enumerate(self._stores):
            bus = period.inputs.get(name)
            if bus is None:  # refused on arrival, or too old: the last good one counts
                continue
            try:
                reading = StoreReading(*battery_readings(bus))
                reading.require_numbers(name)
                telemetry[place] = reading
            except MachineError as error:
                refusals.append((name, str(error)))
        readings = tuple([reading for reading in telemetry if reading is not None])
        state, stamp = replace(state, telemetry=tuple(telemetry)), period.stamp
        if len(readings) < len(telemetry):  # not all is known yet: leave every switch as it is
            return state, Answer([(SWITCHES, status_message(stamp, "switches", {}))], refusals)
        # A manager that is started again in the middle of a run has not seen what went before.
        dt = PERIOD_S if state.stepped_at is None else (stamp - state.stepped_at) * 1e-9
        manager, output = law.step(self.params, state.manager, PowerManagerInput(readings), dt)
        state = replace(state, manager=manager, stepped_at=stamp)
        messages, errors = list[tuple[str, Any]](), list[str]()
        due = is_due(topic(FORECAST), stamp // CONTROL_PERIOD_NS)
        if due or not state.ahead:  # the words do not wait for the first minute to end
            try:
                state, forecast = self._looked_ahead(state, stamp, readings, due)
            except (MachineError, ArithmeticError) as error:  # for what was measured; the switches are set all the same
                forecast = nothing_foreseen(str(error))
                state = replace(state, ahead=forecast.words)  # heat is followed from the look before
                errors.append(forecast.words)
            if due:
                messages.append((FORECAST, forecast_message(stamp, forecast)))
        return state, Answer(chain(self._messages(state, stamp, readings, output), messages), refusals, errors)

    def _looked_ahead(
        self, state: PowerState, stamp: int, readings: Sequence[StoreReading], due: bool
    ) -> tuple[PowerState, PowerForecast]:
        """With what is foreseen. due: a minute has ended, of which it is known what was drawn and what dust there is.

        Raises:
            MachineError, ArithmeticError: the network cannot be reckoned with from these readings on.
        """
        known = Known(stamp * 1e-9, state.manager, readings, self._heat_now(state, stamp, readings), state.clean)
        known = known._replace(held=state.held)
        if due:
            known = known._replace(held=self._forecaster.held_after(known))
            known = known._replace(clean=self._forecaster.clean_after(known))
        forecast, least = self._forecaster.forecast(known), self._forecaster.least_asleep(known)
        manager = state.manager if least is None else law.foreseen(self.params, state.manager, least)
        believed = {"heat": known.heat, "clean": known.clean, "held": known.held}
        return replace(state, ahead=forecast.words, manager=manager, looked_at=stamp, **believed), forecast

    def _heat_now(self, state: PowerState, stamp: int, readings: Sequence[StoreReading]) -> HeatState | None:
        """Followed from what was believed at the last look ahead."""
        before = Known(state.looked_at * 1e-9, state.manager, readings, state.heat, state.clean)
        return self._forecaster.heat_after(before, stamp * 1e-9)

    def on_new_time(self, state: PowerState) -> PowerState:
        """The time since the last telemetry is not known."""
        return replace(state, stepped_at=None)

    def _take_requests(self, state: PowerState, period: Period, refusals: list[Refusal]) -> PowerState:
        """What operators want of the loads from now on; who asks knows of a restart, and its alarm ends."""
        for name, message in period.goals:
            try:
                asked = switches_of(message)
                manager = law.requested(self.params, state.manager, asked)
                state = replace(state, manager=manager, request=LastRequest(message.stamp, asked), alarm="")
            except MachineError as refusal:
                state = replace(state, request=LastRequest(message.stamp, refused=str(refusal)))
                refusals.append((name, str(NotCarriedOutError(name, "request", str(refusal)))))
        return state

    def _messages(
        self, state: PowerState, stamp: int, readings: Sequence[StoreReading], output: PowerManagerOutput
    ) -> Iterator[tuple[str, Any]]:
        switches = {
            switch.name: switch.mode if switch.mode != "limit" else repr(float(switch.fraction))
            for switch in output.switches
        }
        yield SWITCHES, status_message(stamp, "switches", switches)
        if is_due(topic(CHARGE), stamp // CONTROL_PERIOD_NS):
            for place, name in enumerate(self._charges):
                yield name, self._charge_message(stamp, place, readings[place], output)
            yield "/power/status", _status(stamp, output, state)

    def _charge_message(
        self, stamp: int, place: int, reading: StoreReading, output: PowerManagerOutput
    ) -> BatteryState:
        """What is believed of one store, its health too."""
        name, store = list(self.params.power.all_stores.items())[place]
        known, soc, nominal = output.filters[place], output.charges[place], store.charge_capacity
        capacity = nominal if known is None else nominal * known.capacity_factor
        aged = known is not None and known.capacity_factor + 2.0 * known.capacity_sigma < END_OF_LIFE
        measured = (reading.voltage, reading.current, reading.temperature)
        message = battery_state(stamp, *measured, soc, soc * capacity, capacity, nominal)
        health = _health(output.faults, name)
        return message._replace(power_supply_health=DEAD if aged and health == UNKNOWN else health)


def _health(faults: Sequence[Fault], store: str) -> int:
    """Of a store, as sensor_msgs/BatteryState has it; unknown where nothing is wrong that the manager could tell."""
    kinds = [fault.kind for fault in faults if fault.place == store]
    return next((HEALTH_OF.get(kind, UNSPECIFIED_FAILURE) for kind in kinds), UNKNOWN)


def _status(stamp: int, output: PowerManagerOutput, state: PowerState) -> Any:
    shed = [switch for switch in output.switches if switch.mode == "off"]
    alarms = [state.alarm] if state.alarm else []
    values = {
        "mode": output.mode,
        "mode_reason": output.mode_reason,
        "state": "shedding" if output.shed_level else "limiting" if output.drive_fraction < 1.0 else "normal",
        "soc": f"{output.soc:.4f}",
        "energy_remaining_wh": f"{output.energy_remaining_wh:.1f}",
        "time_to_empty_s": f"{output.time_to_empty:.0f}",
        "drive_fraction": f"{output.drive_fraction:.3f}",
        "correcting": str(output.correcting).lower(),
        "shed": ",".join(switch.name for switch in shed),
        "reason": "; ".join([*alarms, *output.warnings, *(f"{switch.name}: {switch.reason}" for switch in shed)]),
    }
    for number, known in enumerate(output.filters):
        if known is not None:
            end = f"_{number}" if number else ""
            values[f"soc_sigma{end}"] = f"{known.sigma:.4f}"
            values[f"capacity_factor{end}"] = f"{known.capacity_factor:.4f}"
            values[f"capacity_sigma{end}"] = f"{known.capacity_sigma:.4f}"
            values[f"current_offset_a{end}"] = f"{known.current_offset:.4f}"
    values["faults"] = "; ".join(fault.text for fault in output.faults)
    values["forecast"] = state.ahead
    if state.clean is not None:
        values["arrays_clean"] = f"{state.clean:.3f}"
    if state.held > 0.0:
        values["held_at_rest_w"] = f"{state.held:.2f}"
    values |= state.request.status(output.switches)
    return status_message(stamp, "power", values, values["reason"] or values["state"], 1 if values["reason"] else 0)
