"""Joints whose drives are not those of the kernels: their laws (`actuator`) are called at each physics step.

To the kernels such a joint is one without a motor. Its torque goes into the bias before the machine is solved, its
slope times the step onto the diagonal of the mass matrix; afterwards its power and heat are booked with those of the
others. A machine without such drives pays nothing for them, one with them two calls a drive and step.
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.actuators.actuator import Actuator, Drawn, JointMotion, JointOrder, Push
from sojourn_physics.actuators.joint_drive import (
    ANGLE,
    ELECTRICAL,
    FRICTION_HEAT,
    WANTED_EFFORT,
    WANTED_POSITION,
    WANTED_RATE,
)

if TYPE_CHECKING:
    from sojourn_physics.plant.kernels import PlantTables

States = tuple[Any, ...]
"""Of each of the drives."""


class DrivenJoint(NamedTuple):
    """A joint with its drive."""

    name: str
    row: int
    """In the tables of joints."""
    column: int
    """In the machine's velocity."""
    load: int
    actuator: Actuator[Any]


class OutsideDrives:
    """Of one machine.

    Args:
        joints: that they drive, in the order of their states.
    """

    def __init__(self, joints: Sequence[DrivenJoint]) -> None:
        self._joints = tuple(joints)
        self._pushed: list[tuple[JointOrder, Push]] = []
        """Of the step under way."""

    def __bool__(self) -> bool:
        return bool(self._joints)

    def first(self, angles: FloatArray) -> States:
        """At rest, at the angles of the machine's joints, (joints,) [rad]."""
        return tuple(joint.actuator.initial_state(float(angles[joint.row])) for joint in self._joints)

    def stored(self, states: States) -> float:
        """Energy that they hold [J]."""
        return math.fsum(joint.actuator.stored(state) for joint, state in zip(self._joints, states, strict=True))

    def push(self, tables: "PlantTables", states: States, step: int) -> None:
        """Put their torques into the equations of a step, from 0, which Pinocchio has set up.

        Raises:
            InvalidValueError: a torque or slope that is not finite, a slope below zero.
        """
        multibody, command, motion, dt = tables.multibody, tables.command, tables.motion, tables.dt
        rates, lead = motion.rates[step], (step + 1) * dt
        self._pushed.clear()
        for joint, state in zip(self._joints, states, strict=True):
            row, column = joint.row, joint.column
            rate = float(command.reference[WANTED_RATE, row])
            told = JointOrder(
                float(command.reference[WANTED_POSITION, row]) + rate * lead,
                rate,
                float(command.reference[WANTED_EFFORT, row]),
                float(command.limits[row]),
                float(command.bus_voltage[row]),
            )
            now = float(rates[column])
            push = joint.actuator.push(state, told, JointMotion(float(motion.joints[ANGLE, row]), now, now), dt)
            if not (all(map(math.isfinite, push)) and push.slope >= 0.0):
                raise InvalidValueError(f"push of the drive of {joint.name}", push, "finite, the slope at least 0")
            multibody.bias[column] -= push.torque
            multibody.mass_matrix[column, column] += dt * push.slope
            self._pushed.append((told, push))

    def settle(self, tables: "PlantTables", states: States, step: int) -> States:
        """Their states after a step that the kernels have solved; what they did is booked.

        Raises:
            InvalidValueError: a power, heat or current that is not finite.
        """
        motion, readings, sums, dt = tables.motion, tables.readings, tables.sums, tables.dt
        before, after = motion.rates[step], motion.rates[step + 1]
        new = []
        for joint, state, (told, push) in zip(self._joints, states, self._pushed, strict=True):
            row, old_rate, rate = joint.row, float(before[joint.column]), float(after[joint.column])
            moved = JointMotion(float(motion.joints[ANGLE, row]), old_rate, rate)
            torque = push.torque - push.slope * (rate - old_rate)
            settled, drawn = joint.actuator.settle(state, told, moved, torque, dt)
            _check(joint.name, drawn)
            new.append(settled)
            readings.efforts[row] += torque
            readings.currents[row] = drawn.current
            sums.load_energy[joint.load] += drawn.power * dt
            readings.energy[ELECTRICAL] += drawn.power * dt
            readings.energy[FRICTION_HEAT] += drawn.heat * dt
        return tuple(new)


def _check(name: str, drawn: Drawn) -> None:
    if not all(map(math.isfinite, drawn)):
        raise InvalidValueError(f"power of the drive of {name}", drawn, "finite numbers")
