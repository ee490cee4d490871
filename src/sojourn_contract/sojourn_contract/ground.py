"""What wheels and tools have done to the ground as messages: the plant tells who looks at it what is new.

A message has a point for each node of the ground's memory (`sojourn_physics.terrain.memory`) whose height has changed
since the message before: x, y in map, and by how much it lies lower than at the start, by ruts and digging, less than
zero where soil was heaped up. In single precision a node is found again on maps of 80 km at 1 cm.
"""

import numpy as np
from numpy.typing import NDArray

from sojourn_contract.clouds import columns_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.field_rules import FLOAT32_TOLERANCE
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.values import FLOAT32, PointCloud2, PointField
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, RUT, TILE, Tile

NAMES = ("x", "y", "lowered")
_FIELDS = tuple(PointField(name, 4 * place, FLOAT32) for place, name in enumerate(NAMES))
DEEPEST = 100.0
"""Of what can be told [m]."""
GROUND = Topic(
    "/truth/ground",
    "sensor_msgs/PointCloud2",
    "plant",
    ("sensors",),
    50,
    3.0,
    "nodes of the ground that wheels and tools have changed since the message before: x y, and how much lower than at "
    "the start; in runs of machines with a sensor that sees it",
    (
        FieldRule("x y", "m", frame="map", low=-1e5, high=1e5, tolerance=FLOAT32_TOLERANCE),
        FieldRule("lowered", "m", low=-DEEPEST, high=DEEPEST, tolerance=FLOAT32_TOLERANCE),
    ),
    frames=("map",),
)


def ground_cloud(stamp: int, before: GroundMemory, after: GroundMemory) -> PointCloud2:
    """What has changed from one memory of a ground to a later one."""
    parts = [np.zeros((0, len(NAMES)), dtype=np.float32)]
    for key, tile in after.tiles.items():
        old = before.tiles.get(key)
        if tile is old:
            continue
        lowered = _lowered(tile)
        rows, columns = np.nonzero(lowered if old is None else lowered != _lowered(old))
        x = after.origin_x + (key[0] * TILE + columns) * after.cell
        y = after.origin_y + (key[1] * TILE + rows) * after.cell
        parts.append(np.column_stack([x, y, lowered[rows, columns]]).astype(np.float32))
    points = np.concatenate(parts)
    step = 4 * len(NAMES)
    return PointCloud2(stamp, "map", len(points), _FIELDS, step, points.tobytes(), row_step=step * len(points))


def with_ground(memory: GroundMemory, cloud: PointCloud2) -> GroundMemory:
    """The memory after a message: of each tile only by how much it is lower, as if all of it were dug.

    Raises:
        RefusedMessageError: fields that are missing, numbers that are not finite or beyond any ground.
    """
    if not cloud.width * cloud.height or memory.cell <= 0.0:
        return memory
    told = columns_of(GROUND.name, cloud, NAMES)
    for name in NAMES:
        bad = ~(np.abs(told[name]) < (DEEPEST if name == "lowered" else 1e6))
        if bad.any():
            value = float(told[name][bad][0])
            raise RefusedMessageError(GROUND.name, name, value, "a finite number within the contract's range")
    columns = _nodes(told["x"], memory.origin_x, memory.cell)
    rows = _nodes(told["y"], memory.origin_y, memory.cell)
    places = np.column_stack([columns // TILE, rows // TILE])
    found, of_tile = np.unique(places, axis=0, return_inverse=True)
    fresh: dict[tuple[int, int], Tile] = {}
    for number, (column, row) in enumerate(found.tolist()):
        inside = of_tile.reshape(-1) == number
        old = memory.tiles.get((column, row))
        tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32) if old is None else old.copy()
        tile[rows[inside] % TILE, columns[inside] % TILE, DUG] = told["lowered"][inside]
        tile.setflags(write=False)
        fresh[column, row] = tile
    return GroundMemory(memory.cell, memory.origin_x, memory.origin_y, {**memory.tiles, **fresh})


def _lowered(tile: Tile) -> NDArray[np.float32]:
    lowered: NDArray[np.float32] = tile[:, :, RUT] + tile[:, :, DUG]
    return lowered


def _nodes(places: NDArray[np.float32], origin: float, cell: float) -> NDArray[np.int64]:
    return np.rint((places.astype(np.float64) - origin) / cell).astype(np.int64)
