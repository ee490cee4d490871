"""Meteoroids: how many of a mass or more hit an area, near a body or on it.

    F(m) = 3.15576e7 { (2.2e3 m^0.306 + 15)^-4.38
                       + 1.3e-9 (m + 1e11 m^2 + 1e27 m^4)^-0.36 + 1.3e-16 (m + 1e6 m^2)^-0.85 }

hits in a year on a square metre of one side of a randomly turned plate at 1 au, m in g. A body draws them in and hides
a part of the sky:

    G = 1 + v_e^2 / v^2,  v_e^2 = 2 GM / d,        S = (1 + cos asin(R / d)) / 2

at a distance d of its centre, v = 20 km/s the speed far from it; on the surface half of the sky is left. Elsewhere
F goes with (r / 1 au)^-1.8, as their density does with r^-1.3 and their speed with r^-0.5.

Sources: Gruen, Zook, Fechtig and Giese 1985, Icarus 62:244 (flux, speed, density over r); ECSS-E-ST-10-04C, 10.2.4 and
annex C (units, focusing, shielding). Range: 1e-18 g to 1 g, 0.3 to 4 au; good to a factor of 2 below 1e-6 g and of 5 at
1e-3 g. Left out: streams (a tenth of the yearly mean, more on some nights), debris in low orbits, secondary ejecta,
which on the Moon are more than the meteoroids but slow, and the belts of dust and rings at planets.
"""

import math

from sojourn_machine.errors import InvalidValueError

_YEAR = 3.15576e7
SPEED = 20e3
"""Of meteoroids at 1 au against a body [m/s]."""
NEAREST, FARTHEST = 0.3, 4.0
"""Distances from the Sun for which the flux is known [au]."""
_AIR_STOPS = 100.0
"""Surface pressure from which air stops all of 1 g and less [Pa]."""


def interplanetary_flux(mass: float) -> float:
    """Hits in a year on a square metre of one side of a turning plate at 1 au, of this mass or more [g].

    Raises:
        InvalidValueError: a mass out of range.
    """
    if not 1e-18 <= mass <= 1.0:
        raise InvalidValueError("mass of meteoroids", mass, "1e-18 to 1 g")
    largest: float = (2.2e3 * mass**0.306 + 15.0) ** -4.38
    middle: float = 1.3e-9 * (mass + 1e11 * mass**2 + 1e27 * mass**4) ** -0.36
    smallest: float = 1.3e-16 * (mass + 1e6 * mass**2) ** -0.85
    return _YEAR * (largest + middle + smallest)


def focusing(gravitational_parameter: float, distance: float) -> float:
    """By how much a body's gravity raises the flux. GM in m3/s2, distance of its centre in m."""
    return 1.0 + 2.0 * gravitational_parameter / distance / SPEED**2


def open_sky(radius: float, distance: float) -> float:
    """Part of the sky that a body leaves open at a distance of its centre, 1/2 on its surface. Both in m."""
    return 0.5 * (1.0 + math.cos(math.asin(min(radius / distance, 1.0))))


def flux_at(mass: float, gravitational_parameter: float, radius: float, distance: float, sun_au: float) -> float:
    """Hits in a year on a square metre of one side of a turning plate near an airless body.

    Args:
        mass: the least that counts [g]. gravitational_parameter: of the body [m3/s2]. radius: of the body [m].
        distance: from its centre [m]. sun_au: from the Sun [au].

    Raises:
        InvalidValueError: a mass or a distance from the Sun out of range.
    """
    if not NEAREST <= sun_au <= FARTHEST:
        raise InvalidValueError("distance from the Sun", sun_au, f"{NEAREST:g} to {FARTHEST:g} au for meteoroids")
    near_body = focusing(gravitational_parameter, distance) * open_sky(radius, distance)
    thinner: float = sun_au**-1.8
    return interplanetary_flux(mass) * near_body * thinner


def stopped_by_air(surface_pressure: float) -> bool:
    """Whether air of a surface pressure [Pa] lets no meteoroid of 1 g or less to the ground."""
    return surface_pressure > _AIR_STOPS


def chance_of_none(hits: float) -> float:
    """That none comes where so many are expected (Poisson)."""
    return math.exp(-hits)
