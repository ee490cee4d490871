"""A converter between two buses: it holds the voltage of one with power from the other.

Equations, for the power P into the bus that it feeds, negative where it takes power back:

    P_in = P / eff + q P^2 / rating + P0      forward
    P_in = P eff + q P^2 / rating + P0        back (P < 0)              -rating <= P <= rating

eff: what switching and diodes lose, in proportion; q: of its resistances, at full load; P0: whatever it gives. It is
best at P = sqrt(P0 rating / q) (Erickson and Maksimovic 2020, "Fundamentals of Power Electronics", 3rd ed., ch. 4).

It is the controlled source of its bus: after the sources of that bus, before its stores are drawn upon, at the bus's
own `voltage`, as a regulator between solar array and battery or between battery and a payload does (Patel 2005,
"Spacecraft Power Systems", ch. 9 and 15). Beyond its rating, and where its own supply falls short, it gives what it
can. Assumptions: losses that go by the power alone; no dynamics.
"""

from math import inf, sqrt

from pydantic import Field

from sojourn_machine.params import Params
from sojourn_machine.power.stores import MAIN


class ConverterParams(Params):
    """One converter."""

    input: str = Field(default=MAIN, min_length=1, description="name of the bus that it draws from")
    output: str = Field(min_length=1, description="name of the bus whose voltage it holds")
    rating_w: float = Field(gt=0.0, le=1e7, description="most power at its output, either way [W]")
    efficiency: float = Field(gt=0.0, le=1.0, description="power out over power in, without the other losses [1]")
    ohmic_loss: float = Field(default=0.0, ge=0.0, le=0.5, description="q, of its rating at full load [1]")
    standby_w: float = Field(default=0.0, ge=0.0, le=1e5, description="drawn whatever it gives [W]")
    both_ways: bool = Field(default=False, description="gives power back to its input where its output has too much")

    def drawn(self, power: float) -> float:
        """Power from its input while it gives `power` [W]."""
        passed = power / self.efficiency if power >= 0.0 else power * self.efficiency
        return passed + self.ohmic_loss * power * power / self.rating_w + self.standby_w

    def given(self, drawn: float) -> float:
        """The most that it can give from `drawn` at its input [W]; nothing from less than its standby power."""
        if drawn == inf:
            return self.rating_w
        left = max(drawn - self.standby_w, 0.0)
        if self.ohmic_loss == 0.0:
            return min(left * self.efficiency, self.rating_w)
        linear = 1.0 / self.efficiency
        root = sqrt(linear * linear + 4.0 * self.ohmic_loss / self.rating_w * left)
        return min(2.0 * left / (linear + root), self.rating_w)
