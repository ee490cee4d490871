"""A stack of hydrogen and oxygen fuel cells with its tanks: polarisation, Faraday's law, heat.

The stack works at its own temperature, which it is taken to hold; a regulator gives its power to the bus at any
voltage. Equations and their sources: `polarisation`. Auxiliaries (pumps, valves) take a part of what the stack makes.
It gives nothing once either tank is empty, and in the step that empties one what is left lasts for (`lasting`), but for
a rounding that may show as a mass below 0.

Start-up and ageing: `cell_condition`. Left out: purging, and how the voltage goes with pressure.
"""

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import ClassVar

from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.power.cell_condition import CellCondition, CellConditionParams, worn_fuel_cell
from sojourn_machine.power.polarisation import (
    CM2,
    HYDROGEN_PER_CHARGE,
    OXYGEN_PER_CHARGE,
    THERMONEUTRAL,
    FuelCellCurve,
)
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings


@dataclass(frozen=True, slots=True)
class FuelCellState:
    """What a stack remembers."""

    hydrogen: float
    """In its tank [kg]."""
    oxygen: float
    """Likewise [kg]."""
    water: float = 0.0
    """Made since the start of the run [kg]."""
    energy: float = 0.0
    """Given to the bus [J]."""
    energy_heat: float = 0.0
    """Released by stack, auxiliaries and regulator [J]."""
    warmth: float = 0.0
    """w, 0 cold to 1 warm [1]."""
    worn: float = 0.0
    """u, lost by each cell [V]."""


class FuelCellParams(CellConditionParams, SourceParams):
    """One stack."""

    kind: str = "fuel_cell"
    curve: FuelCellCurve = Field(description="of one cell")
    cells: int = Field(ge=1, le=10_000, description="in series [1]")
    area: float = Field(gt=0.0, le=10.0, description="of one cell [m2]")
    largest_current_density: float = Field(gt=0.0, le=1e4, description="that is allowed [mA/cm2]")
    hydrogen: float = Field(ge=0.0, le=1e4, description="in its tank at the start [kg]")
    oxygen: float = Field(ge=0.0, le=1e5, description="in its tank at the start [kg]")
    auxiliaries: float = Field(default=0.0, ge=0.0, lt=1.0, description="part of its power that pumps take [1]")
    regulator_efficiency: float = Field(default=1.0, gt=0.0, le=1.0, description="between stack and bus [1]")

    @cached_property
    def best_density(self) -> float:
        """Current density of the most power that is allowed [mA/cm2]."""
        return self.curve.most_power_density(self.largest_current_density)

    @property
    def passed(self) -> float:
        """Part of the stack's power that reaches the bus [1]."""
        return (1.0 - self.auxiliaries) * self.regulator_efficiency

    def initial_state(self) -> FuelCellState:
        """Tanks as its file has them."""
        return FuelCellState(self.hydrogen, self.oxygen, worn=self.worn_before)

    @property
    def milliwatts(self) -> float:
        """Of a milliwatt a square centimetre of each cell, the power of the stack [W cm2/mW]."""
        return self.cells * self.area * CM2 * 1e-3

    def stack_power(self, density: float) -> float:
        """At a current density [mA/cm2], of new cells [W]."""
        return self.milliwatts * density * self.curve.voltage(density)

    def worn_curve(self, worn: float) -> tuple[FuelCellCurve, float]:
        """Curve of cells that have lost a voltage [V], and the density of their most power; by steps of 10 uV."""
        return worn_fuel_cell(self.curve, worn, self.largest_current_density)

    def point(self, state: FuelCellState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """The most that the curve allows; nothing from an empty tank."""
        if state.hydrogen <= 0.0 or state.oxygen <= 0.0:
            return SourcePoint(0.0)
        curve, best = self.worn_curve(state.worn)
        return SourcePoint(self.allowed(state.warmth) * self.passed * self.milliwatts * best * curve.voltage(best))

    runs_out: ClassVar[bool] = True

    def lasting(self, state: FuelCellState, dt: float) -> float:
        """See `SourceParams`: by the charge that the emptier tank is worth."""
        charge = max(min(state.hydrogen / HYDROGEN_PER_CHARGE, state.oxygen / OXYGEN_PER_CHARGE), 0.0) / dt
        curve, best = self.worn_curve(state.worn)
        density = charge / self.milliwatts
        return self.passed * charge * curve.voltage(density) if density < best else inf

    def voltage_at(self, power: float, worn: float = 0.0) -> float:
        """Of a cell while the bus is given a power [W], of cells that have lost a voltage [V] [V]."""
        curve, best = self.worn_curve(worn)
        return curve.voltage(curve.density_at(power / self.passed / self.milliwatts, best))

    def step(
        self, state: FuelCellState, power: float, dt: float, surroundings: PowerSurroundings = DARK
    ) -> FuelCellState:
        """Emptier by what it took to give `power` [W] for `dt` [s]."""
        require_step(power, dt)
        if power <= 0.0:
            if not state.warmth:
                return state
            return replace(state, warmth=self.after(CellCondition(state.warmth, state.worn), False, dt).warmth)
        charge = power / self.passed / self.voltage_at(power, state.worn) * dt  # through all cells, one after another
        condition = self.after(CellCondition(state.warmth, state.worn), True, dt)
        hydrogen, oxygen = HYDROGEN_PER_CHARGE * charge, OXYGEN_PER_CHARGE * charge
        return replace(
            state,
            hydrogen=state.hydrogen - hydrogen,
            oxygen=state.oxygen - oxygen,
            water=state.water + hydrogen + oxygen,
            energy=state.energy + power * dt,
            energy_heat=state.energy_heat + THERMONEUTRAL * charge - power * dt,
            warmth=condition.warmth,
            worn=condition.worn,
        )

    def heat_given(self, before: FuelCellState, after: FuelCellState) -> float:
        """All of its heat: the stack holds its temperature."""
        return after.energy_heat - before.energy_heat

    @property
    def most_power(self) -> float:
        """With full tanks, warm, and as worn as before the run [W]."""
        curve, best = self.worn_curve(self.worn_before)
        return self.passed * self.milliwatts * best * curve.voltage(best)
