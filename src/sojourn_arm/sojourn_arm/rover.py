"""What the arm's node knows of its rover: whether it moves, and where it stands by the drive's estimate."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message

from sojourn_contract.checks import check_message
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.messages import quaternion, xyz
from sojourn_mechanics.arm.goals import PoseGoal
from sojourn_mechanics.arm.interlock import InterlockParams

BASE_FRAME = "base_link"
GROUND_FRAMES = ("map", "odom")
"""They coincide at the start of a run, and nobody here knows better afterwards."""
ODOMETRY, WHEELS = "/odom", "/wheel_command"
STILL_RATE = 0.02
"""A wheel that turns slower stands still [rad/s]: 2.5 mm/s at the rim of the explorer's."""


class Rover:
    """Follows the drive. /odom stays as it came until a goal asks for it: few do.

    Args:
        interlock: whether the arm waits for the rover. drive_joints: joints that turn its wheels.
    """

    def __init__(self, interlock: InterlockParams, drive_joints: Sequence[str]) -> None:
        self._interlock = interlock
        self._drive_joints = frozenset(drive_joints)
        self._odometry: bytes | None = None
        self.why_not_allowed = ""
        """Why the arm may not move, in words; empty where it may."""

    def hear(self, inputs: Mapping[str, Any]) -> None:
        """Take the inputs of a period: what the wheels are told, what they do, where the rover is."""
        self._odometry = inputs.get(ODOMETRY)
        if self._interlock.enabled:
            self.why_not_allowed = _motion(inputs.get(WHEELS), inputs.get("/joint_states"), self._drive_joints)

    def in_base(self, goal: PoseGoal, frame: str) -> PoseGoal:
        """A goal that was given in `frame`, in base_link.

        Raises:
            RefusedMessageError: an unknown frame, or no estimate of where the rover is.
        """
        if frame == BASE_FRAME:
            return goal
        if frame not in GROUND_FRAMES:
            allowed = "one of " + ", ".join((BASE_FRAME, *GROUND_FRAMES))
            raise RefusedMessageError("/arm/goal_pose", "header.frame_id", repr(frame), allowed)
        if self._odometry is None:
            allowed = f"{BASE_FRAME}: there is no {ODOMETRY} that says where the rover is"
            raise RefusedMessageError("/arm/goal_pose", "header.frame_id", repr(frame), allowed)
        here = deserialize_message(self._odometry, Odometry)
        check_message(ODOMETRY, here)
        base_in_frame = pin.XYZQUATToSE3([*xyz(here.pose.pose.position), *quaternion(here.pose.pose.orientation)])
        position = base_in_frame.actInv(np.array(goal.position))
        direction = None if goal.direction is None else base_in_frame.rotation.T @ np.array(goal.direction)
        if goal.orientation is None:
            return PoseGoal(tuple(position), None if direction is None else tuple(direction))
        turned = pin.Quaternion(base_in_frame.rotation).inverse() * pin.Quaternion(np.array(goal.orientation))
        return PoseGoal(tuple(position), orientation=tuple(turned.coeffs()))


def _motion(command: Any, joints: Any, drive_joints: frozenset[str]) -> str:
    """How the rover moves, in words; empty where it stands, or nothing is known of it."""
    if command is not None:
        for name, rate in zip(command.name, command.velocity, strict=False):
            if rate:
                return f"the rover drives: {name} is told {rate:.3f} rad/s"
    if joints is not None:
        for name, rate in zip(joints.name, joints.velocity, strict=False):
            if name in drive_joints and abs(rate) > STILL_RATE:
                return f"the rover drives: {name} turns at {rate:.3f} rad/s"
    return ""
