"""A scoop with a lid: soil that it cuts, carries, pushes ahead and lets fall.

The edge of the cut follows the tool's end. It lags at first, as the end has its lead of the ground that it meets
(`pad_on_soil`): with the way D on which it is dragged and the lead L it is at

    x_cut = x - (1 - |D|) L D/|D|

from where the end was when it began to be dragged. What it passes over is taken from the ground (`terrain.earthwork`):
into the scoop while its lid is open and as long as it holds more; the rest is pushed ahead, and its weight W = m g is a
surcharge on the wedge that the blade lifts (McKyes 1985; `soil.digging.cut_coefficients`). Soil keeps the density that
it had in the ground.

When the end leaves the ground what was pushed stays there as a heap, and what is in a scoop whose lid is open falls
out, onto the ground below. Assumptions: soil falls straight down; it does not stick; pressing alone, without a drag,
takes nothing away; rock is not cut. Volumes below `DUST` stay where they are.
"""

import math
from dataclasses import replace

import numpy as np

from sojourn_machine.contact_report import PLACE, ReportColumn
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import ScoopToolParams
from sojourn_physics.contact.pad_on_soil import lead_length
from sojourn_physics.plant.tools.tool_state import ScoopState, Soil, ToolEnergy, ToolState, ToolSurroundings
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.terrain.earthwork import cut, heap
from sojourn_physics.terrain.height_field import sample_soil

DUST = 1e-9
"""A volume that is not worth a heap [m3]."""
LEAST_DRAG = 0.05
"""|D| below which a tool is not dragged in any direction."""


class Scoop:
    """The law of one scoop.

    Args:
        params: of it. cuts: for each soil whether it can be cut.
    """

    def __init__(self, params: ScoopToolParams, cuts: tuple[bool, ...]) -> None:
        self.params = params
        self._cuts = cuts

    def first(self) -> ToolState:
        """Shut and empty."""
        return ToolState(ScoopState())

    def idle(self, state: ToolState, reference: FloatArray, touches: bool) -> bool:
        """See `ToolLaw`."""
        own = state.own
        if touches or state.rate != 0.0 or not isinstance(own, ScoopState) or own.front is not None:
            return False
        full = own.carried.volume > DUST and state.position > 0.5 * self.params.lid.opening
        return not full and min(max(float(reference[0]), 0.0), self.params.lid.opening) == state.position

    def advance(self, state: ToolState, around: ToolSurroundings) -> tuple[ToolState, ToolEnergy]:
        """State at the end of a period, and the energy that it took."""
        own = state.own
        if not isinstance(own, ScoopState):
            raise InvalidValueError("state of the scoop", type(own).__name__, "ScoopState")
        touches = around.report[ReportColumn.SINKAGE] > 0.0
        lid = self._lid(state, around)
        open_ = lid > 0.5 * self.params.lid.opening
        moved = lid != state.position
        own = self._cut(own, around, open_) if touches else self._leave(own, around, open_)
        energy = self.params.lid.power * around.dt if moved else 0.0
        after = replace(
            state,
            own=own,
            position=lid,
            rate=(lid - state.position) / around.dt,
            payload=own.carried.mass,
            pile=own.pushed.mass * around.gravity,
        )
        return after, ToolEnergy(electrical=energy, friction_heat=energy)

    def _lid(self, state: ToolState, around: ToolSurroundings) -> float:
        most = self.params.lid.rate * around.dt if around.supply > 0.0 else 0.0
        wanted = min(max(float(around.reference[0]), 0.0), self.params.lid.opening)
        return state.position + min(max(wanted - state.position, -most), most)

    def _cut(self, own: ScoopState, around: ToolSurroundings, open_: bool) -> ScoopState:
        """The end is in the ground."""
        soil, place = int(around.report[ReportColumn.SOIL]), around.report[PLACE]
        drag = math.hypot(around.drag[0], around.drag[1])
        if drag < LEAST_DRAG or not self._cuts[soil] or around.board.place[2] <= 0.0:
            return own
        if own.front is None:
            return replace(own, front=(float(place[0]), float(place[1]), float(place[2])))
        along = around.drag / drag
        lead = lead_length(self.params.radius, float(around.board.place[2]))
        edge = place.copy()
        edge[:2] -= (1.0 - drag) * lead * along
        begin = np.array(own.front)
        if float((edge - begin)[:2] @ along) <= 0.0:
            return own
        volume = cut(around.board, around.terrain, around.grid, begin, edge, self.params.cut.width)
        got = Soil(volume, volume * float(around.soils[soil, SoilColumn.DENSITY]))
        inside = min(volume, max(self.params.capacity - own.carried.volume, 0.0)) if open_ else 0.0
        kept = got.part(inside)
        beyond = place[:2] + drag * lead * along
        return replace(
            own,
            carried=own.carried.plus(kept),
            pushed=own.pushed.plus(got.less(kept)),
            front=(float(edge[0]), float(edge[1]), float(edge[2])),
            ahead=(float(beyond[0]), float(beyond[1])),
            taken=own.taken + volume,
            has_worked=True,
        )

    def _leave(self, own: ScoopState, around: ToolSurroundings, open_: bool) -> ScoopState:
        """The end is out of the ground: what it pushed stays there, what it cannot keep falls out."""
        pushed = own.pushed.less(fallen(own.pushed, own.ahead, around)) if own.pushed.volume > DUST else own.pushed
        carried = own.carried
        if open_ and carried.volume > DUST:
            x, y, _ = around.report[PLACE].tolist()
            carried = carried.less(fallen(carried, (x, y), around))
        put = own.carried.volume - carried.volume + own.pushed.volume - pushed.volume
        return replace(own, carried=carried, pushed=pushed, front=None, taken=own.taken - put)


def fallen(soil: Soil, place: tuple[float, float], around: ToolSurroundings) -> Soil:
    """Let soil fall onto a place (x, y) in map: what has got there. It all does, but for the rounding of the ground."""
    grid, terrain = around.grid, around.terrain
    number = sample_soil(terrain.soil_index, grid[0], grid[1], grid[2], place[0], place[1])
    slope = float(around.soils[number, SoilColumn.TAN_PHI])
    return soil.part(heap(around.board, terrain, grid, place[0], place[1], soil.volume, slope))
