"""Poles and prime meridians of planets, dwarf planets and small bodies; see `orientation` for what they mean.

Sources: Archinal et al. (2018), tables 1 and 3, of Mars and Mercury the largest of the oscillations. Earth: precession
of Lieske et al. (1977) and Greenwich mean sidereal time of 1982 (Meeus 1998, ch. 12), in days of UT; nutation, 0.005
deg, is left out. Patroclus and Arrokoth: pole and period alone are known (Mueller et al. 2010, Icarus 205:505; Spencer
et al. 2020, Science 367:eaay3999): where longitude 0 is, is a choice here. Poles of giant planets are those of their
magnetic fields' rotation (System III).
"""

from sojourn_physics.environment.sun.instant import CENTURY
from sojourn_physics.environment.sun.orientation import Angle, BodyAxes

_NEPTUNE = (357.85, 52.316 / CENTURY)


def _steady(right_ascension: float, declination: float, meridian: float, per_day: float) -> BodyAxes:
    """A pole that does not move."""
    return BodyAxes(Angle(right_ascension), Angle(declination), Angle(meridian, per_day))


EARTH = BodyAxes(
    Angle(0.0, -0.640616 / CENTURY),
    Angle(90.0, -0.556753 / CENTURY),
    Angle(280.46061837 - 90.0, 360.98564736629 - 0.640616 / CENTURY),
)
"""In days of universal time."""

PLANETS = {
    "mercury": BodyAxes(
        Angle(281.0103, -0.0328 / CENTURY),
        Angle(61.4155, -0.0049 / CENTURY),
        Angle(329.5988, 6.1385108, ((0.01067257, (174.7910857, 4.092335)), (-0.00112309, (349.5821714, 8.184670)))),
    ),
    "venus": _steady(272.76, 67.16, 160.20, -1.4813688),
    "mars": BodyAxes(
        Angle(317.269202, -0.10927547 / CENTURY, ((0.419057, (79.398797, 0.5042615 / CENTURY)),)),
        Angle(54.432516, -0.05827105 / CENTURY, ((1.591274, (166.325722, 0.5042615 / CENTURY)),)),
        Angle(176.049863, 350.891982443297, ((0.584542, (95.391654, 0.5042615 / CENTURY)),)),
    ),
    "jupiter": BodyAxes(
        Angle(268.056595, -0.006499 / CENTURY), Angle(64.495303, 0.002413 / CENTURY), Angle(284.95, 870.5360000)
    ),
    "saturn": BodyAxes(Angle(40.589, -0.036 / CENTURY), Angle(83.537, -0.004 / CENTURY), Angle(38.90, 810.7939024)),
    "uranus": _steady(257.311, -15.175, 203.81, -501.1600928),
    "neptune": BodyAxes(
        Angle(299.36, 0.0, ((0.70, _NEPTUNE),)),
        Angle(43.46, 0.0, ((-0.51, _NEPTUNE),)),
        Angle(249.978, 541.1397757, ((-0.48, _NEPTUNE),)),
    ),
    "pluto": _steady(132.993, -6.163, 302.695, 56.3625225),
}
"""By the names of the bodies; but for the Earth."""

SMALL_BODIES = {
    "ceres": _steady(291.418, 66.764, 170.650, 952.1532),
    "vesta": _steady(309.031, 42.235, 285.39, 1617.3329428),
    "eros": _steady(11.35, 17.22, 326.07, 1639.38864745),
    "itokawa": _steady(90.53, -66.30, 0.0, 712.143),
    "churyumov_gerasimenko": _steady(69.54, 64.11, 114.69, 696.543884683),
    "patroclus": _steady(134.2, -78.3, 0.0, 360.0 * 24.0 / 102.8),
    "arrokoth": _steady(317.4873, -24.8876, 0.0, 360.0 * 24.0 / 15.9380),
}
"""By the names of the bodies."""
