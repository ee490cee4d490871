"""A store of hydrogen and oxygen: fuel cells that burn them to water, an electrolyser that splits it again.

    discharge    stack power = bus power / (1 - a) / eta_r;     charge    electrolyser power = bus power (1 - a) eta_r
    soc          hydrogen in the tank, of what it holds; water and oxygen go with it in fixed proportion

with the voltages over the currents and Faraday's law of `polarisation`, a: part of the power that auxiliaries take,
eta_r: of the regulator. The regulator shows the bus a voltage that rises with the charge from `voltage_empty` to
`voltage_full` and falls with the current (`resistance`, a droop without a loss), so that such a store shares a bus with
others. What is not electric is heat: 1.481 V less the voltage for each charge in a fuel cell, the voltage less 1.481 V
in an electrolyser.

The regulator gives no more than the cells do, nor lets sources charge with more than the electrolyser takes: most power
of cells as warm and as worn as they are, `cell_condition`, of each of both where its table is there. Without one they
are always warm and never wear. What other stores of the bus or motors put in is not held back.

Published round trips lie near 50 % (Burke 2003, "Fuel cells for space science applications", NASA/TM-2003-212730: 45 to
60 %). Valid at the working temperatures of both; what keeps cells warm, losses of gas and the drying of gases are left
out. The temperature is that of the surroundings.
"""

from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, sqrt
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.cell_condition import (
    ALWAYS_WARM,
    NEW,
    CellCondition,
    CellConditionParams,
    worn_electrolyser,
    worn_fuel_cell,
)
from sojourn_machine.power.polarisation import (
    CM2,
    HYDROGEN_PER_CHARGE,
    THERMONEUTRAL,
    ElectrolyserCurve,
    FuelCellCurve,
)
from sojourn_machine.power.stores import ForceCourse, StoreParams, StorePoint

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
    cells: CellCondition = NEW
    """Of the stack."""
    electrolyser: CellCondition = NEW


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
    condition: CellConditionParams | None = Field(
        default=None, description="how the stack warms and wears; none: it is always warm and stays new"
    )
    electrolyser_condition: CellConditionParams | None = Field(default=None, description="likewise, the electrolyser")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.voltage_full <= self.voltage_empty:
            raise InvalidValueError("voltage_full", self.voltage_full, f"above voltage_empty, {self.voltage_empty} V")
        if self.most_discharge <= 0.0:
            raise InvalidValueError("condition", self._stack.worn_before, "wear [V] that leaves the cells a voltage")
        if self.best_round_trip > 1.0:
            allowed = f"at least what the stack gives back of it without a current, {self._best_given_back:.4g} V"
            raise InvalidValueError("electrolyser.reversible_voltage", self.electrolyser.reversible_voltage, allowed)
        return self

    @property
    def passed(self) -> float:
        """Part of the power that gets from cells to bus, or from bus to cells [1]."""
        return (1.0 - self.auxiliaries) * self.regulator_efficiency

    @property
    def _stack(self) -> CellConditionParams:
        return self.condition or ALWAYS_WARM

    @property
    def _electrolysis(self) -> CellConditionParams:
        return self.electrolyser_condition or ALWAYS_WARM

    @cached_property
    def most_discharge(self) -> float:
        """Power to the bus, of warm cells as worn as before the run [W]."""
        return self._discharge_of(self._stack.worn_before)

    @cached_property
    def most_charge(self) -> float:
        """Power from the bus, likewise [W]."""
        return self._charge_of(self._electrolysis.worn_before)

    def _discharge_of(self, worn: float) -> float:
        """The most to the bus of warm cells that have lost a voltage [V] [W]."""
        curve, density = worn_fuel_cell(self.fuel_cell, worn, self.largest_current_density)
        return self.passed * self.cells * self.area * WATTS * density * curve.voltage(density)

    def _charge_of(self, worn: float) -> float:
        """The most from the bus, likewise [W]."""
        density = self.largest_electrolysis_density
        volts = worn_electrolyser(self.electrolyser, worn).voltage(density)
        return self.electrolyser_cells * self.electrolyser_area * WATTS * density * volts / self.passed

    def charge_of(self, power: float, worn: float | None = None) -> float:
        """Charge that goes through all cells, one after another, while the bus is given a power, out positive; negative
        in the electrolyser [A].

        Args:
            power: [W]. worn: lost by each of the cells that work [V], by default what they had lost before the run.

        Raises:
            InvalidValueError: power of cells that have no voltage left.
        """
        if power >= 0.0:
            lost = self._stack.worn_before if worn is None else worn
            curve, best = worn_fuel_cell(self.fuel_cell, lost, self.largest_current_density)
            each = power / self.passed / (self.cells * self.area * WATTS)
            volts = curve.voltage(curve.density_at(each, best))
            if volts <= 0.0:
                raise InvalidValueError("power of worn cells [W]", power, "none: they are worn out")
            return power / self.passed / volts
        split = worn_electrolyser(self.electrolyser, self._electrolysis.worn_before if worn is None else worn)
        each = -power * self.passed / (self.electrolyser_cells * self.electrolyser_area * WATTS)
        return power * self.passed / split.voltage(split.density_at(each))

    @cached_property
    def _energy(self) -> float:
        """That a full tank gives at half of the most power [J]."""
        half = 0.5 * self.most_discharge
        return half * self.hydrogen / (HYDROGEN_PER_CHARGE * self.charge_of(half))

    @property
    def charge_capacity(self) -> float:
        """Charge between full and empty at the terminals, at half of the most power [C]."""
        return 2.0 * self._energy / (self.voltage_empty + self.voltage_full)

    @cached_property
    def charging_efficiency(self) -> float:
        """Of a whole round at half of both powers [1]."""
        half = 0.5 * self.most_charge
        return self._energy / self.hydrogen * HYDROGEN_PER_CHARGE * -self.charge_of(-half) / half

    @property
    def _best_given_back(self) -> float:
        """Of each charge that was split: of the cells' highest voltage, at hardly a current, less what regulator and
        auxiliaries take on both ways [V].
        """
        curve, _ = worn_fuel_cell(self.fuel_cell, self._stack.worn_before, self.largest_current_density)
        return self.passed**2 * curve.voltage(0.0)

    @property
    def best_round_trip(self) -> float:
        """`charging_efficiency` at no powers: at any others the cells give less and the electrolyser takes more [1]."""
        split = worn_electrolyser(self.electrolyser, self._electrolysis.worn_before)
        return self._best_given_back / split.voltage(0.0)

    def initial_state(self, soc: float, temperature: float | None = None) -> RegenerativeState:
        """See `StoreParams`."""
        if not 0.0 <= soc <= 1.0:
            raise InvalidValueError("state of charge of the regenerative fuel cell", soc, "0 to 1")
        start = self.temperature_surroundings if temperature is None else temperature
        if not (isfinite(start) and start > 0.0):
            raise InvalidValueError("temperature of the regenerative fuel cell [K]", start, "a finite number above 0")
        return RegenerativeState(
            float(soc),
            float(start),
            cells=CellCondition(worn=self._stack.worn_before),
            electrolyser=CellCondition(worn=self._electrolysis.worn_before),
        )

    def point(self, state: RegenerativeState) -> StorePoint:
        """See `StoreParams`."""
        force = self.open_circuit_voltage(state.soc)
        out = self._stack.allowed(state.cells.warmth) * self._discharge_of(state.cells.worn)
        taken = self._electrolysis.allowed(state.electrolyser.warmth) * self._charge_of(state.electrolyser.worn)
        most = self._current_of(out, force)
        # V (V - force) / R = taken of the voltage V
        ceiling = min(self.voltage_full, 0.5 * (force + sqrt(force**2 + 4.0 * self.resistance * taken)))
        return StorePoint(force, self.resistance, ceiling, state.soc > 0.0 and out > 0.0, state.soc < 1.0, most)

    def _current_of(self, power: float, force: float) -> float:
        """I of (force - R I) I = power out [A]."""
        return 2.0 * power / (force + sqrt(max(force**2 - 4.0 * self.resistance * power, 0.0)))

    def course(self, state: RegenerativeState, point: StorePoint, dt: float) -> ForceCourse:
        """See `StoreParams`; its regulator holds what it shows at the beginning, as `step` has it."""
        known = super().course(state, point, dt)
        return ForceCourse(point.source, point.resistance, known.end_force, known.end_resistance)

    def emptying(self, state: RegenerativeState, dt: float) -> float:
        """See `StoreParams`: of the power that the hydrogen lasts for."""
        charge = state.soc * self.hydrogen / HYDROGEN_PER_CHARGE / dt
        curve, best = worn_fuel_cell(self.fuel_cell, state.cells.worn, self.largest_current_density)
        density = charge / (self.cells * self.area * WATTS)
        if density >= best:
            return inf
        return self._current_of(self.passed * charge * curve.voltage(density), self.open_circuit_voltage(state.soc))

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
        charge = self.charge_of(power, (state.cells if power >= 0.0 else state.electrolyser).worn) * dt
        return replace(
            state,
            soc=state.soc - HYDROGEN_PER_CHARGE * charge / self.hydrogen,
            temperature=around,
            energy_terminal=state.energy_terminal + power * dt,
            energy_heat=state.energy_heat + THERMONEUTRAL * charge - power * dt,
            cells=self._stack.after(state.cells, power > 0.0, dt),
            electrolyser=self._electrolysis.after(state.electrolyser, power < 0.0, dt),
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
