"""A planet, moon or asteroid as the machine on its surface feels it.

    g = GM / R^2              (mean gravity of a sphere; of a site: `gravity/field.py`)
    S = S_1 / a^2             (inverse-square law; S_1 = 1361 W/m2 at 1 au: Kopp & Lean 2011)

In orbit a machine falls with its station: nothing has weight. Left out are the tide, some 1e-6 m/s2 a metre off the
station's centre of mass, and drag.

Range: g is the mean over the body. For Phobos, Eros and Itokawa, which are far from round, it is good to a
factor of about 1.5; a site has the gravity of its latitude, altitude and shape. S is at the mean distance; over an
orbit of eccentricity e it goes from S / (1 + e)^2 to S / (1 - e)^2.
"""

import math
from typing import Annotated, Self

import numpy as np
from pydantic import Field, SerializeAsAny, model_validator

from sojourn_machine.choice import kinds_of
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.environment.air.atmosphere import ATMOSPHERES, Air, AtmosphereParams
from sojourn_physics.environment.gravity.attraction import ATTRACTIONS, AttractionParams
from sojourn_physics.environment.gravity.field import BodyField, GravityField, UniformField
from sojourn_physics.environment.gravity.tide import TidalField
from sojourn_physics.environment.magnetic_field import MagneticDipoleParams
from sojourn_physics.environment.rotation import RotationParams
from sojourn_physics.environment.shape import ShapeParams
from sojourn_physics.environment.site import SiteParams, site_frame
from sojourn_physics.thermal.regolith_params import RegolithParams

SOLAR_FLUX_AT_1_AU = 1361.0
"""Total solar irradiance at 1 au [W/m2]."""
Atmosphere = Annotated[SerializeAsAny[AtmosphereParams], *kinds_of(ATMOSPHERES, "kind")]
Attracting = Annotated[SerializeAsAny[AttractionParams], *kinds_of(ATTRACTIONS, "kind")]


class BodyParams(Params):
    """One body, or an orbit about one. The field names are the keys of the files in `config/bodies`."""

    name: str = Field(min_length=1, pattern=r"^[a-z][a-z0-9_]*$", description="name of the body, as its file")
    citation: str = Field(min_length=1, description="where the numbers are from")
    estimates: tuple[str, ...] = Field(
        default=(), description="fields of this set that are rounded guesses or not well known"
    )
    gravitational_parameter: float = Field(gt=0.0, le=1e18, description="GM [m3/s2]")
    radius: float = Field(gt=0.0, le=1e9, description="mean radius [m]")
    semi_major_axis_au: float = Field(gt=0.0, le=1e3, description="mean distance from the Sun [au]")
    orbital_eccentricity: float = Field(ge=0.0, lt=1.0, description="eccentricity of the orbit about the Sun")
    temperature_min: float = Field(ge=0.0, le=2000.0, description="coldest surface temperature [K]")
    temperature_max: float = Field(ge=0.0, le=2000.0, description="hottest surface temperature [K]")
    solar_day_hours: float = Field(gt=0.0, description="noon to noon at the surface [h]")
    surface_pressure: float = Field(default=0.0, ge=0.0, description="atmospheric pressure, 0 for none [Pa]")
    surface_density: float = Field(default=0.0, ge=0.0, description="atmospheric density, 0 for none [kg/m3]")
    free_fall: bool = Field(default=False, description="in orbit: nothing weighs anything; radius is the orbit's")
    ground: bool = Field(default=True, description="false of a giant planet: its surface is the level of 1 bar")
    shape: ShapeParams | None = Field(default=None, description="reference ellipsoid; none: a sphere of `radius`")
    rotation: RotationParams | None = Field(default=None, description="against the stars; none: it does not turn")
    attraction: Attracting | None = Field(default=None, description="how its mass draws; none: as a point does")
    regolith: RegolithParams | None = Field(default=None, description="the ground to heat; none: not known")
    soils: tuple[str, ...] = Field(
        default=(), description="soils of config/soils that are found on it; none: no figure"
    )
    sky_temperature: float = Field(
        default=2.7, gt=0.0, le=2000.0, description="as which the sky radiates in the infrared [K]"
    )
    magnetic_dipole: MagneticDipoleParams | None = Field(
        default=None, description="its own magnetic field; none: it has none of a dipole, or none that is known"
    )
    atmosphere: Atmosphere | None = Field(default=None, description="its air by altitude; none: it has no air")

    @model_validator(mode="after")
    def _fields_agree(self) -> Self:
        if self.temperature_max < self.temperature_min:
            allowed = f"at least temperature_min = {self.temperature_min:g} K"
            raise InvalidValueError("temperature_max", self.temperature_max, allowed)
        if (self.surface_pressure > 0.0) != (self.surface_density > 0.0):
            allowed = f"more than 0 with surface_pressure = {self.surface_pressure:g} Pa, or both 0"
            raise InvalidValueError("surface_density", self.surface_density, allowed)
        unknown = sorted(set(self.estimates) - set(type(self).model_fields))
        if unknown:
            raise InvalidValueError("estimates", unknown, "names of fields of a body")
        return self

    @property
    def surface_gravity(self) -> float:
        """Acceleration that weight comes from, positive downwards [m/s2]; zero in free fall."""
        if self.free_fall:
            return 0.0
        return self.gravitational_parameter / self.radius**2

    @property
    def semi_axes(self) -> tuple[float, float, float]:
        """Of the reference ellipsoid, along x, y and z, the longest first [m]."""
        return (self.radius, self.radius, self.radius) if self.shape is None else self.shape.semi_axes

    def gravity_over(self, site: SiteParams | None) -> GravityField:
        """Gravity in map over a site; without one the mean gravity of the body, everywhere and straight down.

        Raises:
            InvalidValueError: a site in an orbit, where nothing has weight; what the kind of attraction refuses.
        """
        return UniformField(self.surface_gravity) if site is None else self.field_over(site)

    def field_over(self, site: SiteParams) -> BodyField:
        """Gravity in map over a site. Raises as `gravity_over` does."""
        if self.free_fall:
            raise InvalidValueError("site", self.name, "none: in free fall there is no ground to stand on")
        attraction = (self.attraction or ATTRACTIONS.get("oblate")(kind="oblate")).build(self)
        spin, tide = (0.0, 0.0) if self.rotation is None else (self.rotation.rate, self.rotation.tide)
        return BodyField(attraction, spin, site_frame(site, self.semi_axes), tide)

    def field_in_orbit(self) -> TidalField:
        """Gravity in the map of a machine that floats. Raises InvalidValueError for a body that is no orbit."""
        if not self.free_fall:
            raise InvalidValueError("body", self.name, "an orbit, as what floats free would fall")
        return TidalField(math.sqrt(self.gravitational_parameter / self.radius**3))

    def air_at(self, site: SiteParams | None) -> Air:
        """Its air at a site, or at its mean surface.

        Raises:
            InvalidValueError: it has none; a site higher or lower than its air is known for.
        """
        if self.atmosphere is None:
            raise InvalidValueError("air", self.name, "a body whose file has a table `atmosphere`")
        return self.atmosphere.at(0.0) if site is None else self.atmosphere.over(site.latitude_deg, site.altitude_m)

    def magnetic_field_over(self, site: SiteParams | None) -> FloatArray:
        """Its own magnetic field in map over a site, east, north, up, shape (3,) [T]; zero of a body without.

        Raises:
            InvalidValueError: no site on a body with a field, or one in its dipole.
        """
        if self.magnetic_dipole is None:
            return np.zeros(3)
        if site is None:
            raise InvalidValueError(
                "site", None, f"one, as the magnetic field of {self.name} differs from place to place"
            )
        return self.magnetic_dipole.field_over(site_frame(site, self.semi_axes))

    @property
    def solar_flux(self) -> float:
        """Sunlight above the atmosphere at the mean distance from the Sun [W/m2]."""
        return SOLAR_FLUX_AT_1_AU / self.semi_major_axis_au**2

    @property
    def solar_day(self) -> float:
        """Noon to noon at the surface [s]."""
        return self.solar_day_hours * 3600.0
