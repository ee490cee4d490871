"""The machine as the drive believes it to be, and as it truly is, as a ghost, for who asks for it."""

from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.machine_shape import MachineShape
from sojourn_console.model import BasePose, RunScene
from sojourn_console.views.view import wxyz
from sojourn_console.world import World
from sojourn_machine.params import FloatArray

LEAST_WAY, LEAST_TURN = 5e-4, 1e-4
"""Change of the place of a body against base_link [m], and of its quaternion, below which it is not sent again: each is
compared by itself, since a wheel turns all the time and hardly moves, and sending is what a page spends most on.
"""


class SentRows:
    """One property of many things that are drawn, as it was sent last.

    Args:
        things: that have it. name: of the property. least: change of a number from which on it is sent. size: of it.
    """

    def __init__(self, things: list[Any], name: str, least: float, size: int) -> None:
        self._things, self._name, self._least = things, name, least
        self._sent: FloatArray = np.full((len(things), size), np.nan)

    def send(self, rows: FloatArray) -> None:
        """Send of each thing what has changed. rows: (things, size)."""
        changed = np.flatnonzero(~(np.abs(rows - self._sent).max(axis=1) < self._least))
        for number in changed.tolist():
            setattr(self._things[number], self._name, rows[number])
        self._sent[changed] = rows[changed]


class PosedMachine:
    """The bodies of a machine under one frame, each with its parts.

    Args:
        server: where it is drawn. shape: of the machine. name: of its frame. opacity: None for a solid one.
    """

    def __init__(self, server: viser.ViserServer, shape: MachineShape, name: str, opacity: float | None) -> None:
        self._shape = shape
        self.frame = server.scene.add_frame(name, show_axes=False, visible=False)
        bodies = [server.scene.add_frame(f"{name}/{body}", show_axes=False) for body in shape.bodies]
        for number, part in enumerate(shape.parts):
            server.scene.add_mesh_simple(
                f"{name}/{shape.bodies[part.body]}/part_{number}",
                part.vertices,
                part.faces,
                color=part.color,
                flat_shading=True,
                opacity=opacity,
                position=part.place[:3],
                wxyz=part.place[3:],
                cast_shadow=opacity is None,
                receive_shadow=opacity is None,
            )
        self._places = SentRows(bodies, "position", LEAST_WAY, 3)
        self._turns = SentRows(bodies, "wxyz", LEAST_TURN, 4)

    def place(self, pose: BasePose, joints: Any) -> None:
        """Show it in a pose, with joint angles."""
        bodies = self._shape.placements(joints)
        self.frame.position, self.frame.wxyz = pose.position, wxyz(pose.orientation)
        self._places.send(bodies[:, :3])
        self._turns.send(bodies[:, 3:])
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
