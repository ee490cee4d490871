"""A drive whose process was started again: it goes on from where the last one was, or says that it is lost.

What may have happened meanwhile: the last process drove on for KEPT_S after it had kept its state, the machine for as
long as it believes the last command, and then until it stands. So the position may be off by the way of so much time at
the highest speed, the heading by its turn; both are added to the covariance as one standard deviation. Where nothing
is known of the pose, any place within FAR may be, and goals are allowed in base_link alone.
"""

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from sojourn_contract.topics import topic
from sojourn_flight.mobility.motion_limits import MotionLimits
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace

KEPT_S = 0.2
"""Time from keeping to keeping [s]."""
FAR = 100.0
"""[m]"""
LOST = "the drive was restarted and does not know where it is"


def kept_odometry(state: OdometryState) -> dict[str, Any]:
    """An estimate as JSON has it; numbers come back to the last bit."""
    values = {field.name: getattr(state, field.name) for field in fields(state)}
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in values.items()}


def odometry_of(kept: Mapping[str, Any], like: OdometryState) -> OdometryState:
    """The estimate that was kept by a machine whose estimate has the form of `like`.

    Raises:
        InvalidValueError: a field that is missing, of another form, or not finite.
    """
    found: dict[str, Any] = {}
    for field in fields(like):
        name, usual = field.name, getattr(like, field.name)
        try:
            value = None if usual is None else np.array(kept[name], dtype=np.float64)
        except (KeyError, TypeError, ValueError):
            raise InvalidValueError(name, kept.get(name), "as an estimate has it") from None
        if value is not None and (value.shape != np.shape(usual) or not np.isfinite(value).all()):
            raise InvalidValueError(name, kept[name], f"finite numbers of shape {np.shape(usual)}")
        found[name] = value if isinstance(usual, np.ndarray) or value is None else type(usual)(value)
    return OdometryState(**found)


def unseen(limits: MotionLimits, elapsed: float) -> tuple[float, float]:
    """How far it may have moved [m] and turned [rad] since it kept its state, `elapsed` [s] ago."""
    believed = topic("/drive_command").max_age_s
    seconds = min(elapsed, KEPT_S + believed + limits.max_speed / limits.max_deceleration)
    return limits.max_speed * seconds, limits.max_yaw_rate * seconds


def less_sure(state: OdometryState, way: float, turn: float) -> OdometryState:
    """The same estimate, with so much of unknown motion since [m, rad]; velocities are not known."""
    covariance = state.covariance.copy()
    covariance[[0, 1, 2], [0, 1, 2]] += way**2, way**2, turn**2
    return replace(state, covariance=covariance, v_x=0.0, v_y=0.0, yaw_rate=0.0, standing_for=0.0)


def lost(state: OdometryState) -> OdometryState:
    """The same estimate of one who is anywhere."""
    return less_sure(state, FAR, math.pi)
