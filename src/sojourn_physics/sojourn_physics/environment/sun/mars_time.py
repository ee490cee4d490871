"""The season and the clocks of Mars.

    M = 19.3871 + 0.52402073 d, alpha = 270.3871 + 0.524038496 d          (mean anomaly, fictitious mean Sun [deg])
    nu - M = (10.691 + 3e-7 d) sin M + 0.623 sin 2M + 0.050 sin 3M + 0.005 sin 4M + 0.0005 sin 5M + PBS
    Ls = alpha + nu - M,   EOT = 2.861 sin 2Ls - 0.071 sin 4Ls + 0.002 sin 6Ls - (nu - M)
    MSD = (d - 4.5)/1.0274912517 + 44796.0 - 0.0009626,   MTC = 24 h frac(MSD)

d days of TT since J2000; PBS seven small terms by the pull of other planets. Local mean solar time is MTC + east
longitude / 15, local true solar time that + EOT / 15. r and the Sun's declination are given too.

Source: Allison and McEwen (2000), "A post-Pathfinder evaluation of areocentric solar coordinates", Planet. Space Sci.
48:215-235, eq. 15 to 21, with the constants of Allison's Mars24 algorithm (NASA GISS, 2015). Accuracy of Ls 0.01 deg,
of the clocks a second, 1874 to 2127.
"""

import math
from typing import NamedTuple

from sojourn_physics.environment.sun.instant import Instant

SOL = 88775.244
"""Mean solar day of Mars [s]."""
_PULLS = (
    (0.0071, 2.2353, 49.409),
    (0.0057, 2.7543, 168.173),
    (0.0039, 1.1177, 191.837),
    (0.0037, 15.7866, 21.736),
    (0.0021, 2.1354, 15.704),
    (0.0020, 2.4694, 95.528),
    (0.0018, 32.8493, 49.095),
)
"""Amplitude [deg], period in years of 365.25 d, phase [deg]."""


class MarsTime(NamedTuple):
    """Season and mean time at longitude 0 of Mars."""

    solar_longitude: float
    """Ls, 0 at the northern spring equinox, 0 to 360 [deg]."""
    equation_of_time: float
    """True less mean solar time [deg]."""
    sol_date: float
    """Mars Sol Date: sols since 1873 December 29 about noon [sol]."""
    distance: float
    """From the Sun [au]."""
    declination: float
    """Of the Sun, planetographic [deg]."""

    @property
    def coordinated_time(self) -> float:
        """MTC, mean solar time at longitude 0 [h]."""
        return 24.0 * (self.sol_date % 1.0)

    def true_solar_time(self, longitude_deg: float) -> float:
        """Local true solar time at an east longitude, 0 to 24 [h]; 12 is when the Sun is in the meridian."""
        return (self.coordinated_time + (longitude_deg + self.equation_of_time) / 15.0) % 24.0


def mars_time(at: Instant) -> MarsTime:
    """Season and clocks of Mars."""
    days = at.terrestrial
    mean = math.radians(19.3871 + 0.52402073 * days)
    centre = (10.691 + 3e-7 * days) * math.sin(mean)
    for multiple, amplitude in ((2, 0.623), (3, 0.050), (4, 0.005), (5, 0.0005)):
        centre += amplitude * math.sin(multiple * mean)
    for amplitude, years, phase in _PULLS:
        centre += amplitude * math.cos(math.radians(0.985626 * days / years + phase))
    longitude = (270.3871 + 0.524038496 * days + centre) % 360.0
    season = math.radians(longitude)
    equation = 2.861 * math.sin(2 * season) - 0.071 * math.sin(4 * season) + 0.002 * math.sin(6 * season) - centre
    distance = 1.52367934 * (
        1.00436
        - 0.09309 * math.cos(mean)
        - 0.004336 * math.cos(2 * mean)
        - 0.00031 * math.cos(3 * mean)
        - 0.00003 * math.cos(4 * mean)
    )
    declination = math.degrees(math.asin(0.42565 * math.sin(season))) + 0.25 * math.sin(season)
    return MarsTime(longitude, equation, (days - 4.5) / 1.0274912517 + 44796.0 - 0.0009626, distance, declination)
