"""A radioisotope thermoelectric generator: heat that decays, and couples that wear.

Equations, with the age t since the fuelling:

    Q(t) = Q0 2^(-t / T)               heat of the fuel; T = 87.7 years of plutonium 238
    P(t) = P0 2^(-t / T) (1 - d)^t     electric power; d: part that the thermocouples lose a year beside the fuel

Sources: half-life 87.7 years, 0.787 % a year, from the evaluated nuclear data (ENSDF, plutonium 238); design figures
of the multi-mission generator, 2 kW of heat and 110 W at the start (NASA 2013, "Multi-Mission Radioisotope
Thermoelectric Generator", fact sheet). Its power on Mars has been reported to fall by 3.8 to 4.8 % a year in all
(Whiting 2020, "Empirical performance analysis of MMRTG power production and decay", IEEE Aerospace Conference). That
the wear is exponential is an assumption: it is faster at first. `config/parts/mmrtg.yaml` has the figures.

The couples are held near their most power by the power unit, so the power does not depend on the bus; what the bus does
not take goes into a shunt. Heat that is not turned into electric power leaves at the fins: `heat`.
Valid from the fuelling on; temperature of the fins, load mismatch and start-up are left out.
"""

from dataclasses import dataclass
from math import expm1, log
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

SECONDS_PER_YEAR = 365.25 * 86400.0


@dataclass(frozen=True, slots=True)
class GeneratorState:
    """What a generator remembers."""

    age: float
    """Since the fuelling [s]."""
    energy: float = 0.0
    """Given to the bus since the start of the run [J]."""


class RadioisotopeGeneratorParams(SourceParams):
    """One generator. Powers are those at the fuelling."""

    kind: str = "radioisotope_generator"
    electric_power_w: float = Field(gt=0.0, le=1e5, description="electric power at the fuelling [W]")
    thermal_power_w: float = Field(gt=0.0, le=1e6, description="heat of the fuel at the fuelling [W]")
    half_life_years: float = Field(default=87.7, gt=0.0, le=1e6, description="of the fuel; 87.7: plutonium 238 [year]")
    degradation_per_year: float = Field(
        ge=0.0, lt=1.0, description="part of its power that the generator loses a year beside the decay of the fuel [1]"
    )
    age_years: float = Field(default=0.0, ge=0.0, le=1000.0, description="since the fuelling, at the start [year]")

    @model_validator(mode="after")
    def _turns_heat_into_power(self) -> Self:
        if not self.electric_power_w < self.thermal_power_w:
            allowed = f"less than thermal_power_w = {self.thermal_power_w:g} W, from which it comes"
            raise InvalidValueError("electric_power_w", self.electric_power_w, allowed)
        return self

    def initial_state(self) -> GeneratorState:
        """Of its age."""
        return GeneratorState(self.age_years * SECONDS_PER_YEAR)

    def decayed(self, state: GeneratorState) -> float:
        """What is left of the fuel's heat [1]."""
        return float(2.0 ** (-state.age / SECONDS_PER_YEAR / self.half_life_years))

    def heat(self, state: GeneratorState) -> float:
        """What leaves its fins as heat, power that goes into the shunt not among it [W]."""
        return self.thermal_power_w * self.decayed(state) - self.point(state).power

    def heat_given(self, before: GeneratorState, after: GeneratorState) -> float:
        """All heat of the fuel that did not become power of the bus, the shunt's among it [J]."""
        rate = log(2.0) / (self.half_life_years * SECONDS_PER_YEAR)
        fuel = self.thermal_power_w * self.decayed(before) * -expm1(-rate * (after.age - before.age)) / rate
        return fuel - (after.energy - before.energy)

    def point(self, state: GeneratorState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """Constant power."""
        worn = (1.0 - self.degradation_per_year) ** (state.age / SECONDS_PER_YEAR)
        return SourcePoint(self.electric_power_w * self.decayed(state) * worn)

    def step(
        self, state: GeneratorState, power: float, dt: float, surroundings: PowerSurroundings = DARK
    ) -> GeneratorState:
        """Older by `dt` [s], having given `power` [W]."""
        require_step(power, dt)
        return replace(state, age=state.age + dt, energy=state.energy + power * dt)
