"""A store of hydrogen and oxygen: fuel cells that burn them to water, an electrolyser that splits it again.

    discharge    stack power = bus power / (1 - a) / eta_r;     charge    electrolyser power = bus power (1 - a) eta_r
    soc          hydrogen in the tank, of what it holds; water and oxygen go with it in fixed proportion

with the voltages over the currents and Faraday's law of `polarisation`, a: part of the power that auxiliaries take,
eta_r: of the regulator. The regulator shows the bus a voltage that rises with the charge from `voltage_empty` to
`voltage_full` and falls with the current (`resistance`, a droop without a loss), so that such a store shares a bus with
others. What is not electric is heat: 1.481 V less the voltage for each charge in a fuel cell, the voltage less 1.481 V
in an electrolyser.

Published round trips lie near 50 % (Burke 2003, "Fuel cells for space science applications", NASA/TM-2003-212730: 45 to
60 %). Valid at the working temperatures of both; start-up, losses of gas and the drying of gases are left out. The
temperature is that of the surroundings.
"""

from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.polarisation import (
    CM2,
    HYDROGEN_PER_CHARGE,
    THERMONEUTRAL,
    ElectrolyserCurve,
    FuelCellCurve,
)
from sojourn_machine.power.stores import StoreParams, StorePoint

WATTS = CM2 * 1e-3
"""In a milliwatt a square centimetre, for a square metre."""


@dataclass(frozen=True, slots=True)
class RegenerativeState:
    """What such a store remembers. Energies are sums since `initial_state`."""

    soc: float
    """Hydrogen, of what the tank holds [1]; a little below 0 is possible in the step that empties it."""
    temperature: float
    """[K]"""
    energy_terminal: float = 0.0
    """Net energy through the terminals, out positive [J]."""
    energy_heat: float = 0.0
    """Released; a little less than nothing while an electrolyser runs slowly, which cools [J]."""


class RegenerativeFuelCellParams(StoreParams):
    """One store."""

    kind: str = "regenerative_fuel_cell"
    fuel_cell: FuelCellCurve = Field(description="of one cell of the stack")
    cells: int = Field(ge=1, le=10_000, description="of the stack [1]")
    area: float = Field(gt=0.0, le=10.0, description="of one of them [m2]")
    largest_current_density: float = Field(gt=0.0, le=1e4, description="in them [mA/cm2]")
    electrolyser: ElectrolyserCurve = Field(description="of one cell of the electrolyser")
    electrolyser_cells: int = Field(ge=1, le=10_000, description="[1]")
    electrolyser_area: float = Field(gt=0.0, le=10.0, description="of one of them [m2]")
    largest_electrolysis_density: float = Field(gt=0.0, le=1e4, description="in them [mA/cm2]")
    hydrogen: float = Field(gt=0.0, le=1e4, description="in the full tank [kg]")
    auxiliaries: float = Field(default=0.05, ge=0.0, lt=1.0, description="part of the power that pumps take [1]")
    regulator_efficiency: float = Field(default=0.95, gt=0.0, le=1.0, description="between bus and cells [1]")
    voltage_empty: float = Field(gt=0.0, le=1e4, description="that its regulator shows without current [V]")
    voltage_full: float = Field(gt=0.0, le=1e4, description="likewise, full [V]")
    resistance: float = Field(gt=0.0, le=100.0, description="droop of the regulator [ohm]")
    temperature_surroundings: float = Field(gt=20.0, lt=1000.0, description="temperature of its surroundings [K]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.voltage_full <= self.voltage_empty:
            raise InvalidValueError("voltage_full", self.voltage_full, f"above voltage_empty, {self.voltage_empty} V")
        return self

    @property
    def passed(self) -> float:
        """Part of the power that gets from cells to bus, or from bus to cells [1]."""
        return (1.0 - self.auxiliaries) * self.regulator_efficiency

    @cached_property
    def best_density(self) -> float:
        """Current density of the most power of the stack [mA/cm2]."""
        return self.fuel_cell.most_power_density(self.largest_current_density)

    @cached_property
    def most_discharge(self) -> float:
        """Power to the bus [W]."""
        density = self.best_density
        return self.passed * self.cells * self.area * WATTS * density * self.fuel_cell.voltage(density)

    @cached_property
    def most_charge(self) -> float:
        """Power from the bus [W]."""
        density = self.largest_electrolysis_density
        taken = self.electrolyser_cells * self.electrolyser_area * WATTS * density * self.electrolyser.voltage(density)
        return taken / self.passed

    def charge_of(self, power: float) -> float:
        """Charge that goes through all cells, one after another, while the bus is given a power, out positive; negative
        in the electrolyser [A].
        """
        if power >= 0.0:
            each = power / self.passed / (self.cells * self.area * WATTS)
            return power / self.passed / self.fuel_cell.voltage(self.fuel_cell.density_at(each, self.best_density))
        each = -power * self.passed / (self.electrolyser_cells * self.electrolyser_area * WATTS)
        return power * self.passed / self.electrolyser.voltage(self.electrolyser.density_at(each))

    @cached_property
    def _energy(self) -> float:
        """That a full tank gives at half of the most power [J]."""
        half = 0.5 * self.most_discharge
        return half * self.hydrogen / (HYDROGEN_PER_CHARGE * self.charge_of(half))

    @property
    def charge_capacity(self) -> float:
        """Charge between full and empty at the terminals, at half of the most power [C]."""
        return 2.0 * self._energy / (self.voltage_empty + self.voltage_full)

    @property
    def charging_efficiency(self) -> float:
        """Of a whole round at half of both powers [1]."""
        half = 0.5 * self.most_charge
        return self._energy / self.hydrogen * HYDROGEN_PER_CHARGE * -self.charge_of(-half) / half

    def initial_state(self, soc: float, temperature: float | None = None) -> RegenerativeState:
        """See `StoreParams`."""
        if not 0.0 <= soc <= 1.0:
            raise InvalidValueError("state of charge of the regenerative fuel cell", soc, "0 to 1")
        start = self.temperature_surroundings if temperature is None else temperature
        if not (isfinite(start) and start > 0.0):
            raise InvalidValueError("temperature of the regenerative fuel cell [K]", start, "a finite number above 0")
        return RegenerativeState(float(soc), float(start))

    def point(self, state: RegenerativeState) -> StorePoint:
        """See `StoreParams`."""
        force = self.open_circuit_voltage(state.soc)
        ceiling = min(self.voltage_full, force + self.resistance * self.most_charge / force)
        return StorePoint(force, self.resistance, ceiling, state.soc > 0.0, state.soc < 1.0)

    def step(
        self, state: RegenerativeState, current: float, dt: float, temperature_surroundings: float | None = None
    ) -> RegenerativeState:
        """See `StoreParams`."""
        if not isfinite(current):
            raise InvalidValueError("current of the regenerative fuel cell [A]", current, "a finite number")
        if not (isfinite(dt) and dt > 0.0):
            raise InvalidValueError("dt [s]", dt, "a finite number above 0")
        around = self.temperature_surroundings if temperature_surroundings is None else temperature_surroundings
        if not (isfinite(around) and around > 0.0):
            raise InvalidValueError("temperature of the regenerative fuel cell [K]", around, "a finite number above 0")
        power = (self.open_circuit_voltage(state.soc) - self.resistance * current) * current
        charge = self.charge_of(power) * dt
        return replace(
            state,
            soc=state.soc - HYDROGEN_PER_CHARGE * charge / self.hydrogen,
            temperature=around,
            energy_terminal=state.energy_terminal + power * dt,
            energy_heat=state.energy_heat + THERMONEUTRAL * charge - power * dt,
        )

    def heat_given(self, before: RegenerativeState, after: RegenerativeState) -> float:
        """All that was released: its temperature is that of its surroundings [J]."""
        return after.energy_heat - before.energy_heat

    def chemical_energy(self, soc: float) -> float:
        """Heat of the reaction of all that is stored [J]."""
        return soc * self.hydrogen / HYDROGEN_PER_CHARGE * THERMONEUTRAL

    def stored_energy(self, soc: float) -> float:
        """That it would give at half of its most power [J]."""
        return soc * self._energy

    def open_circuit_voltage(self, soc: float) -> float:
        """That its regulator shows without a current [V]."""
        return self.voltage_empty + soc * (self.voltage_full - self.voltage_empty)

    def soc_from_open_circuit_voltage(self, voltage: float) -> float:
        """State of charge [0..1] by what the regulator shows without a current [V]."""
        soc = (voltage - self.voltage_empty) / (self.voltage_full - self.voltage_empty)
        return min(max(soc, 0.0), 1.0)

    def settled_resistance(self, temperature: float) -> float:
        """The droop, at any temperature [ohm]."""
        return self.resistance

    def limits_exceeded(self, temperature: float, current: float) -> tuple[str, ...]:
        """Which limits a current [A, out positive] breaks, in words."""
        found = []
        if current > self.most_discharge / self.voltage_empty:
            found.append("discharge current above its limit")
        if -current > self.most_charge / self.voltage_empty:
            found.append("charge current above its limit")
        return tuple(found)

    @property
    def most_power(self) -> float:
        """That the stack can give to the bus [W]."""
        return self.most_discharge
