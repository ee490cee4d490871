"""Layers over the ground: the slope of the map, and the cells that the drive takes for closed."""

import math
from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.ground_layers import slope_colors, slopes_of
from sojourn_console.model import COSTMAP, RunScene
from sojourn_console.views.view import RED, Shown
from sojourn_console.views.way_view import on_ground
from sojourn_console.world import World
from sojourn_operator.far_goal import closed_places

MOST_POINTS = 40_000
"""Of a layer: what a laptop draws with ease."""
BELOW_LINES = np.array([0.0, 0.0, 0.02])
"""So that ways and zones are drawn over them [m]."""
LIMIT_DEG, REACH = 20.0, 0.5
"""Of a machine whose drive knows no limits of slope."""


class SlopeView:
    """How steep the map is, where the machine would stand: blue is level, red as steep as it drives at most."""

    title: ClassVar[str] = "slope of the map"
    needs: ClassVar[tuple[str, ...]] = ()
    starts_shown: ClassVar[bool] = False

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._server, self._world, self._points = server, world, Shown()

    def show(self, scene: RunScene) -> None:
        if self._points.is_there:
            return
        ground, (limit, reach) = self._world.ground, _limits(self._world)
        slopes = slopes_of(ground, reach)
        step = max(1, math.ceil(math.sqrt(slopes.size / MOST_POINTS)))
        rows, columns = np.mgrid[0 : slopes.shape[0] : step, 0 : slopes.shape[1] : step]
        x, y = (
            origin + ground.resolution * index.ravel()
            for origin, index in ((ground.origin_x, columns), (ground.origin_y, rows))
        )
        self._points.put(
            self._server.scene.add_point_cloud(
                "/layers/slope",
                points=(on_ground(self._world, np.column_stack([x, y])) - BELOW_LINES).astype(np.float32),
                colors=slope_colors(slopes[rows, columns].ravel(), limit),
                point_size=0.75 * step * ground.resolution,
                point_shape="square",
            )
        )

    def hide(self) -> None:
        self._points.remove()


class ClosedView:
    """What the drive takes for closed on its map, zones among it: nothing before it has seen anything."""

    title: ClassVar[str] = "closed to the drive"
    needs: ClassVar[tuple[str, ...]] = (COSTMAP,)
    starts_shown: ClassVar[bool] = False

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._server, self._world, self._points = server, world, Shown()
        self._drawn: Any = None

    def show(self, scene: RunScene) -> None:
        grid = scene.costmap
        if grid is self._drawn:
            return
        self._drawn = grid
        places = closed_places(grid)
        if grid is None or not len(places):
            self._points.remove()
            return
        self._points.put(
            self._server.scene.add_point_cloud(
                "/layers/closed",
                points=(on_ground(self._world, places) - BELOW_LINES).astype(np.float32),
                colors=np.tile(np.array(RED, dtype=np.uint8), (len(places), 1)),
                point_size=0.8 * grid.resolution,
                point_shape="square",
            )
        )

    def hide(self) -> None:
        self._points.remove()
        self._drawn = None


def _limits(world: World) -> tuple[float, float]:
    """Steepest slope that the machine drives [degree], and half its width [m]."""
    driving = world.scenario.as_believed().driving
    obstacles = None if driving is None else driving.obstacles
    if obstacles is None:
        return LIMIT_DEG, REACH
    return math.degrees(math.atan(min(obstacles.passable.tilts))), obstacles.outline.half_width
