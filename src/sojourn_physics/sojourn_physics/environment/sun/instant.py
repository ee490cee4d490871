"""Moments of time: from Coordinated Universal Time to the even time of the ephemerides.

    TT = UTC + 32.184 s + (TAI - UTC)

Terrestrial Time TT runs evenly; the motion of all bodies is a function of it (it differs from the time of the solar
system's centre, TDB, by less than 2 ms). TAI - UTC grew by leap seconds to 37 s in 2017; later ones are not known, and
a second turns Mars by 0.004 deg. The turning Earth is a function of UT1, which UTC follows within 0.9 s (0.004 deg).
Before leap seconds began, in 1972, UTC was kept near UT1 by small steps and rates: TT - UT1 is taken for the
difference, linear between the years of a table, right within 0.2 s.

Source: IERS Bulletin C (leap seconds); Seidelmann and Urban (2013), Explanatory Supplement to the Astronomical Almanac,
ch. 3, and The Astronomical Almanac, p. K9 (TT - UT1). Range: 1958, when atomic time began, to 2100.
"""

from bisect import bisect_right
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError

DAY = 86400.0
"""[s]"""
CENTURY = 36525.0
"""Julian century [d]."""
J2000 = 51544.5
"""2000 January 1, 12 h, as a Modified Julian Date [d]."""
_UNIX = 40587.0
"""1970 January 1, 0 h [d]."""
_LAST = 88069.0
"""2100 January 1 [d]."""
_BEFORE_LEAPS = ((36204.0, 37665.0, 38761.0, 40587.0, 41317.0), (32.18, 34.0, 35.73, 40.18, 42.184))
"""TT - UT1 in January of 1958, 1962, 1965, 1970 and 1972 [d], [s]."""
_TAI_AHEAD_IN_1972 = 10
_LEAPS = (
    *(41499, 41683, 42048, 42413, 42778, 43144, 43509, 43874, 44239, 44786, 45151, 45516, 46247, 47161),
    *(47892, 48257, 48804, 49169, 49534, 50083, 50630, 51179, 53736, 54832, 56109, 57204, 57754),
)
"""Modified Julian Dates before which a leap second was put in, of 1972 July 1 to 2017 January 1 [d]."""


class Instant(NamedTuple):
    """A moment, on the two scales that bodies move by. Days since 2000 January 1, 12 h of the scale [d]."""

    terrestrial: float
    """TT, for orbits and for the rotation of all bodies but the Earth."""
    universal: float
    """UTC, for the rotation of the Earth."""

    def after(self, seconds: float) -> "Instant":
        """The moment `seconds` [s] later."""
        days = seconds / DAY
        return Instant(self.terrestrial + days, self.universal + days)


def instant(unix_time: float) -> Instant:
    """The moment of a date.

    Args:
        unix_time: UTC in seconds since 1970 January 1, 0 h, days of 86400 s each [s]: `datetime.timestamp()`.

    Raises:
        InvalidValueError: out of range.
    """
    date = unix_time / DAY + _UNIX
    (first, *_, leaps_begin), ahead_then = _BEFORE_LEAPS
    if not first <= date < _LAST:
        raise InvalidValueError("time", date, f"{first:g} to {_LAST:g} (modified Julian date), the years 1958 to 2099")
    if date < leaps_begin:
        ahead = float(np.interp(date, _BEFORE_LEAPS[0], ahead_then))
    else:
        ahead = 32.184 + _TAI_AHEAD_IN_1972 + bisect_right(_LEAPS, date)
    universal = date - J2000
    return Instant(universal + ahead / DAY, universal)
