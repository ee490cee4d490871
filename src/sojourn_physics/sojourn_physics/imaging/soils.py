"""How bright the soils of a ground are."""

from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField, SoilArray, sample_soil


class Soils(NamedTuple):
    """For the kernels."""

    of_node: SoilArray
    """See `HeightField.soil_index`; one node where all are as bright as each other."""
    place: FloatArray
    """`HeightField.grid`."""
    brightness: FloatArray
    """Of each soil, of the albedo of the place, (soils,) [-]."""


def soils_of(field: HeightField, brightness: tuple[float, ...]) -> Soils:
    """Of a height field; brightness of each of its soils, of the albedo of the place [-]."""
    bright = np.array(brightness)
    of_node = field.soil_index
    if (bright[of_node] == bright[of_node[0, 0]]).all():
        of_node = np.ascontiguousarray(of_node[:1, :1])
    return Soils(of_node, field.grid, bright)


@small_kernel
def brightness_at(soils: Soils, x: float, y: float) -> float:
    """Of the ground at (x, y) in map, of the albedo of the place [-]; off the map 1, whatever lies at the edge."""
    if soils.of_node.size == 1:
        return float(soils.brightness[soils.of_node[0, 0]])
    rows, columns = soils.of_node.shape
    column, row = (x - soils.place[0]) / soils.place[2], (y - soils.place[1]) / soils.place[2]
    if not (-0.5 <= column <= columns - 0.5 and -0.5 <= row <= rows - 0.5):
        return 1.0
    soil = sample_soil(soils.of_node, soils.place[0], soils.place[1], soils.place[2], x, y)
    return float(soils.brightness[soil])
