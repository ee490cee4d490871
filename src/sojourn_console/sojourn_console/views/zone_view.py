"""Keep-out zones and waypoints of the scenario: drawn on the ground, with their names."""

from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.model import RunScene
from sojourn_console.views.view import GREEN, RED, segments
from sojourn_console.views.way_view import on_ground
from sojourn_console.world import World
from sojourn_machine.params import FloatArray

STEP = 0.25
"""Between two points of an edge, so that it follows the ground [m]."""
LABEL = 0.35
"""Over the ground [m]."""


class ZoneView:
    """They do not change during a run: they are drawn once."""

    title: ClassVar[str] = "keep-out zones and waypoints"
    needs: ClassVar[tuple[str, ...]] = ()
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._server, self._world = server, world
        self._handles: list[Any] = []

    def show(self, scene: RunScene) -> None:
        if self._handles:
            return
        api, config = self._server.scene, self._world.scenario.config
        for number, zone in enumerate(config.keep_out):
            line = on_ground(self._world, edge_of(np.array(zone.points)))
            name = f"/zones/{number}"
            edge = api.add_line_segments(name, segments(line), colors=RED, thickness=4.0, thickness_units="screen")
            middle = line[:, :3].mean(axis=0) + np.array([0.0, 0.0, LABEL])
            self._handles += [edge, api.add_label(f"{name}/name", zone.name, position=middle)]
        for name, place in config.waypoints.items():
            point = on_ground(self._world, np.array([[place.x, place.y, 0.0]]))[0]
            flag = api.add_icosphere(f"/waypoints/{name}", radius=0.1, color=GREEN, position=point, cast_shadow=False)
            self._handles += [flag, api.add_label(f"/waypoints/{name}/name", name, position=(0.0, 0.0, LABEL))]

    def hide(self) -> None:
        while self._handles:
            self._handles.pop().remove()


def edge_of(corners: FloatArray) -> FloatArray:
    """Points along the edge of a polygon, (n, 3) with z = 0, closed; corners: (n, 2) [m]."""
    parts = []
    for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(2, int(np.linalg.norm(other - one) / STEP) + 1)
        parts.append(np.linspace(one, other, count))
    plane = np.concatenate(parts)
    return np.column_stack([plane, np.zeros(len(plane))])
