"""What a lithium-ion cell has lost by its age, of calendar and of cycles.

    capacity left = 1 - a_c t^0.75 - b_c sqrt(Q)        resistance = 1 + a_r t^0.75 + b_r Q
    a_c = (7.543 V - 23.75) 10^6 e^(-6976 K / T)        a_r = (5.270 V - 16.32) 10^5 e^(-5986 K / T)
    b_c = 7.348e-3 (U - 3.667)^2 + 7.600e-4 + 4.081e-3 D
    b_r = 2.153e-4 (U - 3.725)^2 - 1.521e-5 + 2.798e-4 D

t: days on the shelf at the voltage V and the temperature T; Q: charge turned over [Ah] of a cell of 2.15 Ah, in cycles
of the depth D about the mean voltage U (Schmalstieg, Kaebitz, Ecker and Sauer 2014, "A holistic aging model for
Li(NiMnCo)O2 based 18650 lithium-ion batteries", J. Power Sources 257:325). Measured from 35 to 50 C, over 485 days and
to 80 % of the capacity; colder and other chemistries by the same law are an estimate, and a cell is not followed below
half of its capacity.
"""

from math import exp, sqrt
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params

CELL_AH = 2.15
"""Of the cell that was measured [Ah]."""
DAYS_PER_YEAR = 365.25
LEAST_LEFT = 0.5
"""Of the capacity [1]."""


class LithiumAge(Params):
    """What a cell has behind it."""

    years: float = Field(default=0.0, ge=0.0, le=100.0, description="since it was made [year]")
    temperature: float = Field(default=293.15, gt=200.0, lt=350.0, description="mean since then [K]")
    storage_voltage: float = Field(default=3.7, gt=3.2, lt=4.3, description="mean of a cell since then [V]")
    cycles: float = Field(default=0.0, ge=0.0, le=1e5, description="charge turned over, of twice its capacity [1]")
    cycle_depth: float = Field(default=0.5, gt=0.0, le=1.0, description="of a cycle, of the capacity [1]")
    cycle_voltage: float = Field(default=3.7, gt=3.0, lt=4.3, description="mean of a cell in them [V]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.capacity_left < LEAST_LEFT:
            allowed = f"an age that leaves half of the capacity; this one leaves {max(self.capacity_left, 0.0):.0%}"
            raise InvalidValueError("years, cycles", (self.years, self.cycles), allowed)
        return self

    @property
    def _shelf(self) -> float:
        return float((self.years * DAYS_PER_YEAR) ** 0.75)

    @property
    def _turned_over(self) -> float:
        return 2.0 * self.cycles * CELL_AH

    @property
    def capacity_left(self) -> float:
        """Of its capacity when new [1]."""
        shelf = max(7.543 * self.storage_voltage - 23.75, 0.0) * 1e6 * exp(-6976.0 / self.temperature)
        cycling = 7.348e-3 * (self.cycle_voltage - 3.667) ** 2 + 7.600e-4 + 4.081e-3 * self.cycle_depth
        return 1.0 - shelf * self._shelf - cycling * sqrt(self._turned_over)

    @property
    def resistance(self) -> float:
        """Over that when new [1]."""
        shelf = max(5.270 * self.storage_voltage - 16.32, 0.0) * 1e5 * exp(-5986.0 / self.temperature)
        cycling = 2.153e-4 * (self.cycle_voltage - 3.725) ** 2 - 1.521e-5 + 2.798e-4 * self.cycle_depth
        return 1.0 + shelf * self._shelf + max(cycling, 0.0) * self._turned_over
