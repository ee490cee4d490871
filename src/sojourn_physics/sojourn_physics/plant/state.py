"""State, command and energy account of the plant.

All of them are plain values: copy one and you have a branch.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network_state import NetworkOutput, NetworkState
from sojourn_physics.actuators.joint_drive import ANGLE, TWIST
from sojourn_physics.contact.tables import SupportStates
from sojourn_physics.plant.flight import STANDING, Flight
from sojourn_physics.plant.heat import PlantHeatState
from sojourn_physics.plant.tools.tool_state import ToolState
from sojourn_physics.terrain.memory import GroundMemory


@dataclass(frozen=True, slots=True)
class EnergyAccount:
    """Energies since the start of the run [J].

    electrical in = work on the machine + winding heat; work = change of kinetic and potential energy +
    friction heat + stop heat + work done on the soil and on the air.
    """

    electrical: float = 0.0
    """Net, at the motors' terminals."""
    winding_heat: float = 0.0
    friction_heat: float = 0.0
    """Of gears, bearings, dampers, brakes and drives of other kinds, what is stored in the deflection of gears and
    bearings included."""
    stop_heat: float = 0.0
    soil_work: float = 0.0
    """Into the ground, what is stored in it included."""
    air_work: float = 0.0
    """Into the air; negative where a wind drives the machine."""
    mechanical: float = 0.0
    """Kinetic and potential energy of the machine, its springs and what drives of other kinds store included."""

    def balance_error(self, start: "EnergyAccount") -> float:
        """Energy that is missing since `start`, as a fraction of the largest of its terms [-]."""
        terms: list[float] = [getattr(self, name) - getattr(start, name) for name in self.__dataclass_fields__]
        missing = terms[0] - sum(terms[1:])
        return abs(missing) / max(*(abs(term) for term in terms), 1e-12)


@dataclass(frozen=True, slots=True)
class PlantState:
    """Everything that changes.

    Shapes: nq, nv of the multibody; joints are those with one degree of freedom, in the model's order.
    """

    tick: int
    """Control periods since the start of the run."""
    configuration: FloatArray
    """(nq,): base position in map [m], base quaternion x y z w, joints."""
    velocity: FloatArray
    """(nv,): base velocity in base_link [m/s], [rad/s], joint rates [rad/s]."""
    joints: FloatArray
    """(STATE_ROWS, joints): angle, not wrapped [rad]; servo integral; friction deflection [rad]; see `joint_drive`."""
    supports: SupportStates
    """What each kind of support remembers of its contact with the ground."""
    ground: GroundMemory
    """Ruts, see `terrain/memory`."""
    power: NetworkState
    """Stores, sources and buses."""
    energy: EnergyAccount = field(default_factory=EnergyAccount)
    rolled_over: bool = False
    """Has been tilted beyond the machine's limit since the start."""
    off_terrain: bool = False
    """A contact is, or has been, beyond the edge of the map."""
    tool: ToolState | None = None
    """Of the tool at the arm's end; None where there is none."""
    flight: Flight = STANDING
    """Off the ground."""
    conditions: FloatArray | None = None
    """(CONDITION_ROWS, drives): heat and brakes, see `drive_condition`; None where no drive names them. Not written."""

    heat: PlantHeatState | None = None
    """Of a machine whose heat is known."""
    outside: tuple[Any, ...] = ()
    """Of the drives whose law is their own, in the model's order, see `outside_drives`."""

    @property
    def motor_angles(self) -> FloatArray:
        """(joints,): of each motor over its gear [rad]; the joint's own where the gear has no play. What a servo whose
        encoder is on the motor is told to hold.
        """
        return np.asarray(self.joints[ANGLE] + self.joints[TWIST])

    def copy(self) -> "PlantState":
        """A branch that shares no array with this state, but for the ground's tiles, which nobody writes."""
        return replace(
            self,
            configuration=self.configuration.copy(),
            velocity=self.velocity.copy(),
            joints=self.joints.copy(),
            supports=self.supports.copy(),
        )


@dataclass(frozen=True, slots=True)
class PlantCommand:
    """What the machine is told for one control period.

    Args:
        reference: (3, joints): position [rad], rate [rad/s], feed-forward torque [N m] of each joint.
        load_fractions: (loads,) 0 off to 1 on; a motor load's current is limited to that fraction.
        motor_health: (joints,) part of its current that each motor can take, 0 dead to 1; None: all are well.
        tool: (3,) position, rate, effort of the tool's actuator; None: it stays where it is.
    """

    reference: FloatArray
    load_fractions: FloatArray
    motor_health: FloatArray | None = None
    tool: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class PlantOutput:
    """What can be seen of the period that has passed, beyond the state."""

    contacts: FloatArray
    """(supports, REPORT_COLUMNS): columns of `ReportColumn`, in the order of the machine's supports."""
    efforts: FloatArray
    """(joints,) torque at each joint, gear friction included [N m]."""
    currents: FloatArray
    """(joints,) motor current [A]."""
    power: NetworkOutput
    """What stores, sources and loads gave and got."""
    spread: FloatArray
    """(nv,) root mean square of what the velocity was in the period less what it is at its end, [m/s], [rad/s]."""
    wrist_wrench: FloatArray | None = None
    """(6,) force [N] and moment [N m] on the wrist's sensor in its own frame; None for a machine without one."""


def zeros_command(joints: int, loads: int) -> PlantCommand:
    """All joints commanded to zero and all loads on."""
    return PlantCommand(np.zeros((3, joints)), np.ones(loads))
