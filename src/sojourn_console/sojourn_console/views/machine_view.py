"""The machine as the drive believes it to be, and as it truly is, as a ghost, for who asks for it."""

from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.machine_shape import MachineShape
from sojourn_console.model import BasePose, RunScene
from sojourn_console.views.view import wxyz
from sojourn_console.world import World
from sojourn_machine.params import FloatArray

LEAST = 1e-4
"""Change of a place or of a quaternion below which it is not sent again."""


class PosedMachine:
    """The parts of a machine under one frame.

    Args:
        server: where it is drawn. shape: of the machine. name: of its frame. opacity: None for a solid one.
    """

    def __init__(self, server: viser.ViserServer, shape: MachineShape, name: str, opacity: float | None) -> None:
        self._shape = shape
        self.frame = server.scene.add_frame(name, show_axes=False, visible=False)
        self._parts: list[Any] = [
            server.scene.add_mesh_simple(
                f"{name}/part_{number}",
                part.vertices,
                part.faces,
                color=part.color,
                flat_shading=True,
                opacity=opacity,
                cast_shadow=opacity is None,
                receive_shadow=opacity is None,
            )
            for number, part in enumerate(shape.parts)
        ]
        self._last = np.full((len(self._parts), 7), np.nan)
        self._pose: FloatArray = np.full(7, np.nan)

    def place(self, pose: BasePose, joints: Any) -> None:
        """Show it in a pose, with joint angles."""
        where = np.concatenate([pose.position, wxyz(pose.orientation)])
        if not np.abs(where - self._pose).max() < LEAST:
            self.frame.position, self.frame.wxyz = where[:3], where[3:]
            self._pose = where
        positions, turns = self._shape.placements(joints)
        placed = np.concatenate([positions, turns], axis=1)
        moved = np.flatnonzero(~(np.abs(placed - self._last).max(axis=1) < LEAST))
        for number in moved.tolist():
            self._parts[number].position, self._parts[number].wxyz = positions[number], turns[number]
        self._last[moved] = placed[moved]
        self.frame.visible = True


class MachineView:
    """As the drive believes."""

    title: ClassVar[str] = ""
    needs: ClassVar[tuple[str, ...]] = ("/odom", "/joint_states")
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._machine = PosedMachine(server, MachineShape(world.scenario.urdf_xml), "/machine", None)

    def show(self, scene: RunScene) -> None:
        pose = scene.pose or scene.truth
        if pose is not None:
            self._machine.place(pose, scene.joints)

    def hide(self) -> None:
        self._machine.frame.visible = False


class TruthView:
    """As it truly is."""

    title: ClassVar[str] = "truth (ghost)"
    needs: ClassVar[tuple[str, ...]] = ("/truth/odom",)
    starts_shown: ClassVar[bool] = False

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._server, self._world = server, world
        self._machine: PosedMachine | None = None

    def show(self, scene: RunScene) -> None:
        if scene.truth is None:
            return
        if self._machine is None:
            self._machine = PosedMachine(self._server, MachineShape(self._world.scenario.urdf_xml), "/truth", 0.35)
        self._machine.place(scene.truth, scene.joints)

    def hide(self) -> None:
        if self._machine is not None:
            self._machine.frame.visible = False
