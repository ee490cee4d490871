"""The slip estimate as a part of the drive: what of its input it takes, and what becomes of a goal without headway."""

import numpy as np

from sojourn_flight.odometry.odometry import OdometryInput, OdometryState
from sojourn_flight.odometry.slip_estimation import (
    SlipInput,
    SlipModel,
    SlipState,
    estimate_slip,
    further_slip,
    is_stuck,
    trouble,
)
from sojourn_flight.supervision.drive_types import DriveInput, DriveState
from sojourn_machine.errors import InvalidValueError

DRAGGING_SIGMA = 0.5
"""Part of the way over ground that is not known while a wheel without its motor is dragged along: the torques of the
others tell what they pull, not what it holds back [-]."""


UNSURE = 0.3
"""A slip with a greater standard deviation decides nothing [-]: of wheels that slow down after a long climb the
estimate may come to any."""


def step_slip(
    model: SlipModel | None, state: DriveState, inputs: DriveInput, measured: OdometryInput, dt: float
) -> SlipState | None:
    """The slip after a period of `dt` [s]; as it was where a measurement is missing, None where it is not estimated.

    Raises:
        InvalidValueError: efforts that are not finite, or not one for each wheel.
    """
    force, gyro, tilt, efforts = inputs.specific_force, inputs.gyro, inputs.roll_pitch, inputs.wheel_efforts
    if model is None or state.slip is None or force is None or gyro is None or tilt is None or efforts is None:
        return state.slip
    torques = np.array(efforts, dtype=np.float64)
    if torques.shape != measured.wheel_rates.shape or not np.isfinite(torques).all():
        raise InvalidValueError("wheel efforts", torques.tolist(), "one finite number for each wheel")
    limiter = state.limiter
    seen = SlipInput(
        measured.wheel_rates,
        measured.wheel_rates if limiter is None else limiter.wheel_rates,
        measured.steer_angles,
        torques,
        np.array((gyro[0], gyro[1], gyro[2] - state.odometry.gyro_bias)),
        np.array(force),
        tilt,
    )
    found = estimate_slip(model, state.slip, seen, dt)
    if not np.count_nonzero(state.motors.drive_failed):
        return found
    return found._replace(sigma=max(found.sigma, DRAGGING_SIGMA * (1.0 - found.shared)))


def counted_slip(slip: SlipState | None, odometry: OdometryState, least_pace: float) -> float | None:
    """Slip of the machine, with what the camera has found of it; None of wheels slower than `least_pace` [m/s], and
    where it is not known well.
    """
    if slip is None or slip.standing_for > 0.0 or slip.pace < least_pace or slip.sigma > UNSURE:
        return None
    return further_slip(slip.shared, odometry.slip_error)


def no_headway(model: SlipModel | None, slip: SlipState | None, odometry: OdometryState, names: tuple[str, ...]) -> str:
    """Why a goal cannot be pursued any longer, in words; empty where it can.

    A wheel that spins does not end it while the machine gets on, as one with a dead motor does with much slip; nor does
    a slip that is not known well: then the follower's time-out does.
    """
    if model is None or slip is None or slip.sigma > UNSURE or not is_stuck(model.params, slip):
        return ""
    if further_slip(slip.shared, odometry.slip_error) < model.params.stuck_slip:
        return ""
    return trouble(model.params, slip, names)
