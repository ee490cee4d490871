"""The tool on the machine: its law, its end in the table of contacts, its load on the arm and on the bus.

What a tool does to the machine acts from the next period on: numbers in the row of its pad (see `pad_on_soil`), and a
mass at its end, which is added to the inertia of the link that carries it. The work that it takes to give that mass the
energy that it has on the arm is booked as taken from the ground.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
import pinocchio as pin

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import (
    DrillToolParams,
    GripperToolParams,
    ObjectParams,
    ScoopToolParams,
    ToolParams,
)
from sojourn_physics.contact.pad_on_soil import DRAG_X, DRAG_Y, TOOL_MOMENT, ToolColumn
from sojourn_physics.plant.tools.drill import DrillLaw
from sojourn_physics.plant.tools.gripper import Gripper
from sojourn_physics.plant.tools.scoop import Scoop
from sojourn_physics.plant.tools.tool_state import ToolEnergy, ToolState, ToolSurroundings
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.terrain.height_field import HeightField

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantModel

NO_ENERGY = ToolEnergy()
GYRATION = 0.02
"""Radius of gyration of what hangs on a tool [m]."""


class ToolLaw(Protocol):
    """What a kind of tool does."""

    def first(self) -> ToolState:
        """At the start of a run."""

    def idle(self, state: ToolState, reference: FloatArray, touches: bool) -> bool:
        """Whether nothing happens in a period: the usual case, which must be cheap."""

    def advance(self, state: ToolState, around: ToolSurroundings) -> tuple[ToolState, ToolEnergy]:
        """One period."""


class MountedTool:
    """A tool on a plant's model, whose working memory it writes.

    Args:
        model: the plant, with its supports. soils: of the ground, in the order of the kernels.
        objects: that may be picked.

    Raises:
        InvalidValueError: a load that the bus does not have, a soil that lacks what the tool needs.
    """

    def __init__(
        self,
        model: "PlantModel",
        params: ToolParams,
        soils: Sequence[SoilParams],
        objects: Sequence[ObjectParams] = (),
    ) -> None:
        loads = [load.name for load in model.loads]
        if params.load not in loads:
            raise InvalidValueError("load of the tool", params.load, "one of " + ", ".join(loads))
        self.params = params
        pads = model.supports.tables.pads
        self._pad = [pad.name for pad in model.machine.pads].index(params.pad)
        self._contact = model.supports.names.index(params.pad)
        self.load = loads.index(params.load)
        self._law = _law_of(params, soils, objects, model.terrain)
        self._row = pads.tools[self._pad]
        self._multibody = model.multibody
        self._joint = int(pads.carried.bodies[self._pad])
        self._bare = model.multibody.inertias[self._joint].copy()
        pad = next(pad for pad in model.machine.pads if pad.name == params.pad)
        frame = model.multibody.frames[model.multibody.getFrameId(pad.link)]
        self._axis = np.array(frame.placement.rotation[:, 2])
        """Out of the tool, in the frame of the joint that carries it."""
        self._across = np.array(frame.placement.rotation[:, 1])
        """From finger to finger of a gripper."""
        self._centre: FloatArray = pads.carried.offsets[self._pad] - params.load_distance * self._axis
        self._hangs = 0.0

    def first(self) -> ToolState:
        """At the start of a run."""
        return self._law.first()

    def prepare(self, state: ToolState) -> None:
        """Before a period: the model as this state has it."""
        row = self._row
        row[ToolColumn.TAKEN] = state.hole
        row[ToolColumn.PILE] = state.pile
        row[TOOL_MOMENT] = state.moment
        if state.payload != self._hangs:
            self._hang(state.payload)

    def advance(
        self,
        model: "PlantModel",
        state: ToolState,
        pads: FloatArray,
        reference: FloatArray | None,
        supply: float,
        voltage: float,
    ) -> tuple[ToolState, ToolEnergy]:
        """After a period: what the tool has done in it.

        Args:
            pads: states of the pads. reference: of the actuator (3,), None: it stays where it is.
            supply: part of its power that it can have. voltage: of the bus [V].
        """
        report = model.report[self._contact]
        wanted = np.array([state.position, 0.0, 0.0]) if reference is None else reference
        if self._law.idle(state, wanted, bool(report[ReportColumn.SINKAGE] > 0.0)):
            return state, NO_ENERGY
        to_map = model.placements[self._joint, :9].reshape(3, 3)
        around = ToolSurroundings(
            board=model.memory,
            terrain=model.terrain,
            grid=model.grid,
            soils=model.soils,
            gravity=model.gravity,
            falling=np.array(model.multibody.gravity.linear),
            dt=model.simulation.control_period,
            reference=wanted,
            supply=supply,
            report=report,
            drag=pads[self._pad, DRAG_X : DRAG_Y + 1],
            axis=self._axis @ to_map,
            across=self._across @ to_map,
            voltage=voltage,
        )
        return self._law.advance(state, around)

    def _hang(self, mass: float) -> None:
        inertia = self._bare
        if mass > 0.0:
            inertia = inertia + pin.Inertia(mass, self._centre, mass * GYRATION**2 * np.eye(3))
        self._multibody.inertias[self._joint] = inertia
        self._hangs = mass


def _law_of(
    params: ToolParams, soils: Sequence[SoilParams], objects: Sequence[ObjectParams], terrain: HeightField
) -> ToolLaw:
    match params:
        case ScoopToolParams():
            return Scoop(params, tuple(soil.kind == "soil" for soil in soils))
        case DrillToolParams():
            return DrillLaw(params, list(soils))
        case GripperToolParams():
            return Gripper(params, objects, terrain)


def with_tool(machine: MachineParams, tool: ToolParams | None) -> MachineParams:
    """The machine with the end of a tool in place of the pad that it names.

    Raises:
        InvalidValueError: no such pad.
    """
    if tool is None:
        return machine
    names = [pad.name for pad in machine.pads]
    if tool.pad not in names:
        raise InvalidValueError("pad of the tool", tool.pad, "one of " + ", ".join(names))
    pads = tuple(tool.fit(pad) if pad.name == tool.pad else pad for pad in machine.pads)
    return machine.model_copy(update={"pads": pads})
