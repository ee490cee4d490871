"""Moons: which planet each goes about, how far from it, and how it is turned.

Each keeps one face to its planet. Its prime meridian, which landmarks define, is some degrees off the middle of that
face: the planet stands over latitude 0 and the longitude

    l = l_0 + sum A sin theta_i

which swings as the moon's orbit is not round (2 e sin M, on Phobos with the swing of the body itself, which is against
it). l_0 and the A are fits to the theory of Lainey, Duriez and Vienne (2004, Astron. Astrophys. 420:1171, in Astronomy
Engine 2.1.19) for the moons of Jupiter, 1975 to 2055, within 0.13 deg, with arguments of Lieske (1998, Astron.
Astrophys. Suppl. 129:205); those of Saturn's are of the mean elements of JPL Solar System Dynamics and of Meeus (1998),
ch. 46, to some 0.3 deg, swings of less than 1 deg left out. Of the other moons l is taken to be 0: not known here, and
on Iapetus more than 10 deg off. The Moon's own motion is `lunar_orbit`.

Phobos comes nearer to Mars: its longitude gains 12.7 deg T^2 (T centuries since J2000), 0.8 deg in 25 years; that the
angle M5 of its swing does so too is left out (0.06 deg in 2050).

Sources: orientation: Archinal et al. (2018), table 2, of Phobos with its erratum of 2019; distances: JPL Solar System
Dynamics, "Planetary Satellite Mean Elements". Radii of planets: Archinal et al. (2018), table 4 (mean).
"""

from typing import NamedTuple

from sojourn_physics.environment.sun.instant import CENTURY
from sojourn_physics.environment.sun.orientation import Angle, BodyAxes


class Moon(NamedTuple):
    """A moon that keeps one face to its planet, but for a swing."""

    planet: str
    distance: float
    """Semi-major axis of its orbit [m]."""
    orientation: BodyAxes
    planet_longitude: Angle = Angle(0.0)
    """East longitude over which the planet stands."""


RADII = {
    "earth": 6371.01e3,
    "mars": 3389.50e3,
    "jupiter": 69911e3,
    "saturn": 58232e3,
    "uranus": 25362e3,
    "neptune": 24622e3,
}
"""Mean radii of the planets that have moons here [m]."""

_E1, _E2, _E3 = (125.045, -0.0529921), (250.089, -0.1059842), (260.008, 13.0120009)
_E4, _E5, _E6 = (176.625, 13.3407154), (357.529, 0.9856003), (311.589, 26.4057084)
_E7, _E8, _E9 = (134.963, 13.0649930), (276.617, 0.3287146), (34.226, 1.7484877)
_E10, _E11, _E12 = (15.134, -0.1589763), (119.743, 0.0036096), (239.961, 0.1643573)
_E13 = (25.053, 12.9590088)
MOON = BodyAxes(
    Angle(
        269.9949,
        0.0031 / CENTURY,
        (
            *((-3.8787, _E1), (-0.1204, _E2), (0.0700, _E3), (-0.0172, _E4)),
            *((0.0072, _E6), (-0.0052, _E10), (0.0043, _E13)),
        ),
    ),
    Angle(
        66.5392,
        0.0130 / CENTURY,
        (
            *((1.5419, _E1), (0.0239, _E2), (-0.0278, _E3), (0.0068, _E4)),
            *((-0.0029, _E6), (0.0009, _E7), (0.0008, _E10), (-0.0009, _E13)),
        ),
    ),
    Angle(
        38.3213,
        13.17635815,
        (
            *((3.5610, _E1), (0.1208, _E2), (-0.0642, _E3), (0.0158, _E4), (0.0252, _E5), (-0.0066, _E6)),
            *((-0.0047, _E7), (-0.0046, _E8), (0.0028, _E9), (0.0052, _E10), (0.0040, _E11), (0.0019, _E12)),
            (-0.0044, _E13),
        ),
    ),
)
"""The Earth's Moon, in the axes of its mean Earth direction and pole."""


def _of_century(start: float, rate: float) -> tuple[float, float]:
    return start, rate / CENTURY


_J3, _J4, _J5 = _of_century(283.90, 4850.7), _of_century(355.80, 1191.3), _of_century(119.90, 262.1)
_J6, _J7, _J8 = _of_century(229.80, 64.3), _of_century(352.25, 2382.6), _of_century(113.35, 6070.0)
_S3, _S5, _S6 = _of_century(177.40, -36505.5), _of_century(316.45, 506.2), _of_century(345.20, -1016.3)
_U11, _U12, _U13 = _of_century(102.23, -2024.22), _of_century(316.41, 2863.96), _of_century(304.01, -51.94)
_U14, _U15, _U16 = _of_century(308.71, -93.17), _of_century(340.82, -75.32), _of_century(259.14, -504.81)
_M1, _M2 = _of_century(190.72646643, 15917.10818695), _of_century(21.46892470, 31834.27934054)
_M3, _M4 = _of_century(332.86082793, 19139.89694742), _of_century(394.93256437, 38280.79631835)
_M5 = _of_century(189.63271560, 41215158.18420050)


def _twice(angle: tuple[float, float], times: int = 2) -> tuple[float, float]:
    return times * angle[0], times * angle[1]


def _n7(*amplitudes: float) -> tuple[tuple[float, tuple[float, float]], ...]:
    """Of N7 and its multiples, which is where Triton's orbit is in its precession."""
    return tuple(
        (amplitude, _twice(_of_century(177.85, 52.316), times)) for times, amplitude in enumerate(amplitudes, 1)
    )


MOONS = {
    "phobos": Moon(
        "mars",
        9.376e6,
        BodyAxes(
            Angle(
                317.67071657,
                -0.10844326 / CENTURY,
                ((-1.78428399, _M1), (0.02212824, _M2), (-0.01028251, _M3), (-0.00475595, _M4)),
            ),
            Angle(
                52.88627266,
                -0.06134706 / CENTURY,
                ((-1.07516537, _M1), (0.00668626, _M2), (-0.00648740, _M3), (0.00281576, _M4)),
            ),
            Angle(
                35.18774440,
                1128.84475928,
                (
                    *((1.42421769, _M1), (-0.02273783, _M2), (0.00410711, _M3), (0.00631964, _M4)),
                    (-1.143, _M5),
                ),
                12.72192797 / CENTURY**2,
            ),
        ),
        Angle(0.0, 0.0, ((2.873, _M5),)),  # 1.73 of the orbit, e 0.0151, and 1.143 of the body
    ),
    "io": Moon(
        "jupiter",
        421.8e6,
        BodyAxes(
            Angle(268.05, -0.009 / CENTURY, ((0.094, _J3), (0.024, _J4))),
            Angle(64.50, 0.003 / CENTURY, ((0.040, _J3), (0.011, _J4))),
            Angle(200.39, 203.4889538, ((-0.085, _J3), (-0.022, _J4))),
        ),
        Angle(-0.421, 0.0, ((0.475, (330.786, 204.2284621)),)),
    ),
    "europa": Moon(
        "jupiter",
        671.1e6,
        BodyAxes(
            Angle(268.08, -0.009 / CENTURY, ((1.086, _J4), (0.060, _J5), (0.015, _J6), (0.009, _J7))),
            Angle(64.51, 0.003 / CENTURY, ((0.468, _J4), (0.026, _J5), (0.007, _J6), (0.002, _J7))),
            Angle(36.022, 101.3747235, ((-0.980, _J4), (-0.054, _J5), (-0.014, _J6), (-0.008, _J7))),
        ),
        Angle(-1.532, 0.0, ((1.066, (345.393, 102.1142311)),)),
    ),
    "ganymede": Moon(
        "jupiter",
        1070.4e6,
        BodyAxes(
            Angle(268.20, -0.009 / CENTURY, ((-0.037, _J4), (0.431, _J5), (0.091, _J6))),
            Angle(64.57, 0.003 / CENTURY, ((-0.016, _J4), (0.186, _J5), (0.039, _J6))),
            Angle(44.064, 50.3176081, ((0.033, _J4), (-0.389, _J5), (-0.082, _J6))),
        ),
        Angle(
            -2.408,
            0.0,
            ((0.161, (330.287, 50.3104819)), (0.098, (228.362, 50.3157692)), (-0.069, (352.696, 51.0571155))),
        ),
    ),
    "callisto": Moon(
        "jupiter",
        1882.7e6,
        BodyAxes(
            Angle(268.72, -0.009 / CENTURY, ((-0.068, _J5), (0.590, _J6), (0.010, _J8))),
            Angle(64.83, 0.003 / CENTURY, ((-0.029, _J5), (0.254, _J6), (-0.004, _J8))),
            Angle(259.51, 21.5710715, ((0.061, _J5), (-0.533, _J6), (-0.009, _J8))),
        ),
        Angle(0.877, 0.0, ((0.841, (87.454, 21.5692312)),)),
    ),
    "enceladus": Moon(
        "saturn",
        238.0e6,
        BodyAxes(Angle(40.66, -0.036 / CENTURY), Angle(83.52, -0.004 / CENTURY), Angle(6.32, 262.7318996)),
        Angle(-4.05),
    ),
    "tethys": Moon(
        "saturn",
        294.7e6,
        BodyAxes(
            Angle(40.66, -0.036 / CENTURY, ((9.66, _S3),)),
            Angle(83.52, -0.004 / CENTURY, ((-1.09, _S3),)),
            Angle(8.95, 190.6979085, ((-9.60, _S3), (2.23, _S5))),
        ),
    ),
    "dione": Moon(
        "saturn",
        377.4e6,
        BodyAxes(Angle(40.66, -0.036 / CENTURY), Angle(83.52, -0.004 / CENTURY), Angle(357.6, 131.5349316)),
        Angle(-0.64),
    ),
    "rhea": Moon(
        "saturn",
        527.1e6,
        BodyAxes(
            Angle(40.38, -0.036 / CENTURY, ((3.10, _S6),)),
            Angle(83.55, -0.004 / CENTURY, ((-0.35, _S6),)),
            Angle(235.16, 79.6900478, ((-3.08, _S6),)),
        ),
        Angle(-2.75),
    ),
    "titan": Moon(
        "saturn",
        1221.9e6,
        BodyAxes(Angle(39.4827), Angle(83.4279), Angle(186.5855, 22.5769768)),
        Angle(2.11, 0.0, ((3.30, (163.54, 22.5755773)),)),
    ),
    "iapetus": Moon(
        "saturn",
        3560.8e6,
        BodyAxes(Angle(318.16, -3.949 / CENTURY), Angle(75.03, -1.143 / CENTURY), Angle(355.2, 4.5379572)),
    ),
    "miranda": Moon(
        "uranus",
        129.8e6,
        BodyAxes(
            Angle(257.43, 0.0, ((4.41, _U11), (-0.04, _twice(_U11)))),
            Angle(-15.08, 0.0, ((4.25, _U11), (-0.02, _twice(_U11)))),
            Angle(
                30.70,
                -254.6906892,
                ((-1.27, _U12), (0.15, _twice(_U12)), (1.15, _U11), (-0.09, _twice(_U11))),
            ),
        ),
    ),
    "ariel": Moon(
        "uranus",
        190.9e6,
        BodyAxes(
            Angle(257.43, 0.0, ((0.29, _U13),)),
            Angle(-15.10, 0.0, ((0.28, _U13),)),
            Angle(156.22, -142.8356681, ((0.05, _U12), (0.08, _U13))),
        ),
    ),
    "umbriel": Moon(
        "uranus",
        266.0e6,
        BodyAxes(
            Angle(257.43, 0.0, ((0.21, _U14),)),
            Angle(-15.10, 0.0, ((0.20, _U14),)),
            Angle(108.05, -86.8688923, ((-0.09, _U12), (0.06, _U14))),
        ),
    ),
    "titania": Moon(
        "uranus",
        436.3e6,
        BodyAxes(
            Angle(257.43, 0.0, ((0.29, _U15),)),
            Angle(-15.10, 0.0, ((0.28, _U15),)),
            Angle(77.74, -41.3514316, ((0.08, _U15),)),
        ),
    ),
    "oberon": Moon(
        "uranus",
        583.5e6,
        BodyAxes(
            Angle(257.43, 0.0, ((0.16, _U16),)),
            Angle(-15.10, 0.0, ((0.16, _U16),)),
            Angle(6.77, -26.7394932, ((0.04, _U16),)),
        ),
    ),
    "triton": Moon(
        "neptune",
        354.8e6,
        BodyAxes(
            Angle(299.36, 0.0, _n7(-32.35, -6.28, -2.08, -0.74, -0.28, -0.11, -0.07, -0.02, -0.01)),
            Angle(41.17, 0.0, _n7(22.55, 2.10, 0.55, 0.16, 0.05, 0.02, 0.01)),
            Angle(296.53, -61.2572637, _n7(22.25, 6.73, 2.05, 0.74, 0.28, 0.11, 0.05, 0.02, 0.01)),
        ),
    ),
}
"""By the names of the bodies; but for the Earth's Moon."""
