"""Impact craters: how many, of what shape, and how they wear.

Size and frequency: N(>= D) = N_1 D^-b on a square metre, D in metres. Small lunar craters are in equilibrium,
each new one wiping out old ones, with b = 2 and N_1 = 10^-1.1 = 0.079 (Trask 1966, JPL TR 32-800, p. 252).

Shape of a new crater (Pike 1977, Impact and Explosion Cratering, p. 489: depth 0.196 D and rim 0.036 D for
simple craters; those below 100 m are shallower, 0.12 to 0.17: Stopar et al. 2017, Icarus 298:34),
with rho = r / R:

    h = -d + (d + h_rim) rho^2            inside, rho <= 1
    h = h_rim rho^-3 taper(rho)           ejecta, to 0 at rho = 4 (McGetchin et al. 1973, EPSL 20:226)

Wear: the surface creeps downslope as by diffusion, dh/dt = kappa laplacian h (Soderblom 1970, JGR 75:2655;
Fassett & Thomson 2014, JGR Planets 119:2255), which lowers the rim and fills the bowl. One radial solution
of a crater of unit radius gives all sizes, because only kappa t / R^2 counts. The age of a random crater is
uniform from `age_min` to 1, as on a surface in equilibrium; at 1, kappa t / R^2 = 0.35: a crater that was
0.2 D deep below its rim is 0.035 D deep, about what can still be told from the roughness.

Assumptions: round, simple craters (below about 15 km), added to the ground in order of age, oldest first.
"""

import functools
import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.params import CraterLawParams, CraterParams

REACH = 4.0
"""A crater changes the ground up to this many radii from its centre."""

RIM_OVER_DEPTH = 0.2
"""Rim height over depth of a crater placed by hand without a rim height (0.036 / 0.196, rounded)."""

OLDEST_DIFFUSION = 0.35
"""kappa t / R^2 at age 1."""

RADIAL_CELLS = 200
AGES = 41


@dataclass(frozen=True, slots=True)
class Crater:
    """One crater: centre in map, rim diameter, depth and rim height when new [m], age from 0 to 1 [-]."""

    x: float
    y: float
    diameter: float
    depth: float
    rim_height: float
    age: float


def placed_crater(params: CraterParams) -> Crater:
    """A crater placed by hand."""
    rim_height = RIM_OVER_DEPTH * params.depth if params.rim_height is None else params.rim_height
    return Crater(params.x, params.y, params.diameter, params.depth, rim_height, params.age)


def expected_count(law: CraterLawParams, area: float) -> float:
    """Mean number of craters between the limits of the law on an area [m2]."""
    per_area = law.diameter_min**-law.exponent - law.diameter_max**-law.exponent
    return float(law.density_at_1m * per_area * area)


def draw_craters(
    law: CraterLawParams, bounds: tuple[float, float, float, float], generator: np.random.Generator
) -> list[Crater]:
    """Random craters with centres inside bounds (x_min, x_max, y_min, y_max) [m], oldest first."""
    x_min, x_max, y_min, y_max = bounds
    count = int(generator.poisson(expected_count(law, (x_max - x_min) * (y_max - y_min))))
    x = generator.uniform(x_min, x_max, count)
    y = generator.uniform(y_min, y_max, count)
    # Inverse of the cumulative law cut off at both ends.
    share = generator.uniform(0.0, 1.0, count)
    low, high = law.diameter_min**-law.exponent, law.diameter_max**-law.exponent
    diameter = (low - share * (low - high)) ** (-1.0 / law.exponent)
    age = np.sort(generator.uniform(law.age_min, 1.0, count))[::-1]
    return [
        Crater(
            float(x[i]),
            float(y[i]),
            float(diameter[i]),
            law.fresh_depth_ratio * float(diameter[i]),
            law.rim_ratio * float(diameter[i]),
            float(age[i]),
        )
        for i in range(count)
    ]


def fresh_bowl(rho: FloatArray) -> FloatArray:
    """Bowl of a new crater of depth 1 without a rim, at radii rho in units of the crater's radius."""
    return np.where(rho <= 1.0, rho * rho - 1.0, 0.0)


def fresh_rim(rho: FloatArray) -> FloatArray:
    """Rim and ejecta of a new crater with rim height 1, at radii rho in units of the crater's radius."""
    outside = np.maximum(rho, 1.0)
    taper = np.clip((REACH - outside) / (REACH - 1.0), 0.0, 1.0)
    return np.where(rho <= 1.0, rho * rho, outside**-3.0 * taper * (2.0 - taper))


@functools.cache
def worn_profiles() -> FloatArray:
    """Bowl and rim at AGES ages, at radii from 0 to REACH: shape (2, AGES, RADIAL_CELLS + 1).

    Implicit finite volumes on rings, stable at any step, closed at the axis and held at 0 at the outer edge.
    """
    radius = np.linspace(0.0, REACH, RADIAL_CELLS + 1)
    spacing = REACH / RADIAL_CELLS
    edge = radius[:-1] + 0.5 * spacing
    area = np.empty(RADIAL_CELLS)
    area[0] = 0.5 * edge[0] ** 2
    area[1:] = 0.5 * (edge[1:] ** 2 - edge[:-1] ** 2)
    substeps = 8
    step = OLDEST_DIFFUSION / (AGES - 1) / substeps
    flow = step * edge / spacing
    bands = np.zeros((3, RADIAL_CELLS))
    bands[0, 1:] = -flow[:-1] / area[:-1]
    bands[2, :-1] = -flow[:-1] / area[1:]
    bands[1] = 1.0 + flow / area
    bands[1, 1:] += flow[:-1] / area[1:]
    profiles = np.zeros((2, AGES, RADIAL_CELLS + 1))
    profiles[0, 0], profiles[1, 0] = fresh_bowl(radius), fresh_rim(radius)
    profiles[:, 0, -1] = 0.0
    for age in range(1, AGES):
        current = profiles[:, age - 1, :-1].T
        for _ in range(substeps):
            current = solve_banded((1, 1), bands, current)
        profiles[:, age, :-1] = current.T
    profiles.setflags(write=False)
    return profiles


def profile(age: float) -> FloatArray:
    """Bowl of unit depth and rim of unit height at an age from 0 to 1: shape (2, RADIAL_CELLS + 1)."""
    table = worn_profiles()
    position = min(max(age, 0.0), 1.0) * (AGES - 1)
    index = min(int(position), AGES - 2)
    share = position - index
    return np.asarray((1.0 - share) * table[:, index] + share * table[:, index + 1])


def stamp_craters(heights: FloatArray, origin: tuple[float, float], resolution: float, craters: list[Crater]) -> None:
    """Add the craters to heights, shape (ny, nx) [m], in place, in the order given."""
    for crater in craters:
        bowl, rim = profile(crater.age)
        radial = np.ascontiguousarray(crater.depth * bowl + crater.rim_height * rim)
        _stamp(heights, origin[0], origin[1], resolution, crater.x, crater.y, 0.5 * crater.diameter, radial)


@njit(cache=True)
def _stamp(
    heights: FloatArray,
    x0: float,
    y0: float,
    resolution: float,
    x: float,
    y: float,
    radius: float,
    radial: FloatArray,
) -> None:
    rows, columns = heights.shape
    reach = REACH * radius
    cells_per_metre = (radial.shape[0] - 1) / reach
    first_row = max(0, math.ceil((y - reach - y0) / resolution))
    last_row = min(rows - 1, math.floor((y + reach - y0) / resolution))
    first_column = max(0, math.ceil((x - reach - x0) / resolution))
    last_column = min(columns - 1, math.floor((x + reach - x0) / resolution))
    for row in range(first_row, last_row + 1):
        dy = y0 + row * resolution - y
        for column in range(first_column, last_column + 1):
            dx = x0 + column * resolution - x
            position = math.sqrt(dx * dx + dy * dy) * cells_per_metre
            index = int(position)
            if index < radial.shape[0] - 1:
                share = position - index
                heights[row, column] += (1.0 - share) * radial[index] + share * radial[index + 1]
