"""The commands that the plant holds: the last good one of each topic, until it is too old."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_contract import stamps
from sojourn_contract.checks import check_names, check_ranges
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import status_values
from sojourn_contract.switches import check_switches, fraction_of
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT
from sojourn_physics.actuators import joint_drive
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, zeros_command

POSITION, RATE, EFFORT = 0, 1, 2
JOINT_TOPICS = ("/drive_command", "/arm_command")
SWITCHES = "/power/switches"
COMMANDS = (*JOINT_TOPICS, SWITCHES)


@dataclass(frozen=True, slots=True)
class HeldCommands:
    """What is held. Arrays are not written to."""

    reference: FloatArray
    """(3, joints), the tool's actuator after them: position [rad], rate [rad/s], effort [N m]."""
    fractions: FloatArray
    """(loads,) 0 off to 1 on."""
    stamps: Mapping[str, int] = field(default_factory=dict)
    """Of the last good command of each topic [ns]."""
    joints: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """Columns that a topic has ever named."""

    def lost(self, now: int) -> list[str]:
        """Topics whose command is too old at simulation time `now` [ns]."""
        return [
            name for name, stamp in self.stamps.items() if now - stamp > int(topic(name).max_age_s * stamps.NANOSECONDS)
        ]


class NamedJoints(NamedTuple):
    """The joints that a command names, in its order."""

    names: tuple[str, ...]
    columns: tuple[int, ...]
    places: NDArray[np.intp]
    """The same, to set numbers by."""
    needed: tuple[tuple[str, str], ...]
    """Part of the message that must not be empty, and the joints for which, in words."""


class Commands:
    """Takes commands for a machine. One that is older than its row allows is lost: its joints stop where they are told.

    Args:
        model: the machine.
    """

    def __init__(self, model: PlantModel) -> None:
        kinds = dict(zip(model.joints.names, model.joints.kinds.tolist(), strict=True))
        self._index = {name: i for name, i in model.joint_index.items() if kinds[name] != joint_drive.PASSIVE}
        self._by_position = {name for name, kind in kinds.items() if kind == joint_drive.POSITION}
        self._tool: int | None = None
        """Column of the tool's actuator, after those of the joints."""
        if model.tool is not None:
            self._index[TOOL_JOINT] = self._tool = len(kinds)
            self._by_position |= {TOOL_JOINT} if model.tool.params.joint.held else set()
        self._loads = {load.name: place for place, load in enumerate(model.loads)}
        self._joint_count = len(kinds)
        self._named: dict[str, NamedJoints] = {}
        """Of the last command of each topic: looked up again only when the names change."""

    def holding(self, angles: FloatArray) -> HeldCommands:
        """Hold these joint angles, (joints,) [rad], until a command comes."""
        command = zeros_command(self._joint_count + (self._tool is not None), len(self._loads))
        command.reference[POSITION, : len(angles)] = angles
        return HeldCommands(command.reference, command.load_fractions)

    def check(self, row: Topic, message: Any) -> None:
        """Raise RefusedMessageError for a command that the machine cannot follow.

        That is a joint without a motor, a joint held by position without a position, a number out of the
        row's range; an unknown load or a limit outside 0 to 1.
        """
        if row.name == SWITCHES:
            check_switches(row.name, status_values(message), self._loads)
            return
        named = self._joints_of(row.name, message.names)
        check_ranges(row, message)
        for part, joints in named.needed:
            if not len(getattr(message, part)):
                raise RefusedMessageError(row.name, part, "0 numbers", f"one for {joints}")

    def take(self, held: HeldCommands, inputs: Mapping[str, Any]) -> HeldCommands:
        """Keep the commands among the inputs; None (refused) leaves the last good one."""
        reference, sent, joints = held.reference.copy(), dict(held.stamps), dict(held.joints)
        for name in JOINT_TOPICS:
            message = inputs.get(name)
            if message is None:
                continue
            _, columns, places, _ = self._joints_of(name, message.names)
            if joints.get(name) != columns:
                left_out = [column for column in joints.get(name, ()) if column not in columns]
                reference[RATE, left_out] = 0.0  # a joint that is no longer named stops
                joints[name] = (*columns, *left_out)
            sent[name] = message.stamp
            for row, values in zip(reference, (message.position, message.velocity, message.effort), strict=True):
                row[places] = values if len(values) else 0.0
        fractions, switches = held.fractions, inputs.get(SWITCHES)
        if switches is not None:
            fractions = fractions.copy()
            sent[SWITCHES] = switches.stamp
            for load, text in status_values(switches).items():
                fractions[self._loads[load]] = fraction_of(text)
        return replace(held, reference=reference, fractions=fractions, stamps=sent, joints=joints)

    def at(self, held: HeldCommands, now: int) -> PlantCommand:
        """Command at simulation time `now` [ns]: too old ones stop their joints.

        Wheels get rate zero, and joints with a position hold it: for both the rate is zero and the position
        stays. Switches stay as they were: to cut the power of a rover whose manager is silent would be worse.
        """
        reference = held.reference.copy()
        for name in held.lost(now):
            reference[RATE, list(held.joints.get(name, ()))] = 0.0
        # A position is the reference for the end of the period that it is stamped with;
        # between commands it moves on.
        tool = None if self._tool is None else reference[:, self._tool].copy()
        return PlantCommand(np.ascontiguousarray(reference[:, : self._tool]), held.fractions.copy(), tool=tool)

    def _joints_of(self, topic: str, names: tuple[str, ...]) -> NamedJoints:
        """Raises RefusedMessageError for a joint that has no motor or is named twice."""
        known = self._named.get(topic)
        if known is None or known.names != names:
            check_names(topic, names, self._index)
            parts = (("position", self._by_position), ("velocity", self._index.keys() - self._by_position))
            found = [(part, needed.intersection(names)) for part, needed in parts]
            columns = [self._index[name] for name in names]
            needed = tuple((part, ", ".join(sorted(joints))) for part, joints in found if joints)
            known = self._named[topic] = NamedJoints(names, tuple(columns), np.array(columns, dtype=np.intp), needed)
        return known
