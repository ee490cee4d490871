"""A parallel gripper: fingers that close with a speed and a force, and objects that it holds, or that slip.

The opening follows its command with the closing speed. An object is between the fingers where its centre is no further
behind the tip than they are long, and no further aside than half of what the opening leaves over its width. Fingers
that meet it press with a force that rises with the stiffness k and the way by which they would close on, to what the
command allows.

The object stays while the fingers' friction carries its weight and inertia, F = m (g - a), with the part F_u along the
line between the fingers and F_t across it. The fingers' forces differ by n_1 - n_2 = F_u; each carries half of F_t, or
the object would turn, so that the weaker one asks for μ n_2 >= F_t/2 and the stronger one needs

    n_1 >= F_t/(2 μ) + F_u

This is the round cone of `arm.grasp` for two opposite fingers and a load through their middle (Murray, Li & Sastry
1994, ch. 5). An object that needs more slips out at once and falls to the ground below; a is that of the tip, from its
places at the ends of three periods.

Assumptions: objects are small and rigid, centre themselves between the fingers and hang on the arm from the moment when
they are grasped; the fingers do not push those that they miss, and nothing else meets them.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sojourn_machine.contact_report import PLACE
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import GripperToolParams, ObjectParams
from sojourn_physics.plant.tools.tool_state import GripperState, ToolEnergy, ToolState, ToolSurroundings
from sojourn_physics.terrain.height_field import HeightField

LIFTED = 1e-3
"""Height over where it was taken from which an object hangs on the fingers alone [m]."""


def needed_grasp(load: FloatArray, across: FloatArray, friction: float) -> float:
    """Force of the stronger of two opposite fingers that holds a load (3,) through their middle [N].

    Args:
        across: unit vector from finger to finger (3,). friction: of the fingers.
    """
    along = abs(float(load @ across))
    beside = math.sqrt(max(float(load @ load) - along * along, 0.0))
    return 0.5 * beside / friction + along


class Gripper:
    """The law of one gripper.

    Args:
        params: of it. objects: that lie about. terrain: on which they lie.

    Raises:
        OutsideTerrainError: an object beside the ground.
    """

    def __init__(self, params: GripperToolParams, objects: Sequence[ObjectParams], terrain: HeightField) -> None:
        self.params = params
        self._objects = tuple(objects)
        self._terrain = terrain
        self._places = tuple(self._on_ground(thing, thing.x, thing.y) for thing in objects)

    def first(self) -> ToolState:
        """Closed, every object in its place."""
        return ToolState(GripperState(self._places))

    def idle(self, state: ToolState, reference: FloatArray, touches: bool) -> bool:
        """See `ToolLaw`."""
        own = state.own
        if not isinstance(own, GripperState) or own.held is not None or state.rate != 0.0:
            return False
        return min(max(float(reference[0]), 0.0), self.params.stroke) == state.position

    def advance(self, state: ToolState, around: ToolSurroundings) -> tuple[ToolState, ToolEnergy]:
        """State at the end of a period, and the energy that it took."""
        own = state.own
        if not isinstance(own, GripperState):
            raise InvalidValueError("state of the gripper", type(own).__name__, "GripperState")
        wanted = min(max(float(around.reference[0]), 0.0), self.params.stroke)
        step = self.params.speed * around.dt if around.supply > 0.0 else 0.0
        moved = min(max(wanted - state.position, -step), step)
        limit = float(around.reference[2]) or self.params.force
        limit = min(max(limit, 0.0), self.params.force)
        opening, grasp, working = state.position + moved, 0.0, moved != 0.0
        held = own.held if own.held is not None else self._between(own, around, state.position, opening)
        if held is not None:
            width = self._objects[held].width
            closing = self.params.stiffness * step
            grasp = min(own.grasp + closing, limit) if wanted < width else own.grasp - closing
            working = grasp != own.grasp
            opening = width if grasp > 0.0 else opening
        slips = own.slips
        own = self._carry(own, held if grasp > 0.0 else None, grasp, around)
        if own.slips > slips:
            if wanted < opening:
                opening -= step  # the fingers close behind it
            else:
                own = replace(own, slips=slips)  # they were told to open
        energy = self.params.power * around.dt if working and step > 0.0 else 0.0
        after = replace(
            state,
            own=own,
            position=opening,
            rate=(opening - state.position) / around.dt,
            effort=own.grasp,
            payload=0.0 if own.held is None else self._objects[own.held].mass,
        )
        return after, ToolEnergy(electrical=energy, friction_heat=energy)

    def _between(self, own: GripperState, around: ToolSurroundings, before: float, after: float) -> int | None:
        """Number of the object on which the fingers close in this period."""
        for number, (thing, place) in enumerate(zip(self._objects, own.places, strict=True)):
            if not after <= thing.width <= before:
                continue
            offset = np.array(place) - around.report[PLACE]
            behind = -float(offset @ around.axis)
            aside = math.sqrt(max(float(offset @ offset) - behind * behind, 0.0))
            if -0.25 * thing.height <= behind <= self.params.finger_length and aside <= 0.5 * (
                self.params.stroke - thing.width
            ):
                return number
        return None

    def _carry(self, own: GripperState, held: int | None, grasp: float, around: ToolSurroundings) -> GripperState:
        """Hold an object, or let it go."""
        if held is None:
            own = own if own.held is None else self._fallen(own, own.held, around)
            return replace(own, held=None, grasp=0.0, needed=0.0, before=(), has_worked=True)
        x, y, z = around.report[PLACE].tolist()
        tip = (x, y, z)
        acceleration = np.zeros(3)
        if len(own.before) == 2:
            acceleration = (np.array(tip) - 2.0 * np.array(own.before[1]) + np.array(own.before[0])) / around.dt**2
        thing = self._objects[held]
        load = -thing.mass * (acceleration - around.falling)
        needed = needed_grasp(load, around.across, thing.friction)
        own = replace(
            own,
            held=held,
            grasp=grasp,
            needed=needed,
            taken_at=tip[2] if own.held is None else own.taken_at,
            before=(*own.before[-1:], tip),
            has_worked=True,
        )
        if needed > grasp and tip[2] > own.taken_at + LIFTED:  # on the ground it need not be carried
            own = self._fallen(own, held, around)
            return replace(own, held=None, grasp=0.0, before=(), slips=own.slips + 1)
        return own

    def _fallen(self, own: GripperState, number: int, around: ToolSurroundings) -> GripperState:
        """The object lies on the ground under the tip."""
        x, y, _ = around.report[PLACE].tolist()
        place = self._on_ground(self._objects[number], x, y)
        return replace(own, places=(*own.places[:number], place, *own.places[number + 1 :]))

    def _on_ground(self, thing: ObjectParams, x: float, y: float) -> tuple[float, float, float]:
        return x, y, self._terrain.height(x, y) + 0.5 * thing.height
