"""The way behind and the way ahead, and how sure the drive is of where it stands."""

import math
from functools import partial
from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.model import RunScene
from sojourn_console.views.view import BLUE, ORANGE, VIOLET, ShownPoints, segments
from sojourn_console.world import World
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.ground_samples import heights_of

ABOVE = 0.04
"""How far over the ground lines are drawn [m]."""
DEVIATIONS = 2.0
"""Of the ellipse: about 86 % of a plane normal distribution lie within."""
SMALLEST = 0.05
"""Half axis below which the ellipse is drawn so large, to be seen [m]."""
_TURN = np.linspace(0.0, 2.0 * np.pi, 61)


class TrackView:
    """The way behind, by the drive's estimate."""

    title: ClassVar[str] = "way behind"
    needs: ClassVar[tuple[str, ...]] = ("/odom",)
    starts_shown: ClassVar[bool] = True
    name: ClassVar[str] = "/track"
    color: ClassVar[Any] = BLUE
    width: ClassVar[float] = 3.0

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._world = world
        self._line = shown_line(server, self.name, self.color, self.width)
        self._drawn = np.zeros((0, 3))

    def points(self, scene: RunScene) -> FloatArray:
        """Of the line, (n, 3)."""
        return scene.track

    def show(self, scene: RunScene) -> None:
        points = self.points(scene)
        if points is self._drawn and self._line.is_there:
            return
        if len(points) < 2:
            self.hide()
            return
        if len(points) == len(self._drawn) and np.array_equal(points, self._drawn):
            return
        self._drawn = points
        self._line.draw(segments(on_ground(self._world, points)))

    def hide(self) -> None:
        self._line.remove()
        self._drawn = np.zeros((0, 3))


class PlanView(TrackView):
    """What is left of the way to the goal."""

    title: ClassVar[str] = "planned way"
    needs: ClassVar[tuple[str, ...]] = ("/plan",)
    name: ClassVar[str] = "/plan"
    color: ClassVar[Any] = ORANGE
    width: ClassVar[float] = 5.0

    def points(self, scene: RunScene) -> FloatArray:
        return scene.plan


class UncertaintyView:
    """The ellipse of two standard deviations of the position."""

    title: ClassVar[str] = "uncertainty of the estimate"
    needs: ClassVar[tuple[str, ...]] = ("/odom",)
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._world = world
        self._line = shown_line(server, "/uncertainty", VIOLET, 3.0)
        self._drawn = np.zeros((0, 3))

    def show(self, scene: RunScene) -> None:
        if scene.pose is None or not scene.covariance[:2, :2].any():
            self.hide()
            return
        points = ellipse(scene.pose.position[:2], scene.covariance[:2, :2])
        if len(self._drawn) and np.abs(points - self._drawn).max() < 0.01:
            return
        self._drawn = points
        self._line.draw(segments(on_ground(self._world, points)))

    def hide(self) -> None:
        self._line.remove()
        self._drawn = np.zeros((0, 3))


def shown_line(server: viser.ViserServer, name: str, color: Any, width: float) -> ShownPoints:
    """One of segments. name: in the scene. width: as it is seen [pixels]."""
    add = server.scene.add_line_segments
    return ShownPoints(partial(add, name, colors=color, thickness=width, thickness_units="screen"))


def ellipse(centre: FloatArray, covariance: FloatArray) -> FloatArray:
    """Of DEVIATIONS standard deviations of a place in the plane, (n, 3) with z = 0 [m]: along the principal axes of its
    covariance, (2, 2) [m2], as long as the roots of their variances.
    """
    variances, axes = np.linalg.eigh(covariance)
    halves = [max(DEVIATIONS * math.sqrt(max(float(one), 0.0)), SMALLEST) for one in variances]
    plane = np.outer(np.cos(_TURN), halves[0] * axes[:, 0]) + np.outer(np.sin(_TURN), halves[1] * axes[:, 1])
    return np.column_stack([plane + centre, np.zeros(len(_TURN))])


def on_ground(world: World, points: FloatArray) -> FloatArray:
    """The same points a little over the ground, and not in it."""
    heights = heights_of(world.ground, points[:, 0], points[:, 1])
    return np.column_stack([points[:, :2], heights + ABOVE])
