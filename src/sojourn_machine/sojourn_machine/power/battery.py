"""A rechargeable battery pack: open-circuit voltage, one polarisation pair, heat, state of charge.

Equations (Plett 2015, "Battery Management Systems", vol. 1, ch. 2, circuit with one RC pair). The current I is positive
out of the pack (discharge). Pack of n_s cells in series and n_p strings in parallel, cells alike:

    d soc/dt = -eta I / Q            Q = n_p capacity 3600 s/h; eta = 1 in discharge, efficiency in charge
    dv/dt    = I / C1 - v / (R1 C1)  polarisation voltage v, solved exactly for a current constant over dt
    V        = OCV(soc) - v - R0(T) I
    H dT/dt  = heat - G (T - T_surroundings)
    heat     = R0 I^2 + v^2 / R1 + OCV times the charging current that is not stored

OCV is linear between the points of its table, so that the stored chemical energy, the integral of Q OCV d(soc), and the
inverse of OCV are closed forms, and the energy balance of a step is exact to rounding: chemical energy out = terminal
energy + heat + growth of the energy C1 v^2 / 2 in the polarisation capacitor. R0 and R1 are linear between the points
of their tables of temperature and constant beyond them; within a step they keep the value of its start.

Assumptions: cells at one temperature; no entropic heat, no hysteresis; ageing only before the run (`age`); of cells out
of balance the emptiest ends a discharge and the fullest a charge (`imbalance`). Low temperature shows as resistance,
not as lost capacity, until the electrolyte is frozen: then no current flows in or out, and after the thaw the pack is
as it was (cells in liquid nitrogen gave nothing when abused, and had lost little after five times: Grandjean,
Groenewald and Marco 2019, J. Energy Storage 21:202; what frost breaks elsewhere is left out). Once full, charge is not
stored: it becomes heat. Below empty the OCV table is extrapolated, so that the last step keeps its energy balance;
`thevenin` then reports a source of 0 V (the protection switch has opened), which keeps a caller from drawing more.
Valid for currents up to a few times the capacity per hour, steps short against a minute for the temperature.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from functools import cached_property
from math import expm1, isfinite
from typing import Any, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import require_rising
from sojourn_machine.power.battery_kernels import (
    PackTables,
    step_kernel,
    table_clamped,
    table_extrapolated,
    table_integral,
    thevenin_kernel,
)
from sojourn_machine.power.cell_losses import CellLosses
from sojourn_machine.power.lithium_age import LithiumAge
from sojourn_machine.power.pack import Pack, PackState
from sojourn_machine.power.stores import ForceCourse, StoreParams, StorePoint

SECONDS_PER_HOUR = 3600.0


def _check_length(name: str, values: Sequence[float], of: str, points: Sequence[float]) -> None:
    if len(values) != len(points):
        raise ValueError(f"{name} has {len(values)} values: allowed is {len(points)}, as many as {of}")


class BatteryParams(StoreParams):
    """A pack of like cells. All electrical and thermal numbers are of one cell, at the start of life."""

    kind: str = "battery"
    name: str = Field(min_length=1, description="name of the pack, used in telemetry")
    cells_series: int = Field(ge=1, le=1000, description="cells in series [1]")
    cells_parallel: int = Field(ge=1, le=1000, description="strings in parallel [1]")
    capacity_ah: float = Field(gt=0.0, le=1000.0, description="charge of a full cell [Ah]")
    soc_points: tuple[float, ...] = Field(min_length=2, description="states of charge, rising from 0 to 1 [1]")
    ocv_points: tuple[float, ...] = Field(min_length=2, description="OCV of a cell at soc_points, strictly rising [V]")
    resistance_temperatures: tuple[float, ...] = Field(
        min_length=1, description="temperatures of the resistance tables, strictly rising [K]"
    )
    resistance_ohmic: tuple[float, ...] = Field(
        min_length=1, description="ohmic resistance R0 of a cell at resistance_temperatures [ohm]"
    )
    resistance_polarisation: tuple[float, ...] = Field(
        min_length=1, description="polarisation resistance R1 of a cell at resistance_temperatures [ohm]"
    )
    capacitance_polarisation: float = Field(gt=0.0, le=1e7, description="polarisation capacitance C1 of a cell [F]")
    coulombic_efficiency: float = Field(gt=0.5, le=1.0, description="part of the charging current that is stored [1]")
    charge_current_limit: float = Field(ge=0.0, le=1e4, description="largest charging current of a cell [A]")
    discharge_current_limit: float = Field(gt=0.0, le=1e4, description="largest discharging current of a cell [A]")
    heat_capacity: float = Field(gt=0.0, le=1e6, description="heat capacity of a cell with its share of housing [J/K]")
    thermal_conductance: float = Field(
        ge=0.0, le=100.0, description="conductance from the whole pack to its surroundings [W/K]"
    )
    temperature_surroundings: float = Field(
        gt=20.0, lt=1000.0, description="temperature of the surroundings unless the caller gives one [K]"
    )
    temperature_discharge_min: float = Field(gt=20.0, lt=1000.0, description="coldest temperature to discharge at [K]")
    temperature_charge_min: float = Field(gt=20.0, lt=1000.0, description="coldest temperature to charge at [K]")
    temperature_frozen: float = Field(default=0.0, ge=0.0, lt=1000.0, description="below it no current flows [K]")
    imbalance: float = Field(default=0.0, ge=0.0, lt=0.5, description="between the cells, of their capacity [1]")
    age: LithiumAge | None = Field(default=None, description="of its cells; left out: new")
    temperature_max: float = Field(gt=20.0, lt=1000.0, description="hottest temperature to operate at [K]")

    @field_validator("kind")
    @classmethod
    def _is_this_kind(cls, kind: str) -> str:
        """The table `battery` of a machine has no other kind: it would be read as this one."""
        own = cls.model_fields["kind"].default
        if kind != own:
            raise ValueError(f"allowed is {own}; a store of another kind stands in the table stores")
        return kind

    @model_validator(mode="after")
    def _check_tables(self) -> Self:
        _check_length("ocv_points", self.ocv_points, "soc_points", self.soc_points)
        require_rising("soc_points", self.soc_points)
        require_rising("ocv_points", self.ocv_points)
        require_rising("resistance_temperatures", self.resistance_temperatures)
        if self.soc_points[0] != 0.0 or self.soc_points[-1] != 1.0:
            raise ValueError("soc_points: allowed is a table that starts at 0 and ends at 1")
        if self.ocv_points[0] <= 0.0:
            raise ValueError(f"ocv_points[0] = {self.ocv_points[0]}: allowed is above 0 V")
        for name in ("resistance_ohmic", "resistance_polarisation"):
            values = getattr(self, name)
            _check_length(name, values, "resistance_temperatures", self.resistance_temperatures)
            if min(values) <= 0.0:
                raise ValueError(f"{name}: allowed is above 0 ohm everywhere")
        colder = self.temperature_frozen <= self.temperature_discharge_min <= self.temperature_charge_min
        if not (colder and self.temperature_charge_min < self.temperature_max):
            order = "temperature_frozen <= temperature_discharge_min <= temperature_charge_min < temperature_max"
            raise ValueError(f"temperature limits: allowed is {order}")
        return self

    @cached_property
    def pack(self) -> Pack:
        """The numbers of a cell scaled to the pack, made once."""
        scale = self.cells_series / self.cells_parallel * (1.0 if self.age is None else self.age.resistance)
        left = 1.0 if self.age is None else self.age.capacity_left
        capacity = (1.0 - self.imbalance) * left * self.cells_parallel * self.capacity_ah * SECONDS_PER_HOUR
        tables = PackTables(
            soc=np.array(self.soc_points, dtype=np.float64),
            ocv=self.cells_series * np.array(self.ocv_points, dtype=np.float64),
            temperature=np.array(self.resistance_temperatures, dtype=np.float64),
            ohmic=scale * np.array(self.resistance_ohmic, dtype=np.float64),
            polarisation=scale * np.array(self.resistance_polarisation, dtype=np.float64),
            charge_capacity=capacity,
            capacitance=self.capacitance,
            efficiency=self.coulombic_efficiency,
            heat_capacity=self.heat_capacity * self.cells_series * self.cells_parallel,
            conductance=self.thermal_conductance,
        )
        falls = np.diff(tables.ocv) / np.diff(tables.soc) / capacity
        full = self.cells_series * self.ocv_points[-1]
        return Pack(tables, tuple(falls.tolist()), full, self.charge_current_limit * self.cells_parallel)

    @property
    def tables(self) -> PackTables:
        """What the kernels are given of the whole pack."""
        return self.pack.tables

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """As pydantic's, but a changed copy makes its own pack."""
        copied = super().model_copy(update=update, deep=deep)
        copied.__dict__.pop("pack", None)
        return copied

    @property
    def charge_capacity(self) -> float:
        """Charge of the full pack [C]."""
        return self.pack.tables.charge_capacity

    @property
    def capacitance(self) -> float:
        """Polarisation capacitance of the pack [F]."""
        return self.capacitance_polarisation * self.cells_parallel / self.cells_series

    @property
    def energy_capacity_wh(self) -> float:
        """Chemical energy between full and empty [Wh]."""
        return stored_energy(self, 1.0) / SECONDS_PER_HOUR

    @property
    def charging_efficiency(self) -> float:
        """Part of the charging current that is stored [1]."""
        return self.coulombic_efficiency

    @property
    def strings(self) -> int:
        """Cells in parallel [1]."""
        return self.cells_parallel

    def initial_state(self, soc: float, temperature: float | None = None) -> PackState:
        """See `initial_state`."""
        return initial_state(self, soc, temperature)

    def point(self, state: PackState) -> StorePoint:
        """Open-circuit voltage less polarisation, behind the ohmic resistance; sources charge it up to the voltage of
        the full pack and the limit of its current, and not where it is too cold. Empty, it is not discharged.
        """
        source, resistance = thevenin(self, state)
        discharges = state.soc > 0.0
        if not discharges:
            source = open_circuit_voltage(self, state.soc) - state.polarisation_voltage
        if state.temperature < self.temperature_frozen:
            return StorePoint(source, resistance, source, False, False)
        ceiling = source
        if state.temperature >= self.temperature_charge_min:
            ceiling = min(source + resistance * self.pack.largest_charge, self.pack.full_voltage)
        return StorePoint(source, resistance, ceiling, discharges, True)

    def step(
        self, state: PackState, current: float, dt: float, temperature_surroundings: float | None = None
    ) -> PackState:
        """See `step`."""
        return step(self, state, current, dt, temperature_surroundings)

    def losses(self, state: PackState, current: float, dt: float) -> CellLosses:
        """Of the next `dt` [s] at a current, out positive [A]; other chemistries have others."""
        return CellLosses(self.coulombic_efficiency)

    def stored_energy(self, soc: float) -> float:
        """See `stored_energy`."""
        return stored_energy(self, soc)

    def elastance(self, state: PackState) -> float:
        """See `StoreParams`: the slope of the table where it stands."""
        return self.pack.falls[bisect_right(self.soc_points, state.soc, 1, len(self.soc_points) - 1) - 1]

    def course(self, state: PackState, point: StorePoint, dt: float) -> ForceCourse:
        """See `StoreParams`; the polarisation comes to what a steady current has it come to."""
        polarisation, slowness = self.polarisation(state.temperature)
        gone, known = -expm1(-dt / slowness), super().course(state, point, dt)  # gone of it at the end
        held = gone * slowness / dt  # of it in the mean
        return ForceCourse(
            known.mean_force + (1.0 - held) * state.polarisation_voltage,
            known.mean_resistance + (1.0 - held) * polarisation,
            known.end_force + gone * state.polarisation_voltage,
            known.end_resistance + gone * polarisation,
        )

    def largest_charge(self, state: PackState, point: StorePoint) -> float:
        """See `StoreParams`: the limit of its cells, and none where it is too cold."""
        return self.pack.largest_charge * (point.charges and state.temperature >= self.temperature_charge_min)

    @property
    def full_voltage(self) -> float:
        """See `StoreParams`."""
        return self.pack.full_voltage

    def open_circuit_voltage(self, soc: float) -> float:
        """See `open_circuit_voltage`."""
        return open_circuit_voltage(self, soc)

    def soc_from_open_circuit_voltage(self, voltage: float) -> float:
        """See `soc_from_open_circuit_voltage`."""
        return soc_from_open_circuit_voltage(self, voltage)

    @property
    def exchange(self) -> tuple[float, float]:
        """See `StoreParams`."""
        return self.tables.conductance, self.tables.heat_capacity

    def heat_given(self, before: Any, after: Any) -> float:
        """What was released in the cells and did not warm them [J]."""
        warmed = self.tables.heat_capacity * (after.temperature - before.temperature)
        return float(after.energy_heat - before.energy_heat - warmed)

    def settled_resistance(self, temperature: float) -> float:
        """Ohmic and polarisation resistance together [ohm]."""
        return sum(resistances(self, temperature))

    def polarisation(self, temperature: float) -> tuple[float, float]:
        """Resistance of the polarisation pair of the pack [ohm] and its time constant [s]."""
        _, resistance = resistances(self, temperature)
        return resistance, resistance * self.capacitance

    def limits_exceeded(self, temperature: float, current: float) -> tuple[str, ...]:
        """See `limits_exceeded`."""
        telemetry = PackState(soc=1.0, polarisation_voltage=0.0, temperature=temperature)
        return limits_exceeded(self, telemetry, current)


def initial_state(params: BatteryParams, soc: float, temperature: float | None = None) -> PackState:
    """A rested pack at a state of charge [0..1] and a temperature [K], by default its surroundings'."""
    if not 0.0 <= soc <= 1.0:
        raise InvalidValueError(f"{params.name} state of charge", soc, "0 to 1")
    start = params.temperature_surroundings if temperature is None else temperature
    _require_temperature(params, start)
    return PackState(soc=float(soc), polarisation_voltage=0.0, temperature=float(start))


def open_circuit_voltage(params: BatteryParams, soc: float) -> float:
    """Open-circuit voltage of the rested pack at a state of charge [V]."""
    return float(table_extrapolated(params.tables.soc, params.tables.ocv, soc))


def soc_from_open_circuit_voltage(params: BatteryParams, voltage: float) -> float:
    """State of charge [0..1] of a rested pack whose terminals show `voltage` [V]; exact within the table."""
    return float(np.interp(voltage, params.tables.ocv, params.tables.soc))


def resistances(params: BatteryParams, temperature: float) -> tuple[float, float]:
    """Ohmic and polarisation resistance of the pack at a temperature [K], both [ohm]."""
    tables = params.tables
    return (
        float(table_clamped(tables.temperature, tables.ohmic, temperature)),
        float(table_clamped(tables.temperature, tables.polarisation, temperature)),
    )


def thevenin(params: BatteryParams, state: PackState) -> tuple[float, float]:
    """Source voltage (OCV less polarisation) [V] and series resistance [ohm] that hold for a control period.

    The terminal voltage at a current I (out positive) is `source - resistance * I`. The polarisation
    voltage moves in tens of seconds, so both may be kept for 20 ms. An empty pack is switched off by its
    protection: 0 V.
    """
    tables = params.tables
    source, resistance = thevenin_kernel(
        tables.soc,
        tables.ocv,
        tables.temperature,
        tables.ohmic,
        state.soc,
        state.polarisation_voltage,
        state.temperature,
    )
    return float(source), float(resistance)


def terminal_voltage(params: BatteryParams, state: PackState, current: float) -> float:
    """Voltage [V] at the terminals while `current` [A, out positive] flows. An empty pack gives 0 V."""
    source, resistance = thevenin(params, state)
    return source - resistance * current if state.soc > 0.0 else 0.0


def stored_energy(params: BatteryParams, soc: float) -> float:
    """Chemical energy above empty at a state of charge [J]."""
    return params.charge_capacity * float(table_integral(params.tables.soc, params.tables.ocv, soc))


def step(
    params: BatteryParams,
    state: PackState,
    current: float,
    dt: float,
    temperature_surroundings: float | None = None,
) -> PackState:
    """The state after `current` [A, out of the pack positive] has flowed for `dt` [s].

    Args:
        temperature_surroundings: [K], the value of the parameters unless given.

    Raises:
        InvalidValueError: current, dt or temperature not finite, dt not positive.
    """
    around = params.temperature_surroundings if temperature_surroundings is None else temperature_surroundings
    if not isfinite(current):
        raise InvalidValueError(f"{params.name} current [A]", current, "a finite number")
    if not (isfinite(dt) and dt > 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")
    _require_temperature(params, around)
    losses, tables = params.losses(state, current, dt), params.pack.tables
    if losses.efficiency != tables.efficiency:
        tables = tables._replace(efficiency=losses.efficiency)
    soc, polarisation, temperature, energy_terminal, heat = step_kernel(
        tables,
        state.soc,
        state.polarisation_voltage,
        state.temperature,
        float(current),
        float(dt),
        float(around),
        losses.side_current,
    )
    return PackState(
        soc=soc,
        polarisation_voltage=polarisation,
        temperature=temperature,
        charge_drawn=state.charge_drawn + current * dt,
        energy_terminal=state.energy_terminal + energy_terminal,
        energy_heat=state.energy_heat + heat,
    )


def limits_exceeded(params: BatteryParams, state: PackState, current: float) -> tuple[str, ...]:
    """The limits that the pack is beyond at `current` [A, out positive], in words; empty when all is well."""
    found: list[str] = []
    if current > params.discharge_current_limit * params.cells_parallel:
        found.append("discharge current above its limit")
    if -current > params.charge_current_limit * params.cells_parallel:
        found.append("charge current above its limit")
    if state.temperature > params.temperature_max:
        found.append("too hot")
    if state.temperature < params.temperature_frozen:
        found.append("frozen")
    elif state.temperature < params.temperature_discharge_min:
        found.append("too cold to discharge")
    elif current < 0.0 and state.temperature < params.temperature_charge_min:
        found.append("too cold to charge")
    if state.soc <= 0.0:
        found.append("empty")
    return tuple(found)


def _require_temperature(params: BatteryParams, temperature: float) -> None:
    if not (isfinite(temperature) and temperature > 0.0):
        raise InvalidValueError(f"{params.name} temperature [K]", temperature, "a finite number above 0")
