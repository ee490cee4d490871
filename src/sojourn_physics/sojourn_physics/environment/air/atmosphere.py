"""Air over a body: kinds of it, found by their names, and what a machine meets of it.

    rho = p / (R T),    c = sqrt(gamma R T)

A kind is one module: parameters derived from `AtmosphereParams` that say `at` for an altitude, with their source. It is
registered by an entry point of the group `sojourn.atmospheres` under the name that a body's file says as `kind`.
"""

import math
from typing import NamedTuple

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

ATMOSPHERES: "Registry[type[AtmosphereParams]]" = Registry("sojourn.atmospheres", "kind of atmosphere")
"""Parameter sets of the kinds of atmosphere, by their names."""


class Air(NamedTuple):
    """The air at a place."""

    temperature: float
    """[K]"""
    pressure: float
    """[Pa]"""
    density: float
    """[kg/m^3]"""
    speed_of_sound: float
    """[m/s]"""
    zonal_wind: float | None = None
    """Towards the east, in the mean [m/s]; None: not known."""


class AtmosphereParams(Params):
    """The air of one body. Each kind has a subclass with its parameters, whose default of `kind` is its name."""

    kind: str = Field(description="kind of atmosphere")
    gas_constant: float = Field(gt=0.0, le=1e4, description="of the mixture [J/(kg K)]")
    heat_ratio: float = Field(gt=1.0, le=5.0 / 3.0 + 1e-9, description="of specific heats, gamma [1]")

    @property
    def altitudes(self) -> tuple[float, float]:
        """The lowest and highest that it is known for [m]."""
        raise NotImplementedError

    def at(self, altitude: float) -> Air:
        """The air at an altitude over the reference ellipsoid [m].

        Raises:
            InvalidValueError: out of its range.
        """
        raise NotImplementedError

    def over(self, latitude_deg: float, altitude: float) -> Air:
        """Likewise, at a latitude of the vertical [deg], by which a kind may know more. Raises as `at` does."""
        return self.at(altitude)

    def _checked(self, altitude: float) -> float:
        low, high = self.altitudes
        if not low <= altitude <= high:
            raise InvalidValueError("altitude [m]", altitude, f"{low:g} to {high:g}, for which the air is known")
        return altitude

    def _of(self, temperature: float, pressure: float, zonal_wind: float | None = None) -> Air:
        """A perfect gas."""
        density = pressure / (self.gas_constant * temperature)
        sound = math.sqrt(self.heat_ratio * self.gas_constant * temperature)
        return Air(temperature, pressure, density, sound, zonal_wind)
