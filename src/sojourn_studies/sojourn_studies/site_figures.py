"""What is to be said of a place on a body, section by section: the work of scripts/site.

A section is a function from a `SheetPlace` to its figures. To add one, write it and put it into `SECTIONS`.
"""

import argparse
import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError

from sojourn_config.command_errors import UsageError
from sojourn_config.load import load_params
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray
from sojourn_machine.sunlight import Sunlight
from sojourn_physics.environment.body import SOLAR_FLUX_AT_1_AU, BodyParams
from sojourn_physics.environment.gravity.field import MAP_ORIGIN, BodyField
from sojourn_physics.environment.hazards.stay import Stay, rows_of_stay
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.environment.sun.path import SunParams
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.thermal.site_ground import SiteGround

MOMENTS = 145
"""Of a solar day that are looked at."""
HIGHEST_GROUND = 25e3
"""Of any body with air: Olympus Mons has 22 km [m]."""


class SheetRow(NamedTuple):
    """One line of the sheet."""

    name: str
    value: float | str
    unit: str = ""


@dataclass(frozen=True)
class SheetPlace:
    """A site on a body, and the Sun over it if the date is known."""

    body: BodyParams
    site: SiteParams
    sun: SunOver | None
    days: float
    """Of a stay [d]."""

    @cached_property
    def field(self) -> BodyField:
        """Gravity in map."""
        return self.body.field_over(self.site)

    @cached_property
    def hours(self) -> FloatArray:
        """Of a solar day from the date on, (MOMENTS,) [h]."""
        return np.linspace(0.0, self.body.solar_day_hours, MOMENTS)

    @cached_property
    def lights(self) -> list[Sunlight]:
        """Light at these hours; none without a date."""
        return [] if self.sun is None else [self.sun.light(3600.0 * hour, 0.0, 0.0) for hour in self.hours.tolist()]

    @cached_property
    def ground(self) -> FloatArray | None:
        """Temperature of the surface at these hours, (MOMENTS,) [K]; None without a date, or of ground not known."""
        if self.sun is None or self.body.regolith is None:
            return None
        sun = self.sun
        ground = SiteGround(self.body, lambda time: sun.light(time, 0.0, 0.0))
        return np.array([ground.temperature(3600.0 * hour) for hour in self.hours.tolist()])


def gravity(place: SheetPlace) -> Iterator[SheetRow]:
    """What a machine weighs there, which way it falls, and how fast it must go to leave."""
    pull = place.field.acceleration(MAP_ORIGIN)
    strength = float(np.linalg.norm(pull))
    if pull[2] >= 0.0:  # beyond the orbit that keeps its place over the ground
        outwards = f"none: what turns with {place.body.name} there flies off, outwards with {strength:.5g} m/s2"
        yield SheetRow("gravity", outwards)
        yield SheetRow("mean of the body, GM/R2", place.body.surface_gravity, "m/s2")
        yield SheetRow("speed of escape", place.field.escape_speed(MAP_ORIGIN), "m/s")
        return
    yield SheetRow("gravity", strength, "m/s2")
    yield SheetRow("mean of the body, GM/R2", place.body.surface_gravity, "m/s2")
    yield SheetRow("plumb line off the vertical", math.degrees(math.acos(min(-float(pull[2]) / strength, 1.0))), "deg")
    yield SheetRow("speed of escape", place.field.escape_speed(MAP_ORIGIN), "m/s")
    yield SheetRow("time to fall 1 m", math.sqrt(2.0 / strength), "s")


def day(place: SheetPlace) -> Iterator[SheetRow]:
    """How the body turns."""
    yield SheetRow("solar day", place.body.solar_day_hours, "h")
    if place.body.rotation is not None:
        yield SheetRow("turn against the stars, westward negative", place.body.rotation.sidereal_hours, "h")


def not_of_the_height(place: SheetPlace) -> Iterator[SheetRow]:
    """That what air leaves of light, dose and meteoroids is not told for a place within the air, at it."""
    body = place.body
    if not body.ground and body.atmosphere is not None:
        yield SheetRow("of this depth", "not told: these figures are of light and space over all of the air")
    elif body.surface_pressure > 0.0 and place.site.altitude_m > HIGHEST_GROUND:
        yield SheetRow("of this height", "not told: these figures are of the ground, under all of the air")


def sunlight(place: SheetPlace) -> Iterator[SheetRow]:
    """Sunlight over the year, and over a day from the date on."""
    body = place.body
    yield from not_of_the_height(place)
    yield SheetRow("sunlight over the air, mean", body.solar_flux, "W/m2")
    for name, ratio in (("farthest", 1.0 + body.orbital_eccentricity), ("nearest", 1.0 - body.orbital_eccentricity)):
        yield SheetRow(f"sunlight over the air, {name}", body.solar_flux / ratio**2, "W/m2")
    if place.sun is None:
        return
    now = place.lights[0]
    east, north, _ = now.direction
    yield SheetRow("at the date: distance of the Sun", place.sun.path.distance(0.0), "au")
    yield SheetRow("at the date: sunlight over the air", SOLAR_FLUX_AT_1_AU / place.sun.path.distance(0.0) ** 2, "W/m2")
    yield SheetRow("at the date: elevation of the Sun", math.degrees(now.elevation), "deg")
    yield SheetRow("at the date: azimuth, from north by east", math.degrees(math.atan2(east, north)) % 360.0, "deg")
    yield SheetRow("at the date: beam, on a surface square to it", now.direct, "W/m2")
    yield SheetRow("at the date: from the sky, on the level", now.diffuse, "W/m2")
    elevations = [light.elevation for light in place.lights]
    yield SheetRow("over a day: greatest elevation", math.degrees(max(elevations)), "deg")
    yield SheetRow("over a day: least elevation", math.degrees(min(elevations)), "deg")
    up = sum(light.visible > 0.0 for light in place.lights[:-1]) / (MOMENTS - 1)
    yield SheetRow("over a day: the Sun is up for", up * body.solar_day_hours, "h")
    joules = 3600.0 * float(np.trapezoid([on_level(light) for light in place.lights], place.hours))
    yield SheetRow("over a day: energy on the level", joules / 3.6e6, "kWh/m2")


def air(place: SheetPlace) -> Iterator[SheetRow]:
    """The air at the site."""
    if place.body.atmosphere is None:
        yield SheetRow("air", "none that a machine would notice")
        return
    try:
        found = place.body.air_at(place.site)
    except MachineError as error:
        yield SheetRow("air", str(error))
        return
    yield SheetRow("temperature", found.temperature, "K")
    yield SheetRow("pressure", found.pressure, "Pa")
    yield SheetRow("density", found.density, "kg/m3")
    yield SheetRow("speed of sound", found.speed_of_sound, "m/s")
    wind = "not known" if found.zonal_wind is None else found.zonal_wind
    yield SheetRow("mean wind towards the east", wind, "" if found.zonal_wind is None else "m/s")


def temperatures(place: SheetPlace) -> Iterator[SheetRow]:
    """Of the surface: anywhere on the body, and at the place over a day from the date on."""
    yield SheetRow("coldest on the body", place.body.temperature_min, "K")
    yield SheetRow("hottest on the body", place.body.temperature_max, "K")
    if place.ground is None:
        why = "with a date" if place.body.regolith is not None else "not known: no table regolith"
        yield SheetRow("over a day: ground here", why)
        return
    ground = place.ground
    yield SheetRow("at the date: ground here", float(ground[0]), "K")
    for name, which in (("coldest", int(np.argmin(ground))), ("warmest", int(np.argmax(ground)))):
        after = f"{place.hours[which]:.2f} h after the date"
        yield SheetRow(f"over a day: {name} ground here", float(ground[which]), f"K, {after}")


def soils(place: SheetPlace) -> Iterator[SheetRow]:
    """Soils that have been found on the body."""
    if not place.body.soils:
        yield SheetRow("soil", "no figure" if place.body.ground else "none: it has no ground")
    for name in place.body.soils:
        soil = load_params("soils", name, SoilParams)
        strength = f"{soil.cohesion:g} Pa, {soil.friction_angle_deg:g} deg"
        yield SheetRow(name, f"{soil.density:.4g} kg/m3, {strength}, sinkage exponent {soil.n:g} ({soil.citation})")


def stay(place: SheetPlace) -> Iterator[SheetRow]:
    """Dose, upsets, hits and dust of a stay, with the source of each."""
    yield from not_of_the_height(place)
    for row in rows_of_stay(place.body, Stay(place.days)):
        yield SheetRow(row.what, f"{row.value} ({row.source})" if row.source else row.value)


SECTIONS: dict[str, Callable[[SheetPlace], Iterator[SheetRow]]] = {
    "gravity": gravity,
    "day": day,
    "sun": sunlight,
    "air": air,
    "temperature": temperatures,
    "soil: density, cohesion and angle of friction": soils,
    "stay": stay,
}
"""The sheet, in its order."""


def on_level(light: Sunlight) -> float:
    """Of beam and sky on level ground [W/m2]."""
    return light.direct * max(math.sin(light.elevation), 0.0) + light.diffuse


def place_of(given: argparse.Namespace) -> SheetPlace:
    """The place that the options name.

    Raises:
        UsageError: a place that is none. ConfigError: an unknown body.
    """
    body = load_params("bodies", given.body, BodyParams)
    if not given.days > 0.0:
        raise UsageError(f"site: --days {given.days:g}: allowed is more than 0")
    if body.free_fall:
        raise UsageError(f"site: {body.name} is an orbit and has no places: allowed is a planet, moon or asteroid")
    try:
        site = SiteParams(latitude_deg=given.lat, longitude_deg=given.lon, altitude_m=given.altitude)
        body.gravity_over(site)
        sun = None if given.time is None else SunOver(SunParams.model_validate({"time": given.time}), body, site)
    except ValidationError as error:
        raise UsageError("site: " + "; ".join(map(_problem, error.errors()))) from error
    except MachineError as error:
        raise UsageError(f"site: {error}") from error
    return SheetPlace(body, site, sun, given.days)


def _problem(found: object) -> str:
    """One line of pydantic's errors in the words of the options."""
    values = dict(found)  # type: ignore[call-overload]
    option = {"latitude_deg": "--lat", "longitude_deg": "--lon", "altitude_m": "--altitude"}
    name = str(values["loc"][0]) if values["loc"] else "time"
    given, said = values["input"], values["msg"]
    if isinstance(given, dict):  # found by a check of the whole table, of which this is the only value
        given, said = given.get(name), said.removeprefix("Value error, ")
    return f"{option.get(name, '--' + name)} {given}: {said[0].lower()}{said[1:]}"


def run(given: argparse.Namespace) -> int:
    """Draw the sheet, and print it: a picture that cannot be written is told before."""
    place = place_of(given)
    sheet = {name: list(section(place)) for name, section in SECTIONS.items()}
    if given.plot is not None:
        from sojourn_studies.site_plot import draw  # matplotlib, which the figures alone do not need

        draw(given.plot, place)
    if given.json:
        print(json.dumps({name: {row.name: row.value for row in rows} for name, rows in sheet.items()}, indent=1))
    else:
        _print(place, sheet)
    return 0


def _print(place: SheetPlace, sheet: dict[str, list[SheetRow]]) -> None:
    site = place.site
    where = f"latitude {site.latitude_deg:g} deg, longitude {site.longitude_deg:g} deg, {site.altitude_m:g} m"
    print(f"{place.body.name}, {where}")
    width = max(len(row.name) for rows in sheet.values() for row in rows)
    for name, rows in sheet.items():
        print(f"\n{name}" + (f" of {place.days:g} days" if name == "stay" else ""))
        for row in rows:
            value = row.value if isinstance(row.value, str) else f"{row.value:.5g}"
            print(f"  {row.name.ljust(width)}  {value} {row.unit}".rstrip())
    if place.sun is None:
        print("\nWith --time the Sun's place and light at that date, and over a day.")
    print(f"\nSources: {place.body.citation}; others beside the numbers in config/bodies/{place.body.name}.yaml")
