"""The machine's shadow."""

from typing import Any, ClassVar

import viser

from sojourn_console.model import RunScene
from sojourn_console.views.ground_view import SHADE
from sojourn_console.views.sun_view import LIGHT
from sojourn_console.world import World


class ShadowView:
    """On the ground and on the machine itself; without it, a browser that has no graphics card draws three times as
    often. It is of the Sun's light and falls on the ground that other views have drawn.
    """

    title: ClassVar[str] = "shadow of the machine"
    needs: ClassVar[tuple[str, ...]] = ()
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._light: Any = server.scene.get_handle_by_name(LIGHT)
        self._ground: Any = server.scene.get_handle_by_name(SHADE)

    def show(self, scene: RunScene) -> None:
        self._light.cast_shadow = self._ground.visible = True

    def hide(self) -> None:
        self._light.cast_shadow = self._ground.visible = False
