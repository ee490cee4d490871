"""A heat engine on stored propellants: a cycle, its losses, a tank that empties.

    m' = P / (eta_cycle eta_mechanical eta_generator LHV) + idle

`cycle` is that of Otto by its compression ratio, or that of Brayton by its pressure ratio and temperatures
(`heat_engines`: air-standard, so an upper bound that `quality` brings down to what real engines of the cycle reach).
Fuel and oxidiser are one store in a fixed mixture; `heating_value` is that of the mixture. Range: steady running;
heating values: hydrogen with oxygen 13.4 MJ/kg of both (lower), methane with oxygen 10.0 (Heywood 1988, "Internal
Combustion Engine Fundamentals", appendix D, over the mass of both). Start-up and part load's own losses are the idle
consumption's.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.power.heat_engines import brayton, otto
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings


class OttoCycle(Params):
    """Of an engine with pistons."""

    cycle: Literal["otto"] = "otto"
    compression_ratio: float = Field(gt=1.0, le=50.0, description="of volumes [1]")
    heat_ratio: float = Field(default=1.3, gt=1.0, le=1.7, description="gamma of the burnt gas [1]")

    @property
    def efficiency(self) -> float:
        """[1]"""
        return otto(self.compression_ratio, self.heat_ratio)


class BraytonCycle(Params):
    """Of a gas turbine."""

    cycle: Literal["brayton"] = "brayton"
    pressure_ratio: float = Field(gt=1.0, le=100.0, description="[1]")
    temperature_ratio: float = Field(
        gt=1.0, le=10.0, description="before the turbine, of that before the compressor [1]"
    )
    heat_ratio: float = Field(default=1.4, gt=1.0, le=1.7, description="gamma [1]")
    machine_efficiency: float = Field(default=0.85, gt=0.0, le=1.0, description="isentropic, of both machines [1]")
    recuperation: float = Field(default=0.0, ge=0.0, le=1.0, description="effectiveness of the recuperator [1]")

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if self.efficiency <= 0.0:
            allowed = "a turbine that gives more than its compressor takes"
            raise InvalidValueError("temperature_ratio", self.temperature_ratio, allowed)
        return self

    @property
    def efficiency(self) -> float:
        """[1]"""
        return brayton(
            self.pressure_ratio, self.temperature_ratio, self.heat_ratio, self.machine_efficiency, self.recuperation
        )


Cycle: TypeAlias = Annotated[OttoCycle | BraytonCycle, Field(discriminator="cycle")]


@dataclass(frozen=True, slots=True)
class EngineState:
    """What an engine remembers."""

    propellant: float
    """Fuel and oxidiser left [kg]."""
    energy: float = 0.0
    """Given to the bus since the start of the run [J]."""
    energy_heat: float = 0.0
    """Of exhaust and cooling [J]."""


class HeatEngineParams(SourceParams):
    """One engine with its generator."""

    kind: str = "heat_engine"
    engine: Cycle = Field(description="its cycle")
    quality: float = Field(default=1.0, gt=0.0, le=1.0, description="of the ideal cycle's efficiency reached [1]")
    mechanical_efficiency: float = Field(default=0.9, gt=0.0, le=1.0, description="[1]")
    generator_efficiency: float = Field(default=0.9, gt=0.0, le=1.0, description="[1]")
    heating_value: float = Field(gt=0.0, le=2e8, description="of fuel and oxidiser together [J/kg]")
    rated_w: float = Field(gt=0.0, le=1e6, description="electric power [W]")
    propellant: float = Field(ge=0.0, le=1e6, description="fuel and oxidiser at the start [kg]")
    cooling: float = Field(
        default=0.3, ge=0.0, le=1.0, description="part of its heat that does not leave with the exhaust [1]"
    )
    idle_rate: float = Field(default=0.0, ge=0.0, le=10.0, description="consumption that no power comes from [kg/s]")

    @cached_property
    def efficiency(self) -> float:
        """From the heating value to the bus [1]."""
        return self.engine.efficiency * self.quality * self.mechanical_efficiency * self.generator_efficiency

    def initial_state(self) -> EngineState:
        """The tank as its file has it."""
        return EngineState(self.propellant)

    def point(self, state: EngineState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """Its rating, while there is propellant."""
        return SourcePoint(self.rated_w if state.propellant > 0.0 else 0.0)

    runs_out: ClassVar[bool] = True

    def lasting(self, state: EngineState, dt: float) -> float:
        """See `SourceParams`: at its rating until the tank is empty."""
        rate = self.rated_w / (self.efficiency * self.heating_value) + self.idle_rate
        return self.rated_w * min(max(state.propellant, 0.0) / (rate * dt), 1.0)

    def step(self, state: EngineState, power: float, dt: float, surroundings: PowerSurroundings = DARK) -> EngineState:
        """Emptier by what it burnt to give `power` [W] for `dt` [s], at most all; it stands still where nothing is
        asked."""
        require_step(power, dt)
        if power <= 0.0:
            return state
        burnt = min((power / (self.efficiency * self.heating_value) + self.idle_rate) * dt, state.propellant)
        return replace(
            state,
            propellant=state.propellant - burnt,
            energy=state.energy + power * dt,
            energy_heat=state.energy_heat + burnt * self.heating_value - power * dt,
        )

    def heat_given(self, before: EngineState, after: EngineState) -> float:
        """What its cooling takes up."""
        return self.cooling * (after.energy_heat - before.energy_heat)
