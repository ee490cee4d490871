"""The ground, coloured by its soils, with the ruts as they form."""

import math
import time
from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.ground_tiles import GroundTiles, TileKey
from sojourn_console.model import RunScene
from sojourn_console.ruts import deepest_of_each
from sojourn_console.world import World
from sojourn_machine.params import FloatArray

REDRAW_S = 2.0
"""Wall time between two drawings of a tile: it is sent as a whole."""
OUTDATED_S = 8.0
"""A tile as it was stays so long, until even a slow browser has read the new one."""
NAMES = 8
"""Of one tile after the other; a name that comes again takes the place of its first bearer in viser's memory."""
SUN_MOVED = math.radians(1.0)
"""From then on the ground is lit anew."""
SHADE = "/shade"
"""Name of what the machine's shadow falls on, in the scene: one for all drawings of a tile."""
DARKNESS = 0.55
"""Of the shadow; what is left is the sky's light."""
NARROWEST = 0.04
"""Half the width of a rut at least [m]."""


class GroundView:
    """Ruts are those of /truth/ground where the run tells them, else where /truth/contacts says so."""

    title: ClassVar[str] = ""
    needs: ClassVar[tuple[str, ...]] = ("/truth/contacts", "/truth/ground")
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._server, self._world = server, world
        self.tiles = GroundTiles(world.ground)
        self._half_width = max(NARROWEST, _half_width(world))
        self._drawn: dict[TileKey, tuple[Any, int]] = {}
        self._stale: list[tuple[float, Any]] = []
        self._changed: set[TileKey] = set()
        self._waiting: dict[float, list[FloatArray]] = {}
        """What has been pressed down since the last drawing, by the radius round each place."""
        self._redrawn_at = 0.0
        self._told = False
        self._sun = np.zeros(3)
        self._light_up(world.sun_direction(0), 0)
        for key in self.tiles.keys():  # noqa: SIM118 - it is no mapping
            self._draw(key)
        server.scene.add_glb(SHADE, glb_data=self.tiles.unseen(), cast_shadow=False, receive_shadow=DARKNESS)

    def show(self, scene: RunScene) -> None:
        sun = self._world.sun_direction(scene.stamp)
        if np.abs(sun - self._sun).max() > SUN_MOVED:
            self._light_up(sun, scene.stamp)
            self._changed.update(self.tiles.keys())
        if scene.lowered:
            self._told = True
            self._waiting.setdefault(NARROWEST / 2, []).extend(scene.lowered)
        elif scene.passed and not self._told:
            self._waiting.setdefault(self._half_width, []).extend(scene.passed)
        now = time.monotonic()
        while self._stale and now - self._stale[0][0] > OUTDATED_S:
            self._stale.pop(0)[1].remove()
        if (self._changed or self._waiting) and now - self._redrawn_at > REDRAW_S:
            self._redrawn_at = now
            self._lower()
            for key in self._changed:
                self._draw(key)
            self._changed.clear()

    def hide(self) -> None:
        return

    def clear(self) -> None:
        """Forget the ruts: time has jumped."""
        self._waiting.clear()
        self._changed |= self.tiles.clear()

    def _lower(self) -> None:
        """Press down what waits, together: the wheels of a machine come by one place in many messages."""
        for radius, nodes in self._waiting.items():
            deepest = deepest_of_each(np.concatenate(nodes))
            self._changed |= self.tiles.lower(deepest[:, :2], deepest[:, 2], radius)
        self._waiting.clear()

    def _light_up(self, direction: FloatArray, stamp: int) -> None:
        self._sun = direction.copy()
        self.tiles.light.shine(direction, self._world.sun_disc(stamp))

    def _draw(self, key: TileKey) -> None:
        """Beside the tile as it was, which goes later: so there is no moment without one."""
        handle, number = self._drawn.get(key, (None, 0))
        if handle is not None:
            self._stale.append((time.monotonic(), handle))
        name = f"/ground/tile_{key.row}_{key.column}_{number % NAMES}"
        fresh = self._server.scene.add_glb(name, glb_data=self.tiles.glb(key), cast_shadow=False, receive_shadow=False)
        self._drawn[key] = fresh, number + 1


def _half_width(world: World) -> float:
    """Of what leaves ruts [m]."""
    machine = world.scenario.machine
    widths = [*(wheel.width for wheel in machine.wheels), *(track.width for track in machine.tracks)]
    return 0.5 * max(widths, default=0.0)
