"""Wheels that spin or are dragged for some seconds, as at a step: the accelerometer knows the speed better meanwhile.

The speed of the body is carried on by the accelerometer, and drawn to that of the wheels:

    v' = v + a dt,   a = f_x + g sin(pitch),   v += (u - v') dt / settling   while |u - v'| <= gate,

with f_x the specific force along the body, pitch positive nose down, g the specific force at a stand, and u the mean of
r W cos(steer angle) over the wheels, less the slip that the soil is expected to give. Wheels whose speed has left that
of the body by more than the gate spin (or are dragged): for at most `longest` v is the speed and the wheels' slip
1 - v / (mean of r W cos); beyond that the wheels are believed until the machine has stood. What slips slowly is not
seen: v follows the wheels.

Sources: Dissanayake et al. (2001), IEEE Trans. Robotics and Automation 17(5):731 (accelerometer and wheels of a land
vehicle); Kiencke & Nielsen (2005), Automotive Control Systems, sec. 8.2 (speed from accelerations while wheels slip).

Assumptions: tilt and bias make an error of acceleration of some mm/s^2 (the accelerometer's bias and the tilt that was
levelled by it cancel), so that v is good to centimetres per second for some seconds. For fast machines: at the speed of
others the gate would be a good part of it.
"""

import math
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from sojourn_mechanics.params import FloatArray, Params
from sojourn_mechanics.steering.wheel_table import WheelTableColumn

GRAVITY_TIME = 1.0
"""Of the mean of the specific force at a stand [s]."""
LEAST_RIM = 0.05
"""Speed of the rims below which a slip has no meaning [m/s]."""


class WheelSpinParams(Params):
    """When the accelerometer is believed rather than the wheels."""

    gate: float = Field(gt=0.0, le=10.0, description="difference of speeds from which the wheels spin [m/s]")
    settling: float = Field(gt=0.0, le=60.0, description="time in which the speed follows the wheels [s]")
    longest: float = Field(gt=0.0, le=60.0, description="time for which the accelerometer is good [s]")


@dataclass(frozen=True, slots=True)
class WheelSpinState:
    """What is remembered."""

    gravity: float | None = None
    """Specific force at a stand [m/s^2]; None until the machine has stood."""
    speed: float = 0.0
    """Of the body, ahead [m/s]."""
    lasting: float = 0.0
    """Time for which the wheels have been spinning [s]."""


def step_spin(
    params: WheelSpinParams,
    state: WheelSpinState,
    rim: float,
    expected_slip: float,
    force: tuple[float, float, float],
    pitch: float,
    dt: float,
) -> tuple[WheelSpinState, float | None]:
    """The state after a period of `dt` [s], and the slip of wheels that spin; None of those that do not.

    Args:
        rim: mean of the wheels' rolling speeds, ahead [m/s]. expected_slip: that which they are expected to have [-].
        force: specific force in base_link [m/s^2]. pitch: positive nose down [rad].
    """
    if rim == 0.0:
        felt = math.sqrt(sum(component * component for component in force))
        gravity = felt if state.gravity is None else state.gravity + (felt - state.gravity) * dt / GRAVITY_TIME
        return WheelSpinState(gravity), None
    wheels = rim * (1.0 - expected_slip)
    if state.gravity is None or state.lasting > params.longest:
        return WheelSpinState(state.gravity, wheels, state.lasting), None
    speed = state.speed + (force[0] + state.gravity * math.sin(pitch)) * dt
    if abs(wheels - speed) <= params.gate:
        return WheelSpinState(state.gravity, speed + (wheels - speed) * min(dt / params.settling, 1.0)), None
    slip = 1.0 - speed / rim if abs(rim) > LEAST_RIM else None
    return WheelSpinState(state.gravity, speed, state.lasting + dt), slip


def rim_speed(table: FloatArray, rates: FloatArray, angles: FloatArray) -> float:
    """Mean of the wheels' rolling speeds along the body [m/s], of machines whose wheels steer about their contact."""
    return float(np.mean(table[:, WheelTableColumn.RADIUS] * rates * np.cos(angles)))
