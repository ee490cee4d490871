"""Slip of each wheel, from encoders, motor torques, gyro and accelerometer, and wheels that are in trouble.

What is seen of it. Encoders and gyro tell the differences between the wheels, never the slip that they share: wheels
that agree may all spin. That level comes from two sides:

- torque: the force that the grade and the resistances ask for has its slip on the believed soil (`traction`);
- acceleration: after a stop the IMU knows the speed for some seconds, which sets the soil's factor (`speed_filter`).

The slip of a wheel is then s = (r w - v) / max(|r w|, |v|), with v what the motion of the body gives at the wheel
along its rolling direction, and r the radius on which the soil shears, that of the grouser tips. What is told outside
(`slip_status`) is counted on the rim, 1 - s_rim = (1 - s) r / r_rim, as the plant does and the field: Wong and Reece
(1967) define it with the wheel's radius, and zero is then a wheel that rolls freely.

Trouble, told in words: wheels that spin without headway (slip above a limit for a time); a wheel that turns without its
load (off the ground, in a hole, or a broken shaft); a wheel that stands while others roll (blocked). Sources: Ojeda et
al. (2006), IEEE Trans. Robotics 22:366; Wong (2008), Theory of Ground Vehicles, sec. 2.5 and 4.1.

Not seen: slip on firm ground, where torque needs none. The camera sees it, where the ground has relief (`key_frames`).
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.rolling_lines import rolling_line
from sojourn_mechanics.steering.slip_params import SlipParams, TractionCurve
from sojourn_mechanics.steering.speed_filter import FACTOR, SPEED, carry_gravity, predict, roll, stand, update
from sojourn_mechanics.steering.traction import believed_slip, coefficient, in_rut
from sojourn_mechanics.steering.wheel_twist import velocity_kernel

STANDING_STILL = 1e-4
"""Speed of the fastest rim below which the machine stands [m/s]."""
SETTLED_AFTER = 0.5
"""Time for which the wheels must have stood before the machine does not rock any more [s]."""
ROCKING, ROCKING_SIGMA = 3.0, 0.002
"""Speed of the body against its wheels: over the change of their speed in the lag [-], and at a steady pace [m/s]."""
TURNING_SIGMA = 0.01
"""Speed of base_link that wheels turning on the spot may leave [m/s]."""
UNKNOWN_SPEED_SIGMA = 0.1
"""Of a machine that moves already when the drive starts [m/s]."""
ROCKING_ACCELERATION = 0.3
"""Of a machine that has just stopped, in the one reading that gravity is taken from when the drive starts [m/s^2]."""
ALSO = 0.5
"""Part of the time that makes trouble of a wheel, from which others in the same state are named with it [-]."""
IDLE_EXPECTED = 0.3
"""Torque that a wheel must be expected to need before it can lack it [N m]."""


@dataclass(frozen=True, slots=True)
class SlipInput:
    """Measurements of one period; arrays of wheels have shape (wheels,)."""

    wheel_rates: FloatArray
    """[rad/s]"""
    commanded_rates: FloatArray
    """[rad/s]"""
    steer_angles: FloatArray
    """[rad]"""
    wheel_torques: FloatArray
    """[N m]"""
    gyro: FloatArray
    """In base_link, less the bias of its z axis, shape (3,) [rad/s]."""
    specific_force: FloatArray
    """In base_link, shape (3,) [m/s^2]."""
    roll_pitch: tuple[float, float]
    """[rad]"""


@dataclass(frozen=True, slots=True)
class SlipState:
    """What is believed, and what the next period needs."""

    states: FloatArray
    """Speed [m/s], drift [m/s^2], soil factor [-]; shape (3,)."""
    covariance: FloatArray
    """Shape (3, 3)."""
    gravity: FloatArray | None
    """In base_link, as the accelerometers feel it, shape (3,) [m/s^2]; None before the first period."""
    torques: FloatArray
    """Averaged torque of each wheel less that of its rotor [N m]."""
    rates: FloatArray
    """Rate of each wheel [rad/s]."""
    slip: FloatArray
    """Of each wheel, -1 (blocked) to 1 (spins on the spot) [-]."""
    shared: float
    """Slip of the machine: 1 - speed over ground / speed of the wheels [-]."""
    sigma: float
    """Standard deviation of that [-]."""
    way: float
    """Over ground since the machine began to make tracks: at the start, and after turning on the spot [m]."""
    pace: float
    """Speed of the wheels, averaged as the torques are [m/s]."""
    standing_for: float
    """Time for which no wheel has turned [s]."""
    stuck_for: FloatArray
    """Time for which each wheel has spun without headway [s]."""
    idle_for: FloatArray
    """Time for which each wheel has turned without its load [s]."""
    blocked_for: FloatArray
    """Time for which each wheel has stood while it should turn [s]."""


@dataclass(frozen=True, eq=False, slots=True)
class SlipModel:
    """Parameters of one machine, prepared for the kernels.

    Args:
        params: belief and trust. table: of the wheels. loads: from `wheel_load_map`, (wheels, 3) [N].
    """

    params: SlipParams
    table: FloatArray
    loads: FloatArray
    curves: FloatArray

    @staticmethod
    def of(params: SlipParams, table: FloatArray, loads: FloatArray) -> "SlipModel":
        """The model of a machine."""
        return SlipModel(params, table, loads, np.array([_row(params.fresh), _row(params.rut)]))

    def initial_state(self, at_rest: bool = True) -> SlipState:
        """Before the first period. at_rest: False where the machine may still rock, as after a drive that has died."""
        zero = np.zeros(self.table.shape[0])
        params = self.params
        drift = params.drift_sigma**2 + (0.0 if at_rest else ROCKING_ACCELERATION**2)
        variances = (UNKNOWN_SPEED_SIGMA**2, drift, params.factor_sigma**2)
        return SlipState(
            states=np.array((0.0, 0.0, 1.0)),
            covariance=np.diag(np.array(variances)),
            gravity=None,
            torques=zero,
            rates=zero,
            slip=zero,
            shared=0.0,
            sigma=0.0,
            way=0.0,
            pace=0.0,
            standing_for=0.0,
            stuck_for=zero,
            idle_for=zero,
            blocked_for=zero,
        )


def estimate_slip(model: SlipModel, state: SlipState, measured: SlipInput, dt: float) -> SlipState:
    """State after one period of `dt` [s]; `measured` has been checked by the drive."""
    params = model.params
    gravity = state.gravity
    if gravity is None:
        roll_angle, pitch = measured.roll_pitch
        size = float(np.linalg.norm(measured.specific_force))
        level = math.cos(pitch)
        gravity = size * np.array(
            (math.sin(pitch), -level * math.sin(roll_angle), -level * math.cos(roll_angle)), dtype=np.float64
        )
    share = dt / (params.torque_lag + dt)
    return SlipState(
        *_period(
            model.table,
            model.loads,
            model.curves,
            state.states,
            state.covariance,
            gravity,
            state.torques,
            state.rates,
            measured.wheel_rates,
            measured.commanded_rates,
            measured.steer_angles,
            measured.wheel_torques,
            measured.gyro,
            measured.specific_force,
            measured.roll_pitch[0],
            measured.roll_pitch[1],
            share,
            params.rotor_inertia * share / dt,
            params.rut_width,
            params.least_speed,
            params.force_noise,
            params.drift_walk,
            params.factor_sigma,
            params.factor_length,
            params.free_slip,
            params.torque_error,
            params.slip_noise,
            2.0 * params.slip_noise_time / dt,
            params.stuck_slip,
            params.idle_torque,
            state.way,
            state.pace,
            state.standing_for,
            state.stuck_for,
            state.idle_for,
            state.blocked_for,
            state.shared,
            state.sigma,
            dt,
        )
    )


def trouble(params: SlipParams, state: SlipState, names: tuple[str, ...]) -> str:
    """Which wheels are in trouble, in words; empty where none is."""

    def named(times: FloatArray, limit: float) -> str:
        if not (times >= limit).any():
            return ""
        return ", ".join(name for name, time in zip(names, times, strict=True) if time >= ALSO * limit)

    found = (
        (f"spinning without headway (slip {float(state.slip.max()):.2f})", state.stuck_for, params.stuck_time),
        ("turning without load", state.idle_for, params.idle_time),
        ("blocked", state.blocked_for, params.stuck_time),
    )
    return "; ".join(f"{text}: {wheels}" for text, times, limit in found if (wheels := named(times, limit)))


def is_stuck(params: SlipParams, state: SlipState) -> bool:
    """Whether a wheel spins without headway."""
    return bool((state.stuck_for >= params.stuck_time).any())


def further_slip(slip: float, error: float) -> float:
    """The slip of a wheel that gets over ground less than was thought by a part `error` of its way."""
    ground = (1.0 - slip if slip >= 0.0 else 1.0 / max(1.0 + slip, 1e-6)) * (1.0 - error)
    return 1.0 - ground if ground <= 1.0 else 1.0 / ground - 1.0


def slip_status(
    model: SlipModel | None, state: SlipState | None, names: tuple[str, ...], error: float = 0.0
) -> dict[str, str | float]:
    """Fields of /drive/status, slips counted on the rim; none where slip is not estimated.

    Args:
        error: what the camera has found the way to be shorter than that of the estimate, over it [-].
    """
    if model is None or state is None:
        return {}
    tips_over_rim = 1.0 / (1.0 - model.params.free_slip)
    further = 1.0 - (1.0 - error) * tips_over_rim
    status: dict[str, str | float] = {
        f"slip_{name}": further_slip(float(slip), further) for name, slip in zip(names, state.slip, strict=True)
    }
    status["slip"], status["slip_sigma"] = further_slip(state.shared, further), state.sigma * tips_over_rim
    status["soil_factor"] = float(state.states[FACTOR])
    status["soil_factor_sigma"] = math.sqrt(state.covariance[FACTOR, FACTOR])
    status["wheels_in_trouble"] = trouble(model.params, state, names)
    return status


def _row(curve: TractionCurve) -> tuple[float, float, float]:
    return curve.limit, curve.softness, curve.offset


@njit(cache=True)
def _period(
    table: FloatArray, loads: FloatArray, curves: FloatArray, old_states: FloatArray, old_covariance: FloatArray,
    old_gravity: FloatArray, old_torques: FloatArray, old_rates: FloatArray, rates: FloatArray, commands: FloatArray,
    angles: FloatArray, torques: FloatArray, gyro: FloatArray, force: FloatArray, roll_angle: float, pitch: float,
    share: float, rotor: float, rut_width: float, least_speed: float, force_noise: float, drift_walk: float,
    factor_sigma: float, factor_length: float, free_slip: float, torque_error: float, slip_noise: float,
    inflation: float,
    stuck_slip: float, idle_torque: float, way: float, pace: float, standing_for: float, old_stuck: FloatArray,
    old_idle: FloatArray, old_blocked: FloatArray, old_shared: float, old_sigma: float, dt: float,
) -> tuple[
    FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, float, float, float, float, float,
    FloatArray, FloatArray, FloatArray,
]:  # fmt: skip
    """The fields of a SlipState after a period; `rotor` is the rotor's inertia over the lag of the averages."""
    count = table.shape[0]
    states, covariance = old_states.copy(), old_covariance.copy()
    gravity = carry_gravity(old_gravity, gyro, dt)
    felt, smooth_torques = force + gravity, np.empty(count)
    standing, fastest = np.zeros(count), 0.0
    for i in range(count):
        smooth_torques[i] = old_torques[i] + share * (torques[i] - old_torques[i]) - rotor * (rates[i] - old_rates[i])
        rim = abs(table[i, 2] * rates[i])
        fastest = max(fastest, rim)
        standing[i] = 1.0 if rim < 0.5 * least_speed else 0.0
    v_x, v_y, _ = velocity_kernel(table, rates, angles, np.zeros(count), gyro[2], 1.0)
    wheels = math.hypot(v_x, v_y)
    pace += share * (wheels - pace)
    ahead_x, ahead_y = (v_x / wheels, v_y / wheels) if wheels >= least_speed else (1.0, 0.0)

    stuck, idle, blocked = np.zeros(count), np.zeros(count), np.zeros(count)
    slip = np.zeros(count)
    shared, sigma = old_shared, old_sigma
    standing_for = standing_for + dt if fastest < STANDING_STILL else 0.0
    if standing_for > SETTLED_AFTER:
        stand(states, covariance, felt[0], force_noise**2 / dt)
        smooth_torques[:] = 0.0
        return (
            states, covariance, gravity, smooth_torques, rates, slip, shared, sigma, way, pace,
            standing_for, stuck, idle, blocked,
        )  # fmt: skip
    acceleration = felt[0] * ahead_x + felt[1] * ahead_y
    predict(
        states, covariance, acceleration, ahead_x, wheels * dt, dt, force_noise, drift_walk, factor_sigma, factor_length
    )
    along, levers, counts = np.empty(count), np.empty(count), np.empty(count)
    kinds = np.zeros(count, dtype=np.int64)
    level, nose, lean = math.cos(pitch) * math.cos(roll_angle), math.sin(pitch), math.sin(roll_angle) * math.cos(pitch)
    for i in range(count):
        x, y, w, known = rolling_line(table[i], angles[i], 0.0)
        along[i] = x * v_x + y * v_y + w * gyro[2] + known
        load = max(loads[i, 0] * level + loads[i, 1] * nose + loads[i, 2] * lean, 0.0)
        levers[i] = table[i, 2] * load
        kinds[i] = 1 if in_rut(table, i, ahead_x, ahead_y, rut_width, way) else 0
        counts[i] = 0.0 if standing[i] > 0.5 or old_idle[i] > 1.0 else 1.0
    if wheels < least_speed:
        update(states, covariance, np.array((1.0, 0.0, 0.0)), wheels - states[SPEED], TURNING_SIGMA**2 * inflation)
    elif counts.sum() > 0.5:
        pulling = np.empty(count)
        for i in range(count):
            pulling[i] = smooth_torques[i] if along[i] >= 0.0 else -smooth_torques[i]
        believed, per_torque = believed_slip(pulling, levers, kinds, counts, curves)
        spread = math.hypot(slip_noise, torque_error * (levers * counts).sum() * per_torque)
        # a body on its wheels rocks when they change their speed
        doubt = math.sqrt((wheels * spread) ** 2 + (ROCKING * (wheels - pace)) ** 2 + ROCKING_SIGMA**2)
        roll(states, covariance, wheels, believed, free_slip, doubt, inflation)
        shared = min(max(1.0 - states[SPEED] / wheels, -1.0), 1.0)
        sigma = math.sqrt(max(covariance[SPEED, SPEED], 0.0)) / wheels
        for i in range(count):
            expected = levers[i] * coefficient(curves[kinds[i]], min(believed, 1.0))
            if expected > IDLE_EXPECTED and pulling[i] < idle_torque * expected and standing[i] < 0.5:
                idle[i] = old_idle[i] + dt
    way = way + max(states[SPEED], 0.0) * dt if wheels >= least_speed else 0.0
    ground = 1.0 - shared
    for i in range(count):
        x, y, w, known = rolling_line(table[i], angles[i], 0.0)
        over_ground = (x * v_x + y * v_y) * ground + w * gyro[2] + known
        rim = table[i, 2] * rates[i]
        largest = max(abs(rim), abs(over_ground))
        if largest >= least_speed:
            slip[i] = (rim - over_ground) / largest * (1.0 if rim + over_ground >= 0.0 else -1.0)
        if slip[i] > stuck_slip and wheels >= least_speed:
            stuck[i] = old_stuck[i] + dt
        if standing[i] > 0.5 and abs(table[i, 2] * commands[i]) >= least_speed and fastest >= least_speed:
            blocked[i] = old_blocked[i] + dt
    return (
        states, covariance, gravity, smooth_torques, rates, slip, shared, sigma, way, pace, standing_for, stuck,
        idle, blocked,
    )  # fmt: skip
