"""The law of the power manager: charge estimate, load shedding, drive limit.

It is what would fly: it sees only telemetry.

Charge. Of each store: see `charge_estimate`. What is shed goes by all of them: each counts with its part of the
energy that all hold when they are full.

Shedding. Loads that are not essential form levels by priority, the smallest first. The charge thresholds of
the levels lie evenly between `shed_soc_first` and `shed_soc_last`; level k is shed below its threshold and
restored above it plus the hysteresis. A low bus sheds one more level after each `shed_interval` below
`shed_voltage` and restores one after each `restore_interval` above it plus its hysteresis. The larger of
the two levels counts, so what is shed is always the lowest priorities first, and essential loads never.

Drive. The fraction of their power that the loads may take which drive the machine has a target that falls along a
smooth step

    3 x^2 - 2 x^3      from 1 at `derate_start_voltage` to 0 at `derate_stop_voltage`.

It follows the target with `derate_time_constant` and rises no faster than `recovery_rate`. With the bus it forms a loop
of gain g = 1.5 R P / (V (start - stop)); at a period dt it settles without swinging while dt (1 + g) is below
`derate_time_constant`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import exp, isfinite
from typing import Any

from sojourn_flight.power_manager import charge_estimate, faults, modes, switch_watch
from sojourn_flight.power_manager.charge_estimate import StoreEstimate
from sojourn_flight.power_manager.faults import Fault, FaultState
from sojourn_flight.power_manager.kalman import KalmanState
from sojourn_flight.power_manager.modes import AWAKE, SLEEP, Mode, SleepState, Supply
from sojourn_flight.power_manager.params import PowerLawParams, PowerManagerParams
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_flight.power_manager.requests import switched
from sojourn_flight.power_manager.switchboard import Grounds, LoadSwitch, Orders
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.battery import SECONDS_PER_HOUR


@dataclass(frozen=True, slots=True)
class PowerManagerInput:
    """Telemetry of one period."""

    stores: tuple[StoreReading, ...]
    """One for each store."""


@dataclass(frozen=True, slots=True)
class PowerManagerState:
    """What the manager remembers."""

    stores: tuple[StoreEstimate, ...]
    """What is known of each store."""
    wanted: tuple[bool, ...]
    """What the operator asked of each load."""
    level_by_charge: int = 0
    """Levels shed for low charge [1]."""
    level_by_voltage: int = 0
    """Levels shed for low voltage [1]."""
    low_elapsed: float = 0.0
    """Time since the bus went low or the last level was shed for it [s]."""
    high_elapsed: float = 0.0
    """Time since the bus recovered or the last level was restored [s]."""
    drive_fraction: float = 1.0
    """Fraction of its power that the bus voltage allows a load which drives the machine [1]."""
    sleep: SleepState = AWAKE
    faults: FaultState = field(default_factory=FaultState)

    @property
    def grounds(self) -> Grounds:
        """What the switches go by."""
        levels = (self.level_by_charge, self.level_by_voltage)
        return Grounds(self.wanted, *levels, self.sleep.asleep, self.drive_fraction)


@dataclass(frozen=True, slots=True)
class PowerManagerOutput:
    """Switches and battery estimates of one period; what is not asked for is not worked out."""

    params: PowerManagerParams
    state: PowerManagerState
    """After the period."""
    inputs: PowerManagerInput
    orders: Orders

    @property
    def soc(self) -> float:
        """Estimated charge of all stores [1]."""
        return _charge(self.params, self.state.stores)

    @property
    def charges(self) -> tuple[float, ...]:
        """Estimated charge of each store [1]."""
        return tuple([store.charge for store in self.state.stores])

    @property
    def filters(self) -> tuple[KalmanState | None, ...]:
        """Of each store, where the law estimates by one."""
        return tuple([store.filter for store in self.state.stores])

    @property
    def energy_remaining_wh(self) -> float:
        """Energy above empty at the estimated charges [Wh]."""
        return self.params.stored_energy(self.charges) / SECONDS_PER_HOUR

    @property
    def time_to_empty(self) -> float:
        """At the filtered currents [s]; infinite while the stores are not discharging."""
        charge, current = 0.0, 0.0
        for store, ratio, known in zip(self.params.stores, self.params.ratios, self.state.stores, strict=True):
            charge += ratio * known.charge * store.charge_capacity
            current += ratio * known.current_filtered
        return charge / current if current > 0.0 else float("inf")

    @property
    def correcting(self) -> bool:
        """The open-circuit voltage is correcting the charge of a store."""
        return any(store.correcting for store in self.state.stores)

    @property
    def mode(self) -> Mode:
        """One word for what is switched off."""
        return self.orders.mode

    @property
    def mode_reason(self) -> str:
        """Why, in words."""
        if self.state.sleep.asleep:
            return self.state.sleep.reason
        return self.params.switchboard.level_reason(self.state.grounds, self.shed_level)

    @property
    def faults(self) -> tuple[Fault, ...]:
        """That telemetry shows."""
        return faults.recognised(self.params.power, self.state.faults)

    @property
    def shed_level(self) -> int:
        """Levels shed, 0 none [1]."""
        return self.orders.shed_level

    @property
    def drive_fraction(self) -> float:
        """Fraction of their power that the loads may take which drive the machine [1]."""
        return self.state.drive_fraction

    @property
    def switches(self) -> tuple[LoadSwitch, ...]:
        """One for each load, in the order of the parameters."""
        return self.orders.switches

    @property
    def fractions(self) -> tuple[float, ...]:
        """The fraction of every switch, in the order of the parameters, as the network takes it."""
        return self.orders.fractions

    @property
    def warnings(self) -> tuple[str, ...]:
        """What an operator should know, in words."""
        found = list(_store_warnings(self.params, self.inputs))
        if self.shed_level > 0:
            found.append(f"load shedding at level {self.shed_level} of {len(self.params.shed_priorities)}")
        if self.drive_fraction < 1.0:
            found.append(f"drive limited to {self.drive_fraction:.0%} by the bus voltage")
        return tuple(found)


def initial_state(params: PowerManagerParams, soc: float | None = None) -> PowerManagerState:
    """All loads wanted on. Without a charge [0..1] the first telemetry sets those of the stores from their voltages."""
    if soc is not None and not 0.0 <= soc <= 1.0:
        raise InvalidValueError("state of charge", soc, "0 to 1")
    stores, wanted = (StoreEstimate(soc),) * len(params.stores), (True,) * len(params.loads)
    return PowerManagerState(stores, wanted, faults=faults.initial_state(params.power))


def requested(params: PowerManagerParams, state: PowerManagerState, asked: Mapping[str, bool]) -> PowerManagerState:
    """After an operator asked for switches, load name to on (True) or off (False), kept until asked otherwise; SLEEP
    among the names puts the machine to sleep or wakes it.

    Raises:
        UnknownNameError: a load that does not exist.
        InvalidValueError: an essential one that is to be off; sleep where the law knows none.
    """
    loads = {name: on for name, on in asked.items() if name != SLEEP}
    state = replace(state, wanted=switched(params, state.wanted, loads))
    if SLEEP not in asked:
        return state
    if params.law.sleep is None:
        raise InvalidValueError(SLEEP, asked[SLEEP], "nothing: power_manager.sleep of flight.yaml is not given")
    return _changed(params, state, modes.requested(state.sleep, asked[SLEEP]))


def foreseen(params: PowerManagerParams, state: PowerManagerState, least: float) -> PowerManagerState:
    """After a forecast: `least` is the charge that sleep from now on would leave [1]."""
    if params.law.sleep is None:
        return state
    return _changed(params, state, modes.foreseen(params.law.sleep, state.sleep, least, params.law.forecast.hours))


def in_stages(params: PowerManagerParams, state: PowerManagerState) -> PowerManagerState:
    """With loads that come back one level after another, as after a low bus."""
    return replace(state, level_by_voltage=len(params.shed_priorities), high_elapsed=0.0)


def _changed(params: PowerManagerParams, state: PowerManagerState, sleep: SleepState) -> PowerManagerState:
    """After sleep may have begun or ended."""
    wakes = state.sleep.asleep and not sleep.asleep
    return replace(in_stages(params, state) if wakes else state, sleep=sleep)


def warm_up(params: PowerManagerParams) -> None:
    """Have every compiled kernel ready, so that no later step waits for the compiler or its libraries."""
    reading = StoreReading(voltage=28.0, current=1.0, temperature=290.0)
    step(params, initial_state(params), PowerManagerInput((reading,) * len(params.stores)), 0.02)


def step(
    params: PowerManagerParams, state: PowerManagerState, inputs: PowerManagerInput, dt: float
) -> tuple[PowerManagerState, PowerManagerOutput]:
    """One period of `dt` [s] of the law.

    Raises:
        InvalidValueError: telemetry or dt not a finite number, not one reading a store.
    """
    state, output = decided(params, state, inputs, dt)
    state = replace(state, faults=_faults(params, state.faults, inputs, output.orders.on, dt))
    return state, replace(output, state=state)


def decided(
    params: PowerManagerParams, state: PowerManagerState, inputs: PowerManagerInput, dt: float
) -> tuple[PowerManagerState, PowerManagerOutput]:
    """One period of the law without its watch for faults, which decides nothing: all that a look ahead needs. Raises
    InvalidValueError as `step`.
    """
    _require_telemetry(params, inputs, dt)
    estimates = [
        charge_estimate.step(store, params.law, before, reading, dt)
        for store, before, reading in zip(params.stores, state.stores, inputs.stores, strict=True)
    ]
    stores = tuple(estimates)
    voltage = inputs.stores[params.watched].voltage
    fraction = _drive_fraction(params.law, state.drive_fraction, voltage, dt)
    state = replace(state, stores=stores, drive_fraction=fraction, **_levels(params, state, stores, dt))
    sleep = modes.after(params.law.sleep, params.loads, state.sleep, _supply(params, state), dt)
    state = state if sleep is state.sleep else _changed(params, state, sleep)
    return state, PowerManagerOutput(params, state, inputs, params.switchboard.orders(state.grounds))


def _faults(
    params: PowerManagerParams, before: FaultState, inputs: PowerManagerInput, on: tuple[bool, ...], dt: float
) -> FaultState:
    """What telemetry shows of faults; on: which loads are from now on."""
    watch, watched = params.law.faults.switches, params.switch_watch
    found = faults.step(params.law.faults, params.power, before, inputs.stores, dt)
    switches = switch_watch.step(watch, watched, found.switches, inputs.stores, dt)
    if on != switches.on:
        switches = switch_watch.told(watch, watched, switches, on, inputs.stores[params.watched].voltage, dt)
    return replace(found, switches=switches)


def derate_target(law: PowerLawParams, voltage: float) -> float:
    """Fraction of the power for driving at a steady bus voltage [V]: smooth, never falling with voltage."""
    span = law.derate_start_voltage - law.derate_stop_voltage
    x = min(max((voltage - law.derate_stop_voltage) / span, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


def _drive_fraction(law: PowerLawParams, fraction: float, voltage: float, dt: float) -> float:
    target = derate_target(law, voltage)
    # Half the loop is the bus itself: stepping straight to the target would swing on a weak battery.
    change = (target - fraction) * (1.0 - exp(-dt / law.derate_time_constant))
    moved = fraction + min(change, law.recovery_rate * dt)
    at_end = target in (0.0, 1.0) and abs(target - moved) < 1e-3
    return target if at_end else moved


def _charge(params: PowerManagerParams, stores: Sequence[StoreEstimate]) -> float:
    """State of charge of all stores together [1]."""
    return sum([share * store.charge for share, store in zip(params.shares, stores, strict=True)])


def _supply(params: PowerManagerParams, state: PowerManagerState) -> Supply:
    """What decides on sleep."""
    known = [(store.voltage_filtered or 0.0) * store.current_filtered for store in state.stores]
    survival = 0 < len(params.shed_priorities) == max(state.level_by_charge, state.level_by_voltage)
    return Supply(survival or not params.shed_priorities, _charge(params, state.stores), -sum(known))


def _levels(
    params: PowerManagerParams, state: PowerManagerState, stores: Sequence[StoreEstimate], dt: float
) -> dict[str, Any]:
    """What is remembered of the levels that are shed, for low charge and for low voltage; stores: as known now."""
    law, thresholds = params.law, params.shed_thresholds
    soc = _charge(params, stores)
    by_charge = state.level_by_charge
    while by_charge < len(thresholds) and soc < thresholds[by_charge]:
        by_charge += 1
    while by_charge > 0 and soc > thresholds[by_charge - 1] + law.shed_soc_hysteresis:
        by_charge -= 1

    filtered = stores[params.watched].voltage_filtered
    voltage = law.shed_voltage if filtered is None else filtered
    by_voltage = state.level_by_voltage
    low = state.low_elapsed + dt if voltage < law.shed_voltage else 0.0
    high = state.high_elapsed + dt if voltage > law.shed_voltage + law.shed_voltage_hysteresis else 0.0
    if low > law.shed_interval and by_voltage < len(thresholds):
        # Start above what the charge has shed already, or this level would bring no relief.
        by_voltage, low = max(by_voltage, min(by_charge, len(thresholds) - 1)) + 1, 0.0
    if high > law.restore_interval and by_voltage > 0:
        by_voltage, high = by_voltage - 1, 0.0
    return {"level_by_charge": by_charge, "level_by_voltage": by_voltage, "low_elapsed": low, "high_elapsed": high}


def _store_warnings(params: PowerManagerParams, inputs: PowerManagerInput) -> Iterator[str]:
    for name, store, reading in zip(params.power.all_stores, params.stores, inputs.stores, strict=True):
        for text in store.limits_exceeded(reading.temperature, reading.current):
            yield f"{name} {text}"


def _require_telemetry(params: PowerManagerParams, inputs: PowerManagerInput, dt: float) -> None:
    if len(inputs.stores) != len(params.stores):
        raise InvalidValueError("readings", len(inputs.stores), f"{len(params.stores)}, one for each store")
    for name, reading in zip(params.power.all_stores, inputs.stores, strict=True):
        reading.require_numbers(name)
    if not isfinite(dt) or dt <= 0.0:
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")
