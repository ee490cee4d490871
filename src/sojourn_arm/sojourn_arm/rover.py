"""What the arm knows of its rover in a period: whether it moves, and where it stands by the drive's estimate."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.values import JointState, Odometry
from sojourn_flight.arm.goals import PoseGoal
from sojourn_flight.arm.interlock import InterlockParams
from sojourn_machine.rotations import quaternion_of

BASE_FRAME = "base_link"
GROUND_FRAMES = ("map", "odom")
"""They coincide at the start of a run, and nobody here knows better afterwards."""
ODOMETRY, WHEELS = "/odom", "/drive_command"
STILL_RATE = 0.02
"""A wheel that turns slower stands still [rad/s]: 2.5 mm/s at the rim of the explorer's."""


@dataclass(frozen=True, slots=True, eq=False)
class Rover:
    """As the inputs of one period tell."""

    why_not_allowed: str
    """Why the arm may not move, in words; empty where it may."""
    odometry: Odometry | None
    """/odom of the period; None where there is none."""

    def place(self) -> pin.SE3 | None:
        """Where base_link is in odom; None where nobody says."""
        here = self.odometry
        return None if here is None else pin.XYZQUATToSE3([*here.position, *here.orientation])

    def base_in(self, frame: str, name: str, *others: str) -> pin.SE3:
        """Where base_link is in `frame`, for a message on topic `name`; `others`: frames that it may have besides.

        Raises:
            RefusedMessageError: an unknown frame, or no estimate of where the rover is.
        """
        if frame == BASE_FRAME:
            return pin.SE3.Identity()
        if frame not in GROUND_FRAMES:
            allowed = "one of " + ", ".join((BASE_FRAME, *GROUND_FRAMES, *others))
            raise RefusedMessageError(name, "header.frame_id", repr(frame), allowed)
        here = self.place()
        if here is None:
            allowed = f"{BASE_FRAME}: there is no {ODOMETRY} that says where the rover is"
            raise RefusedMessageError(name, "header.frame_id", repr(frame), allowed)
        return here


class RoverWatch:
    """Follows the drive.

    Args:
        interlock: whether the arm waits for the rover. drive_joints: joints that turn its wheels.
    """

    def __init__(self, interlock: InterlockParams, drive_joints: Sequence[str]) -> None:
        self._interlock = interlock
        self._drive_joints = frozenset(drive_joints)
        self._names: tuple[str, ...] = ()
        self._places: list[int] = []
        """Of these joints in a message with the names in `_names`."""

    def rover(self, inputs: Mapping[str, Any]) -> Rover:
        """By the inputs of a period: what the wheels are told, what they do, where the rover is."""
        why_not = ""
        if self._interlock.enabled:
            why_not = _commanded(inputs.get(WHEELS)) or self._measured(inputs.get("/joint_states"))
        return Rover(why_not, inputs.get(ODOMETRY))

    def _measured(self, joints: JointState | None) -> str:
        """How the rover moves, in words; empty where it stands, or nothing is known of it."""
        if joints is None:
            return ""
        if joints.names != self._names:
            self._names = joints.names
            self._places = [place for place, name in enumerate(joints.names) if name in self._drive_joints]
        rates = joints.velocity.tolist()
        for place in self._places:
            if abs(rates[place]) > STILL_RATE:
                return f"the rover drives: {joints.names[place]} turns at {rates[place]:.3f} rad/s"
        return ""


def in_base(goal: PoseGoal, base_in_frame: pin.SE3) -> PoseGoal:
    """A goal that was given in a frame, in base_link."""
    position = base_in_frame.actInv(np.array(goal.position))
    direction = None if goal.direction is None else base_in_frame.rotation.T @ np.array(goal.direction)
    if goal.orientation is None:
        return PoseGoal(tuple(position), None if direction is None else tuple(direction))
    turned = pin.Quaternion(quaternion_of(base_in_frame.rotation)).inverse() * pin.Quaternion(
        np.array(goal.orientation)
    )
    return PoseGoal(tuple(position), orientation=tuple(turned.coeffs()))


def _commanded(command: JointState | None) -> str:
    """How the rover is told to move, in words; empty where it is not."""
    if command is None or not any(command.velocity.tolist()):
        return ""
    name, rate = next((name, rate) for name, rate in zip(command.names, command.velocity, strict=False) if rate)
    return f"the rover drives: {name} is told {rate:.3f} rad/s"
