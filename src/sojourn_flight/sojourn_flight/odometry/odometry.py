"""Odometry from what the machine moves on and the gyro, with tilt, and with a covariance that includes lasting errors.

Estimate. The mobility tells v_x, v_y of base_link over one period (`mobility`), with the yaw rate taken from the gyro
less its bias, or from the mobility where there is no gyro, or none was read for a while: what they disagree by is then
an error of the heading. The displacement in the body plane is the exact arc of
SE(2),

    t = w dt,  s = sin t / t,  c = (1 - cos t) / t,   d = dt (1 - s) [s v_x - c v_y, c v_x + s v_y],

with the estimated slip s (see `slip_estimation`), or s = mean_slip + slip_per_grade g that the soil is expected to
give on the grade g = -sin pitch (forwards), and a drift downhill of side_slip_per_grade sin roll on side slopes
(measured for a machine and a soil; zero where unknown), and one downhill in turns (see `turn_drift`). It is
turned into the odom frame by Rz(yaw) Ry(pitch) Rx(roll), with the tilt from the IMU. The Euler rate of yaw is
(w_y sin roll + w_z cos roll) / cos pitch.

Errors. P is the covariance of e = [x, y, yaw, slip, side slip, gyro bias]: the pose and three lasting errors
that its growth has to remember (a consider filter): within slip_length the pose error grows with distance,
over longer ways, where the soil changes, with its square root. With the displacement D, what it
would be without the correction of slip, T (below), its sideways companion S, all in odom, the way d and the period's
gyro gain g = dt cos roll / cos pitch:

    e_x += -D_y (e_yaw - g e_bias / 2) - T_x e_slip + S_x e_side,   e_y likewise,   e_yaw += -g e_bias,
    e_slip *= exp(-d / slip_length),  e_side likewise,              P' = F P F^T + Q;

Q: travel_sigma^2 per metre and turn_sigma^2 per radian in x and y; gyro random walk per second (or wheel_yaw_sigma^2
per metre); the bias walks; slip and drift are renewed so that their variances stay slip_sigma^2 and side_slip_sigma^2.
What is expected of a slope is off by slope_error of itself besides, as its soil is another than that of the
measurement: slip_sigma and side_slip_sigma grow by it, and of the drift downhill in turns, D_t in all (it fades like
the slip), x and y get slope_error^2 times the growth of D_t^2: errors of one sign.

The sun sensor corrects heading and bias in between, see `heading_fix`; cameras pose, slip and drift, see
`key_frames` and `visual_odometry`.
What a measurement has told of e_slip and e_side is kept as slip_error and side_error, which fade like them, and is
taken off the way: D = (1 - slip_error) T, S side_error.

Standing still (supports and gyro below thresholds for standing_time, and nothing commanded) freezes
the pose and lets the gyro measure its own bias: a Kalman update of the bias alone (Schmidt gain, Joseph
form). The part of a planet's rotation along the body's z axis is in that bias.

Sources: Siegwart, Nourbakhsh, Scaramuzza (2011), sections 5.2.4 (odometry error) and 3.2; Borenstein and
Feng, IEEE Trans. Robotics and Automation 12 (1996) 869 (lasting against random errors); Schmidt (1966)
consider filter, in Jazwinski, Stochastic Processes and Filtering Theory (1970), chapter 8; Titterton and
Weston, Strapdown Inertial Navigation Technology (2004), chapter 3 (Euler rates).

Assumptions: tilt changes little within a period, pitch within 80 degrees, base_link's height above the
contacts times the tilt rate is small against the speed. An estimated slip brings its own standard deviation: what is
known of the old error is kept as a part of the new one, in proportion, mean and covariance alike.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sojourn_flight.mobility.mobility import BodyMotion, Triple
from sojourn_flight.odometry.odometry_kernels import (
    START_POSITION_VARIANCE,
    START_YAW_VARIANCE,
    AddedVariances,
    Ways,
    body_arc,
    covariances_of,
    propagate,
    rescaled,
    update_bias,
)
from sojourn_flight.odometry.odometry_params import OdometryParams
from sojourn_flight.odometry.turn_drift import Downhill, downhill_of, slid_in_turn, smoothed
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

LEAST_GROUND = 0.1
"""Way over ground for a travel of the wheels, below which the errors of slip and drift grow no further [-]."""
SMALLEST_SLIP_SIGMA = 1e-3
"""So that the covariance stays positive definite [-]."""
SLIP, SIDE_SLIP = 3, 4
"""Where their errors are in the covariance."""
MOUNTING = 6
"""Where the sun sensor's mounting and levelling are in the covariance: places 6 to 12, see `heading_fix`."""
LEAST_SLIP_ERROR, LARGEST_SLIP_ERROR = -1.0, 1.0
"""What a correction of the slip may come to [-]."""
LARGEST_PITCH = math.radians(80.0)
"""Beyond this pitch the Euler rate of yaw is not used [rad]."""


@dataclass(frozen=True, slots=True)
class OdometryInput:
    """Measurements of one period."""

    motion: BodyMotion
    """What the joints say."""
    gyro: Triple | None = None
    """Angular velocity of base_link in base_link [rad/s], None without a gyro."""
    roll_pitch: tuple[float, float] | None = None
    """Roll and pitch (REP 103, pitch positive nose down) [rad], None to take the ground as level."""
    unread: float = 0.0
    """Part of the period of which no reading of the gyro tells [s]."""


@dataclass(frozen=True, slots=True)
class OdometryState:
    """Pose of base_link in odom, its errors, and what the next period needs."""

    x: float
    y: float
    z: float
    """[m]"""
    roll: float
    pitch: float
    yaw: float
    """[rad], yaw in (-pi, pi]"""
    v_x: float
    v_y: float
    """Velocity in base_link [m/s]."""
    yaw_rate: float
    """About the body's z axis [rad/s]."""
    distance: float
    """Distance travelled [m]."""
    covariance: FloatArray
    """Of [x, y, yaw, slip, side slip, gyro bias], then of `mounting` where there is a sun sensor, then of `keys` where
    there is a camera; shape (6, 6) to (19, 19)."""
    mounting: FloatArray
    """Estimated errors of mounting and levelling about the axes of base_link, shape (7,), see `heading_fix` [rad]."""
    keys: FloatArray | None
    """Poses of the key frames of the cameras in odom: x, y [m] and yaw [rad], shape (k, 3); None without a camera."""
    slip_error: float
    side_error: float
    """By how much of the way the rover slips more, and drifts to the left, than was believed of it [-]."""
    slip_sigma: float
    """Standard deviation of the slip as it was believed in the last period, a part of the way over ground [-]."""
    side_sigma: float
    """The same of the drift aside [-]."""
    gyro_bias: float
    """Estimated bias of the gyro's z axis [rad/s]."""
    standing_for: float
    """Time since the rover last moved [s]."""
    residual: float
    """Disagreement among the wheels [m/s]."""
    yaw_rate_difference: float
    """Yaw rate of the wheels less that of the gyro [rad/s]; large when wheels slip."""
    downhill: Downhill
    """Slope of the ground over which it has come, see `turn_drift`."""
    turn_drift: float
    """How far it is said to have drifted downhill in turns of late [m]."""
    encoder_jumps: int
    """Times a wheel position moved farther than it can; its rate was used instead [-]."""


def initial_odometry(
    params: OdometryParams,
    x: float = 0.0,
    y: float = 0.0,
    yaw: float = 0.0,
    z: float = 0.0,
    mounting: tuple[float, ...] = (),
    key_frames: int = 0,
) -> OdometryState:
    """State at a known start pose in odom [m, rad].

    Args:
        mounting: variances of the sun sensor's mounting and levelling, if any. key_frames: how many cameras make one.
    """
    variances = (
        START_POSITION_VARIANCE,
        START_POSITION_VARIANCE,
        START_YAW_VARIANCE,
        params.slip_sigma**2,
        params.side_slip_sigma**2,
        params.gyro_bias_sigma**2,
        *mounting,
        *(START_POSITION_VARIANCE, START_POSITION_VARIANCE, START_YAW_VARIANCE) * key_frames,
    )
    return OdometryState(
        x=x,
        y=y,
        z=z,
        roll=0.0,
        pitch=0.0,
        yaw=wrap_angle(yaw),
        v_x=0.0,
        v_y=0.0,
        yaw_rate=0.0,
        distance=0.0,
        covariance=np.diag(np.array(variances)),
        mounting=np.zeros(7),
        keys=np.tile((x, y, wrap_angle(yaw)), (key_frames, 1)) if key_frames else None,
        slip_error=0.0,
        side_error=0.0,
        slip_sigma=params.slip_sigma,
        side_sigma=params.side_slip_sigma,
        gyro_bias=0.0,
        standing_for=0.0,
        residual=0.0,
        yaw_rate_difference=0.0,
        downhill=(0.0, 0.0),
        turn_drift=0.0,
        encoder_jumps=0,
    )


def wrap_angle(angle: float) -> float:
    """The same angle in (-pi, pi] [rad]."""
    wrapped = math.remainder(angle, 2.0 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def step_odometry(params: OdometryParams, state: OdometryState, measured: OdometryInput, dt: float) -> OdometryState:
    """State after one period.

    Args:
        params: trust in joints and gyro.
        state: before the period.
        measured: at the end of the period, finite.
        dt: period [s], above 0.

    Raises:
        InvalidValueError: if the pitch is beyond 80 degrees, where yaw has no meaning.
    """
    roll, pitch = measured.roll_pitch if measured.roll_pitch is not None else (0.0, 0.0)
    if abs(pitch) > LARGEST_PITCH:
        raise InvalidValueError("pitch", pitch, f"within {LARGEST_PITCH:.3f} rad of level")
    gyro, motion = measured.gyro, measured.motion
    body_rate = gyro[2] - state.gyro_bias if gyro is not None else 0.0
    v_x, v_y, residual = motion.v_x, motion.v_y, motion.residual
    body_turning = gyro is not None and abs(body_rate) > params.standing_yaw_rate
    standing = motion.commanded_still and motion.fastest < params.standing_speed and not body_turning
    standing_for = state.standing_for + dt if standing else 0.0
    gyro_variance = params.gyro_random_walk**2

    if standing and standing_for >= params.standing_time:
        bias = state.gyro_bias
        covariance = state.covariance
        if gyro is not None:
            walked = covariance.copy()
            walked[5, 5] += params.gyro_bias_walk**2 * dt
            gain, covariance = update_bias(walked, gyro_variance / dt)
            bias += gain * (gyro[2] - bias)
        return replace(
            state,
            roll=roll,
            pitch=pitch,
            v_x=0.0,
            v_y=0.0,
            yaw_rate=0.0,
            covariance=covariance,
            gyro_bias=bias,
            standing_for=standing_for,
            residual=residual,
            yaw_rate_difference=0.0,
            downhill=state.downhill if state.distance else downhill_of(roll, pitch, state.yaw),
        )

    before, slip_error = state.covariance, state.slip_error
    side_slip_sigma = math.hypot(
        params.side_slip_sigma, params.slope_error * params.side_slip_per_grade * math.sin(roll)
    )
    if motion.slip is None:
        grade = -math.sin(pitch) * (1.0 if v_x >= 0.0 else -1.0)
        ground = 1.0 - min(max(params.mean_slip + params.slip_per_grade * grade, -0.5), 0.9)
        slip_sigma = math.hypot(params.slip_sigma, params.slope_error * params.slip_per_grade * math.sin(pitch))
        side_sigma = side_slip_sigma
    else:
        ground = 1.0 - motion.slip
        over_ground = 1.0 / min(max(ground, LEAST_GROUND), 1.0)  # what is unknown of the travel is more of the way
        slip_sigma = min(max(motion.slip_sigma * over_ground, SMALLEST_SLIP_SIGMA), 1.0)
        side_sigma = side_slip_sigma * over_ground
    if slip_sigma != state.slip_sigma:
        ratio = slip_sigma / state.slip_sigma
        before = rescaled(before, SLIP, ratio)
        slip_error = min(max(ratio * slip_error, LEAST_SLIP_ERROR), LARGEST_SLIP_ERROR)
    if side_sigma != state.side_sigma:
        before = rescaled(before, SIDE_SLIP, side_sigma / state.side_sigma)
    drift = (state.side_error - params.side_slip_per_grade * math.sin(roll)) * abs(v_x) * ground
    gripped = 1.0 - slip_error
    pitch_rate = gyro[1] if gyro is not None else 0.0
    yaw_rate = body_rate if gyro is not None else motion.yaw_rate
    difference = motion.yaw_rate - yaw_rate
    unfelt = difference * measured.unread  # turned in a gap, which the mobility alone knows
    yaw_rate += unfelt / dt
    slid_x, slid_y = slid_in_turn(params.turn_drift_per_grade * abs(yaw_rate), v_x, state.downhill, state.yaw)
    told_x, told_y = v_x * ground + slid_x, v_y * ground + drift + slid_y
    body_x, body_y = body_arc(float(told_x), float(told_y), float(yaw_rate * dt), float(dt))
    cos_roll, sin_roll, cos_pitch, sin_pitch = (
        math.cos(roll),
        math.sin(roll),
        math.cos(pitch),
        math.sin(pitch),
    )
    cos_yaw, sin_yaw = math.cos(state.yaw), math.sin(state.yaw)
    level_x = cos_pitch * body_x + sin_pitch * sin_roll * body_y
    level_y = cos_roll * body_y
    way_x = cos_yaw * level_x - sin_yaw * level_y
    way_y = sin_yaw * level_x + cos_yaw * level_y
    move = gripped * way_x, gripped * way_y
    travel = gripped * math.hypot(body_x, body_y)
    bias_gain = cos_roll / cos_pitch * dt if gyro is not None else 0.0
    kept = math.exp(-travel / params.slip_length)
    renewed = 1.0 - kept * kept
    turn_drift = kept * state.turn_drift
    slid = math.hypot(slid_x, slid_y) * dt
    unsure = params.slope_error**2 * slid * (2.0 * turn_drift + slid)
    yaw_variance = gyro_variance * dt if gyro is not None else params.wheel_yaw_sigma**2 * travel
    added = AddedVariances(
        slip=slip_sigma**2 * renewed,
        side=side_sigma**2 * renewed,
        move=params.travel_sigma**2 * travel
        + (params.turn_sigma**2 + motion.turn_sigma**2) * abs(yaw_rate) * dt
        + unsure,
        yaw=yaw_variance + unfelt**2,
        bias=params.gyro_bias_walk**2 * dt if gyro is not None else 0.0,
    )
    side = (-sin_yaw * travel, cos_yaw * travel)
    covariance = propagate(before, Ways(move, (way_x, way_y), side), bias_gain, kept, added)
    return OdometryState(
        x=state.x + move[0],
        y=state.y + move[1],
        z=state.z + gripped * (cos_pitch * sin_roll * body_y - sin_pitch * body_x),
        roll=roll,
        pitch=pitch,
        yaw=wrap_angle(state.yaw + (pitch_rate * sin_roll + yaw_rate * cos_roll) / cos_pitch * dt),
        v_x=gripped * told_x,
        v_y=gripped * told_y,
        yaw_rate=yaw_rate,
        distance=state.distance + travel,
        covariance=covariance,
        mounting=state.mounting,
        keys=state.keys,
        slip_error=kept * slip_error,
        side_error=kept * state.side_error,
        slip_sigma=slip_sigma,
        side_sigma=side_sigma,
        gyro_bias=state.gyro_bias,
        standing_for=standing_for,
        residual=residual,
        yaw_rate_difference=difference,
        downhill=smoothed(state.downhill, downhill_of(roll, pitch, state.yaw), abs(v_x) * dt),
        turn_drift=turn_drift + slid,
        encoder_jumps=state.encoder_jumps + motion.jumps,
    )


def stood(params: OdometryParams, state: OdometryState, time: float) -> OdometryState:
    """After a time [s] of which nothing has been measured; of a rover that stands: its gyro's bias has walked on."""
    if state.standing_for < params.standing_time:
        return state
    covariance = state.covariance.copy()
    covariance[5, 5] += params.gyro_bias_walk**2 * time
    return replace(state, covariance=covariance, standing_for=state.standing_for + time)


def corrected(odometry: OdometryState, change: FloatArray, covariance: FloatArray) -> OdometryState:
    """The state after a measurement that has changed all that the covariance is of, shapes (n,) and (n, n)."""
    mounting, keys, rest = odometry.mounting, odometry.keys, len(change)
    if keys is not None:
        rest -= keys.size
        keys = keys + change[rest:].reshape(keys.shape)
        keys[:, 2] = [wrap_angle(float(yaw)) for yaw in keys[:, 2]]
    if rest > MOUNTING:
        mounting = mounting + change[MOUNTING:rest]
    return replace(
        odometry,
        x=odometry.x + float(change[0]),
        y=odometry.y + float(change[1]),
        yaw=wrap_angle(odometry.yaw + float(change[2])),
        slip_error=min(max(odometry.slip_error + float(change[SLIP]), LEAST_SLIP_ERROR), LARGEST_SLIP_ERROR),
        side_error=odometry.side_error + float(change[SIDE_SLIP]),
        gyro_bias=odometry.gyro_bias + float(change[5]),
        mounting=mounting,
        keys=keys,
        covariance=covariance,
    )


def message_covariances(params: OdometryParams, state: OdometryState, dt: float) -> tuple[FloatArray, FloatArray]:
    """Covariances as nav_msgs/Odometry orders them, both positive definite and of shape (6, 6).

    Returns:
        That of x, y, z [m], roll, pitch, yaw [rad] in odom, and that of v_x, v_y, v_z [m/s], w_x, w_y, w_z
        [rad/s] in base_link. Errors of height grow from that at the start with
        distance times the error of tilt.
    """
    speed = math.hypot(state.v_x, state.v_y)
    told = speed / max(1.0 - state.slip_error, LEAST_GROUND)
    pose, twist = covariances_of(
        state.covariance,
        params.tilt_sigma,
        params.start_height_sigma**2 + (params.tilt_sigma * float(state.distance)) ** 2,
        params.travel_sigma**2 * speed / dt,
        float(state.covariance[SLIP, SLIP]) * told**2,
        (state.side_sigma * speed) ** 2,
        params.gyro_random_walk**2 / dt + float(state.covariance[5, 5]),
    )
    return pose, twist
