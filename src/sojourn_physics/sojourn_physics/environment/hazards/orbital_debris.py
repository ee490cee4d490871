"""Debris in low Earth orbit: how many pieces of a size or more hit an area.

    F = H(d) phi(h, S) psi(i) [F1(d) g1(t) + F2(d) g2(t)]

    H = 10^(e^(-((lg d - 0.78)/0.637)^2) / 2)      phi = f/(f + 1),  f = 10^(h/200 - S/140 - 1.5)
    F1 = 1.22e-5 d^-2.5,  g1 = 1.02^(t - 1988)     F2 = 8.1e10 (d + 700)^-6,  g2 = 1 + 0.05 (t - 1988)

hits in a year on a square metre of a randomly turned plate; d in cm, h in km, S the solar flux at 10.7 cm of the year
before. psi goes up with the inclination, by the table of the source, here to 52 degrees (Kessler, Reynolds and
Anz-Meador 1989, "Orbital debris environment for spacecraft designed to operate in low Earth orbit", NASA TM-100471).

Range: to 2000 km, 0.1 mm to 5 m, inclinations from 28.5 to 52 degrees, years from 1988 to 2010: what was measured until
1988, and its growth as it was foreseen. It knows of neither the break-ups of 2007 and 2009 nor the fleets since: ORDEM
and MASTER do, which are programs.
"""

import math

import numpy as np

from sojourn_machine.errors import InvalidValueError

INCLINATIONS = ((28.5, 0.9135), (30.0, 0.920), (35.0, 0.940), (40.0, 0.960), (45.0, 0.990), (52.0, 1.030))
"""[deg] and psi."""
UNCHECKED_BELOW = 45.0
"""Factors of smaller inclinations [deg] were not held against the report itself."""
MEAN_SOLAR_FLUX = 130.0
"""Of a cycle, at 10.7 cm [1e-22 W/(m2 Hz)]."""
LAST_YEAR = 2010.0
SIZES = (1e-4, 5.0)
"""Range of diameters [m]."""


def known_for(altitude: float, inclination: float) -> bool:
    """Whether the figures hold at an altitude [m] and an inclination [deg]."""
    return 0.0 < altitude <= 2000e3 and INCLINATIONS[0][0] <= inclination <= INCLINATIONS[-1][0]


def debris_flux(diameter: float, altitude: float, inclination: float, year: float = LAST_YEAR) -> float:
    """Hits in a year on a square metre of a turning plate, of this diameter or more [m].

    Args:
        altitude: [m]. inclination: [deg]. year: as 2005.0.

    Raises:
        InvalidValueError: out of range.
    """
    if not SIZES[0] <= diameter <= SIZES[1]:
        raise InvalidValueError("diameter of debris", diameter, f"{SIZES[0]:g} to {SIZES[1]:g} m")
    if not known_for(altitude, inclination):
        allowed = "up to 2000 km and 28.5 to 52 deg"
        raise InvalidValueError("altitude and inclination", (altitude, inclination), allowed)
    if not 1988.0 <= year <= LAST_YEAR:
        raise InvalidValueError("year", year, f"1988 to {LAST_YEAR:g}")
    d = 100.0 * diameter
    shape: float = 10.0 ** (0.5 * math.exp(-(((math.log10(d) - 0.78) / 0.637) ** 2)))
    height: float = 10.0 ** (altitude / 200e3 - MEAN_SOLAR_FLUX / 140.0 - 1.5)
    angles, factors = zip(*INCLINATIONS, strict=True)
    turned = float(np.interp(inclination, angles, factors))
    small = 1.22e-5 * d**-2.5 * 1.02 ** (year - 1988.0)
    large = 8.1e10 * (d + 700.0) ** -6 * (1.0 + 0.05 * (year - 1988.0))
    found: float = shape * height / (height + 1.0) * turned * (small + large)
    return found
