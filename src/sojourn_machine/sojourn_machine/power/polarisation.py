"""The voltage of a fuel cell over its current density, and that of an electrolyser.

    V(i) = E0 - b ln(i) - R i - m e^(n i)     fuel cell, i in mA/cm2
    V(i) = E0 + b ln(1 + i / i0) + R i        electrolyser: reversible voltage, activation, ohmic part

(Kim, Lee, Srinivasan and Chamberlin 1995, "Modeling of proton exchange membrane fuel cell performance with an empirical
equation", J. Electrochem. Soc. 142:2670; Ulleberg 2003, "Modeling of advanced alkaline electrolyzers", Int. J. Hydrogen
Energy 28:21, at one temperature).

Faraday's law: a current I through n cells turns over n I / (2 F) mol of hydrogen and half as much of oxygen a second,
and makes or splits as much water. Water leaves as a liquid, so all energy of the reaction is 1.481 V times the charge
(higher heating value) and what is not electric is heat.
"""

from math import exp, inf, log

from pydantic import Field

from sojourn_machine.params import Params
from sojourn_machine.power.search import peak_of, root_of

FARADAY = 96485.332
"""[C/mol]"""
HYDROGEN, OXYGEN = 2.01588e-3, 31.9988e-3
"""Molar masses of H2 and O2 [kg/mol]."""
THERMONEUTRAL = 1.481
"""Voltage at which a cell would neither give off heat nor take it in, water liquid [V]."""
LEAST_REVERSIBLE = 0.9
"""Voltage under which no electrolyser splits water, at 1 bar of each gas: -dG/(2 F) of steam is 0.97 V at 1100 K, where
cells of solid oxide work, and 0.91 V at 1300 K, hotter than any do (Chase 1998, "NIST-JANAF Thermochemical Tables",
4th ed., H2O) [V]."""
HYDROGEN_PER_CHARGE = HYDROGEN / (2.0 * FARADAY)
OXYGEN_PER_CHARGE = OXYGEN / (4.0 * FARADAY)
"""Turned over in one cell [kg/C]."""
LEAST = 1.0
"""Current density under which the voltage is taken for that at it [mA/cm2]: the logarithm knows no end."""
CM2 = 1e4
"""In a square metre."""


class FuelCellCurve(Params):
    """Of one cell at its working temperature and pressure."""

    open_voltage: float = Field(gt=0.2, le=1.3, description="E0 [V]")
    tafel: float = Field(ge=0.0, le=0.2, description="b [V]")
    resistance: float = Field(ge=0.0, le=0.01, description="R [V cm2/mA]")
    transport: float = Field(ge=0.0, le=0.1, description="m, of the transport of gas [V]")
    transport_rate: float = Field(ge=0.0, le=0.1, description="n [cm2/mA]")

    def voltage(self, density: float) -> float:
        """At a current density [mA/cm2]; at least 0 [V]."""
        i = max(density, LEAST)
        volts = self.open_voltage - self.tafel * log(i) - self.resistance * i
        # beyond any current that flows the exponential would overflow
        return max(volts - self.transport * exp(min(self.transport_rate * i, 50.0)), 0.0)

    def most_power_density(self, largest: float) -> float:
        """Current density of the most power up to a largest one [mA/cm2]."""
        return peak_of(lambda i: i * self.voltage(i), 0.0, largest)

    def density_at(self, power: float, largest: float) -> float:
        """Current density at which a square centimetre gives a power [mW], on the side of the higher voltage; `largest`
        where it cannot. `largest`: where the power is greatest [mA/cm2].
        """
        if power >= largest * self.voltage(largest):
            return largest
        return root_of(lambda i: i * self.voltage(i) - power, 0.0, largest)


class ElectrolyserCurve(Params):
    """Of one cell at its working temperature and pressure."""

    reversible_voltage: float = Field(
        default=1.229, ge=LEAST_REVERSIBLE, le=2.0, description="E0; 1.229: of liquid water at 25 C [V]"
    )
    activation: float = Field(ge=0.0, le=0.5, description="b [V]")
    exchange: float = Field(gt=0.0, le=100.0, description="i0 [mA/cm2]")
    resistance: float = Field(ge=0.0, le=0.01, description="R [V cm2/mA]")

    def voltage(self, density: float) -> float:
        """At a current density [mA/cm2] [V]."""
        return (
            self.reversible_voltage + self.activation * log(1.0 + density / self.exchange) + self.resistance * density
        )

    def density_at(self, power: float) -> float:
        """Current density at which a square centimetre takes a power [mW]: it grows with it without end [mA/cm2]."""
        return root_of(lambda i: i * self.voltage(i) - power, 0.0, power / self.reversible_voltage)


def water_of(hydrogen: float) -> float:
    """Mass of the water that a mass of hydrogen burns to [kg]."""
    return hydrogen * (1.0 + 0.5 * OXYGEN / HYDROGEN)


def specific_consumption(voltage: float) -> float:
    """Hydrogen and oxygen for an electric energy at a cell's voltage [kg/J]; infinite at 0 V."""
    return (HYDROGEN_PER_CHARGE + OXYGEN_PER_CHARGE) / voltage if voltage > 0.0 else inf
