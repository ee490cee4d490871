"""What the arm and its tool are told, as a message."""

from collections.abc import Sequence
from typing import Any

from sojourn_contract.messages import fill_joint_state
from sojourn_mechanics.arm.state import ArmOutput
from sojourn_mechanics.arm.tasks.task_control import TaskState
from sojourn_mechanics.arm.tool_params import TOOL_JOINT


def fill_command(message: Any, joints: Sequence[str], output: ArmOutput, state: TaskState) -> None:
    """Fill a JointState: the joints of the arm, then the actuator of its tool, if it has one. The stamp is left."""
    fill_joint_state(message, 0, output.positions, output.velocities, output.efforts)
    message.name = list(joints)
    if state.tool is not None:
        command = state.tool_command
        message.name.append(TOOL_JOINT)
        message.position.append(command.position)
        message.velocity.append(command.rate)
        message.effort.append(command.effort)
