"""Radiation on bodies as tabulated dose rates, and what shielding leaves of that of cosmic rays.

Absorbed dose is what parts of a machine wear by, the dose equivalent what is said of people. The rates are of galactic
cosmic rays with what they knock out of the ground, in quiet times of the Sun: a solar particle event may bring as much
in a day as they in a year. Around Jupiter they are of the belts' electrons, which a few mm of metal stop, behind hardly
any.

Shielding: dose under a mass of ground per area, as a share of that at the surface, linear in its logarithm between the
depths for which it was computed from the measurements on Mars (10 cm, 1 m, 2 m, 3 m of ground of 2.8 g/cm3). The first
cm of a shield add to the dose: heavy nuclei break up in it. Range: 0 to 840 g/cm2, the last slope goes on beyond.

Sources: Hassler et al. 2014, Science 343:1244797 (RAD on Mars and its table of depths); Zeitlin et al. 2013, Science
340:1080 (RAD on the way there); Zhang et al. 2020, Science Advances 6:eaaz1334 (LND on the Moon: 13.2 uGy/h and 57.1
uSv/h); Berger et al. 2016, J. Space Weather Space Clim. 6:A39 (space station); UNSCEAR 2000, annex B (Earth at sea
level).
"""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import NamedTuple


class DoseRate(NamedTuple):
    """Of a place in the open."""

    absorbed: float
    """[uGy/day]"""
    equivalent: float
    """[uSv/day]"""
    source: str
    shieldable: bool = True
    """Whether the law of `share_behind` holds for it: it is of cosmic rays."""


_BELT = "as commonly quoted for the unshielded surface, an estimate to a factor of 3"
INTERPLANETARY = DoseRate(481.0, 1840.0, "RAD on the way to Mars, Zeitlin et al. 2013")
DOSE_RATES: Mapping[str, DoseRate] = {
    "mars": DoseRate(210.0, 640.0, "RAD, Hassler et al. 2014"),
    "moon": DoseRate(13.2 * 24.0, 57.1 * 24.0, "LND, Zhang et al. 2020"),
    "earth": DoseRate(0.77, 1.04, "sea level, UNSCEAR 2000"),
    "low_earth_orbit": DoseRate(286.0, 647.0, "inside the space station, Berger et al. 2016"),
    "io": DoseRate(36e6, 36e6, _BELT, shieldable=False),
    "europa": DoseRate(5.4e6, 5.4e6, _BELT, shieldable=False),
    "ganymede": DoseRate(80e3, 80e3, _BELT, shieldable=False),
}
"""By the names of the bodies."""
_SHARES = ((0.0, 232.0), (28.0, 295.0), (280.0, 81.0), (560.0, 15.0), (840.0, 2.9))
"""Mass over the place [g/cm2], dose equivalent [mSv/year]."""
_DENSE_AIR = 2000.0
"""Surface pressure from which air shields so much that the rate of an airless body says nothing [Pa]."""


def dose_rate(body: str, surface_pressure: float) -> DoseRate | None:
    """Of the open surface of a body; None under dense air.

    An airless one that has not been measured has that of the Moon as an estimate. Surface pressure in Pa.
    """
    if body in DOSE_RATES:
        return DOSE_RATES[body]
    if surface_pressure > _DENSE_AIR:
        return None
    return DOSE_RATES["moon"]._replace(source="as on the Moon, an estimate")


def share_behind(mass: float) -> float:
    """Part of the dose of cosmic rays that is left behind a shield of ground of so much mass per area [g/cm2]."""
    for (low, more), (high, less) in pairwise(_SHARES):
        if mass <= high or high == _SHARES[-1][0]:
            share = (mass - low) / (high - low)
            return math.exp((1.0 - share) * math.log(more) + share * math.log(less)) / _SHARES[0][1]
    return 0.0
