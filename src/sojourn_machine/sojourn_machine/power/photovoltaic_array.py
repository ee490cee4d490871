"""A photovoltaic array: cells by the single-diode model, behind a regulator that holds them at their most power.

Equations. With short-circuit current, open-circuit voltage and point of most power of one cell at the reference
irradiance G_r and temperature T_r (a data sheet's four numbers), no shunt resistance:

    a = (2 V_m - V_oc) / (I_m/(I_sc - I_m) + ln(1 - I_m/I_sc)),   R_s = (a ln(1 - I_m/I_sc) + V_oc - V_m)/I_m

(I(V) goes through the three points, and dP/dV = 0 at the third: Townsend 1989, "A method for estimating the long-term
performance of direct-coupled photovoltaic systems", MSc thesis, Wisconsin; Duffie & Beckman 2013, "Solar Engineering
of Thermal Processes", sec. 23.2.) At another temperature and light G (`photovoltaic_kernels`):

    I_sc(T) = I_sc + alpha (T - T_r),   V_oc(T) = V_oc + beta (T - T_r),   a(T) = a T/T_r
    I_ph = I_sc(T) G/G_r,   I_0 = I_sc(T) e^(-V_oc(T)/a(T))

Light on a plane of normal n, Sun at u, zenith at z, dust and ageing leaving the part q of it:

    G = q s (G_b max(n.u, 0) + G_d (1 + n.z)/2)        s: spectral factor, isotropic sky (Duffie & Beckman, sec. 2.14)

Temperature of the plane, both sides radiating, one implicit step a second, or a period where that is longer:

    C dT/dt = A (alpha_s G' - P/A - (e_f + e_b) sigma (T^4 - T_s^4))        G' before dust: it warms as well

Dust takes dust_loss_per_day of what is left each day, radiation degradation_per_year. Shadows of the machine itself (a
mast) are told by the direction from which they come: `shadows`. A grid of groups stands in one string, strings side by
side; each string has the shadow of the first.

Assumptions: no loss of the glass at grazing light; reverse breakdown does not occur behind bypass diodes; the
regulator holds the most power without delay, with `tracking_efficiency`. Range: 80 to 420 K, G to some G_r.
"""

from dataclasses import dataclass
from functools import cached_property
from math import atan2, degrees, hypot, log
from typing import Annotated, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.power.photovoltaic_kernels import (
    COLDEST,
    HOTTEST,
    CellGroup,
    GroupSheet,
    group_at,
    irradiance_on,
    most_power,
    most_power_in_light,
)
from sojourn_machine.power.radioisotope_generator import SECONDS_PER_YEAR
from sojourn_machine.power.sources import SourceParams, SourcePoint, require_step
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

STEFAN_BOLTZMANN = 5.670374419e-8
"""[W/(m2 K4)] (CODATA 2018)"""
SECONDS_PER_DAY = 86400.0
MOST_AT_ZERO = 3.0
"""V_oc(T) at 0 K over V_oc at most: there it is the band gap of the junctions, twice V_oc of silicon and 1.5 times that
of gallium arsenide (Green 1982, "Solar Cells", sec. 5.3) [1]."""
MOST_EXPONENT = 600.0
"""Of V_oc(T)/a(T) at the coldest: of some 5 eV in three junctions it is 250. From 690 on I_0 would be 0 to a computer,
from 709 on I_ph/I_0 beyond its numbers [1]."""
HELD = 1.0
"""For how long temperature, dust and age are held where periods are shorter [s]: they change in minutes and days."""


@dataclass(frozen=True, slots=True)
class ArrayState:
    """What an array remembers."""

    temperature: float
    """Of its plane [K]."""
    clean: float
    """Part of the light that dust lets through [1]."""
    age: float
    """[s]"""
    energy: float = 0.0
    """Given to the bus since the start of the run [J]."""
    waited: float = 0.0
    """Since temperature, dust and age were last stepped [s]."""
    given: float = 0.0
    """To the bus since then [J]."""


class CellParams(Params):
    """One cell, as its data sheet has it at the reference irradiance and temperature."""

    area: float = Field(gt=0.0, le=1.0, description="of one cell [m2]")
    short_circuit_current: float = Field(ge=1e-9, le=100.0, description="I_sc [A]")
    open_circuit_voltage: float = Field(ge=1e-3, le=100.0, description="V_oc [V]")
    current_at_most_power: float = Field(gt=0.0, le=100.0, description="I_m [A]")
    voltage_at_most_power: float = Field(gt=0.0, le=100.0, description="V_m [V]")
    current_slope: float = Field(ge=-0.1, le=0.1, description="alpha, of I_sc over temperature [A/K]")
    voltage_slope: float = Field(ge=-1.0, le=0.0, description="beta, of V_oc over temperature [V/K]")
    reference_irradiance: float = Field(default=1367.0, gt=0.0, le=1e4, description="G_r [W/m2]")
    reference_temperature: float = Field(default=301.15, ge=COLDEST, le=HOTTEST, description="T_r [K]")

    @model_validator(mode="after")
    def _is_a_cell(self) -> Self:
        i_sc, v_oc, i_m, v_m = (
            self.short_circuit_current,
            self.open_circuit_voltage,
            self.current_at_most_power,
            self.voltage_at_most_power,
        )
        # a curve that bends as a diode's has its most power beyond the middle of both
        if not 0.5 * i_sc < i_m < i_sc:
            allowed = f"less than short_circuit_current = {i_sc:g} A, more than half of it"
            raise InvalidValueError("current_at_most_power", i_m, allowed)
        if not 0.5 * v_oc < v_m < v_oc:
            allowed = f"between half of open_circuit_voltage = {v_oc:g} V and all of it"
            raise InvalidValueError("voltage_at_most_power", v_m, allowed)
        if self.diode[1] < 0.0:
            raise InvalidValueError(
                "voltage_at_most_power", v_m, "of a curve that one diode with a series resistance can have: less"
            )
        if self.efficiency > 1.0:
            light = self.reference_irradiance * self.area
            raise InvalidValueError(
                "current_at_most_power * voltage_at_most_power", i_m * v_m, f"at most all of the light, {light:g} W"
            )
        return self

    @model_validator(mode="after")
    def _is_one_when_cold_and_when_hot(self) -> Self:
        span = f"from {COLDEST:g} to {HOTTEST:g} K"
        if min(self.current_at(COLDEST), self.current_at(HOTTEST)) <= 0.0:
            allowed = f"one that leaves a short-circuit current {span}"
            raise InvalidValueError("current_slope", self.current_slope, allowed)
        if min(self.voltage_at(COLDEST), self.voltage_at(HOTTEST)) <= 0.0:
            allowed = f"one that leaves an open-circuit voltage {span}"
            raise InvalidValueError("voltage_slope", self.voltage_slope, allowed)
        if self.voltage_at(0.0) > MOST_AT_ZERO * self.open_circuit_voltage:
            most = (MOST_AT_ZERO - 1.0) * self.open_circuit_voltage / self.reference_temperature
            allowed = f"at least {-most:.4g}: at 0 K a cell has at most {MOST_AT_ZERO:g} times open_circuit_voltage"
            raise InvalidValueError("voltage_slope", self.voltage_slope, allowed)
        if self.voltage_at(COLDEST) > MOST_EXPONENT * self.diode[0] * COLDEST / self.reference_temperature:
            allowed = f"of a curve whose bend a diode has at {COLDEST:g} K too: less"
            raise InvalidValueError("voltage_at_most_power", self.voltage_at_most_power, allowed)
        if self.most_of_light > 1.0:
            allowed = f"of a cell that makes no more than all of the light {span}"
            raise InvalidValueError("current_slope, voltage_slope", (self.current_slope, self.voltage_slope), allowed)
        return self

    def current_at(self, temperature: float) -> float:
        """I_sc(T), at the reference irradiance [A]."""
        return self.short_circuit_current + self.current_slope * (temperature - self.reference_temperature)

    def voltage_at(self, temperature: float) -> float:
        """V_oc(T), likewise [V]."""
        return self.open_circuit_voltage + self.voltage_slope * (temperature - self.reference_temperature)

    @property
    def efficiency(self) -> float:
        """At the reference irradiance and temperature [1]."""
        return self.current_at_most_power * self.voltage_at_most_power / (self.reference_irradiance * self.area)

    @property
    def most_of_light(self) -> float:
        """Part of the reference irradiance that I_sc times V_oc comes to where that is most of all temperatures: more
        than the cell makes at any [1].
        """
        temperatures = np.linspace(COLDEST, HOTTEST, 35)
        most = max(self.current_at(each) * self.voltage_at(each) for each in temperatures.tolist())
        return float(most) / (self.reference_irradiance * self.area)

    @cached_property
    def diode(self) -> tuple[float, float]:
        """a [V] and R_s [ohm]."""
        i_sc, i_m = self.short_circuit_current, self.current_at_most_power
        bend = log(1.0 - i_m / i_sc)
        fall = self.open_circuit_voltage - self.voltage_at_most_power
        slope = (self.voltage_at_most_power - fall) / (i_m / (i_sc - i_m) + bend)
        return slope, (slope * bend + fall) / i_m


class ShadowParams(Params):
    """A part of the machine that stands between Sun and array for Suns from some directions."""

    azimuth_from_deg: float = Field(
        ge=-360.0, le=360.0, description="of the Sun in base_link, from x towards y [degree]"
    )
    azimuth_to_deg: float = Field(ge=-360.0, le=360.0, description="on from there [degree]")
    below_elevation_deg: float = Field(ge=0.0, le=90.0, description="of the Sun over the deck [degree]")
    light: tuple[Annotated[float, Field(ge=0.0, le=1.0)], ...] = Field(
        min_length=1, description="part of the beam that reaches each group of cells behind one bypass diode [1]"
    )

    def falls(self, azimuth_deg: float, elevation_deg: float) -> bool:
        """Whether it does, for a Sun there."""
        width = (self.azimuth_to_deg - self.azimuth_from_deg) % 360.0
        return elevation_deg < self.below_elevation_deg and (azimuth_deg - self.azimuth_from_deg) % 360.0 <= width


class PhotovoltaicArrayParams(SourceParams):
    """One array, all of its cells in one plane."""

    kind: str = "photovoltaic_array"
    takes_light: ClassVar[bool] = True
    cell: CellParams = Field(description="of which it is made")
    cells_series: int = Field(ge=1, le=10_000, description="cells of a string [1]")
    strings: int = Field(ge=1, le=10_000, description="side by side [1]")
    groups: int = Field(default=1, ge=1, le=64, description="parts of a string with a bypass diode each [1]")
    bypass_voltage: float = Field(default=0.7, ge=0.0, le=5.0, description="over a bypass diode that carries [V]")
    normal: tuple[float, float, float] = Field(default=(0.0, 0.0, 1.0), description="of its plane in base_link [1]")
    shadows: tuple[ShadowParams, ...] = Field(default=(), description="of the machine itself; the first counts")
    spectral_factor: float = Field(
        default=1.0,
        gt=0.0,
        le=1.2,
        description="what its cells make of the light here over what they make in space [1]",
    )
    tracking_efficiency: float = Field(default=0.95, gt=0.0, le=1.0, description="of the regulator [1]")
    clean: float = Field(default=1.0, gt=0.0, le=1.0, description="part of light past the dust at the start [1]")
    dust_loss_per_day: float = Field(default=0.0, ge=0.0, lt=1.0, description="of what is left, each 24 hours [1]")
    age_years: float = Field(default=0.0, ge=0.0, le=100.0, description="at the start [year]")
    degradation_per_year: float = Field(default=0.0, ge=0.0, lt=1.0, description="of current, by radiation [1]")
    absorptance: float = Field(default=0.9, ge=0.0, le=1.0, description="of its face, for sunlight [1]")
    emittance_front: float = Field(default=0.85, ge=0.0, le=1.0, description="for heat [1]")
    emittance_back: float = Field(default=0.8, ge=0.0, le=1.0, description="for heat [1]")
    heat_capacity_per_area: float = Field(default=4000.0, gt=0.0, le=1e6, description="of plane and cells [J/(m2 K)]")
    temperature_surroundings: float = Field(
        default=220.0, gt=0.0, le=1000.0, description="that it radiates to where nobody says another, and starts at [K]"
    )

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.cells_series % self.groups:
            raise InvalidValueError("groups", self.groups, f"a divisor of cells_series = {self.cells_series}")
        if not hypot(*self.normal) > 1e-6:
            raise InvalidValueError("normal", self.normal, "a direction")
        made = self.spectral_factor * self.cell.efficiency
        if made > self.absorptance:
            allowed = f"at least {made:.4g}, what its cells make of the light"
            raise InvalidValueError("absorptance", self.absorptance, allowed)
        for shadow in self.shadows:
            if len(shadow.light) != self.groups:
                raise InvalidValueError("shadows.light", shadow.light, f"{self.groups} numbers, one for each group")
        return self

    @cached_property
    def area(self) -> float:
        """Of all cells [m2]."""
        return self.cells_series * self.strings * self.cell.area

    @cached_property
    def _plane(self) -> FloatArray:
        """Its normal as a unit vector (3,)."""
        return np.array(self.normal) / hypot(*self.normal)

    @cached_property
    def _unshaded(self) -> FloatArray:
        return np.ones(self.groups)

    @cached_property
    def _sheet(self) -> GroupSheet:
        cell = self.cell
        return GroupSheet(
            current=cell.short_circuit_current,
            current_slope=cell.current_slope,
            voltage=cell.open_circuit_voltage,
            voltage_slope=cell.voltage_slope,
            slope=cell.diode[0],
            series=cell.diode[1],
            reference_irradiance=cell.reference_irradiance,
            reference_temperature=cell.reference_temperature,
            number=self.cells_series // self.groups,
            bypass=self.bypass_voltage,
        )

    def initial_state(self) -> ArrayState:
        """As its file has it, as warm as its surroundings."""
        return ArrayState(self.temperature_surroundings, self.clean, self.age_years * SECONDS_PER_YEAR)

    def group(self, temperature: float) -> CellGroup:
        """A group of cells at a temperature [K]."""
        group: CellGroup = group_at(self._sheet, temperature)
        return group

    def irradiance(self, surroundings: PowerSurroundings) -> tuple[float, float]:
        """Of beam and sky on its plane [W/m2]."""
        here = surroundings
        beam, sky = irradiance_on(self._plane, here.to_sun, here.up, here.direct, here.diffuse)
        return beam, sky

    def shadow(self, to_sun: FloatArray) -> FloatArray:
        """Part of the beam that reaches each group, shape (groups,) [1]."""
        if not self.shadows:
            return self._unshaded
        x, y, z = to_sun.tolist()
        azimuth, elevation = degrees(atan2(y, x)), degrees(atan2(z, hypot(x, y)))
        for shadow in self.shadows:
            if shadow.falls(azimuth, elevation):
                return np.array(shadow.light)
        return self._unshaded

    def point(self, state: ArrayState, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """The most power that the light makes, whatever the voltage of the bus."""
        worn = (1.0 - self.degradation_per_year) ** (state.age / SECONDS_PER_YEAR)
        past, here = state.clean * worn * self.spectral_factor, surroundings
        lit = (self.shadow(here.to_sun), self._plane, here.to_sun, here.up, here.direct, here.diffuse)
        power = most_power_in_light(self._sheet, state.temperature, past, *lit)
        return SourcePoint(self.tracking_efficiency * self.strings * power)

    def holds(self, state: ArrayState) -> bool:
        """While its temperature, dust and age wait for their next step."""
        return state.waited > 0.0

    def step(self, state: ArrayState, power: float, dt: float, surroundings: PowerSurroundings = DARK) -> ArrayState:
        """Warmer or colder, dustier and older by `dt` [s], having given `power` [W]."""
        require_step(power, dt)
        waited, given, energy = state.waited + dt, state.given + power * dt, state.energy + power * dt
        if waited < HELD * (1.0 - 1e-9):  # fifty periods of 20 ms are a second but for rounding
            return replace(state, energy=energy, waited=waited, given=given)
        return replace(
            state,
            temperature=self._warmed(state.temperature, given / waited, waited, surroundings),
            clean=state.clean * (1.0 - self.dust_loss_per_day) ** (waited / SECONDS_PER_DAY),
            age=state.age + waited,
            energy=energy,
            waited=0.0,
            given=0.0,
        )

    def _warmed(self, before: float, power: float, dt: float, surroundings: PowerSurroundings) -> float:
        """The temperature at the end of a step [K]: backward Euler, by Newton's method from above the root."""
        beam, sky = self.irradiance(surroundings)
        sink = surroundings.temperature
        around = self.temperature_surroundings if sink is None else sink
        emitted = (self.emittance_front + self.emittance_back) * STEFAN_BOLTZMANN
        taken = self.absorptance * (beam + sky) - power / self.area + emitted * around**4
        stored = self.heat_capacity_per_area / dt
        warm = max(before, (max(taken, 0.0) / emitted) ** 0.25 if emitted > 0.0 else 0.0, 1.0)
        for _ in range(50):
            excess = stored * (warm - before) + emitted * warm**4 - taken
            change = excess / (stored + 4.0 * emitted * warm**3)
            warm -= change
            if abs(change) < 1e-9 * warm:
                break
        return max(warm, 1.0)

    @property
    def most_power(self) -> float:
        """In the light of the reference, square to it, new and clean [W]."""
        power, _ = most_power(self.group(self.cell.reference_temperature), self.spectral_factor * self._unshaded)
        return float(self.tracking_efficiency * self.strings * power)
