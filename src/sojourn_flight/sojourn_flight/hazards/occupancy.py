"""The map of obstacles as others read maps: cells that are free, closed or not known."""

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.obstacle_map import ObstacleMap
from sojourn_flight.hazards.traversability import FREE, Passability

NOT_KNOWN, OPEN, CLOSED = -1, 0, 100
"""As nav_msgs/OccupancyGrid has them."""


def occupancy(map_: ObstacleMap, ground: Passability) -> NDArray[np.int8]:
    """What each cell of a map and of what is thought of it is, shape (cells, cells), row along y, column along x."""
    cells = np.where(map_.known, np.int8(OPEN), np.int8(NOT_KNOWN))
    cells[ground.kinds != FREE] = CLOSED
    return cells
