"""What the contract needs to know of a rover: its joints by group with their limits, its loads, its contacts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

import numpy as np

from sojourn_config.machine import MachineConfig
from sojourn_config.scenario import LoadedScenario
from sojourn_config.urdf import UrdfJoint, UrdfSummary
from sojourn_contract.run_table import table_of
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import STANDARD
from sojourn_machine.tools import TOOL_JOINT, ToolParams


@dataclass(frozen=True)
class JudgedMachine:
    """A rover as seen from outside.

    Args:
        name: of the robot. joints: those that move, by name. arm, tool: names of joints with a motor.
        drive, steer: joints that move the machine, by rate and by position. pointed: joints held by position that
            neither drive nor arm moves.
        held: joints held by position; the others with a motor by rate. loads: what the power manager may switch.
        poses: names of the arm's poses. contacts: of its supports. table: the topics of its runs.
    """

    name: str
    joints: dict[str, UrdfJoint]
    drive: tuple[str, ...]
    steer: tuple[str, ...]
    arm: tuple[str, ...]
    tool: tuple[str, ...]
    held: frozenset[str]
    loads: tuple[str, ...]
    poses: tuple[str, ...]
    contacts: int
    table: TopicTable = STANDARD
    pointed: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        name: str,
        config: MachineConfig,
        urdf: UrdfSummary,
        arm_joints: Sequence[str],
        loads: Sequence[str],
        poses: Sequence[str],
        tool: ToolParams | None = None,
        moves: Sequence[str] = (),
    ) -> "JudgedMachine":
        """From a machine's parameter sets. moves: joints of its mobility."""
        of_tool = {} if tool is None else {TOOL_JOINT: _actuator(tool)}
        held = {joint for drive in config.drives if drive.mode == "position" for joint in drive.joints}
        return cls(
            name=name,
            joints={joint: urdf.joints[joint] for joint in urdf.moving_joints} | of_tool,
            drive=tuple(joint for joint in moves if joint not in held),
            steer=tuple(joint for joint in moves if joint in held),
            arm=tuple(arm_joints),
            tool=tuple(of_tool),
            held=frozenset(held | (set(of_tool) if tool is not None and tool.joint.held else set())),
            loads=tuple(loads),
            poses=tuple(poses),
            contacts=len(config.supports),
        )

    @classmethod
    def of_scenario(cls, scenario: LoadedScenario) -> "JudgedMachine":
        """The machine of a scenario."""
        machine = cls.of(
            scenario.config.machine,
            scenario.machine,
            scenario.urdf,
            scenario.arm_joints,
            [load.name for load in scenario.power.loads],
            () if scenario.arm is None else tuple(scenario.arm.named_poses),
            scenario.tool,
            () if scenario.driving is None else scenario.driving.mobility.joints(scenario.machine),
        )
        return replace(machine, table=table_of(scenario), pointed=scenario.pointed_joints)

    @property
    def motors(self) -> tuple[str, ...]:
        """Joints with a motor."""
        return (*self.drive, *self.steer, *self.arm, *self.tool)

    def as_data(self) -> dict[str, Any]:
        """As JSON values; joints without stops have none."""
        group_of = {name: group for group in ("drive", "steer", "arm", "tool") for name in getattr(self, group)}
        return {
            "name": self.name,
            "joints": {
                name: {
                    "group": group_of.get(name),
                    "held_by": None if name not in group_of else "position" if name in self.held else "rate",
                    "kind": joint.kind,
                    "lower": joint.lower if isfinite(joint.lower) else None,
                    "upper": joint.upper if isfinite(joint.upper) else None,
                    "velocity": joint.velocity if isfinite(joint.velocity) else None,
                }
                for name, joint in self.joints.items()
            },
            "loads": list(self.loads),
            "poses": list(self.poses),
            "contacts": self.contacts,
        }

    def known(self, joint_set: str) -> dict[str, UrdfJoint]:
        """Joints that a message of this set (see JOINT_SETS) may name."""
        sets = {
            "drive": (*self.drive, *self.steer),
            "arm": self.arm,
            "arm and tool": (*self.arm, *self.tool),
            "pointed": self.pointed,
        }
        names = sets.get(joint_set, tuple(self.joints))
        return {name: self.joints[name] for name in names}

    def needed(self, joint_set: str) -> tuple[str, ...]:
        """Joints that a message of this set must name."""
        return {"moving": tuple(self.joints), "measured": self.motors}.get(joint_set, ())


def _actuator(tool: ToolParams) -> UrdfJoint:
    """The tool's joint, as if the URDF had it."""
    kind, lower, upper, velocity, _ = tool.joint
    return UrdfJoint(TOOL_JOINT, kind, "", "", np.eye(4), lower, upper, velocity, float("inf"), np.eye(3)[2])
