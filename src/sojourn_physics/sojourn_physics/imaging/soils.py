"""How bright the soils of a ground are."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ground import DrawnGround
from sojourn_physics.imaging.nodes import Nodes
from sojourn_physics.imaging.single import HALF, ONE, ZERO, narrowed
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


@small_kernel
def brightness_between(soils: Soils, ground: DrawnGround, nodes: Nodes, bright: NDArray[np.float32]) -> None:
    """Write the same of places between the nodes of the ground, (n,), but for half a node around the map."""
    if soils.of_node.size == 1:
        bright[:] = narrowed(soils.brightness[soils.of_node[0, 0]])
        return
    scale = narrowed(ground.place[3] / soils.place[2])
    for j in range(bright.shape[0]):
        column = np.int32((np.float32(nodes.column[j]) + nodes.right[j]) * scale + HALF)
        row = np.int32((np.float32(nodes.row[j]) + nodes.up[j]) * scale + HALF)
        soil = soils.of_node[np.uint64(row), np.uint64(column)]
        bright[j] = narrowed(soils.brightness[soil]) if nodes.on[j] > ZERO else ONE
