"""A small fission reactor that follows its load by its own temperature, with Stirling convertors on heat pipes.

    rho   = rho_rod + alpha (T - T_0)        [dollar]; alpha < 0: a hotter core is worth less
    C T'  = N - Q_e - G (T - T_s)            Q_e: what the convertors take, G: what leaks through the insulation
    P     = f (1 - T_c / T) Q_e              f: part of Carnot's efficiency, generator included; T_c: of what is around
                                             where that is hotter

and the fission power N by prompt jump and six groups of delayed neutrons (`reactor_kernels`).

So a larger load cools the core, which brings the fission up to it, and the temperature comes back near where it was: no
control acts while it runs. The start: the rod comes in at a rate, pauses while reactivity or power are at their limits,
and stops at the worth that holds the working temperature. Convertors take only what the bus asks; heat pipes carry
`heat_pipe_limit` at most and nothing under `least_temperature`.

Sources: behaviour and class: Poston,
Gibson, Godfroy and McClure 2020, "KRUSTY reactor design" and "Results of the KRUSTY nuclear system test", Nuclear
Technology 206, suppl. 1 (28 hours, core near 800 C, start in about an hour and a half, loads changed without any
control). Left out: burn-up, xenon (too little flux to count), decay heat after a stop. Steps within: 0.1 s at most.
"""

from dataclasses import dataclass
from functools import cached_property
from math import ceil

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.power.heat_engines import carnot
from sojourn_machine.power.reactor_kernels import LEAST, SHARES, Core, core_kernel
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

LONGEST = 0.1
"""Of the steps within [s]."""


@dataclass(frozen=True, eq=False, slots=True)
class ReactorState:
    """What a reactor remembers."""

    temperature: float
    """Of the core [K]."""
    groups: FloatArray
    """Delayed neutrons, as the fission power that they bear, (6,) [W]."""
    rod: float
    """Worth of the rod [dollar]."""
    energy: float = 0.0
    """Given to the bus since the start of the run [J]."""
    energy_fission: float = 0.0
    """Released in the core [J]."""


class FissionReactorParams(SourceParams):
    """One reactor."""

    kind: str = "fission_reactor"
    heat_capacity: float = Field(gt=0.0, le=1e7, description="C, of core and what is as warm [J/K]")
    feedback: float = Field(lt=0.0, ge=-1.0, description="alpha [dollar/K]")
    working_temperature: float = Field(gt=400.0, le=2000.0, description="of the core, without a load [K]")
    cold_temperature: float = Field(default=293.15, gt=50.0, le=400.0, description="T_0, and T_s around [K]")
    leak: float = Field(default=0.0, ge=0.0, le=1e3, description="G, through the insulation [W/K]")
    heat_pipe_limit: float = Field(gt=0.0, le=1e7, description="the most heat that convertors are given [W]")
    least_temperature: float = Field(default=700.0, gt=100.0, le=2000.0, description="at which they work [K]")
    cold_end: float = Field(gt=50.0, le=1000.0, description="T_c, of the convertors [K]")
    carnot_fraction: float = Field(gt=0.0, lt=1.0, description="f, generator included [1]")
    running: bool = Field(default=True, description="at its working temperature at the start; else cold, and it starts")
    rod_rate: float = Field(default=0.002, gt=0.0, le=0.1, description="at the start [dollar/s]")
    start_reactivity: float = Field(default=0.15, gt=0.0, lt=0.8, description="limit at the start [dollar]")
    start_power: float = Field(default=3000.0, gt=0.0, le=1e7, description="of fission, limit at the start [W]")

    @model_validator(mode="after")
    def _check(self) -> "FissionReactorParams":
        if not self.cold_end < self.least_temperature < self.working_temperature:
            allowed = f"between cold_end = {self.cold_end:g} K and working_temperature = {self.working_temperature:g} K"
            raise InvalidValueError("least_temperature", self.least_temperature, allowed)
        return self

    @property
    def full_worth(self) -> float:
        """Of the rod that holds the working temperature [dollar]."""
        return -self.feedback * (self.working_temperature - self.cold_temperature)

    def initial_state(self) -> ReactorState:
        """At its working temperature without a load, or cold."""
        if not self.running:
            return ReactorState(self.cold_temperature, LEAST * SHARES, 0.0)
        idle = self.leak * (self.working_temperature - self.cold_temperature)
        return ReactorState(self.working_temperature, max(idle, LEAST) * SHARES, self.full_worth)

    def efficiency(self, temperature: float, around: float | None = None) -> float:
        """Of the convertors at a temperature of the core [K]; 0 where they stand still [1].

        Args:
            around: what their cold end gives its heat to, than which it is not colder [K]; None where it is cold.
        """
        cold = self.cold_end if around is None else max(self.cold_end, around)
        if temperature < self.least_temperature or temperature <= cold:
            return 0.0
        return self.carnot_fraction * carnot(temperature, cold)

    def point(self, state: ReactorState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """What the heat pipes can carry, at the core's temperature."""
        return SourcePoint(self.efficiency(state.temperature, surroundings.temperature) * self.heat_pipe_limit)

    def step(
        self, state: ReactorState, power: float, dt: float, surroundings: PowerSurroundings = DARK
    ) -> ReactorState:
        """The core after it has given `power` [W] for `dt` [s]; the convertors' efficiency is that of its start."""
        require_step(power, dt)
        efficiency = self.efficiency(state.temperature, surroundings.temperature)
        drawn = power / efficiency if efficiency > 0.0 else 0.0
        count, groups = ceil(dt / LONGEST), state.groups.copy()
        temperature, rod, released = core_kernel(
            self._core, groups, state.temperature, state.rod, drawn, (count, dt / count)
        )
        return replace(
            state,
            temperature=temperature,
            groups=groups,
            rod=rod,
            energy=state.energy + power * dt,
            energy_fission=state.energy_fission + released,
        )

    def fission(self, state: ReactorState) -> float:
        """Power of the core [W]."""
        reactivity = state.rod + self.feedback * (state.temperature - self.cold_temperature)
        return max(float(state.groups.sum()) / (1.0 - min(reactivity, 0.95)), LEAST)

    @cached_property
    def _core(self) -> Core:
        return Core(
            self.heat_capacity,
            self.feedback,
            self.leak,
            self.cold_temperature,
            self.full_worth,
            self.rod_rate,
            self.start_reactivity,
            self.start_power,
        )

    def heat_given(self, before: ReactorState, after: ReactorState) -> float:
        """What leaks, and what the convertors do not turn into power [J]."""
        warmed = self.heat_capacity * (after.temperature - before.temperature)
        return after.energy_fission - before.energy_fission - warmed - (after.energy - before.energy)

    @property
    def most_power(self) -> float:
        """At the working temperature [W]."""
        return self.efficiency(self.working_temperature) * self.heat_pipe_limit
