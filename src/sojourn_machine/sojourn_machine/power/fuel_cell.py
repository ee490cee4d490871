"""A stack of hydrogen and oxygen fuel cells with its tanks: polarisation, Faraday's law, heat.

The stack works at its own temperature, which it is taken to hold; a regulator gives its power to the bus at any
voltage. Equations and their sources: `polarisation`. Auxiliaries (pumps, valves) take a part of what the stack makes.
It gives nothing once either tank is empty; what the step that empties one takes too much shows as a mass below 0.

    w' = 1/t_w while it gives power, -1/t_c while not, 0 <= w <= 1        most power = (p + (1 - p) w) of that when warm
    V = V(i) - u,    u' = r_h while it gives power,  + r_s at each start from cold

Start-up: a cold stack allows the part p of its power, and all of it after t_w of running; it is cold again after t_c
without a load. Ageing: every cell loses voltage by the hours of its running and by its starts, 1 to 10 uV/h of good
cells in steady running (de Bruijn, Dam and Janssen 2008, "Review: durability and degradation issues of PEM fuel cell
components", Fuel Cells 8:3); a loss that is the same at all currents is an assumption. Both are linear, and off where
their numbers are 0. Left out: purging, and how the voltage goes with pressure.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.power.polarisation import (
    CM2,
    HYDROGEN_PER_CHARGE,
    OXYGEN_PER_CHARGE,
    THERMONEUTRAL,
    FuelCellCurve,
)
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

SECONDS_PER_HOUR = 3600.0
WEAR_STEP = 1e-5
"""Wear for which a curve is made anew [V]."""


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


class FuelCellParams(SourceParams):
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
    warm_up_s: float = Field(default=0.0, ge=0.0, le=1e5, description="t_w; 0: it is always warm [s]")
    cool_down_s: float = Field(default=3600.0, gt=0.0, le=1e7, description="t_c [s]")
    cold_part: float = Field(default=0.2, gt=0.0, le=1.0, description="p [1]")
    wear_per_hour: float = Field(default=0.0, ge=0.0, le=0.1, description="r_h, of each cell [V/h]")
    wear_per_start: float = Field(default=0.0, ge=0.0, le=0.1, description="r_s, likewise [V]")

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
        return FuelCellState(self.hydrogen, self.oxygen)

    @property
    def milliwatts(self) -> float:
        """Of a milliwatt a square centimetre of each cell, the power of the stack [W cm2/mW]."""
        return self.cells * self.area * CM2 * 1e-3

    def stack_power(self, density: float) -> float:
        """At a current density [mA/cm2], of new cells [W]."""
        return self.milliwatts * density * self.curve.voltage(density)

    def worn_curve(self, worn: float) -> tuple[FuelCellCurve, float]:
        """Curve of cells that have lost a voltage [V], and the density of their most power; by steps of 10 uV."""
        steps = round(min(worn, self.curve.open_voltage) / WEAR_STEP)
        return (self.curve, self.best_density) if steps == 0 else _worn(self.curve, self.largest_current_density, steps)

    def point(self, state: FuelCellState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """The most that the curve allows; nothing from an empty tank."""
        if state.hydrogen <= 0.0 or state.oxygen <= 0.0:
            return SourcePoint(0.0)
        curve, best = self.worn_curve(state.worn)
        allowed = self.cold_part + (1.0 - self.cold_part) * self._warmth(state)
        return SourcePoint(allowed * self.passed * self.milliwatts * best * curve.voltage(best))

    def voltage_at(self, power: float, worn: float = 0.0) -> float:
        """Of a cell while the bus is given a power [W], of cells that have lost a voltage [V] [V]."""
        curve, best = self.worn_curve(worn)
        return curve.voltage(curve.density_at(power / self.passed / self.milliwatts, best))

    def _warmth(self, state: FuelCellState) -> float:
        return state.warmth if self.warm_up_s > 0.0 else 1.0

    def step(
        self, state: FuelCellState, power: float, dt: float, surroundings: PowerSurroundings = DARK
    ) -> FuelCellState:
        """Emptier by what it took to give `power` [W] for `dt` [s]."""
        require_step(power, dt)
        if power <= 0.0:
            return replace(state, warmth=max(state.warmth - dt / self.cool_down_s, 0.0)) if state.warmth else state
        charge = power / self.passed / self.voltage_at(power, state.worn) * dt  # through all cells, one after another
        warmer = 1.0 if self.warm_up_s <= dt else min(state.warmth + dt / self.warm_up_s, 1.0)
        started = self.wear_per_start if state.warmth == 0.0 else 0.0
        hydrogen, oxygen = HYDROGEN_PER_CHARGE * charge, OXYGEN_PER_CHARGE * charge
        return replace(
            state,
            hydrogen=state.hydrogen - hydrogen,
            oxygen=state.oxygen - oxygen,
            water=state.water + hydrogen + oxygen,
            energy=state.energy + power * dt,
            energy_heat=state.energy_heat + THERMONEUTRAL * charge - power * dt,
            warmth=warmer,
            worn=state.worn + started + self.wear_per_hour * dt / SECONDS_PER_HOUR,
        )

    def heat_given(self, before: FuelCellState, after: FuelCellState) -> float:
        """All of its heat: the stack holds its temperature."""
        return after.energy_heat - before.energy_heat

    @property
    def most_power(self) -> float:
        """With full tanks, warm and new [W]."""
        return self.passed * self.stack_power(self.best_density)


@lru_cache(maxsize=64)
def _worn(curve: FuelCellCurve, largest: float, steps: int) -> tuple[FuelCellCurve, float]:
    """A curve that has sunk by so many steps, and the density of its most power up to a largest one."""
    sunk = curve.model_copy(update={"open_voltage": curve.open_voltage - steps * WEAR_STEP})
    return sunk, sunk.most_power_density(largest)
