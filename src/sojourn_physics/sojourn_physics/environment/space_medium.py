"""What there is between the planets, and between the stars, for a machine on a spacecraft: mean figures.

Solar wind: speed 400 km/s, 7 protons per cm3 at 1 astronomical unit, thinning with the square of the distance; the
Sun's magnetic field is wound into a spiral by the rotation of the Sun, 25.38 days (Parker 1958, "Dynamics of the
interplanetary gas and magnetic fields", Astrophys. J. 128:664), 5 nT in all at 1 astronomical unit (Kivelson and
Russell 1995, "Introduction to Space Physics", tables 4.1 and 4.2). Its pressure on a plate is m n v^2, that of light 2
S/c on a mirror. Cosmic rays: 1.84 mSv a day behind the walls of a spacecraft on its way to Mars, solar minimum to mean
(Zeitlin et al. 2013, Science 340:1080); less inwards and more outwards by some per cent an astronomical unit, which is
left out. Beyond the heliopause, 121.6 astronomical units where Voyager 1 passed it (Gurnett et al. 2013, Science
341:1489): a plasma of 0.08 electrons per cm3; neutral hydrogen 0.2 per cm3 and 6 300 K, that the Sun goes through at 26
km/s (Frisch, Redfield and Slavin 2011, Annu. Rev. Astron. Astrophys. 49:237), 0.5 nT (Burlaga and Ness 2014, Astrophys.
J. 784:146). A grey ball takes in the light of the Sun with its section and the cosmic microwave background, 2.72548 K,
with all of its surface (Fixsen 2009, "The temperature of the cosmic microwave background", Astrophys. J. 707:916).
Range: 0.1 astronomical units on; all of it changes with the Sun's activity by factors.
"""

import math
from typing import NamedTuple

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.thermal.thermal_kernels import STEFAN_BOLTZMANN
from sojourn_physics.environment.body import SOLAR_FLUX_AT_1_AU
from sojourn_physics.environment.sun.orbits import ASTRONOMICAL_UNIT

HELIOPAUSE = 121.6
"""[AU]"""
COSMIC_BACKGROUND = 2.72548
"""Temperature of the radiation that comes from everywhere [K]."""
NEAREST = 0.1
LIGHT_SPEED = 299_792_458.0
PROTON = 1.67262e-27
"""[kg]"""
WIND_SPEED = 400e3
"""[m/s]"""
WIND_AT_1_AU = 7e6
"""[1/m3]"""
FIELD_AT_1_AU = 5e-9
"""[T]"""
TURN_OF_THE_SUN = 25.38 * 86400.0
"""Sidereal [s]."""
DOSE_A_DAY = 1.84e-3
"""Dose equivalent behind a spacecraft's walls [Sv/d]."""


class SpaceMedium(NamedTuple):
    """At a distance from the Sun."""

    light: float
    """[W/m2]"""
    light_pressure: float
    """On a mirror square to it [Pa]."""
    grey_temperature: float
    """Of a grey ball that sunlight and the cosmic background warm [K]."""
    particles: float
    """Protons of the wind, or hydrogen between the stars [1/m3]."""
    speed: float
    """Of them past a machine at rest to the Sun [m/s]."""
    wind_pressure: float
    """Of them [Pa]."""
    magnetic_field: float
    """[T]"""
    spiral: float
    """Angle of the field to the direction from the Sun [rad]; 0 between the stars."""


def spiral_at(distance: float) -> float:
    """Angle of Parker's spiral to the direction from the Sun, at a distance [AU]: [rad]."""
    turning = 2.0 * math.pi / TURN_OF_THE_SUN
    return math.atan(turning * distance * ASTRONOMICAL_UNIT / WIND_SPEED)


def medium_at(distance: float) -> SpaceMedium:
    """At a distance from the Sun [AU].

    Raises:
        InvalidValueError: nearer than the range, or no number.
    """
    if not (math.isfinite(distance) and distance >= NEAREST):
        raise InvalidValueError("distance from the Sun [AU]", distance, f"a finite number, at least {NEAREST:g}")
    light = SOLAR_FLUX_AT_1_AU / distance**2
    particles, speed, spiral = WIND_AT_1_AU / distance**2, WIND_SPEED, spiral_at(distance)
    # along the Sun's direction the field thins as the wind, across it as one over the distance
    along = FIELD_AT_1_AU * math.cos(spiral_at(1.0)) / distance**2
    field = along / math.cos(spiral)
    if distance > HELIOPAUSE:
        particles, speed, field, spiral = 0.2e6, 26e3, 0.5e-9, 0.0
    return SpaceMedium(
        light=light,
        light_pressure=2.0 * light / LIGHT_SPEED,
        grey_temperature=(0.25 * light / STEFAN_BOLTZMANN + COSMIC_BACKGROUND**4) ** 0.25,
        particles=particles,
        speed=speed,
        wind_pressure=PROTON * particles * speed**2,
        magnetic_field=field,
        spiral=spiral,
    )
