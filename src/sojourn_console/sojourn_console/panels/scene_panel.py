"""What is drawn, and whom the eye follows."""

from typing import Any, ClassVar

import numpy as np

from sojourn_console.model import RunScene
from sojourn_console.panels.panel import QuietPanel, Workbench
from sojourn_console.views.view import SceneView
from sojourn_contract.messages import yaw_of
from sojourn_machine.params import FloatArray

FOLLOW_STEP = 0.04
"""The eye moves on when the machine has moved so far [m]."""
EYE = np.array([-3.6, -2.6, 2.3])
"""From the machine, of a new page and of “Behind”: behind it and to its right, as it heads [m]."""
AHEAD = np.array([0.9, 0.0, 0.0])
"""Where it looks, from the machine [m]."""
ABOVE = np.array([-0.6, 0.0, 14.0])


class ScenePanel(QuietPanel):
    """One box a view; the eye follows, or goes back to where it began.

    Args:
        bench: what it works on. views: that are drawn.
    """

    title: ClassVar[str] = "Scene"

    def __init__(self, bench: Workbench, views: tuple[SceneView, ...]) -> None:
        self._bench = bench
        gui = bench.server.gui
        self._views = views
        self._boxes = {view.title: gui.add_checkbox(view.title, view.starts_shown) for view in views if view.title}
        self._follow = gui.add_checkbox("Eye follows the machine", True)
        eyes = gui.add_button_group("Eye", ("Behind", "Above"))
        eyes.on_click(lambda event: self._look(event.client, ABOVE if eyes.value == "Above" else EYE))
        self._at: FloatArray | None = None
        bench.server.on_client_connect(lambda client: self._look(client, EYE))
        self._hidden: set[str] = set()

    def topics(self) -> frozenset[str]:
        return frozenset(topic for view in self._views if self._is_shown(view) for topic in view.needs)

    def show(self, scene: RunScene) -> None:
        for view in self._views:
            if self._is_shown(view):
                self._hidden.discard(view.title)
                view.show(scene)
            elif view.title not in self._hidden:
                self._hidden.add(view.title)
                view.hide()
        pose = scene.pose or scene.truth
        if pose is None:
            return
        if self._at is None:
            self._at = pose.position.copy()
            for client in self._bench.server.get_clients().values():
                self._look(client, EYE)
        moved = pose.position - self._at
        if self._follow.value and float(np.linalg.norm(moved)) > FOLLOW_STEP:
            self._at = pose.position.copy()
            for client in self._bench.server.get_clients().values():
                client.camera.position = client.camera.position + moved  # and with it where it looks

    def _is_shown(self, view: SceneView) -> bool:
        return not view.title or bool(self._boxes[view.title].value)

    def _look(self, client: Any, eye: FloatArray) -> None:
        pose = self._bench.scene.pose or self._bench.scene.truth
        if client is None or pose is None:
            return
        heading = yaw_of(pose.orientation) or 0.0
        turn = np.array([[np.cos(heading), -np.sin(heading), 0.0], [np.sin(heading), np.cos(heading), 0.0], [0, 0, 1]])
        with client.atomic():
            client.camera.position = pose.position + turn @ eye
            client.camera.look_at = pose.position + turn @ AHEAD
