"""What the arm and its tool are told, as a value and as a message."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sojourn_contract.values import JointState
from sojourn_flight.arm.state import ArmOutput
from sojourn_flight.arm.tasks.task import ToolCommand
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT


def _nothing() -> FloatArray:
    return np.zeros(0)


@dataclass(frozen=True, slots=True, eq=False)
class Command:
    """Of the joints of the arm, then of the actuator of its tool, if it has one; arrays (n,) in the order of `names`.

    Empty until the first measurement says where the arm is: a command of no joint.
    """

    names: tuple[str, ...] = ()
    positions: FloatArray = field(default_factory=_nothing)
    """[rad or m]"""
    velocities: FloatArray = field(default_factory=_nothing)
    """[rad/s or m/s]"""
    efforts: FloatArray = field(default_factory=_nothing)
    """[N m or N]"""

    def at_rest(self) -> "Command":
        """To hold where the arm was sent last."""
        return replace(self, velocities=np.zeros(len(self.names)))

    def message(self, stamp: int) -> JointState:
        """At a stamp [ns]."""
        return JointState(stamp, self.names, self.positions, self.velocities, self.efforts)


def command_of(joints: Sequence[str], output: ArmOutput, tool: ToolCommand | None) -> Command:
    """Command by the laws' output for the joints of the arm; `tool`: for its actuator, None where it has none."""
    if tool is None:
        return Command(tuple(joints), output.positions, output.velocities, output.efforts)
    rows = np.empty((3, len(joints) + 1))
    rows[0, :-1], rows[1, :-1], rows[2, :-1] = output.positions, output.velocities, output.efforts
    rows[:, -1] = tool.position, tool.rate, tool.effort
    return Command((*joints, TOOL_JOINT), rows[0], rows[1], rows[2])
