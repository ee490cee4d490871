"""Drag of the uppermost air of the Earth on a spacecraft, and how its orbit sinks.

    ln rho                                        linear in altitude between the levels of the table
    a = rho v^2 / (2 B),    dr/dt = -rho sqrt(GM r) / B,    B = m/(C_D A)

The table: Vallado 2013, Fundamentals of Astrodynamics and Applications, table 8-4 (U.S. Standard Atmosphere 1976 and
CIRA-72, mean activity of the Sun). The orbit: King-Hele 1987, Satellite Orbits in an Atmosphere. The air is taken as at
rest against the stars. Range: 150 to 1000 km; the Sun's activity changes the density at 400 km about tenfold.
"""

import math

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.orbit.circular import CircularOrbit

LEVELS = (
    (150e3, 2.070e-9),
    (180e3, 5.464e-10),
    (200e3, 2.789e-10),
    (250e3, 7.248e-11),
    (300e3, 2.418e-11),
    (350e3, 9.518e-12),
    (400e3, 3.725e-12),
    (450e3, 1.585e-12),
    (500e3, 6.967e-13),
    (600e3, 1.454e-13),
    (700e3, 3.614e-14),
    (800e3, 1.170e-14),
    (900e3, 5.245e-15),
    (1000e3, 3.019e-15),
)
"""Altitude [m] and density there [kg/m^3]."""
LOWEST, HIGHEST = LEVELS[0][0], LEVELS[-1][0]


def density(altitude: float) -> float:
    """Of the air over the Earth at an altitude [m]: [kg/m^3].

    Raises:
        InvalidValueError: an altitude that the table does not have.
    """
    if not LOWEST <= altitude <= HIGHEST:
        raise InvalidValueError("altitude", altitude, f"{LOWEST:g} to {HIGHEST:g} m")
    levels, densities = zip(*LEVELS, strict=True)
    return math.exp(float(np.interp(altitude, levels, np.log(densities))))


OXYGEN_SHARE = 0.9
"""Of the mass of the air from 300 to 600 km that is atomic oxygen, mean activity of the Sun [1]."""
OXYGEN_ATOM = 2.6567e-26
"""[kg]"""
KAPTON_YIELD = 3.0e-30
"""Of polyimide that an atom takes away (Banks, Miller, de Groh and Demko 2003, "Atomic oxygen effects on spacecraft
materials", NASA/TM-2003-212484: 3.0e-24 cm3) [m3]."""
OXYGEN_RANGE = (300e3, 600e3)
"""Altitudes for which that is said [m]."""


def atomic_oxygen(orbit: CircularOrbit, air: float) -> float:
    """Atoms that hit a surface square to the flight, in air of a density [kg/m^3]: [1/(m^2 s)]."""
    return OXYGEN_SHARE * air / OXYGEN_ATOM * orbit.speed


def deceleration(orbit: CircularOrbit, air: float, ballistic_coefficient: float) -> float:
    """By drag [m/s^2], in air of a density [kg/m^3]; m/(C_D A) [kg/m^2]."""
    return 0.5 * air * orbit.speed**2 / ballistic_coefficient


def sinking(orbit: CircularOrbit, air: float, ballistic_coefficient: float) -> float:
    """Rate of the orbit's radius, negative [m/s]; arguments as of `deceleration`."""
    return -air * math.sqrt(orbit.gravitational_parameter * orbit.radius) / ballistic_coefficient
