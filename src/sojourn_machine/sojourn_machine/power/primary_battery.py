"""A battery that is not charged: lithium thionyl chloride, silver zinc, by Peukert's law.

    t = H (C / (I H))^k        hours to empty at a current I; C: capacity at the current C/H, k: Peukert's exponent

As a current that empties the cells beside the one at the terminals, I_e - I with

    I_e = I (I H / C)^(k - 1) / part(T) + Q r 2^((T - 293 K) / 10 K)

part: of the capacity that the cells give at their temperature; r: self-discharge; its doubling each 10 K is Van 't
Hoff's rule (Doerffel and Abu Sharkh 2006, "A critical review of using the Peukert equation for determining the
remaining capacity of lead-acid and lithium-ion batteries", J. Power Sources 155:395, on how far the law holds; Linden
and Reddy 2002, "Handbook of Batteries", 3rd ed., ch. 14 and 33). What the law loses is taken for heat. Voltages,
resistances and heat are those of `battery`; slower than C/H the capacity is C.
"""

from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.params import require_rising
from sojourn_machine.power.battery import SECONDS_PER_HOUR, BatteryParams
from sojourn_machine.power.cell_losses import CellLosses, SelfDischarge
from sojourn_machine.power.pack import PackState
from sojourn_machine.power.radioisotope_generator import SECONDS_PER_YEAR
from sojourn_machine.power.stores import StorePoint


class PrimaryBatteryParams(BatteryParams):
    """A pack of like cells."""

    kind: str = "primary_battery"
    coulombic_efficiency: float = Field(default=1.0, gt=0.5, le=1.0, description="without a meaning here [1]")
    charge_current_limit: float = Field(default=0.0, ge=0.0, le=0.0, description="0: it is not charged [A]")
    temperature_charge_min: float = Field(default=273.15, gt=20.0, lt=1000.0, description="without a meaning here [K]")
    peukert: float = Field(default=1.0, ge=1.0, le=2.0, description="k [1]")
    rated_hours: float = Field(gt=0.0, le=1e5, description="H, in which it gives capacity_ah [h]")
    self_discharge_per_year: float = Field(default=0.0, ge=0.0, lt=1.0, description="r, at 20 degrees [1]")
    part_temperatures: tuple[float, ...] = Field(
        default=(293.15,), min_length=1, description="temperatures of part_points, strictly rising [K]"
    )
    part_points: tuple[float, ...] = Field(
        default=(1.0,), min_length=1, description="of the capacity that it gives [1]"
    )

    @model_validator(mode="after")
    def _check_parts(self) -> Self:
        if len(self.part_points) != len(self.part_temperatures):
            raise ValueError(
                f"part_points has {len(self.part_points)} values: allowed is {len(self.part_temperatures)}, "
                "as many as part_temperatures"
            )
        if min(self.part_points) <= 0.0 or max(self.part_points) > 1.0:
            raise ValueError("part_points: allowed is above 0, at most 1")
        require_rising("part_temperatures", self.part_temperatures)
        return self

    @property
    def charging_efficiency(self) -> float:
        """Nothing is stored; what a current in would be counted as [1]."""
        return 1.0

    def point(self, state: PackState) -> StorePoint:
        """As a battery that nothing charges."""
        found = super().point(state)
        return found._replace(ceiling=found.source, charges=False)

    def peukert_current(self, current: float, temperature: float) -> float:
        """Of the whole pack: what empties it while a current flows at a temperature [K] [A]."""
        rated = self.charge_capacity / (self.rated_hours * SECONDS_PER_HOUR)
        part = float(np.interp(temperature, self.part_temperatures, self.part_points))
        return current * max(current / rated, 1.0) ** (self.peukert - 1.0) / part if current > 0.0 else 0.0

    def emptying(self, state: PackState, dt: float) -> float:
        """See `StoreParams`: Peukert's law the other way round."""
        rated = self.charge_capacity / (self.rated_hours * SECONDS_PER_HOUR)
        part = float(np.interp(state.temperature, self.part_temperatures, self.part_points))
        current = part * super().emptying(state, dt)
        return float(rated * (current / rated) ** (1.0 / self.peukert)) if current > rated else current

    def losses(self, state: PackState, current: float, dt: float) -> CellLosses:
        """Peukert's law and self-discharge; nothing from a pack that is empty."""
        if state.soc <= 0.0:
            return CellLosses(1.0)
        lost = SelfDischarge(self.self_discharge_per_year, SECONDS_PER_YEAR).lost(state.temperature, dt)
        beside = self.peukert_current(current, state.temperature) - max(current, 0.0)
        return CellLosses(1.0, beside + lost * state.soc * self.charge_capacity / dt)
