"""The commands that the plant holds: the last good one of each topic, until it is too old."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.checks import check_names, check_ranges
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import status_values
from sojourn_contract.messages import joint_columns, numbers
from sojourn_contract.switches import check_switches, fraction_of
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_mechanics.actuators import joint_drive
from sojourn_mechanics.arm.tool_params import TOOL_JOINT
from sojourn_mechanics.plant.model import PlantModel
from sojourn_mechanics.plant.state import PlantCommand, zeros_command

POSITION, RATE, EFFORT = 0, 1, 2
JOINT_TOPICS = ("/wheel_command", "/arm_command")
SWITCHES = "/power/switches"
COMMANDS = (*JOINT_TOPICS, SWITCHES)


class CommandBuffer:
    """Last good command of each topic. A command older than its row allows is lost: its joints stop where
    they are told.
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
        self._loads = {load.name: place for place, load in enumerate(model.bus.loads)}
        command = zeros_command(len(kinds) + (self._tool is not None), len(model.bus.loads))
        self._reference = command.reference
        self._fractions = command.load_fractions
        self._stamps: dict[str, int] = {}
        self._joints: dict[str, list[int]] = {}
        self.lost: list[str] = []
        """Topics whose command is too old."""

    def hold(self, angles: Any) -> None:
        """Hold these joint angles, (joints,) [rad], until a command comes."""
        self._reference[POSITION, : len(angles)] = angles

    def check(self, row: Topic, message: Any) -> None:
        """Raise RefusedMessageError for a command that the machine cannot follow.

        That is a joint without a motor, a joint held by position without a position, a number out of the
        row's range; an unknown load or a limit outside 0 to 1.
        """
        if row.name == SWITCHES:
            check_switches(row.name, status_values(message), self._loads)
            return
        check_names(row.name, message.name, self._index)
        check_ranges(row, message)
        for field, needed in (
            ("position", self._by_position),
            ("velocity", self._index.keys() - self._by_position),
        ):
            named = needed.intersection(message.name)
            if named and not len(getattr(message, field)):
                raise RefusedMessageError(row.name, field, "0 numbers", f"one for {', '.join(sorted(named))}")

    def take(self, inputs: Mapping[str, Any]) -> None:
        """Keep the commands among the inputs; None (refused) leaves the last good one."""
        for name in JOINT_TOPICS:
            message = inputs.get(name)
            if message is None:
                continue
            columns = joint_columns(message, self._index)
            left_out = [column for column in self._joints.get(name, ()) if column not in columns]
            self._reference[RATE, left_out] = 0.0  # a joint that is no longer named stops
            self._joints[name] = columns + left_out
            self._stamps[name] = stamps.from_message(message.header.stamp)
            for row, values in (
                (POSITION, message.position),
                (RATE, message.velocity),
                (EFFORT, message.effort),
            ):
                self._reference[row, columns] = numbers(values) if len(values) else 0.0
        switches = inputs.get(SWITCHES)
        if switches is not None:
            self._stamps[SWITCHES] = stamps.from_message(switches.header.stamp)
            for load, text in status_values(switches).items():
                self._fractions[self._loads[load]] = fraction_of(text)

    def at(self, now: int) -> PlantCommand:
        """Command at simulation time `now` [ns]: too old ones stop their joints.

        Wheels get rate zero, and joints with a position hold it: for both the rate is zero and the position
        stays. Switches stay as they were: to cut the power of a rover whose manager is silent would be worse.
        """
        self.lost = [
            name
            for name, stamp in self._stamps.items()
            if now - stamp > int(topic(name).max_age_s * stamps.NANOSECONDS)
        ]
        reference = self._reference.copy()
        for name in self.lost:
            reference[RATE, self._joints.get(name, [])] = 0.0
        # A position is the reference for the end of the period that it is stamped with;
        # between commands it moves on.
        tool = None if self._tool is None else reference[:, self._tool].copy()
        return PlantCommand(np.ascontiguousarray(reference[:, : self._tool]), np.array(self._fractions), tool=tool)
