"""Batteries of nickel: nickel hydrogen, whose pressure tells its charge, and nickel cadmium.

    eta(soc) = eta_0                                      up to the knee
             = eta_0 (1 - soc) / (1 - knee)               above it: the charging current makes gas, and then heat
    d soc/dt = -soc r 2^((T - 293 K) / 10 K)              self-discharge, r a day
    p(soc)   = p_0 + (p_1 - p_0) soc                      of the hydrogen in the vessel

Voltages, resistances and heat are those of `battery`. Sources: Linden and Reddy 2002, "Handbook of Batteries", 3rd ed.,
ch. 27 (nickel cadmium) and 32 (nickel hydrogen: charge acceptance over the state of charge, self-discharge in
proportion to the pressure, so to the charge); Zimmerman 2009, "Nickel-hydrogen batteries: principles and practice", ch.
3. Left out: the memory of nickel cadmium, the second plateau, and how eta goes with temperature.
"""

from pydantic import Field

from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.cell_losses import CellLosses, SelfDischarge
from sojourn_machine.power.pack import PackState

SECONDS_PER_DAY = 86400.0
LEAST = 1e-3
"""Efficiency of a full pack: none would divide by it [1]."""


class NickelBatteryParams(BatteryParams):
    """A pack of like cells, of either kind."""

    acceptance_knee: float = Field(gt=0.0, lt=1.0, description="state of charge up to which charge is accepted [1]")
    self_discharge_per_day: float = Field(ge=0.0, lt=1.0, description="r, of what is left, at 20 degrees [1]")

    def acceptance(self, soc: float) -> float:
        """Part of a charging current that is stored at a state of charge [1]."""
        above = (1.0 - soc) / (1.0 - self.acceptance_knee)
        return max(self.coulombic_efficiency * min(above, 1.0), LEAST)

    def losses(self, state: PackState, current: float, dt: float) -> CellLosses:
        """Acceptance and self-discharge of the step's start."""
        lost = SelfDischarge(self.self_discharge_per_day, SECONDS_PER_DAY).lost(state.temperature, dt)
        return CellLosses(self.acceptance(state.soc), lost * max(state.soc, 0.0) * self.charge_capacity / dt)


class NickelCadmiumParams(NickelBatteryParams):
    """Of nickel cadmium."""

    kind: str = "nickel_cadmium"


class NickelHydrogenParams(NickelBatteryParams):
    """Of nickel hydrogen."""

    kind: str = "nickel_hydrogen"
    pressure_empty: float = Field(default=3.0e5, ge=0.0, le=1e8, description="p_0, of hydrogen in the vessel [Pa]")
    pressure_full: float = Field(default=4.0e6, gt=0.0, le=1e8, description="p_1, likewise [Pa]")

    def pressure(self, state: PackState) -> float:
        """Of the hydrogen: what a strain gauge on the vessel tells of the charge [Pa]."""
        return self.pressure_empty + state.soc * (self.pressure_full - self.pressure_empty)
