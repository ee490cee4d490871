"""Light from where the Sun stands, so that its side and the shadow side are seen as they are."""

from functools import partial
from typing import ClassVar

import numpy as np
import viser

from sojourn_console.ground_light import SKY, SKY_COLOR, SUN
from sojourn_console.model import RunScene
from sojourn_console.views.view import YELLOW, ShownPoints
from sojourn_console.world import World

LIGHT = "/sun"
"""Name of the Sun's light in the scene."""
AWAY = 30.0
"""From the machine to the light [m]."""
ARROW = 1.2
OVER = 1.6
"""Where the arrow towards the Sun begins, over the machine [m]."""
MOVED = 0.01


class SunView:
    """A light, and an arrow towards the Sun over the machine."""

    title: ClassVar[str] = "direction to the Sun"
    needs: ClassVar[tuple[str, ...]] = ()
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._world = world
        server.scene.configure_default_lights(enabled=False)
        server.scene.configure_environment_map(None)
        self._light = server.scene.add_light_directional(LIGHT, intensity=SUN, cast_shadow=True)
        server.scene.add_light_ambient("/sky", intensity=SKY, color=SKY_COLOR)
        add = server.scene.add_arrows
        self._arrow = ShownPoints(
            partial(add, "/sun_arrow", colors=YELLOW, shaft_radius=0.015, head_radius=0.045, head_length=0.12)
        )
        self._last = np.zeros(3)
        self._at = np.zeros(3)
        self._light_up(world.sun_direction(0), np.zeros(3))

    def show(self, scene: RunScene) -> None:
        pose = scene.pose or scene.truth
        if pose is None:
            return
        direction = self._world.sun_direction(scene.stamp)
        moved = np.abs(direction - self._last).max() > MOVED or np.abs(pose.position - self._at).max() > 0.05
        if not moved and self._arrow.is_there:
            return
        self._light_up(direction, pose.position)
        begin = pose.position + np.array([0.0, 0.0, OVER])
        self._arrow.draw(np.array([[begin, begin + ARROW * direction]]))

    def hide(self) -> None:
        self._arrow.remove()

    def _light_up(self, direction: np.ndarray, place: np.ndarray) -> None:
        self._last, self._at = direction.copy(), place.copy()
        self._light.position = AWAY * direction
        self._light.intensity = SUN if direction[2] > 0.0 else 0.0
