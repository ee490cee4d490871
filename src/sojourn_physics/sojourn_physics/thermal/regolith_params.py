"""What a regolith is to heat: density and conductivity over depth, heat capacity over temperature, emissivity, albedo.

    rho(z) = rho_d - (rho_d - rho_s) e^(-z/H)
    k(z, T) = k_c (1 + chi (T/350)^3),   k_c = k_d - (k_d - k_s) (rho_d - rho)/(rho_d - rho_s)
    c(T) = c_0 + c_1 T + c_2 T^2 + c_3 T^3 + c_4 T^4
    A(i) = A_0 + a (i/45 deg)^3 + b (i/90 deg)^8,   i: angle of incidence (after Keihm 1984)

(Hayne et al. 2017, "Global regolith thermophysical properties of the Moon from the Diviner lunar radiometer
experiment", JGR Planets 122, table A1: `config/bodies/moon.yaml` has its figures.)
Ground that is known by its thermal inertia alone, I = sqrt(k rho c), is the same with constants: `uniform_regolith`.
Range: dry grains, 20 to 450 K; ice, its latent heat and how conductivity depends on the pressure of air are left out.
"""

import math
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params

_REFERENCE = 350.0
"""Of the radiative conductivity [K]."""


class RegolithParams(Params):
    """A regolith, alike over the site."""

    density_surface: float = Field(gt=0.0, le=1e4, description="rho_s, bulk density at the surface [kg/m3]")
    density_deep: float = Field(gt=0.0, le=1e4, description="rho_d, bulk density far below [kg/m3]")
    density_scale: float = Field(gt=0.0, le=10.0, description="H, depth over which the density grows [m]")
    conductivity_surface: float = Field(gt=0.0, le=10.0, description="k_s, of the contacts at the surface [W/(m K)]")
    conductivity_deep: float = Field(gt=0.0, le=10.0, description="k_d, of the contacts far below [W/(m K)]")
    radiative_conductivity: float = Field(ge=0.0, le=100.0, description="chi, radiation between grains at 350 K [1]")
    heat_capacity: tuple[float, float, float, float, float] = Field(
        description="c_0 to c_4 of the specific heat [J/(kg K), J/(kg K2), ...]"
    )
    emissivity: float = Field(gt=0.0, le=1.0, description="of the surface in the infrared [1]")
    albedo_normal: float = Field(ge=0.0, lt=1.0, description="A_0, albedo for the Sun overhead [1]")
    albedo_slant: tuple[float, float] = Field(default=(0.0, 0.0), description="a and b of the albedo [1]")
    heat_flow: float = Field(default=0.0, ge=0.0, le=100.0, description="from the interior [W/m2]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if min(self.specific_heat(temperature) for temperature in (20.0, 100.0, 200.0, 300.0, 450.0)) <= 0.0:
            raise ValueError(f"heat_capacity = {self.heat_capacity}: allowed is above 0 J/(kg K) from 20 to 450 K")
        if not 0.0 <= self.albedo(0.5 * math.pi) <= 1.0:
            raise ValueError(f"albedo_slant = {self.albedo_slant}: allowed is an albedo within 0 to 1 at every angle")
        return self

    def density(self, depth: float) -> float:
        """Bulk density [kg/m3] at a depth [m]."""
        return self.density_deep - (self.density_deep - self.density_surface) * math.exp(-depth / self.density_scale)

    def contact_conductivity(self, depth: float) -> float:
        """k_c [W/(m K)] at a depth [m]: with the density, which goes exponentially, so does it."""
        growth = math.exp(-depth / self.density_scale)
        return self.conductivity_deep - (self.conductivity_deep - self.conductivity_surface) * growth

    def conductivity(self, depth: float, temperature: float) -> float:
        """k [W/(m K)] at a depth [m] and a temperature [K]."""
        return self.contact_conductivity(depth) * (1.0 + self.radiative_conductivity * (temperature / _REFERENCE) ** 3)

    def specific_heat(self, temperature: float) -> float:
        """c [J/(kg K)] at a temperature [K]."""
        return math.fsum(c * temperature**power for power, c in enumerate(self.heat_capacity))

    def albedo(self, incidence: float) -> float:
        """A [1] for light that comes in at an angle from the normal [rad]."""
        a, b = self.albedo_slant
        return self.albedo_normal + a * (incidence / (0.25 * math.pi)) ** 3 + b * (incidence / (0.5 * math.pi)) ** 8

    def skin_depth(self, period: float, temperature: float, depth: float = 0.0) -> float:
        """sqrt(kappa P / pi) [m]: depth over which a wave of a period [s] falls to 1/e."""
        diffusivity = self.conductivity(depth, temperature) / (self.density(depth) * self.specific_heat(temperature))
        return math.sqrt(diffusivity * period / math.pi)


def uniform_regolith(
    thermal_inertia: float,
    albedo: float,
    emissivity: float = 0.95,
    volumetric_heat: float = 1.0e6,
    heat_flow: float = 0.0,
) -> RegolithParams:
    """Ground of one thermal inertia [J/(m2 K s^(1/2))] at every depth and temperature.

    `volumetric_heat`, rho c [J/(m3 K)], sets how deep the wave goes and not how warm the surface becomes; 1e6 is an
    estimate for dry soil. Albedo and emissivity [1], `heat_flow` from the interior [W/m2].
    """
    density = 1500.0
    conductivity = thermal_inertia**2 / volumetric_heat
    return RegolithParams(
        density_surface=density,
        density_deep=density,
        density_scale=1.0,
        conductivity_surface=conductivity,
        conductivity_deep=conductivity,
        radiative_conductivity=0.0,
        heat_capacity=(volumetric_heat / density, 0.0, 0.0, 0.0, 0.0),
        emissivity=emissivity,
        albedo_normal=albedo,
        heat_flow=heat_flow,
    )
