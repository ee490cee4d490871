"""What the arm takes from the sensors' messages: its own joints, gravity, the force at its wrist."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_contract.app import Refusal
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.messages import wrench_of
from sojourn_contract.values import Imu, JointState
from sojourn_flight.arm.feedforward import gravity_in_body
from sojourn_flight.arm.tasks.task import ToolReading
from sojourn_machine.errors import MachineError
from sojourn_machine.mounting import IMU_LINK, mounting
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import TOOL_JOINT

JOINTS, IMU = MEASUREMENTS = ("/joint_states", "/imu/data")
"""Without which no goal can be followed."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Of one period. Arrays (n,) in the order of the arm's joints."""

    positions: FloatArray
    velocities: FloatArray
    efforts: FloatArray | None
    """[N m]; None where nobody tells them."""
    gravity: FloatArray
    """In base_link (3,) [m/s2]."""
    wrench: FloatArray | None
    """Of the tool on the wrist's sensor (6,) [N], [N m]; None where it is not measured."""
    tool: ToolReading | None
    """Its actuator; None where nobody tells it."""


class Measurements:
    """Reads them; keeps where each joint stands in a message.

    Args:
        joints: of the arm. urdf_xml: the machine. gravity: on the body [m/s2].
    """

    def __init__(self, joints: Sequence[str], urdf_xml: str, gravity: float) -> None:
        self._gravity = gravity
        self._places = JointPlaces(JOINTS, joints)
        self._tool: int | None = None
        """Place of the tool's actuator in a message, of the names in `_names`."""
        self._names: tuple[str, ...] = ()
        self._imu_to_base = mounting(urdf_xml, IMU_LINK)[0]

    def read(self, inputs: Mapping[str, Any], refusals: list[Refusal]) -> Measured | None:
        """Measurements of a period from /joint_states, /imu/data and /wrist/wrench; None where they cannot be used,
        with the reasons added to `refusals`.
        """
        joints, imu, wrist = inputs.get(JOINTS), inputs.get(IMU), inputs.get("/wrist/wrench")
        places, gravity = self._places_in(joints, refusals), self._gravity_in_base(imu, refusals)
        if joints is None or places is None or gravity is None:
            return None
        return Measured(
            positions=joints.position[places],
            velocities=joints.velocity[places],
            efforts=joints.effort[places] if len(joints.effort) else None,
            gravity=gravity,
            wrench=None if wrist is None else wrench_of(wrist),
            tool=self._tool_reading(joints),
        )

    def _places_in(self, joints: JointState | None, refusals: list[Refusal]) -> NDArray[np.intp] | None:
        """Where the arm's joints stand in a message, or None."""
        if joints is None:  # refused on arrival
            return None
        try:
            return self._places.places(joints)
        except RefusedMessageError as refusal:
            refusals.append((JOINTS, str(refusal)))
            return None

    def _tool_reading(self, joints: JointState) -> ToolReading | None:
        """The tool's actuator; None where the message does not name it."""
        if joints.names != self._names:
            self._names = joints.names
            self._tool = self._names.index(TOOL_JOINT) if TOOL_JOINT in self._names else None
        place = self._tool
        if place is None:
            return None
        effort = float(joints.effort[place]) if len(joints.effort) else 0.0
        return ToolReading(float(joints.position[place]), float(joints.velocity[place]), effort)

    def _gravity_in_base(self, imu: Imu | None, refusals: list[Refusal]) -> FloatArray | None:
        """Gravity from the attitude that the IMU reports, or None where it cannot be used."""
        if imu is None:  # refused on arrival
            return None
        try:
            gravity: FloatArray = self._imu_to_base @ gravity_in_body(imu.orientation, self._gravity)
        except MachineError as error:
            refusals.append((IMU, str(error)))
            return None
        return gravity
