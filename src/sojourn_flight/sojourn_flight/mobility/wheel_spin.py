"""Wheels that spin or are dragged for some seconds, as at a step: the accelerometer knows the speed better meanwhile.

The speed of the body is carried on by the accelerometer, and drawn to that of the wheels:

    v_x += (f_x + g sin(pitch) + ω v_y) dt,             v_x += (u - v_x) dt / settling   while |u - v_x| <= gate,
    w   += (f_y - g sin(roll) cos(pitch) - ω v_x) dt,   w += (ω l - w) dt / settling,   v_y = w - ω l

with f the specific force in base_link, less the centripetal part of the accelerometer's place, which is l ahead of the
origin of base_link, so that w is the speed to the side there; ω the yaw rate by the gyro, pitch positive nose down, g
the specific force at a stand, and u the mean of r W cos(steer angle) over the wheels, less the slip that the soil is
expected to give. Without v_y a machine that slides outward in a curve would seem not to slow down.

Wheels whose speed has left that of the body by more than the gate spin (or are dragged): v_x is the speed then and the
wheels' slip 1 - v_x / (mean of r W cos). Wheels that speed up at a rate a without the body are a times the settling
time ahead of v_x: what slips more slowly is not seen.

After `longest` the accelerometer is not good any more and nothing knows how far the machine gets: a goal ends
(`endless_spin`), so that it stands; until then v_x stays between none and that of the wheels.

Sources: Dissanayake et al. (2001), IEEE Trans. Robotics and Automation 17(5):731 (accelerometer and wheels of a land
vehicle); Kiencke & Nielsen (2005), Automotive Control Systems, sec. 8.2 (speed from accelerations while wheels slip).

Assumptions: tilt and bias make an error of acceleration of some mm/s^2 (the accelerometer's bias and the tilt that was
levelled by it cancel), so that v_x is good to centimetres per second for some seconds. For fast machines: at the speed
of others the gate would be a good part of it.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.wheel_spin_params import WheelSpinParams
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_machine.params import FloatArray

GRAVITY_TIME = 1.0
"""Of the mean of the specific force at a stand [s]."""
LEAST_RIM = 0.05
"""Speed of the rims below which a slip has no meaning [m/s]."""


@dataclass(frozen=True, slots=True)
class WheelSpinState:
    """What is remembered."""

    gravity: float | None = None
    """Specific force at a stand [m/s^2]; None until the machine has stood."""
    speed: float = 0.0
    """Of the body, ahead [m/s]."""
    side_speed: float = 0.0
    """To the left, at the accelerometer [m/s]."""
    lasting: float = 0.0
    """Time for which the wheels have been spinning [s]."""


class FeltMotion(NamedTuple):
    """What accelerometer and gyro feel."""

    force: tuple[float, float, float]
    """Specific force in base_link [m/s^2]."""
    roll: float
    pitch: float
    """[rad], pitch positive nose down."""
    yaw_rate: float
    """[rad/s]"""
    ahead: float = 0.0
    """Of the accelerometer before the origin of base_link [m]."""


def step_spin(
    params: WheelSpinParams, state: WheelSpinState, rim: float, expected_slip: float, felt: FeltMotion, dt: float
) -> tuple[WheelSpinState, float | None]:
    """The state after a period of `dt` [s], and the slip of wheels that spin; None of those that do not.

    Args:
        rim: mean of the wheels' rolling speeds, ahead [m/s]. expected_slip: that which they are expected to have [-].
        felt: by accelerometer and gyro.
    """
    if rim == 0.0:
        present = math.sqrt(sum(component * component for component in felt.force))
        gravity = present if state.gravity is None else state.gravity + (present - state.gravity) * dt / GRAVITY_TIME
        return WheelSpinState(gravity), None
    wheels = rim * (1.0 - expected_slip)
    if state.gravity is None:
        return WheelSpinState(None, wheels), None
    down_x, down_y = -math.sin(felt.pitch), math.sin(felt.roll) * math.cos(felt.pitch)
    turning = felt.yaw_rate * felt.ahead
    drawn = min(dt / params.settling, 1.0)
    speed = state.speed + (felt.force[0] - state.gravity * down_x + felt.yaw_rate * (state.side_speed - turning)) * dt
    side = state.side_speed + (felt.force[1] - state.gravity * down_y - felt.yaw_rate * state.speed) * dt
    side += (turning - side) * drawn
    if abs(wheels - speed) <= params.gate:
        return WheelSpinState(state.gravity, speed + (wheels - speed) * drawn, side), None
    if state.lasting > params.longest:
        speed = min(max(speed, min(wheels, 0.0)), max(wheels, 0.0))
    slip = 1.0 - speed / rim if abs(rim) > LEAST_RIM else None
    return WheelSpinState(state.gravity, speed, side, state.lasting + dt), slip


def endless_spin(params: WheelSpinParams | None, state: WheelSpinState) -> str:
    """Why a goal cannot go on whose way is known by nothing any more, in words; empty as long as it is."""
    if params is None or state.lasting <= params.longest:
        return ""
    return f"the wheels have been spinning for {params.longest:g} s: how far the rover gets is no longer known"


def rim_speed(table: FloatArray, rates: FloatArray, angles: FloatArray) -> float:
    """Mean of the wheels' rolling speeds along the body [m/s], of machines whose wheels steer about their contact."""
    return float(np.mean(table[:, WheelTableColumn.RADIUS] * rates * np.cos(angles)))
