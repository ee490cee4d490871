"""How warm cells of hydrogen and oxygen are and how far they are worn: what a fuel cell and an electrolyser share.

    w' = 1/t_w while they work, -1/t_c while not, 0 <= w <= 1             most power = (p + (1 - p) w) of that when warm
    V = V(i) - u of a fuel cell, V(i) + u of an electrolyser,   u' = r_h while they work, + r_s at each start from cold

Start-up: cold cells allow the part p of their power, and all of it after t_w of work; they are cold again after t_c
without any. Ageing: every cell loses voltage by the hours of its work and by its starts, a fuel cell 1 to 10 uV/h of
good cells in steady running (de Bruijn, Dam and Janssen 2008, "Review: durability and degradation issues of PEM fuel
cell components", Fuel Cells 8:3); a loss that is the same at all currents is an assumption. Both are linear, and off
where their numbers are 0.
"""

from functools import lru_cache
from typing import NamedTuple

from pydantic import Field

from sojourn_machine.params import Params
from sojourn_machine.power.polarisation import ElectrolyserCurve, FuelCellCurve

SECONDS_PER_HOUR = 3600.0
WEAR_STEP = 1e-5
"""Wear for which a curve is made anew [V]."""


class CellCondition(NamedTuple):
    """What cells remember."""

    warmth: float = 0.0
    """w, 0 cold to 1 warm [1]."""
    worn: float = 0.0
    """u, lost by each cell [V]."""


class CellConditionParams(Params):
    """How cells warm and wear, and what they have behind them."""

    warm_up_s: float = Field(default=0.0, ge=0.0, le=1e5, description="t_w; 0: it is always warm [s]")
    cool_down_s: float = Field(default=3600.0, gt=0.0, le=1e7, description="t_c [s]")
    cold_part: float = Field(default=0.2, gt=0.0, le=1.0, description="p [1]")
    wear_per_hour: float = Field(default=0.0, ge=0.0, le=0.1, description="r_h, of each cell [V/h]")
    wear_per_start: float = Field(default=0.0, ge=0.0, le=0.1, description="r_s, likewise [V]")
    hours_before: float = Field(default=0.0, ge=0.0, le=1e6, description="of work before the run [h]")
    starts_before: int = Field(default=0, ge=0, le=1_000_000, description="likewise, from cold [1]")

    @property
    def worn_before(self) -> float:
        """Lost by each cell before the run [V]."""
        return self.wear_per_hour * self.hours_before + self.wear_per_start * self.starts_before

    def allowed(self, warmth: float) -> float:
        """Part of the power of warm cells that they allow [1]."""
        return self.cold_part + (1.0 - self.cold_part) * warmth if self.warm_up_s > 0.0 else 1.0

    def after(self, before: CellCondition, works: bool, dt: float) -> CellCondition:
        """After dt [s] of work or of none."""
        if not works:
            return CellCondition(max(before.warmth - dt / self.cool_down_s, 0.0), before.worn)
        started = self.wear_per_start if before.warmth == 0.0 else 0.0
        warmer = 1.0 if self.warm_up_s <= dt else min(before.warmth + dt / self.warm_up_s, 1.0)
        return CellCondition(warmer, before.worn + started + self.wear_per_hour * dt / SECONDS_PER_HOUR)


NEW = CellCondition()
"""Cold cells that never worked."""
ALWAYS_WARM = CellConditionParams()
"""And as good as new for ever."""


def worn_fuel_cell(curve: FuelCellCurve, worn: float, largest: float) -> tuple[FuelCellCurve, float]:
    """Curve of cells that have lost a voltage [V], by steps of 10 uV, and the density of their most power up to a
    largest one [mA/cm2].
    """
    return _worn_fuel_cell(curve, round(min(worn, curve.open_voltage) / WEAR_STEP), largest)


def worn_electrolyser(curve: ElectrolyserCurve, worn: float) -> ElectrolyserCurve:
    """Curve of cells that need a voltage [V] more, by steps of 10 uV."""
    steps = round(worn / WEAR_STEP)
    return curve if steps == 0 else _worn_electrolyser(curve, steps)


@lru_cache(maxsize=64)
def _worn_fuel_cell(curve: FuelCellCurve, steps: int, largest: float) -> tuple[FuelCellCurve, float]:
    sunk = curve.model_copy(update={"open_voltage": curve.open_voltage - steps * WEAR_STEP}) if steps else curve
    return sunk, sunk.most_power_density(largest)


@lru_cache(maxsize=64)
def _worn_electrolyser(curve: ElectrolyserCurve, steps: int) -> ElectrolyserCurve:
    return curve.model_copy(update={"reversible_voltage": curve.reversible_voltage + steps * WEAR_STEP})
