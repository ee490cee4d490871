"""Torsion of a harmonic drive: stiffness that grows with the torque, and hysteresis.

Catalogue stiffness in three straight pieces up to T_1, T_2 and beyond, K_1 <= K_2 <= K_3 (Harmonic Drive, engineering
data):

    twist(T) = T/K_1                                       |T| <= T_1
             = T_1/K_1 + (|T| - T_1)/K_2                   |T| <= T_2
             = T_1/K_1 + (T_2 - T_1)/K_2 + (|T| - T_2)/K_3

Hysteresis of Dahl's kind (Dahl 1968, Aerospace TOR-0158; for harmonic drives Tuttle 1992, MIT AI-TR-1365):

    dz/dx = (1 - z sign(x'))/x_c,   T = twist^-1(x) + T_h z,   |z| <= 1
so that a slow cycle over a large twist loses close to 4 T_h x and the width of the loop at zero torque is about 2
T_h/K_1.
Assumptions: independent of the rate, no kinematic error. Range: below the ratcheting torque.
"""

import math
from typing import NamedTuple, Self

from pydantic import Field, model_validator

from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import Params


class HarmonicDriveParams(Params):
    """Torsion of one size and ratio."""

    torque_1: float = Field(gt=0.0, le=1e6, description="T_1 [N m]")
    torque_2: float = Field(gt=0.0, le=1e6, description="T_2 [N m]")
    stiffness_1: float = Field(gt=0.0, le=1e9, description="K_1 [N m/rad]")
    stiffness_2: float = Field(gt=0.0, le=1e9, description="K_2 [N m/rad]")
    stiffness_3: float = Field(gt=0.0, le=1e9, description="K_3 [N m/rad]")
    hysteresis_torque: float = Field(default=0.0, ge=0.0, le=1e5, description="T_h [N m]")
    hysteresis_twist: float = Field(default=1e-4, gt=0.0, le=1.0, description="x_c [rad]")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.torque_1 < self.torque_2:
            raise ValueError(f"torque_1 = {self.torque_1:g}: allowed is less than torque_2 = {self.torque_2:g} N m")
        return self


class HarmonicDriveState(NamedTuple):
    """Twist [rad] and state of the hysteresis z in -1..1 [-]."""

    twist: float = 0.0
    memory: float = 0.0


def elastic_twist(drive: HarmonicDriveParams, torque: float) -> float:
    """Twist [rad] under a torque [N m], without hysteresis."""
    size = abs(torque)
    twist = min(size, drive.torque_1) / drive.stiffness_1
    twist += min(max(size - drive.torque_1, 0.0), drive.torque_2 - drive.torque_1) / drive.stiffness_2
    twist += max(size - drive.torque_2, 0.0) / drive.stiffness_3
    return math.copysign(twist, torque)


def elastic_torque(drive: HarmonicDriveParams, twist: float) -> float:
    """Torque [N m] at a twist [rad]: the inverse of `elastic_twist`."""
    size = abs(twist)
    first = drive.torque_1 / drive.stiffness_1
    second = first + (drive.torque_2 - drive.torque_1) / drive.stiffness_2
    torque = drive.stiffness_1 * min(size, first)
    torque += drive.stiffness_2 * min(max(size - first, 0.0), second - first)
    torque += drive.stiffness_3 * max(size - second, 0.0)
    return math.copysign(torque, twist)


def step_twist(drive: HarmonicDriveParams, state: HarmonicDriveState, twist: float) -> tuple[HarmonicDriveState, float]:
    """New state and torque [N m] after the twist has moved to a value [rad]; exact for a move in one sense."""
    if not math.isfinite(twist):
        raise InvalidValueError("twist", twist, "a finite number")
    move = twist - state.twist
    end = math.copysign(1.0, move)
    memory = end + (state.memory - end) * math.exp(-abs(move) / drive.hysteresis_twist) if move else state.memory
    return HarmonicDriveState(twist, memory), elastic_torque(drive, twist) + drive.hysteresis_torque * memory
