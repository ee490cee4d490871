"""Keep-out zones on the maps of obstacle handling: closed, whatever the camera thinks of the ground there.

On a grid a zone closes the cells whose middles lie in it and those that its edge may cut: no corner is lost between two
middles. Positions in odom, which is map at the start of a run; lengths [m].
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.obstacle_map import CellGrid
from sojourn_flight.hazards.traversability import FREE, Obstacle, Passability
from sojourn_flight.hazards.wide_map import COST, WideMap
from sojourn_flight.hazards.zone_params import KeepOutZone, first_in

KEEP_OUT = 6
"""Kind of a cell in a zone, beside those of `traversability`."""


@dataclass(frozen=True)
class KeepOut:
    """All zones of a run."""

    zones: tuple[KeepOutZone, ...] = ()

    def closing(self, ground: Passability, cell: float) -> Passability:
        """Judged ground with its free cells in a zone closed; `cell`: side of one [m]."""
        if not self.zones:
            return ground
        mask = _mask(self.zones, CellGrid(ground.x0, ground.y0, cell), len(ground.kinds), cell * math.sqrt(0.5))
        return replace(ground, kinds=np.where(mask & (ground.kinds == FREE), KEEP_OUT, ground.kinds))

    def closing_wide(self, wide: WideMap, straight: float) -> WideMap:
        """The wide map closed where the rover's middle would be too near: `straight` as in `detour_search` [m]."""
        if not self.zones:
            return wide
        grid, layers = CellGrid(wide.x0, wide.y0, wide.cell), wide.layers.copy()
        layers[COST][_mask(self.zones, grid, layers.shape[1], straight)] = np.inf
        return replace(wide, layers=layers)

    def obstacle_at(self, x: float, y: float, cell: float) -> "ZoneObstacle":
        """The zone that has closed the cell about a place; `cell`: its side [m]."""
        found = first_in(self.zones, np.array([[x, y]]), cell)
        return ZoneObstacle("keep-out zone" if found is None else f"keep-out zone {found[1].name}", x, y, 0.0, 0.0)


NO_ZONES = KeepOut()


@dataclass(frozen=True, slots=True)
class ZoneObstacle(Obstacle):
    """A zone as what stands in the way: there is nothing to be measured."""

    def __str__(self) -> str:
        return f"{self.kind} at ({self.x:.2f}, {self.y:.2f})"


@lru_cache(maxsize=8)
def _mask(zones: tuple[KeepOutZone, ...], grid: CellGrid, count: int, margin: float) -> NDArray[np.bool_]:
    """Cells whose middles are nearer than that to a zone, shape (count, count)."""
    middles = grid.cell * (np.arange(count) + 0.5)
    x, y = np.meshgrid(grid.x0 + middles, grid.y0 + middles)
    places = np.stack([x.ravel(), y.ravel()], axis=1)
    near = np.zeros(len(places), dtype=np.bool_)
    for zone in zones:
        near |= zone.distances(places) <= margin
    mask: NDArray[np.bool_] = near.reshape(count, count)
    mask.setflags(write=False)
    return mask
