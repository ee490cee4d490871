"""With what force the ground pushes, at each wheel, track, foot or pad."""

from functools import partial
from typing import ClassVar

import numpy as np
import viser

from sojourn_console.model import Contacts, RunScene
from sojourn_console.views.view import GREEN, ShownPoints
from sojourn_console.world import World

LEAST_N = 1.0
LONGEST = 0.8
"""Length of the arrow of a wheel that bears a quarter of the machine [m]."""


class ForceView:
    """As arrows from where it pushes."""

    title: ClassVar[str] = "contact forces"
    needs: ClassVar[tuple[str, ...]] = ("/truth/contacts",)
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        mass = sum(one.mass for one in world.scenario.urdf.inertials.values())
        self._scale = LONGEST / max(0.25 * mass * world.scenario.gravity, LEAST_N)
        self._arrows = ShownPoints(
            partial(
                server.scene.add_arrows, "/forces", colors=GREEN, shaft_radius=0.012, head_radius=0.03, head_length=0.07
            )
        )
        self._last = np.zeros((0, 2, 3))
        self._seen: Contacts | None = None

    def show(self, scene: RunScene) -> None:
        if scene.contacts is None or scene.contacts is self._seen:
            return
        self._seen = contacts = scene.contacts
        touching = np.linalg.norm(contacts.forces, axis=1) > LEAST_N
        begin = contacts.places[touching]
        arrows = np.stack([begin, begin + self._scale * contacts.forces[touching]], axis=1)
        if arrows.shape == self._last.shape and (not len(arrows) or np.abs(arrows - self._last).max() < 0.01):
            return
        self._last = arrows
        if len(arrows):
            self._arrows.draw(arrows)
        else:
            self._arrows.remove()

    def hide(self) -> None:
        self._arrows.remove()
        self._last = np.zeros((0, 2, 3))
        self._seen = None
