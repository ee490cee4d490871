"""Makes the ground of a scenario from its parameters and a seed.

Order: plane, step or elevation model; features; roughness; craters (oldest first, those placed by hand last); rocks.
Soils: the soil of the scenario, or of a raster; patches; rocks on all. Each part draws
from its own stream of the seed, so that a change of one leaves the others as they are. The same parameters
and seed give the identical arrays on one machine and one version of numpy and scipy.
"""

import math
from dataclasses import replace

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.craters import Crater, draw_craters, placed_crater, stamp_craters
from sojourn_physics.terrain.features import add_features, lay_patches
from sojourn_physics.terrain.height_field import HeightField, SoilArray
from sojourn_physics.terrain.params import KeepClearParams, TerrainParams
from sojourn_physics.terrain.raster import Raster, check_scale, filled, resample, soils_at
from sojourn_physics.terrain.rocks import Rock, draw_rocks, placed_rock, stamp_rocks
from sojourn_physics.terrain.roughness import rough_surface

CRATER_MARGIN = 1.5
"""A random crater with its rim and near ejecta, this many radii, stays out of a clear circle."""

ROCK_MARGIN = 0.5 * math.sqrt(1.5)
"""Half the longest outline of a random rock over its diameter."""


def generate(params: TerrainParams, soil: str, rock_soil: str, seed: int, raster: Raster | None = None) -> HeightField:
    """The ground of a scenario.

    Args:
        params: what it is like.
        soil: name of the soil, index 0 of the height field.
        rock_soil: name of the soil of rocks, index 1. If it is the same as `soil` there is one index only.
        seed: 0 or more; the random parts follow from it.
        raster: what was read from the file of a terrain of kind `file`.

    Further soils have the indices after these, in the order of `params.extra_soils`.

    Raises:
        InvalidValueError: a negative seed, an empty name, a raster that does not cover the map or has holes.
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

    heights = _base(params) if params.file is None else _from_raster(params, raster)
    add_features(heights, origin, params.resolution, params.features)
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
    soil_names = tuple(dict.fromkeys((soil, rock_soil, *params.extra_soils)))
    soil_index = np.zeros(shape, dtype=np.uint8)
    if params.file is not None and raster is not None and raster.soils is not None:
        _map_soils(params, raster, soil_names, soil_index)
    lay_patches(soil_index, origin, params.resolution, params.soil_patches, soil_names)
    stamp_rocks(heights, soil_index, soil_names.index(rock_soil), origin, params.resolution, rocks)

    return HeightField(
        heights=heights,
        soil_index=soil_index,
        resolution=params.resolution,
        origin_x=origin[0],
        origin_y=origin[1],
        soil_names=soil_names,
        interpolation=params.interpolation,
    )


def _from_raster(params: TerrainParams, raster: Raster | None) -> FloatArray:
    """Heights of the map's nodes from its file: shape (ny, nx) [m]."""
    if raster is None or params.file is None:
        raise InvalidValueError("raster", None, "what was read from the terrain's file")
    whole = replace(raster, heights=filled(raster.heights, params.file.fill))
    check_scale(whole.heights, whole.resolution)
    heights = resample(whole, params.node_counts, params.origin, params.resolution, params.interpolation)
    if params.file.height_offset is None:
        rows, columns = heights.shape
        heights -= heights[rows // 2, columns // 2]
    return heights


def _map_soils(params: TerrainParams, raster: Raster, soil_names: tuple[str, ...], soil_index: SoilArray) -> None:
    """Write the soils of a raster into soil_index, in place."""
    classes = params.file.soil_classes if params.file is not None else ()
    numbers = soils_at(raster, params.node_counts, params.origin, params.resolution)
    known = {item.value: soil_names.index(item.soil) for item in classes}
    for value in np.unique(numbers).tolist():
        if value not in known:
            allowed = "values of soil_classes: " + ", ".join(str(number) for number in known)
            raise InvalidValueError("soil raster", value, allowed)
        soil_index[numbers == value] = known[value]


def _base(params: TerrainParams) -> FloatArray:
    """Plane or step that everything else is set on: shape (ny, nx) [m]."""
    rows, columns = params.node_counts
    origin_x, origin_y = params.origin
    x = origin_x + params.resolution * np.arange(columns, dtype=np.float64)[np.newaxis, :]
    y = origin_y + params.resolution * np.arange(rows, dtype=np.float64)[:, np.newaxis]
    steepness = math.tan(math.radians(params.slope_deg))
    direction = math.radians(params.slope_direction_deg)
    heights = np.zeros((rows, columns))  # in place from here: a large map has no room for a second one
    if steepness:
        heights += steepness * math.cos(direction) * x
        heights += steepness * math.sin(direction) * y
    if params.kind == "step":
        # A rounding error of a node's position must not move the edge by a cell.
        tolerance = 1e-6 * params.resolution
        raised = x >= params.step_x - tolerance
        if params.step_y is not None:
            raised = raised & (y >= params.step_y - tolerance)
        heights += np.where(raised, params.step_height, 0.0)
    return heights


def _crater_is_clear(crater: Crater, keep_clear: tuple[KeepClearParams, ...]) -> bool:
    reach = CRATER_MARGIN * 0.5 * crater.diameter
    return all(math.hypot(crater.x - c.x, crater.y - c.y) >= c.radius + reach for c in keep_clear)


def _rock_is_clear(rock: Rock, keep_clear: tuple[KeepClearParams, ...]) -> bool:
    reach = ROCK_MARGIN * rock.diameter
    return all(math.hypot(rock.x - c.x, rock.y - c.y) >= c.radius + reach for c in keep_clear)
