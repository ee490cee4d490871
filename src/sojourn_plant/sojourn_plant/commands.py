"""The commands that the plant holds: the last good one of each topic, until it is too old."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import status_values
from sojourn_contract.messages import joint_columns, numbers
from sojourn_contract.topics import Topic, topic
from sojourn_mechanics.plant.model import PlantModel
from sojourn_mechanics.plant.state import PlantCommand, zeros_command

POSITION, RATE, EFFORT = 0, 1, 2
JOINT_TOPICS = ("/wheel_command", "/arm_command")
SWITCHES = "/power/switches"


class CommandBuffer:
    """Last good command of each topic. A command older than its row allows is lost: its joints stop where they are told."""

    def __init__(self, model: PlantModel) -> None:
        self._index = model.joint_index
        self._loads = {load.name: place for place, load in enumerate(model.bus.loads)}
        command = zeros_command(len(model.joints.names), len(model.bus.loads))
        self._reference = command.reference
        self._fractions = command.load_fractions
        self._stamps: dict[str, int] = {}
        self._joints: dict[str, list[int]] = {}
        self.lost: list[str] = []
        """Topics whose command is too old."""

    def hold(self, angles: Any) -> None:
        """Hold these joint angles, (joints,) [rad], until a command comes."""
        self._reference[POSITION] = angles

    def check_order(self, row: Topic, stamp: int, now: int) -> None:
        """Raise RefusedMessageError for a stamp from the past: before the last command, or too old at simulation time `now` [ns]."""
        oldest = max(self._stamps.get(row.name, 0), now - int(row.max_age_s * stamps.NANOSECONDS))
        if stamp < oldest:
            raise RefusedMessageError(
                row.name, "header.stamp", f"{stamps.seconds(stamp):.3f} s", f"{stamps.seconds(oldest):.3f} s or later"
            )

    def check_switches(self, name: str, values: dict[str, str]) -> None:
        """Raise RefusedMessageError for an unknown load or a limit outside 0 to 1."""
        for load, text in values.items():
            if load not in self._loads:
                raise RefusedMessageError(name, "status.values.key", load, "one of " + ", ".join(self._loads))
            if fraction_of(text) is None:
                raise RefusedMessageError(name, f"status.values.{load}", text, "on, off, or a fraction from 0 to 1")

    def take(self, inputs: Mapping[str, Any]) -> None:
        """Keep the commands among the inputs; None (refused) leaves the last good one."""
        for name in JOINT_TOPICS:
            message = inputs.get(name)
            if message is None:
                continue
            columns = joint_columns(message, self._index)
            self._joints[name] = columns
            self._stamps[name] = stamps.from_message(message.header.stamp)
            for row, values in ((POSITION, message.position), (RATE, message.velocity), (EFFORT, message.effort)):
                self._reference[row, columns] = numbers(values) if len(values) else 0.0
        switches = inputs.get(SWITCHES)
        if switches is not None:
            self._stamps[SWITCHES] = stamps.from_message(switches.header.stamp)
            for load, text in status_values(switches).items():
                self._fractions[self._loads[load]] = fraction_of(text)

    def at(self, now: int) -> PlantCommand:
        """Command at simulation time `now` [ns]: too old ones stop their joints.

        Wheels get rate zero, and joints with a position hold it: for both the rate is zero and the position stays.
        Switches stay as they were: to cut the power of a rover whose manager is silent would be worse.
        """
        self.lost = [
            name
            for name, stamp in self._stamps.items()
            if now - stamp > int(topic(name).max_age_s * stamps.NANOSECONDS)
        ]
        reference = self._reference.copy()
        for name in self.lost:
            reference[RATE, self._joints.get(name, [])] = 0.0
        # A position is the reference for the end of the period that it is stamped with; between commands it moves on.
        return PlantCommand(reference, np.array(self._fractions))


def fraction_of(text: str) -> float | None:
    """Fraction that a switch's text stands for, or None if it stands for none."""
    if text in ("on", "off"):
        return 1.0 if text == "on" else 0.0
    try:
        fraction = float(text)
    except ValueError:
        return None
    return fraction if 0.0 <= fraction <= 1.0 else None
