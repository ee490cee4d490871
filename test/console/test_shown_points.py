"""Nodes of the scene that change with every look: they are made once, and then only their points are sent."""

import numpy as np
import viser

from sojourn_console.gate import GuardedServer
from sojourn_console.model import Contacts, RunScene
from sojourn_console.views.force_view import ForceView
from sojourn_console.views.view import ShownPoints
from sojourn_console.world import World
from sojourn_machine.params import FloatArray


class Node:
    """One that notes whether it was taken away."""

    def __init__(self, points: FloatArray) -> None:
        self.points, self.is_gone = points, False

    def remove(self) -> None:
        self.is_gone = True


def test_points_are_replaced_and_the_node_stays() -> None:
    made: list[Node] = []

    def make(points: FloatArray) -> Node:
        made.append(Node(points))
        return made[-1]

    shown = ShownPoints(make)
    for count in (2, 3, 1):
        shown.draw(np.full((count, 2, 3), float(count)))
        assert shown.is_there and len(made) == 1
        assert made[0].points.shape == (count, 2, 3) and (made[0].points == count).all()
    shown.remove()
    assert made[0].is_gone and not shown.is_there
    shown.draw(np.zeros((1, 2, 3)))
    assert len(made) == 2


def pushed(heights: list[float]) -> RunScene:
    """Wheels at some heights that bear 100 N each, and one that hangs in the air."""
    places = np.array([[0.0, 0.3 * number, height] for number, height in enumerate([*heights, 1.0])])
    forces = np.array([[0.0, 0.0, 100.0]] * len(heights) + [[0.0, 0.0, 0.0]])
    return RunScene(contacts=Contacts(places, forces, np.zeros(len(places)), np.zeros(len(places))))


def test_arrows_of_forces_are_those_of_the_newest_scene(world: World) -> None:
    server = GuardedServer("forces", 9140)
    try:
        view = ForceView(server, world)
        view.show(pushed([0.0, 0.1]))
        arrows: viser.ArrowHandle = view._arrows._handle
        assert arrows.points.shape == (2, 2, 3)
        view.show(pushed([0.0, 0.1, 0.2]))
        assert view._arrows._handle is arrows and arrows.points.shape == (3, 2, 3)
        assert np.allclose(arrows.points[:, 0, 2], [0.0, 0.1, 0.2])
        view.show(pushed([]))
        assert not view._arrows.is_there
        view.show(pushed([0.5]))
        assert view._arrows._handle is not arrows and np.allclose(view._arrows._handle.points[:, 0, 2], 0.5)
    finally:
        server.stop()
