"""Twist of the gears between the arm's motors and its joints, from the load that the model expects.

Encoder and servo on the motor know nothing of what the gear gives. Where a joint carries the torque T its motor is
ahead by

    x(T) = T/k + h clip(T/b, -1, 1)

k: stiffness of the gear; h: half its play; b: friction of the joint's own bearing, below which the torque does not say
on which flank the teeth rest. T is the rigid-body torque of the model, from the gravity that the IMU sees (a
compensation that placing an instrument to millimetres needs: Tunstel et al. 2005, IEEE SMC, of the MER arm).

What stays: h where T is near zero, b/k, what the model's masses are wrong by, loads from outside. Range: small twists.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sojourn_flight.arm.dynamics import gravity_effort
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import ArmGearParams
from sojourn_machine.params import FloatArray

_LEAST_FRICTION = 1e-3
"""[N m]: a bearing without friction would let the play jump."""


class _Gears(NamedTuple):
    """Arrays (n,), never written to."""

    bearing: FloatArray
    half_play: FloatArray
    compliance: FloatArray


@lru_cache(maxsize=32)
def _gears(bearing: tuple[float, ...], backlash: tuple[float, ...], compliance: tuple[float, ...]) -> _Gears:
    friction = np.maximum(np.array(bearing), _LEAST_FRICTION)
    return _Gears(friction, 0.5 * np.array(backlash), np.array(compliance))


def gear_twist(params: ArmGearParams, efforts: FloatArray) -> FloatArray:
    """x (n,) [rad]: motor over the gear less joint, under joint torques `efforts` (n,) [N m]."""
    bearing, half_play, compliance = _gears(params.bearing_friction, params.gear_backlash, params.gear_compliance)
    flank = np.minimum(np.maximum(efforts / bearing, -1.0), 1.0)
    return np.asarray(compliance * efforts + half_play * flank)


def joint_positions(params: ArmGearParams, model: ArmModel, measured: FloatArray, gravity: FloatArray) -> FloatArray:
    """Where the joints are (n,) [rad or m], from the encoders (n,) and gravity in base_link (3,) [m/s2]."""
    if not params.gear_compliance:
        return measured
    return measured - gear_twist(params, gravity_effort(model, measured, gravity))


def motor_positions(params: ArmGearParams, positions: FloatArray, efforts: FloatArray) -> FloatArray:
    """Where the motors have to be (n,) for the joints to be at `positions` (n,) with rigid-body torques (n,)."""
    if not params.gear_compliance:
        return positions
    return positions + gear_twist(params, efforts)
