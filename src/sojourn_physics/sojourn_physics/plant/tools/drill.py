"""A rotary drill: thrust from the contact of its bit, torque and depth a turn from the ground, rate from its motor.

The bit is the pad at the tool's end: it presses on the bottom of its hole as the ground lets it (`pad_on_soil`), with
the thrust W along its axis. `soil.drilling` gives torque and depth for a turn (Detournay & Defourny 1992; Teale 1965),
`actuators.spindle` the rate. The hole grows by

    dh = d(W) ω dt/2π

so that an arm that presses on keeps its thrust, and one that stops finds it falling. The ground's moment on the bit,
-T about the axis, acts on the arm; the work T ω goes into the ground, of which the bit keeps a share as heat
(`BitHeatParams`, one lump: Zacny & Cooper 2007, J. Geophys. Res. 112:E03003, for why this limits dry drilling).

A hole is as wide as the bit, and the bit meets its bottom as long as it is over its mouth. Assumptions: rotary only, no
percussion; chips are cleared, and are not found again on the ground; walls neither guide nor hold the bit.
"""

import math
from dataclasses import replace

from sojourn_machine.contact_report import FORCE, ReportColumn
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import DrillToolParams
from sojourn_physics.actuators.spindle import spindle_step
from sojourn_physics.plant.tools.tool_state import DrillState, Hole, ToolEnergy, ToolState, ToolSurroundings
from sojourn_physics.soil.drilling import Drilling, drill
from sojourn_physics.soil.params import SoilParams

COLD = 1e-3
"""Difference to the turret at which a bit has cooled down [K]."""
NO_DRILLING = Drilling(0.0, 0.0, math.inf)


class DrillLaw:
    """The law of one drill.

    Args:
        params: of it. soils: of the ground, in the order of the kernels.

    Raises:
        InvalidValueError: a soil that does not say how hard it is to drill.
    """

    def __init__(self, params: DrillToolParams, soils: list[SoilParams]) -> None:
        self.params = params
        self._energies: list[float] = []
        for soil in soils:
            if soil.specific_energy is None:
                raise InvalidValueError(f"specific_energy of {soil.name}", None, "a number [J/m3]: the drill needs it")
            self._energies.append(soil.specific_energy)

    def first(self) -> ToolState:
        """Cold and still."""
        return ToolState(DrillState(self.params.heat.ambient))

    def idle(self, state: ToolState, reference: FloatArray, touches: bool) -> bool:
        """See `ToolLaw`."""
        own = state.own
        still = not touches and reference[1] <= 0.0 and state.rate == 0.0 and state.effort == 0.0
        if not still or not isinstance(own, DrillState):
            return False
        return not own.holes and abs(own.temperature - self.params.heat.ambient) <= COLD

    def advance(self, state: ToolState, around: ToolSurroundings) -> tuple[ToolState, ToolEnergy]:
        """State at the end of a period, and the energy that it took."""
        own, report, axis = state.own, around.report, around.axis
        wanted = max(float(around.reference[1]), 0.0)
        if not isinstance(own, DrillState):
            raise InvalidValueError("state of the drill", type(own).__name__, "DrillState")
        place = float(report[ReportColumn.X]), float(report[ReportColumn.Y])
        touches, over = report[ReportColumn.SINKAGE] > 0.0, self._over(own, place)
        hole = 0.0 if over is None else own.holes[over].depth
        thrust, found = 0.0, NO_DRILLING
        if touches:
            thrust = max(-float(report[FORCE] @ axis), 0.0)
            found = drill(self.params.bit, self._energies[int(report[ReportColumn.SOIL])], thrust)
        turned = spindle_step(
            self.params.motor,
            self.params.gear,
            self.params.acceleration,
            state.rate,
            min(wanted, self.params.rate),
            found.torque,
            around.voltage,
            around.supply,
            around.dt,
        )
        angle = 0.5 * (state.rate + turned.rate) * around.dt
        gone = (
            min(found.depth_per_turn * angle / (2.0 * math.pi), float(report[ReportColumn.SINKAGE])) if touches else 0.0
        )
        turning = angle > 0.0
        torque = found.torque if turning or turned.stalled else 0.0
        work = turned.at_load * around.dt
        if gone > 0.0:
            sunk = gone * abs(float(axis[2]))
            hole += sunk
            holes = self._grown(own, over, Hole(*(place if over is None else own.holes[over][:2]), hole))
            area = math.pi * self.params.bit.radius**2
            own = replace(own, holes=holes, cuttings=own.cuttings + area * gone)
        own = replace(
            own,
            thrust=thrust,
            torque=torque,
            stalled=turned.stalled,
            temperature=self.params.heat.step(own.temperature, work / around.dt, around.dt),
            has_worked=True,
        )
        after = replace(
            state,
            own=own,
            position=state.position + angle,
            rate=turned.rate,
            effort=torque,
            hole=hole,
            moment=(-torque * float(axis[0]), -torque * float(axis[1]), -torque * float(axis[2])),
        )
        dt = around.dt
        return after, ToolEnergy(turned.electrical * dt, turned.winding_heat * dt, turned.friction_heat * dt, work)

    def _over(self, own: DrillState, place: tuple[float, float]) -> int | None:
        """Number of the hole over whose mouth the bit is, if it is over one."""
        for number, hole in enumerate(own.holes):
            if math.hypot(place[0] - hole.x, place[1] - hole.y) < self.params.bit.radius:
                return number
        return None

    @staticmethod
    def _grown(own: DrillState, number: int | None, hole: Hole) -> tuple[Hole, ...]:
        if number is None:
            return (*own.holes, hole)
        return (*own.holes[:number], hole, *own.holes[number + 1 :])
