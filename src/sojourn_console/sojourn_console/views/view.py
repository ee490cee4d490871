"""What every view is."""

from collections.abc import Callable
from typing import Any, ClassVar, Protocol

import numpy as np

from sojourn_console.model import RunScene
from sojourn_machine.params import FloatArray

ORANGE, BLUE, GREEN, RED, YELLOW, VIOLET = (
    (255, 149, 0), (64, 156, 255), (48, 209, 88), (255, 69, 58), (255, 214, 10), (191, 90, 242),
)  # fmt: skip


class SceneView(Protocol):
    """Something that is drawn."""

    title: ClassVar[str]
    """In the list of what can be shown; empty for what always is."""
    needs: ClassVar[tuple[str, ...]]
    """Topics that are heard for it."""
    starts_shown: ClassVar[bool]

    def show(self, scene: RunScene) -> None:
        """Draw a scene. Called some tens of times a second: what has not changed is not sent."""
        ...

    def hide(self) -> None:
        """Draw nothing."""
        ...


def wxyz(orientation: FloatArray) -> FloatArray:
    """A quaternion x y z w as w x y z."""
    return orientation[[3, 0, 1, 2]]


def segments(points: FloatArray) -> FloatArray:
    """Points (n, 3) as line segments (n - 1, 2, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)


class Shown:
    """A node of the scene that is made anew when it is drawn otherwise, and taken away when there is none."""

    def __init__(self) -> None:
        self._handle: Any = None

    def put(self, handle: Any) -> None:
        """In its place. A node of the same name has replaced the one before already."""
        self._handle = handle

    def remove(self) -> None:
        """Take it away."""
        if self._handle is not None:
            self._handle.remove()
            self._handle = None

    @property
    def is_there(self) -> bool:
        """Whether there is one."""
        return self._handle is not None


class ShownPoints(Shown):
    """One of points alone, in which these are replaced: to make it anew takes twenty times as long.

    Args:
        make: a method of viser's scene with all that the node has besides, to be called with its `points`.
    """

    def __init__(self, make: Callable[..., Any]) -> None:
        super().__init__()
        self._make = make

    def draw(self, points: FloatArray) -> None:
        """Show it with these points, of the shape that viser asks of such a node."""
        if self._handle is None:
            self._handle = self._make(points=points)
        else:
            self._handle.points = points
