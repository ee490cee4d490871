"""Rocks: how many, of what size, and their stamp on the ground.

Part of the ground covered by rocks of diameter D and more (Golombek & Rapp 1997, J. Geophys. Res. 102:4117,
eq. 1, 2):

    F_k(D) = k exp(-q(k) D),   q(k) = 1.79 + 0.152 / k      (D in metres)

so that the number on a square metre between D and D + dD is k q exp(-q D) 4 / (pi D^2) dD. Height is about
half the diameter (same source, sec. 5). The law was found at the Viking sites; it holds from about 0.1 m to
a few metres, and for the Moon too, with k of 0.005 to 0.02 on plains and up to 0.1 near fresh craters
(Surveyor and Chang'E panoramas).

A rock is half an ellipsoid set on the ground, rigid, with an elliptic outline of aspect up to 1.5 that covers
pi D^2 / 4. Where rocks overlap the higher one counts.
"""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import SoilArray
from sojourn_physics.terrain.params import RockLawParams, RockParams

MAX_ASPECT = 1.5
HEIGHT_SPREAD = 0.3
"""Heights are uniform within this part of the mean, up and down."""

TABLE_SIZE = 4001


@dataclass(frozen=True, slots=True)
class Rock:
    """One rock: centre in map, diameter of the circle of equal area, height [m]; the outline's long axis over
    its short one [-] and the direction of the long one from x [rad]."""

    x: float
    y: float
    diameter: float
    height: float
    aspect: float
    direction: float


def placed_rock(params: RockParams) -> Rock:
    """A round rock placed by hand."""
    return Rock(params.x, params.y, params.diameter, params.height, 1.0, 0.0)


def decay_rate(area_fraction: float) -> float:
    """q(k) of the law [1/m], for k more than 0."""
    return 1.79 + 0.152 / area_fraction


def _cumulative_number(law: RockLawParams) -> tuple[FloatArray, FloatArray]:
    """Diameters [m] and number of rocks on a square metre from diameter_min up to each, by Simpson's rule."""
    diameters = np.geomspace(law.diameter_min, law.diameter_max, TABLE_SIZE)
    rate = decay_rate(law.area_fraction)

    def density(diameter: FloatArray) -> FloatArray:
        covered = law.area_fraction * rate * np.exp(-rate * diameter)
        return np.asarray(covered * 4.0 / (math.pi * diameter * diameter))

    left, right = diameters[:-1], diameters[1:]
    pieces = (right - left) / 6.0 * (density(left) + 4.0 * density(0.5 * (left + right)) + density(right))
    return diameters, np.concatenate(([0.0], np.cumsum(pieces)))


def expected_count(law: RockLawParams, area: float) -> float:
    """Mean number of rocks between the limits of the law on an area [m2]."""
    if law.area_fraction == 0.0:
        return 0.0
    return float(_cumulative_number(law)[1][-1]) * area


def draw_rocks(
    law: RockLawParams, bounds: tuple[float, float, float, float], generator: np.random.Generator
) -> list[Rock]:
    """Random rocks with centres inside bounds (x_min, x_max, y_min, y_max) [m]."""
    if law.area_fraction == 0.0:
        return []
    x_min, x_max, y_min, y_max = bounds
    diameters, cumulative = _cumulative_number(law)
    count = int(generator.poisson(float(cumulative[-1]) * (x_max - x_min) * (y_max - y_min)))
    x = generator.uniform(x_min, x_max, count)
    y = generator.uniform(y_min, y_max, count)
    diameter = np.interp(generator.uniform(0.0, float(cumulative[-1]), count), cumulative, diameters)
    height = law.height_ratio * diameter * generator.uniform(1.0 - HEIGHT_SPREAD, 1.0 + HEIGHT_SPREAD, count)
    aspect = generator.uniform(1.0, MAX_ASPECT, count)
    direction = generator.uniform(0.0, math.pi, count)
    columns = (x, y, diameter, height, aspect, direction)
    return [Rock(*(float(column[i]) for column in columns)) for i in range(count)]


def stamp_rocks(
    heights: FloatArray,
    soil_index: SoilArray,
    rock_soil_index: int,
    origin: tuple[float, float],
    resolution: float,
    rocks: list[Rock],
) -> None:
    """Set the rocks on heights [m] and mark their nodes in soil_index, both of shape (ny, nx), in place."""
    if not rocks:
        return
    rows = [(rock.x, rock.y, rock.diameter, rock.height, rock.aspect, rock.direction) for rock in rocks]
    table = np.array(rows, dtype=np.float64)
    bump = np.zeros_like(heights)
    _stamp(bump, soil_index, rock_soil_index, origin[0], origin[1], resolution, table)
    heights += bump


@njit(cache=True)
def _stamp(
    bump: FloatArray,
    soil_index: SoilArray,
    rock_soil_index: int,
    x0: float,
    y0: float,
    resolution: float,
    rocks: FloatArray,
) -> None:
    rows, columns = bump.shape
    for number in range(rocks.shape[0]):
        x, y, diameter, height, aspect, direction = rocks[number]
        half_long = 0.5 * diameter * math.sqrt(aspect)
        half_short = 0.5 * diameter / math.sqrt(aspect)
        cosine, sine = math.cos(direction), math.sin(direction)
        first_row = max(0, math.ceil((y - half_long - y0) / resolution))
        last_row = min(rows - 1, math.floor((y + half_long - y0) / resolution))
        first_column = max(0, math.ceil((x - half_long - x0) / resolution))
        last_column = min(columns - 1, math.floor((x + half_long - x0) / resolution))
        for row in range(first_row, last_row + 1):
            dy = y0 + row * resolution - y
            for column in range(first_column, last_column + 1):
                dx = x0 + column * resolution - x
                along = (cosine * dx + sine * dy) / half_long
                across = (cosine * dy - sine * dx) / half_short
                squared = along * along + across * across
                if squared < 1.0:
                    bump[row, column] = max(bump[row, column], height * math.sqrt(1.0 - squared))
                    soil_index[row, column] = rock_soil_index
