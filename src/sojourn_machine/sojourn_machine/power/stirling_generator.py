"""A radioisotope generator with a Stirling convertor: heat that decays, a part of Carnot's efficiency, a radiator.

    Q(t)  = Q0 2^(-t / T)                            heat of the fuel
    P     = f (1 - T_c / T_h) (1 - l) Q              f: part of Carnot's efficiency, alternator and controller included;
                                                     l: part of the heat that leaks past the convertor
    eps sigma A (T_c^4 - T_s^4) = Q - P              the cold end: what does not become power leaves at the radiator

The convertor holds the temperature T_h of its hot end by its stroke. Sources: Chan, Wood and Schreiber 2007,
"Development of Advanced Stirling Radioisotope Generator for space exploration", NASA/TM-2007-214806 (two general
purpose heat sources of 250 W, 130 to 140 W at 28 V, hot end 650 to 850 C); equilibrium of the radiator: Gilmore 2002,
Spacecraft Thermal Control Handbook. Valid while the radiator's balance is quick against the day: the cold end has no
heat of its own.
"""

from dataclasses import dataclass
from math import expm1, log

from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.power.heat_engines import carnot
from sojourn_machine.power.radioisotope_generator import SECONDS_PER_YEAR
from sojourn_machine.power.search import root_of
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN


@dataclass(frozen=True, slots=True)
class StirlingState:
    """What a generator remembers."""

    age: float
    """Since the fuelling [s]."""
    energy: float = 0.0
    """Given to the bus since the start of the run [J]."""


class StirlingGeneratorParams(SourceParams):
    """One generator."""

    kind: str = "stirling_generator"
    thermal_power_w: float = Field(gt=0.0, le=1e6, description="heat of the fuel at the fuelling [W]")
    half_life_years: float = Field(default=87.7, gt=0.0, le=1e6, description="of the fuel; 87.7: plutonium 238 [year]")
    age_years: float = Field(default=0.0, ge=0.0, le=1000.0, description="since the fuelling, at the start [year]")
    hot_end: float = Field(gt=300.0, le=1500.0, description="temperature that the convertor holds [K]")
    carnot_fraction: float = Field(gt=0.0, lt=1.0, description="of Carnot's efficiency, from heat to the bus [1]")
    leak: float = Field(default=0.0, ge=0.0, lt=1.0, description="part of the heat past the convertor [1]")
    radiator_area: float = Field(gt=0.0, le=1e3, description="[m2]")
    radiator_emissivity: float = Field(default=0.85, gt=0.0, le=1.0, description="[1]")
    temperature_surroundings: float = Field(
        default=220.0, gt=0.0, lt=1000.0, description="that it radiates to where nobody says another [K]"
    )

    def initial_state(self) -> StirlingState:
        """Of its age."""
        return StirlingState(self.age_years * SECONDS_PER_YEAR)

    def fuel_heat(self, age: float) -> float:
        """At an age [s] [W]."""
        return float(self.thermal_power_w * 2.0 ** (-age / SECONDS_PER_YEAR / self.half_life_years))

    def cold_end(self, heat: float, around: float) -> float:
        """Temperature at which its radiator loses what does not become power, for the loss grows faster with it than
        the power falls [K]. heat: of the fuel [W]. around: what it radiates to [K].
        """

        def excess(cold: float) -> float:
            return self._lost(cold, around) + self._power(heat, cold) - heat

        return root_of(excess, around, self.hot_end)

    def _power(self, heat: float, cold: float) -> float:
        return self.carnot_fraction * carnot(self.hot_end, cold) * (1.0 - self.leak) * heat

    def _lost(self, cold: float, around: float) -> float:
        return self.radiator_emissivity * STEFAN_BOLTZMANN * self.radiator_area * (cold**4 - around**4)

    def point(self, state: StirlingState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """Constant over a period."""
        sink = self.temperature_surroundings if surroundings.temperature is None else surroundings.temperature
        heat = self.fuel_heat(state.age)
        return SourcePoint(max(self._power(heat, self.cold_end(heat, min(sink, self.hot_end))), 0.0))

    def step(
        self, state: StirlingState, power: float, dt: float, surroundings: PowerSurroundings = DARK
    ) -> StirlingState:
        """Older by `dt` [s], having given `power` [W]."""
        require_step(power, dt)
        return replace(state, age=state.age + dt, energy=state.energy + power * dt)

    def heat_given(self, before: StirlingState, after: StirlingState) -> float:
        """All heat of the fuel that did not become power of the bus [J]."""
        rate = log(2.0) / (self.half_life_years * SECONDS_PER_YEAR)
        fuel = self.fuel_heat(before.age) * -expm1(-rate * (after.age - before.age)) / rate
        return fuel - (after.energy - before.energy)
