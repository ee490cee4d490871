"""Makes the ground of a scenario from its parameters and a seed.

Order: plane or step, roughness, craters (oldest first, those placed by hand last), rocks. Each part draws
from its own stream of the seed, so that a change of one leaves the others as they are. The same parameters
and seed give the identical arrays on one machine and one version of numpy and scipy.
"""

import math

import numpy as np

from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.terrain.craters import Crater, draw_craters, placed_crater, stamp_craters
from sojourn_mechanics.terrain.height_field import HeightField
from sojourn_mechanics.terrain.params import KeepClearParams, TerrainParams
from sojourn_mechanics.terrain.rocks import Rock, draw_rocks, placed_rock, stamp_rocks
from sojourn_mechanics.terrain.roughness import rough_surface

CRATER_MARGIN = 1.5
"""A random crater with its rim and near ejecta, this many radii, stays out of a clear circle."""

ROCK_MARGIN = 0.5 * math.sqrt(1.5)
"""Half the longest outline of a random rock over its diameter."""


def generate(params: TerrainParams, soil: str, rock_soil: str, seed: int) -> HeightField:
    """The ground of a scenario.

    Args:
        params: what it is like.
        soil: name of the soil, index 0 of the height field.
        rock_soil: name of the soil of rocks, index 1. If it is the same as `soil` there is one index only.
        seed: 0 or more; the random parts follow from it.

    Raises:
        InvalidValueError: a negative seed, an empty name.
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InvalidValueError("seed", seed, "an integer, at least 0")
    for name, value in (("soil", soil), ("rock_soil", rock_soil)):
        if not value:
            raise InvalidValueError(name, value, "the name of a soil")
    streams = np.random.SeedSequence(seed).spawn(3)
    roughness_stream, crater_stream, rock_stream = (np.random.default_rng(stream) for stream in streams)
    shape = params.node_counts
    origin = params.origin
    bounds = (
        origin[0],
        origin[0] + (shape[1] - 1) * params.resolution,
        origin[1],
        origin[1] + (shape[0] - 1) * params.resolution,
    )

    heights = _base(params)
    if params.roughness is not None:
        heights += rough_surface(params.roughness, shape, params.resolution, roughness_stream)

    craters: list[Crater] = []
    if params.crater_law is not None:
        drawn_craters = draw_craters(params.crater_law, bounds, crater_stream)
        craters = [crater for crater in drawn_craters if _crater_is_clear(crater, params.keep_clear)]
    craters += [placed_crater(crater) for crater in params.craters]
    stamp_craters(heights, origin, params.resolution, craters)

    rocks: list[Rock] = []
    if params.rock_law is not None:
        drawn_rocks = draw_rocks(params.rock_law, bounds, rock_stream)
        rocks = [rock for rock in drawn_rocks if _rock_is_clear(rock, params.keep_clear)]
    rocks += [placed_rock(rock) for rock in params.rocks]
    soil_names = (soil,) if soil == rock_soil else (soil, rock_soil)
    soil_index = np.zeros(shape, dtype=np.int64)
    stamp_rocks(heights, soil_index, len(soil_names) - 1, origin, params.resolution, rocks)

    return HeightField(
        heights=heights,
        soil_index=soil_index,
        resolution=params.resolution,
        origin_x=origin[0],
        origin_y=origin[1],
        soil_names=soil_names,
    )


def _base(params: TerrainParams) -> FloatArray:
    """Plane or step that everything else is set on: shape (ny, nx) [m]."""
    rows, columns = params.node_counts
    origin_x, origin_y = params.origin
    x = origin_x + params.resolution * np.arange(columns, dtype=np.float64)[np.newaxis, :]
    y = origin_y + params.resolution * np.arange(rows, dtype=np.float64)[:, np.newaxis]
    steepness = math.tan(math.radians(params.slope_deg))
    direction = math.radians(params.slope_direction_deg)
    heights = steepness * (math.cos(direction) * x + math.sin(direction) * y)
    if params.kind == "step":
        # A rounding error of a node's position must not move the edge by a cell.
        tolerance = 1e-6 * params.resolution
        raised = x >= params.step_x - tolerance
        if params.step_y is not None:
            raised = raised & (y >= params.step_y - tolerance)
        heights = heights + np.where(raised, params.step_height, 0.0)
    return np.ascontiguousarray(heights, dtype=np.float64)


def _crater_is_clear(crater: Crater, keep_clear: tuple[KeepClearParams, ...]) -> bool:
    reach = CRATER_MARGIN * 0.5 * crater.diameter
    return all(math.hypot(crater.x - c.x, crater.y - c.y) >= c.radius + reach for c in keep_clear)


def _rock_is_clear(rock: Rock, keep_clear: tuple[KeepClearParams, ...]) -> bool:
    reach = ROCK_MARGIN * rock.diameter
    return all(math.hypot(rock.x - c.x, rock.y - c.y) >= c.radius + reach for c in keep_clear)
