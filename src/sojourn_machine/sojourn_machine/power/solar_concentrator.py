"""A mirror that gathers sunlight on a receiver, and a heat engine on it.

    Q = eta_o A_m G - eps sigma A_r (T_h^4 - T_s^4)      into the engine; A_r = A_m / C, C: concentration;
                                                         the loss is at least 0: hotter surroundings feed no engine
    P = f (1 - T_c / T_h) eta_g Q                        f: part of Carnot's efficiency; eta_g: generator

The engine holds the temperature T_h of the receiver; where what it would lose is more than what comes in it stands
still. A hotter receiver makes a better engine and loses more: `best_receiver_temperature` is where P is greatest for a
light (Duffie and Beckman 2013, "Solar Engineering of Thermal Processes", 4th ed., ch. 7 and 17; Stine and Geyer 2001,
"Power From The Sun", ch. 9). Only the Sun's beam can be gathered. The mirror follows the Sun down to an elevation over
the deck; engine and receiver have no heat of their own.
"""

from dataclasses import dataclass
from math import asin, radians
from typing import ClassVar

from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.power.heat_engines import carnot
from sojourn_machine.power.search import peak_of
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN

REFERENCE_LIGHT = 1361.0
"""Of the Sun at 1 astronomical unit [W/m2]."""


@dataclass(frozen=True, slots=True)
class ConcentratorState:
    """What a concentrator remembers."""

    energy: float = 0.0
    """Given to the bus since the start of the run [J]."""


class SolarConcentratorParams(SourceParams):
    """One mirror with its engine."""

    kind: str = "solar_concentrator"
    takes_light: ClassVar[bool] = True
    mirror_area: float = Field(gt=0.0, le=1e4, description="A_m, square to the Sun [m2]")
    concentration: float = Field(gt=1.0, le=46_000.0, description="C; 46 000 is the limit at the Earth's distance [1]")
    optical_efficiency: float = Field(gt=0.0, le=1.0, description="of mirror and receiver [1]")
    receiver_emissivity: float = Field(gt=0.0, le=1.0, description="[1]")
    receiver_temperature: float = Field(gt=300.0, le=2500.0, description="T_h [K]")
    cold_end: float = Field(gt=50.0, le=1000.0, description="T_c [K]")
    carnot_fraction: float = Field(gt=0.0, lt=1.0, description="f, of the engine [1]")
    generator_efficiency: float = Field(default=0.9, gt=0.0, le=1.0, description="eta_g [1]")
    least_elevation_deg: float = Field(
        default=5.0, ge=-90.0, lt=90.0, description="of the Sun over the deck that it can follow to [degree]"
    )
    temperature_surroundings: float = Field(
        default=220.0, gt=0.0, lt=1000.0, description="that the receiver radiates to where nobody says another [K]"
    )

    def initial_state(self) -> ConcentratorState:
        """At the start of a run."""
        return ConcentratorState()

    def engine_heat(self, light: float, receiver: float, around: float) -> float:
        """What the engine gets in a beam [W/m2] at temperatures of receiver and surroundings [K]; at least 0 [W]."""
        area = self.mirror_area / self.concentration
        lost = self.receiver_emissivity * STEFAN_BOLTZMANN * area * (receiver**4 - around**4)
        return max(self.optical_efficiency * self.mirror_area * light - lost, 0.0)

    def power(self, light: float, receiver: float, around: float) -> float:
        """Likewise, to the bus [W]."""
        cold = max(self.cold_end, around)  # no end that loses heat is colder than where it goes
        if receiver <= cold:
            return 0.0
        best = carnot(receiver, cold) * self.engine_heat(light, receiver, around)
        return self.carnot_fraction * self.generator_efficiency * best

    def best_receiver_temperature(self, light: float, around: float | None = None) -> float:
        """Temperature of the receiver at which a beam [W/m2] gives the most [K]."""
        sink = self.temperature_surroundings if around is None else around
        return peak_of(lambda receiver: self.power(light, receiver, sink), max(self.cold_end, sink), 3000.0)

    def point(self, state: ConcentratorState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """In the light of the moment."""
        elevation = asin(min(max(float(surroundings.to_sun[2]), -1.0), 1.0))
        if elevation < radians(self.least_elevation_deg) or surroundings.direct <= 0.0:
            return SourcePoint(0.0)
        sink = self.temperature_surroundings if surroundings.temperature is None else surroundings.temperature
        return SourcePoint(self.power(surroundings.direct, self.receiver_temperature, sink))

    def step(
        self, state: ConcentratorState, power: float, dt: float, surroundings: PowerSurroundings = DARK
    ) -> ConcentratorState:
        """Having given `power` [W] for `dt` [s]."""
        require_step(power, dt)
        return replace(state, energy=state.energy + power * dt)

    @property
    def most_power(self) -> float:
        """In the light at the Earth's distance from the Sun [W]."""
        return self.power(REFERENCE_LIGHT, self.receiver_temperature, self.temperature_surroundings)
