"""The law of the power manager: charge estimate, load shedding, drive limit.

It is what would fly: it sees only telemetry.

Charge. Coulomb counting of the measured current, corrected by the open-circuit voltage while the rover rests:

    soc <- soc - eta I dt / Q
    soc <- soc + (OCV^-1(V + (R0 + R1) I) - soc) (1 - exp(-dt / tau_c))   after |I| <= I_rest for long enough

(Plett 2015, "Battery Management Systems", vol. 2, ch. 3). V and I are low-pass filtered for the correction;
after the rest time the polarisation has settled to R1 I, so it needs no model in time.

Shedding. Loads that are not essential form levels by priority, the smallest first. The charge thresholds of
the levels lie evenly between `shed_soc_first` and `shed_soc_last`; level k is shed below its threshold and
restored above it plus the hysteresis. A low bus sheds one more level after each `shed_interval` below
`shed_voltage` and restores one after each `restore_interval` above it plus its hysteresis. The larger of
the two levels counts, so what is shed is always the lowest priorities first, and essential loads never.

Drive. The fraction of its power that the drive may take has a target that falls along a smooth step

    3 x^2 - 2 x^3      from 1 at `derate_start_voltage` to 0 at `derate_stop_voltage`.

It follows the target with `derate_time_constant` and rises no faster than `recovery_rate`. With the bus it forms a loop
of gain g = 1.5 R P / (V (start - stop)); at a period dt it settles without swinging while dt (1 + g) is below
`derate_time_constant`.

Range: steps shorter than the filters' time constants; temperature within the tables
of the battery.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import exp, isfinite
from typing import Any, Literal, TypeAlias

from sojourn_flight.power_manager.params import PowerLawParams, PowerManagerParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power import battery
from sojourn_machine.power.battery import SECONDS_PER_HOUR, BatteryParams
from sojourn_machine.power.loads import LoadParams

SwitchMode: TypeAlias = Literal["on", "off", "limit"]


@dataclass(frozen=True, slots=True)
class PowerManagerInput:
    """Telemetry of one period and, when an operator asked, switches by load name."""

    voltage: float
    """Measured bus voltage [V]."""
    current: float
    """Measured current out of the battery [A]."""
    temperature: float
    """Measured battery temperature [K]."""
    requests: Mapping[str, bool] = field(default_factory=dict)
    """Load name to on (True) or off (False); kept until asked otherwise."""


@dataclass(frozen=True, slots=True)
class PowerManagerState:
    """What the manager remembers."""

    soc: float | None
    """Estimated charge [1]; None until the first telemetry gives it from the voltage."""
    wanted: tuple[bool, ...]
    """What the operator asked of each load."""
    voltage_filtered: float | None = None
    """Low-passed bus voltage [V]."""
    current_filtered: float = 0.0
    """Low-passed current [A]."""
    rest_elapsed: float = 0.0
    """Time at rest [s]."""
    level_by_charge: int = 0
    """Levels shed for low charge [1]."""
    level_by_voltage: int = 0
    """Levels shed for low voltage [1]."""
    low_elapsed: float = 0.0
    """Time since the bus went low or the last level was shed for it [s]."""
    high_elapsed: float = 0.0
    """Time since the bus recovered or the last level was restored [s]."""
    drive_fraction: float = 1.0
    """Fraction of the drive's power that the bus voltage allows [1]."""


@dataclass(frozen=True, slots=True)
class LoadSwitch:
    """The command to one load."""

    name: str
    mode: SwitchMode
    fraction: float
    """0 off to 1 on; between, the part of its power that the load may take [1]."""
    reason: str


@dataclass(frozen=True, slots=True)
class PowerManagerOutput:
    """Switches and battery estimates of one period."""

    soc: float
    """Estimated charge [1]."""
    energy_remaining_wh: float
    """Chemical energy above empty at the estimated charge [Wh]."""
    time_to_empty: float
    """At the filtered current [s]; infinite while the battery is not discharging."""
    correcting: bool
    """The open-circuit voltage is correcting the charge."""
    shed_level: int
    """Levels shed, 0 none [1]."""
    drive_fraction: float
    """Fraction of its power that the drive may take [1]."""
    switches: tuple[LoadSwitch, ...]
    """One for each load, in the order of the parameters."""
    warnings: tuple[str, ...]
    """What an operator should know, in words."""

    def fractions(self) -> tuple[float, ...]:
        """The fraction of every switch, in the order of the parameters, as `loads.step` takes it."""
        return tuple(switch.fraction for switch in self.switches)


def initial_state(params: PowerManagerParams, soc: float | None = None) -> PowerManagerState:
    """All loads wanted on. Without a charge [0..1] the first telemetry sets it from the bus voltage."""
    if soc is not None and not 0.0 <= soc <= 1.0:
        raise InvalidValueError("state of charge", soc, "0 to 1")
    return PowerManagerState(soc=soc, wanted=(True,) * len(params.loads))


def warm_up(params: PowerManagerParams) -> None:
    """Have every compiled kernel ready, so that no later step waits for the compiler or its libraries."""
    step(params, initial_state(params), PowerManagerInput(voltage=28.0, current=1.0, temperature=290.0), 0.02)


def step(
    params: PowerManagerParams, state: PowerManagerState, inputs: PowerManagerInput, dt: float
) -> tuple[PowerManagerState, PowerManagerOutput]:
    """One period of `dt` [s] of the law.

    Raises:
        InvalidValueError: telemetry or dt not a finite number, a request for an unknown load, or to switch
        off an
            essential one. The state is a value: the caller may step again without the request.
    """
    _require_telemetry(inputs, dt)
    state = _filter(params, state, inputs, dt)
    state, correcting = _estimate_charge(params, state, inputs, dt)
    state = replace(
        state,
        wanted=_apply_requests(params, state.wanted, inputs.requests),
        drive_fraction=_drive_fraction(params.law, state.drive_fraction, inputs.voltage, dt),
        **_levels(params, state, dt),
    )
    return state, _output(params, state, inputs, correcting)


def derate_target(law: PowerLawParams, voltage: float) -> float:
    """Fraction of the drive's power at a steady bus voltage [V]: smooth, never falling with voltage."""
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


def _filter(
    params: PowerManagerParams, state: PowerManagerState, inputs: PowerManagerInput, dt: float
) -> PowerManagerState:
    if state.voltage_filtered is None:
        return replace(state, voltage_filtered=inputs.voltage, current_filtered=inputs.current)
    gain = 1.0 - exp(-dt / params.law.filter_time_constant)
    return replace(
        state,
        voltage_filtered=state.voltage_filtered + gain * (inputs.voltage - state.voltage_filtered),
        current_filtered=state.current_filtered + gain * (inputs.current - state.current_filtered),
    )


def _estimate_charge(
    params: PowerManagerParams, state: PowerManagerState, inputs: PowerManagerInput, dt: float
) -> tuple[PowerManagerState, bool]:
    law, pack = params.law, params.battery
    voltage = inputs.voltage if state.voltage_filtered is None else state.voltage_filtered
    ohmic, polarisation = battery.resistances(pack, inputs.temperature)
    rested_voltage = voltage + (ohmic + polarisation) * state.current_filtered
    soc_by_voltage = battery.soc_from_open_circuit_voltage(pack, rested_voltage)
    if state.soc is None:
        return replace(state, soc=soc_by_voltage), False

    efficiency = pack.coulombic_efficiency if inputs.current < 0.0 else 1.0
    soc = state.soc - efficiency * inputs.current * dt / pack.charge_capacity
    rest_elapsed = state.rest_elapsed + dt if abs(inputs.current) <= law.rest_current else 0.0
    correcting = rest_elapsed > law.rest_time
    if correcting:
        soc += (soc_by_voltage - soc) * (1.0 - exp(-dt / law.correction_time_constant))
    return replace(state, soc=min(max(soc, 0.0), 1.0), rest_elapsed=rest_elapsed), correcting


def _levels(params: PowerManagerParams, state: PowerManagerState, dt: float) -> dict[str, Any]:
    """What is remembered of the levels that are shed, for low charge and for low voltage."""
    law, thresholds = params.law, params.shed_thresholds
    soc = 0.0 if state.soc is None else state.soc
    by_charge = state.level_by_charge
    while by_charge < len(thresholds) and soc < thresholds[by_charge]:
        by_charge += 1
    while by_charge > 0 and soc > thresholds[by_charge - 1] + law.shed_soc_hysteresis:
        by_charge -= 1

    voltage = law.shed_voltage if state.voltage_filtered is None else state.voltage_filtered
    by_voltage = state.level_by_voltage
    low = state.low_elapsed + dt if voltage < law.shed_voltage else 0.0
    high = state.high_elapsed + dt if voltage > law.shed_voltage + law.shed_voltage_hysteresis else 0.0
    if low > law.shed_interval and by_voltage < len(thresholds):
        # Start above what the charge has shed already, or this level would bring no relief.
        by_voltage, low = max(by_voltage, min(by_charge, len(thresholds) - 1)) + 1, 0.0
    if high > law.restore_interval and by_voltage > 0:
        by_voltage, high = by_voltage - 1, 0.0
    return {"level_by_charge": by_charge, "level_by_voltage": by_voltage, "low_elapsed": low, "high_elapsed": high}


def _output(
    params: PowerManagerParams, state: PowerManagerState, inputs: PowerManagerInput, correcting: bool
) -> PowerManagerOutput:
    soc = 0.0 if state.soc is None else state.soc
    level = max(state.level_by_charge, state.level_by_voltage)
    shed = params.shed_priorities[:level]
    pack = params.battery
    charge = soc * pack.charge_capacity
    warnings = list(_battery_warnings(pack, inputs))
    if level > 0:
        warnings.append(f"load shedding at level {level} of {len(params.shed_priorities)}")
    if state.drive_fraction < 1.0:
        warnings.append(f"drive limited to {state.drive_fraction:.0%} by the bus voltage")
    return PowerManagerOutput(
        soc=soc,
        energy_remaining_wh=battery.stored_energy(pack, soc) / SECONDS_PER_HOUR,
        time_to_empty=charge / state.current_filtered if state.current_filtered > 0.0 else float("inf"),
        correcting=correcting,
        shed_level=level,
        drive_fraction=state.drive_fraction,
        switches=tuple(
            _switch(params, state, load, granted, shed) if wanted or load.essential else _switched_off(load)
            for load, wanted, granted in zip(params.loads, state.wanted, params.granted, strict=True)
        ),
        warnings=tuple(warnings),
    )


def _switch(
    params: PowerManagerParams,
    state: PowerManagerState,
    load: LoadParams,
    granted: tuple[float, str],
    shed: tuple[int, ...],
) -> LoadSwitch:
    if load.essential:
        return LoadSwitch(load.name, "on", 1.0, "essential")
    if load.priority in shed:
        rank = shed.index(load.priority)
        if rank < state.level_by_charge:
            threshold = params.shed_thresholds[rank]
            return LoadSwitch(load.name, "off", 0.0, f"shed: charge was below {threshold:.1%}")
        return LoadSwitch(load.name, "off", 0.0, f"shed: bus was below {params.law.shed_voltage:.1f} V")
    fraction, reason = granted
    if load.group == "drive" and state.drive_fraction < 1.0:
        fraction, reason = fraction * state.drive_fraction, "bus voltage is low"
    mode: SwitchMode = "on" if fraction >= 1.0 else "limit" if fraction > 0.0 else "off"
    return LoadSwitch(load.name, mode, fraction, reason)


def _switched_off(load: LoadParams) -> LoadSwitch:
    return LoadSwitch(load.name, "off", 0.0, "switched off by the operator")


def _battery_warnings(pack: BatteryParams, inputs: PowerManagerInput) -> tuple[str, ...]:
    telemetry = battery.PackState(soc=1.0, polarisation_voltage=0.0, temperature=inputs.temperature)
    return tuple(f"battery {text}" for text in battery.limits_exceeded(pack, telemetry, inputs.current))


def _apply_requests(
    params: PowerManagerParams, wanted: tuple[bool, ...], requests: Mapping[str, bool]
) -> tuple[bool, ...]:
    if not requests:
        return wanted
    names = [load.name for load in params.loads]
    for name, on in requests.items():
        if name not in names:
            raise InvalidValueError("load", name, "one of " + ", ".join(names))
        if not on and params.loads[names.index(name)].essential:
            switchable = ", ".join(load.name for load in params.loads if not load.essential)
            raise InvalidValueError(f"switch of essential load {name}", "off", f"on; may be off: {switchable}")
    return tuple(requests.get(name, old) for name, old in zip(names, wanted, strict=True))


def _require_telemetry(inputs: PowerManagerInput, dt: float) -> None:
    for name, value in (("bus voltage [V]", inputs.voltage), ("bus current [A]", inputs.current)):
        if not isfinite(value):
            raise InvalidValueError(name, value, "a finite number")
    if not isfinite(inputs.temperature) or inputs.temperature <= 0.0:
        raise InvalidValueError("battery temperature [K]", inputs.temperature, "a finite number above 0")
    if not isfinite(dt) or dt <= 0.0:
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")
