"""What is to be said of an orbit about a body: the work of scripts/site --orbit."""

import argparse
import json
import math
from collections.abc import Iterator
from typing import NamedTuple

from sojourn_config.command_errors import UsageError
from sojourn_config.load import load_params
from sojourn_machine.errors import MachineError
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.gravity.oblate import OblateParams
from sojourn_physics.environment.hazards.meteoroids import FARTHEST, NEAREST, flux_at
from sojourn_physics.environment.hazards.orbital_debris import LAST_YEAR, UNCHECKED_BELOW, debris_flux, known_for
from sojourn_physics.environment.orbit.circular import CircularOrbit, Flattening, TurnedOrbit
from sojourn_physics.environment.orbit.eccentric import EccentricOrbit
from sojourn_physics.environment.orbit.relative_motion import transition
from sojourn_physics.environment.orbit.thin_air import (
    HIGHEST,
    KAPTON_YIELD,
    LOWEST,
    OXYGEN_RANGE,
    atomic_oxygen,
    deceleration,
    density,
    sinking,
)
from sojourn_physics.environment.sun.moons import MOONS
from sojourn_physics.environment.sun.orbits import ASTRONOMICAL_UNIT
from sojourn_studies.site_figures import SheetRow

DAY = 86400.0
EARTH = "earth"
PLANETS = {**{name: (moon.planet, moon.distance) for name, moon in MOONS.items()}, "moon": (EARTH, 384.4e6)}
"""What each moon goes about, and at which distance [m] (JPL Solar System Dynamics, "Planetary Satellite Mean
Elements")."""
SUN = 1.3271244e20
"""GM of the Sun (IAU 2015, resolution B3) [m^3/s^2]."""
HITS = ((1e-4, "0.1 mm"), (1e-3, "1 mm"), (5e-3, "5 mm"))
"""Diameters of what hits a spacecraft [m]."""
METEOROID_DENSITY = 2.5
"""As ECSS-E-ST-10-04C takes it [g/cm3]."""
BALLISTIC_COEFFICIENT = 100.0
"""Of the spacecraft that drag is told for [kg/m^2]."""
DENSE = 1e-9
"""Density of air from which on no orbit lasts: that spacecraft sinks by 3 km in each turn about the Earth, in which the
air doubles within 10 km, so it falls within a day [kg/m^3]."""


class HillSphere(NamedTuple):
    """Where a body holds what goes about it."""

    beside: str
    """What pulls it away beyond."""
    radius: float
    """[m]"""


def hill_sphere(body: BodyParams) -> HillSphere:
    """a (m / (3 M))^(1/3) (Murray and Dermott 1999, "Solar System Dynamics", eq. 3.75), of a moon beside its planet;
    of any other body beside the Sun. That of a moon which is not known as one comes out too large, never too small.
    """
    if body.name in PLANETS:
        planet, distance = PLANETS[body.name]
        beside, heavier = planet, load_params("bodies", planet, BodyParams).gravitational_parameter
    else:
        beside, heavier, distance = "the Sun", SUN, body.semi_major_axis_au * ASTRONOMICAL_UNIT
    return HillSphere(beside, distance * math.cbrt(body.gravitational_parameter / (3.0 * heavier)))


def orbit_of(body: BodyParams, altitude: float) -> CircularOrbit:
    """At an altitude over the equator [m].

    Raises:
        UsageError: of what is an orbit itself; one that does not clear the body, or is beyond its Hill sphere.
    """
    if body.free_fall:
        raise UsageError(f"site: --orbit about {body.name}, an orbit itself: allowed is a planet, moon or asteroid")
    largest, hill = max(body.semi_axes), hill_sphere(body)
    try:
        orbit = CircularOrbit(body.gravitational_parameter, largest, largest + altitude)
    except MachineError as error:
        raise UsageError(f"site: --altitude {altitude:g} of an orbit: allowed is more than 0") from error
    if orbit.radius > hill.radius:
        allowed = (
            f"more than 0, at most {hill.radius - largest:.4g} m: beyond its Hill sphere {hill.beside} pulls it away"
        )
        raise UsageError(f"site: --altitude {altitude:g} of an orbit about {body.name}: allowed is {allowed}")
    return orbit


def rows_of_orbit(body: BodyParams, altitude: float, inclination: float, beta: float) -> Iterator[SheetRow]:
    """Its figures; altitude in metres, angles in radians. Raises as `orbit_of` does."""
    orbit = orbit_of(body, altitude)
    yield SheetRow("period", orbit.period / 60.0, "min")
    yield SheetRow("speed", orbit.speed, "m/s")
    yield SheetRow("in the body's shadow", orbit.shadow_share(beta) * orbit.period / 60.0, "min each turn")
    yield SheetRow("no shadow from beta", math.degrees(orbit.always_sunlit_above), "deg")
    yield from _drifts(body, orbit, inclination)
    beside = transition(orbit.rate, orbit.period) @ (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    yield SheetRow("what rests 1 m above a spacecraft is along its flight a turn later", float(beside[1]), "m")
    yield SheetRow("gravity gradient, largest torque for 1 kg m2 between two axes", 1.5 * orbit.rate**2, "N m")
    yield _row_of_hill(body)
    yield from _air(body, orbit)
    if body.name == EARTH and LOWEST <= altitude <= HIGHEST:
        yield from _drag(orbit, altitude)


def _row_of_hill(body: BodyParams) -> SheetRow:
    beside, radius = hill_sphere(body)
    return SheetRow(f"highest orbit, by the Hill sphere beside {beside}", (radius - max(body.semi_axes)) / 1e3, "km")


def _air(body: BodyParams, orbit: CircularOrbit) -> Iterator[SheetRow]:
    """Whether it lets an orbit last, at the height of a circle, where there is air."""
    altitude = orbit.radius - orbit.body_radius
    known_from, known_to = (0.0, 0.0) if body.atmosphere is None else body.atmosphere.altitudes
    if body.name == EARTH and altitude < LOWEST:
        yield SheetRow("air", f"too dense for an orbit to last; its figures are from {LOWEST / 1e3:g} km on")
    elif body.name == EARTH and altitude <= HIGHEST:
        if density(altitude) > DENSE:
            yield SheetRow("air", "too dense for an orbit to last")
    elif body.atmosphere is not None and altitude <= known_to:
        air = body.atmosphere.at(max(altitude, known_from)).density
        sunk = -sinking(orbit, air, BALLISTIC_COEFFICIENT) * orbit.period
        if air > DENSE or sunk > altitude:
            yield SheetRow("air", f"too dense for an orbit to last, {air:.2g} kg/m3")
    elif body.name != EARTH and body.surface_density > 0.0:
        known = body.surface_density if body.atmosphere is None else body.atmosphere.at(known_to).density
        yield SheetRow("air", f"not known here, only up to {known_to / 1e3:g} km, where it is {known:.2g} kg/m3")


def _drag(orbit: CircularOrbit, altitude: float) -> Iterator[SheetRow]:
    """Of the Earth's air, for whose altitude it is known."""
    air = density(altitude)
    yield SheetRow("air, mean activity of the Sun", air, "kg/m3")
    of_drag = f"at {BALLISTIC_COEFFICIENT:g} kg/m2"
    yield SheetRow(f"drag {of_drag}", deceleration(orbit, air, BALLISTIC_COEFFICIENT), "m/s2")
    yield SheetRow(f"sinks {of_drag}", -sinking(orbit, air, BALLISTIC_COEFFICIENT) * DAY, "m/day")
    if OXYGEN_RANGE[0] <= altitude <= OXYGEN_RANGE[1]:
        atoms = atomic_oxygen(orbit, air)
        yield SheetRow("atomic oxygen on what flies ahead", atoms, "1/(m2 s)")
        yield SheetRow("polyimide that it takes away", atoms * KAPTON_YIELD * 1e6 * 365.25 * DAY, "um/year")


def _ellipse(body: BodyParams, lowest: CircularOrbit, eccentricity: float) -> EccentricOrbit:
    """With its pericentre at the height of a circle. Raises UsageError for what is no ellipse, or is not held."""
    try:
        orbit = EccentricOrbit(lowest.gravitational_parameter, lowest.body_radius, lowest.radius, eccentricity)
    except MachineError as error:
        raise UsageError(f"site: --eccentricity {eccentricity:g}: allowed is 0 to less than 1") from error
    hill = hill_sphere(body)
    if orbit.apocentre > hill.radius:
        most = (hill.radius - lowest.radius) / (hill.radius + lowest.radius)
        allowed = f"0 to {most:.4g} from this altitude: beyond its Hill sphere {hill.beside} pulls it away"
        raise UsageError(f"site: --eccentricity {eccentricity:g} of an orbit about {body.name}: allowed is {allowed}")
    return orbit


def rows_of_ellipse(body: BodyParams, orbit: EccentricOrbit, inclination: float, beta: float) -> Iterator[SheetRow]:
    """Its figures; angles in radians."""
    yield SheetRow("period", orbit.period / 60.0, "min")
    yield SheetRow("highest", (orbit.apocentre - orbit.body_radius) / 1e3, "km")
    yield SheetRow("speed at the lowest place", orbit.speed(orbit.pericentre), "m/s")
    yield SheetRow("speed at the highest place", orbit.speed(orbit.apocentre), "m/s")
    yield SheetRow("in the body's shadow, its highest place in it", orbit.shadow(beta, 0.0) / 60.0, "min each turn")
    yield SheetRow("in the body's shadow, its lowest place in it", orbit.shadow(beta, math.pi) / 60.0, "min each turn")
    yield from _drifts(body, orbit, inclination)
    gradient = 1.5 * body.gravitational_parameter / orbit.pericentre**3
    yield SheetRow("gravity gradient, largest torque for 1 kg m2 between two axes", gradient, "N m")
    yield _row_of_hill(body)
    yield from _air(body, CircularOrbit(orbit.gravitational_parameter, orbit.body_radius, orbit.pericentre))


def _drifts(body: BodyParams, orbit: TurnedOrbit, inclination: float) -> Iterator[SheetRow]:
    """By the flattening of the body, where it is known; inclination in radians."""
    if isinstance(body.attraction, OblateParams):
        flattening = Flattening(body.attraction.j2, body.attraction.reference_radius or max(body.semi_axes))
        drifts = flattening.node_rate(orbit, inclination), flattening.perigee_rate(orbit, inclination)
        yield SheetRow("drift of the node, eastward", math.degrees(drifts[0]) * DAY, "deg/day")
        yield SheetRow("drift of the perigee", math.degrees(drifts[1]) * DAY, "deg/day")


def rows_of_hits(body: BodyParams, orbit: CircularOrbit, inclination: float) -> Iterator[SheetRow]:
    """What hits a spacecraft in a year, of a diameter or more: meteoroids, and debris about the Earth; inclination in
    degrees.
    """
    sun, altitude = body.semi_major_axis_au, orbit.radius - max(body.semi_axes)
    for diameter, name in HITS:
        if NEAREST <= sun <= FARTHEST:
            mass = METEOROID_DENSITY * math.pi / 6.0 * (100.0 * diameter) ** 3
            met = flux_at(mass, body.gravitational_parameter, orbit.body_radius, orbit.radius, sun)
            yield SheetRow(f"meteoroids of {name} or more", met, "1/(m2 year)")
        if body.name == EARTH and known_for(altitude, inclination):
            found = debris_flux(diameter, altitude, inclination)
            unchecked = ", by a factor of inclination that wants a check" if inclination < UNCHECKED_BELOW else ""
            yield SheetRow(f"debris of {name} or more, of {LAST_YEAR:g}", found, f"1/(m2 year){unchecked}")


def run(given: argparse.Namespace) -> int:
    """Print the sheet of the orbit that the options name.

    Raises:
        UsageError: angles or an altitude that no orbit has; a place or a date of one. ConfigError: an unknown body.
    """
    body = load_params("bodies", given.body, BodyParams)
    for option, angle, most in (("inclination", given.inclination, 180.0), ("beta", given.beta, 90.0)):
        least = 0.0 if option == "inclination" else -most
        if not least <= angle <= most:
            raise UsageError(f"site: --{option} {angle:g}: allowed is {least:g} to {most:g}")
    if given.lat or given.lon or given.time is not None or given.plot is not None:
        raise UsageError("site: --lat, --lon, --time, --plot with --orbit: allowed is a place or an orbit")
    inclination, beta = math.radians(given.inclination), math.radians(given.beta)
    circle = orbit_of(body, given.altitude)
    if given.eccentricity:
        rows = list(rows_of_ellipse(body, _ellipse(body, circle, given.eccentricity), inclination, beta))
    else:
        rows = list(rows_of_orbit(body, given.altitude, inclination, beta))
        rows += rows_of_hits(body, circle, given.inclination)
    if given.json:
        print(json.dumps({"orbit": {row.name: row.value for row in rows}}, indent=1))
        return 0
    high = "high" if not given.eccentricity else f"high at its lowest, eccentricity {given.eccentricity:g}"
    print(f"{body.name}, orbit {given.altitude:g} m {high}, inclination {given.inclination:g} deg")
    width = max(len(row.name) for row in rows)
    for row in rows:
        value = row.value if isinstance(row.value, str) else f"{row.value:.5g}"
        print(f"  {row.name.ljust(width)}  {value} {row.unit}".rstrip())
    return 0
