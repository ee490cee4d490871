"""Force of the ground on the tool, from the wrench at the wrist.

    F = R (w - b) - m g        R: sensor's frame to base_link; b: what was left when the tool hung free (`tare`)

with the mass m of all that hangs on the sensor, which is the arm's last link, from the URDF, and gravity in base_link
from the attitude of the IMU. What the tool's own acceleration adds is left in: 0.3 N for 2 kg at 0.15 m/s2.
"""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.kinematics import TipPose
from sojourn_flight.arm.model import ArmModel
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.vectors import cross


@dataclass(frozen=True, slots=True)
class ContactSense:
    """What hangs on the sensor, and its bias (6,) in the sensor's frame [N], [N m]."""

    mass: float
    centre: FloatArray
    bias: FloatArray

    def tool_load(self, model: ArmModel, tip: TipPose, gravity_in_base: FloatArray) -> FloatArray:
        """Wrench of the tool's own weight in the sensor's frame, (6,)."""
        return self._load(sensor_rotation(model, tip), gravity_in_base)

    def contact(self, model: ArmModel, tip: TipPose, wrench: FloatArray, gravity_in_base: FloatArray) -> FloatArray:
        """Force of the ground on the tool in base_link, (3,) [N].

        Args:
            wrench: as measured, of the tool on the arm, (6,).
        """
        turned = sensor_rotation(model, tip)
        rest = wrench - self.bias - self._load(turned, gravity_in_base)
        return np.asarray(turned @ rest[:3])

    def _load(self, rotation: FloatArray, gravity_in_base: FloatArray) -> FloatArray:
        weight = self.mass * (rotation.T @ gravity_in_base)
        return np.concatenate([weight, cross(self.centre, weight)])


def contact_sense(model: ArmModel) -> ContactSense:
    """Of an arm whose sensor sits at its last joint, without bias."""
    inertia = model.pinocchio_model.inertias[model.joint_count]
    return ContactSense(float(inertia.mass), np.array(inertia.lever), np.zeros(6))


def sensor_rotation(model: ArmModel, tip: TipPose) -> FloatArray:
    """Rotation (3, 3) from the frame of the last joint, which is the sensor's, to base_link."""
    return np.asarray(tip.rotation @ model.chain.tip_rotation.T)


def check_wrench(wrench: FloatArray | None) -> None:
    """Raise InvalidValueError for a wrench that is not six finite numbers; None is no measurement."""
    if wrench is not None and (wrench.shape != (6,) or not all(map(math.isfinite, wrench.tolist()))):
        raise InvalidValueError("wrist wrench", wrench.tolist(), "6 finite numbers, or none")
