"""Slip of each wheel, from encoders, motor torques, gyro and accelerometer, and wheels that are in trouble.

What is seen of it. Encoders and gyro tell the differences between the wheels, never the slip that they share: wheels
that agree may all spin. That level comes from two sides:

- torque: the force that the grade and the resistances ask for has its slip on the believed soil (`traction`);
- acceleration: after a stop the IMU knows the speed for some seconds, which sets the soil's factor (`speed_filter`).

The slip of a wheel is then s = (r w - v) / max(|r w|, |v|), with v what the motion of the body gives at the wheel
along its rolling direction, and r the radius on which the soil shears, that of the grouser tips. What is told outside
(`slip_status`) is counted on the rim, 1 - s_rim = (1 - s) r / r_rim, as the plant does and the field: Wong and Reece
(1967) define it with the wheel's radius, and zero is then a wheel that rolls freely.

Where there is none to tell: the way that the wheels make as one must be at least least_speed and TURNING_PART of what
the fastest rim makes. While the machine stands, comes to a halt or turns on the spot, the body rocks by more than the
wheels roll, and a speed over theirs says nothing; no slip is reported then, and odometry takes the expected one.

Trouble, reported in words: wheels that spin without headway (slip above a limit for a time, beyond doubt); a wheel that
turns without its load (off the ground, in a hole, or a broken shaft); a wheel that stands while others roll (blocked).
Sources: Ojeda et al. (2006), IEEE Trans. Robotics 22:366; Wong (2008), Theory of Ground Vehicles, sec. 2.5 and 4.1.

Not seen: slip on firm ground, where torque needs none. The camera sees it, where the ground has relief (`key_frames`).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.rolling_lines import rolling_line
from sojourn_flight.mobility.wheel_twist import velocity_kernel
from sojourn_flight.odometry.slip_params import SlipParams, TractionCurve
from sojourn_flight.odometry.speed_filter import (
    DRIFT,
    ROCKING_LAG,
    ROCKING_RATE,
    SPEED,
    ProcessNoise,
    bound_factor,
    carry_gravity,
    felt_rocking,
    felt_tilting,
    initial_covariance,
    is_tilting,
    level_gravity,
    predict,
    rest,
    rest_share,
    roll,
    stand,
    turn_to,
    update,
)
from sojourn_flight.odometry.traction import LOWEST_SLIP, believed_slip, coefficient, in_rut
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

STANDING_STILL = 1e-4
"""Speed of the fastest rim below which the machine stands [m/s]."""
SETTLED_AFTER = 0.5
"""Time for which the wheels must have stood before the machine does not rock any more [s]."""
RESTING_AFTER = 3.0
"""Time for which they must have stood before what gyro and accelerometer tell is no motion of the body at all [s]."""
ROCKING, ROCKING_SIGMA = 3.0, 0.002
"""Speed of the body against its wheels: over the change of their speed in the lag [-], and at a steady pace [m/s]."""
TURNING_SIGMA = 0.01
"""Speed of base_link that wheels turning on the spot may leave [m/s]."""
TURNING_PART = 0.25
"""A machine whose wheels make less way as one than this part of the fastest rim's turns on the spot [-]."""
TURNED_APART = 1.3
"""Variance of two biases that were one before a turn, over theirs and its angle [1/rad]."""
UNKNOWN_SPEED_SIGMA = 0.1
"""Of a machine that moves already when the drive starts [m/s]."""
ROCKING_ACCELERATION = 0.3
"""Of a machine that has just stopped or changes its pace: in the one reading that gravity is taken from when the drive
starts, and while no reading comes [m/s^2]."""
SAMPLED_WITHIN = 0.1
"""A reading of the IMU speaks for so long, in a drive ten times a second [s]; beyond it nobody has felt the motion."""
HEADWAY_LOST, CERTAIN = 0.5, 2.0
"""Wheels spin without headway where at least this part of their way is lost, so many standard deviations from doubt: at
the end of a way the wheels are so slow that a few mm/s of doubt are a slip of 1 [-]."""
IDLE_EXPECTED = 0.3
"""Torque that a wheel must be expected to need before it can lack it [N m]."""


class SlipInput(NamedTuple):
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


class SlipState(NamedTuple):
    """What is believed, and what the next period needs."""

    states: FloatArray
    """Speed [m/s], drift [m/s^2], soil factor [-], flicker [m/s^2]; shape (4,)."""
    covariance: FloatArray
    """Shape (4, 4)."""
    gravity: FloatArray
    """In base_link, as the accelerometers feel it, shape (3,) [m/s^2]; zero before the first period."""
    rest_rate: FloatArray
    """What the gyros tell of a machine at rest about x and y of base_link: the planet's spin and their bias, shape (2,)
    [rad/s]."""
    torques: FloatArray
    """Averaged torque of each wheel less that of its rotor [N m]."""
    rates: FloatArray
    """Rate of each wheel [rad/s]."""
    slip: FloatArray
    """Of each wheel, -1 (blocked) to 1 (spins on the spot) [-]."""
    observable: bool
    """Whether the wheels turn in such a way that the machine's slip can be observed."""
    shared: float
    """Slip of the machine: 1 - speed over ground / speed of the wheels; 0 where it is not observable [-]."""
    sigma: float
    """Standard deviation of that [-]."""
    ahead: FloatArray
    """Where the wheels roll to, or did when they last rolled: unit vector in base_link, shape (2,)."""
    tilting: FloatArray
    """From `felt_tilting`, shape (2, 2)."""
    felt: FloatArray
    """Acceleration along x of base_link: mean [m/s^2] and variance [m^2/s^4] of late, shape (2,)."""
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


class WheeledMachine(NamedTuple):
    """What the kernel knows of the machine and its ground."""

    table: FloatArray
    """Of the wheels."""
    loads: FloatArray
    """From `wheel_load_map`, shape (wheels, 3) [N]."""
    curves: FloatArray
    """Limit, softness and offset on fresh ground and in a rut, shape (2, 3)."""


class Trust(NamedTuple):
    """The numbers of SlipParams, by their names there."""

    rut_width: float
    free_slip: float
    rotor_inertia: float
    torque_lag: float
    torque_error: float
    factor_sigma: float
    factor_length: float
    slip_noise: float
    slip_noise_time: float
    force_noise: float
    accelerometer_bias: float
    accelerometer_flicker: float
    drift_walk: float
    least_speed: float
    stuck_slip: float
    idle_torque: float


@dataclass(frozen=True, eq=False, slots=True)
class SlipModel:
    """Parameters of one machine, prepared for the kernel."""

    params: SlipParams
    machine: WheeledMachine
    trust: Trust

    @staticmethod
    def of(params: SlipParams, table: FloatArray, loads: FloatArray) -> "SlipModel":
        """The model of a machine."""
        machine = WheeledMachine(table, loads, np.array([_row(params.fresh), _row(params.rut)]))
        return SlipModel(params, machine, Trust(*(getattr(params, name) for name in Trust._fields)))

    def initial_state(self, at_rest: bool = True) -> SlipState:
        """Before the first period. at_rest: False where the machine may still rock, as after a drive that has died."""
        zero = np.zeros(self.machine.table.shape[0])
        params = self.params
        drift = math.hypot(params.drift_sigma, 0.0 if at_rest else ROCKING_ACCELERATION)
        return SlipState(
            states=np.array((0.0, 0.0, 1.0, 0.0)),
            covariance=initial_covariance(UNKNOWN_SPEED_SIGMA, drift, _noise(self.trust, 0.0)),
            gravity=np.zeros(3),
            rest_rate=np.zeros(2),
            torques=zero,
            rates=zero,
            slip=zero,
            observable=False,
            shared=0.0,
            sigma=0.0,
            ahead=np.array((1.0, 0.0)),
            tilting=np.zeros((2, 2)),
            felt=np.zeros(2),
            way=0.0,
            pace=0.0,
            standing_for=0.0,
            stuck_for=zero,
            idle_for=zero,
            blocked_for=zero,
        )


def estimate_slip(model: SlipModel, state: SlipState, measured: SlipInput, dt: float) -> SlipState:
    """State after one period of `dt` [s]; `measured` has been checked by the drive."""
    if not np.count_nonzero(state.gravity):
        state = state._replace(gravity=level_gravity(measured.specific_force, measured.roll_pitch))
    elif dt > SAMPLED_WITHIN:
        state = _levelled_anew(state, measured.roll_pitch, model.params.drift_sigma)
    return SlipState(*_period(model.machine, model.trust, state, measured, dt))


def _levelled_anew(state: SlipState, roll_pitch: tuple[float, float], sigma: float) -> SlipState:
    """After a time in which nobody has felt how the body turned: gravity as roll and pitch tell it, and a drift of
    which nothing is known but its sigma [m/s^2].
    """
    states, covariance = state.states.copy(), state.covariance.copy()
    states[DRIFT] = 0.0
    covariance[DRIFT], covariance[:, DRIFT] = 0.0, 0.0
    covariance[DRIFT, DRIFT] = sigma**2
    gravity = level_gravity(state.gravity, roll_pitch)
    return state._replace(states=states, covariance=covariance, gravity=gravity)


def _row(curve: TractionCurve) -> tuple[float, float, float]:
    return curve.limit, curve.softness, curve.offset


@njit(cache=True)
def _noise(trust: Trust, drift_variance: float) -> ProcessNoise:
    return ProcessNoise(
        trust.force_noise, trust.accelerometer_flicker, drift_variance, trust.factor_sigma, trust.factor_length
    )


@njit(cache=True)
def _period(machine: WheeledMachine, trust: Trust, old: SlipState, seen: SlipInput, dt: float) -> SlipState:
    """The state after a period."""
    table, rates, angles, gyro = machine.table, seen.wheel_rates, seen.steer_angles, seen.gyro
    least_speed, force_noise = trust.least_speed, trust.force_noise
    roll_angle, pitch = seen.roll_pitch
    lasting = min(dt, SAMPLED_WITHIN)  # for which the readings speak
    share = dt / (trust.torque_lag + dt)
    rotor = trust.rotor_inertia * share / dt
    inflation = 2.0 * trust.slip_noise_time / dt
    count = table.shape[0]
    states, covariance = old.states.copy(), old.covariance.copy()
    rest_rate = old.rest_rate.copy()
    gravity = old.gravity
    if dt <= SAMPLED_WITHIN:
        gravity = carry_gravity(gravity, np.array((gyro[0] - rest_rate[0], gyro[1] - rest_rate[1], gyro[2])), dt)
    felt, torques = seen.specific_force + gravity, np.empty(count)
    rocking, tilting = felt_rocking(old.felt, felt[0], lasting), felt_tilting(old.tilting, gyro, lasting)
    standing, fastest = np.zeros(count), 0.0
    for i in range(count):
        late = seen.wheel_torques[i] - old.torques[i]
        torques[i] = old.torques[i] + share * late - rotor * (rates[i] - old.rates[i])
        rim = abs(table[i, 2] * rates[i])
        fastest = max(fastest, rim)
        standing[i] = 1.0 if rim < 0.5 * least_speed else 0.0
    v_x, v_y, _ = velocity_kernel(table, rates, angles, np.zeros(count), gyro[2], 1.0)
    wheels = math.hypot(v_x, v_y)
    pace = old.pace + lasting / (trust.torque_lag + lasting) * (wheels - old.pace)
    observable = wheels >= max(least_speed, TURNING_PART * fastest)
    ahead = np.array((v_x / wheels, v_y / wheels)) if observable else old.ahead
    ahead_x, ahead_y = ahead[0], ahead[1]
    turn_to(states, covariance, ahead_x * old.ahead[0] + ahead_y * old.ahead[1], TURNING_SIGMA)

    stuck, idle, blocked = np.zeros(count), np.zeros(count), np.zeros(count)
    slip = np.zeros(count)
    shared, sigma = 0.0, 0.0
    standing_for = (old.standing_for if dt <= SAMPLED_WITHIN else 0.0) + lasting if fastest < STANDING_STILL else 0.0
    if standing_for > SETTLED_AFTER:
        if standing_for > RESTING_AFTER and not is_tilting(tilting):
            rest(states, gravity, rest_rate, gyro, felt[1], rest_share(standing_for - RESTING_AFTER, dt))
        stand(states, covariance, rocking, felt[0], dt, _noise(trust, trust.drift_walk**2 * dt))
        torques[:] = 0.0
        return SlipState(
            states, covariance, gravity, rest_rate, torques, rates, slip, False, shared, sigma, ahead, tilting, rocking,
            old.way, pace, standing_for, stuck, idle, blocked,
        )  # fmt: skip
    acceleration = felt[0] * ahead_x + felt[1] * ahead_y
    drift_variance = (trust.drift_walk**2 + TURNED_APART * abs(gyro[2]) * trust.accelerometer_bias**2) * dt
    predict(states, covariance, acceleration, ahead_x, wheels * dt, dt, _noise(trust, drift_variance))
    covariance[SPEED, SPEED] += (ROCKING_ACCELERATION * max(dt - SAMPLED_WITHIN, 0.0)) ** 2
    loads, way = machine.loads, old.way
    along, levers, counts = np.empty(count), np.empty(count), np.empty(count)
    kinds = np.zeros(count, dtype=np.int64)
    level, nose, lean = math.cos(pitch) * math.cos(roll_angle), math.sin(pitch), math.sin(roll_angle) * math.cos(pitch)
    for i in range(count):
        x, y, w, known = rolling_line(table[i], angles[i], 0.0)
        along[i] = x * v_x + y * v_y + w * gyro[2] + known
        load = max(loads[i, 0] * level + loads[i, 1] * nose + loads[i, 2] * lean, 0.0)
        levers[i] = table[i, 2] * load
        kinds[i] = 1 if in_rut(table, i, ahead_x, ahead_y, trust.rut_width, way) else 0
        counts[i] = 0.0 if standing[i] > 0.5 or old.idle_for[i] > 1.0 else 1.0
    if not observable:
        off = v_x * ahead_x + v_y * ahead_y - states[SPEED]
        update(states, covariance, np.array((1.0, 0.0, 0.0, 0.0)), off, TURNING_SIGMA**2 * inflation)
    elif counts.sum() > 0.5:
        pulling = np.empty(count)
        for i in range(count):
            pulling[i] = torques[i] if along[i] >= 0.0 else -torques[i]
        believed, per_torque = believed_slip(pulling, levers, kinds, counts, machine.curves)
        spread = math.hypot(trust.slip_noise, trust.torque_error * (levers * counts).sum() * per_torque)
        # A body on its wheels rocks when they change their speed: by no more than that, nor than is felt of it.
        swing = math.sqrt(max(rocking[1] - 2.0 * force_noise**2 / dt, 0.0)) / ROCKING_RATE
        rocks = math.hypot(ROCKING * min(abs(wheels - pace), swing), ROCKING_SIGMA)
        variance = (wheels * spread) ** 2 * inflation + rocks**2 * 2.0 * ROCKING_LAG / dt
        roll(states, covariance, wheels, believed, trust.free_slip, variance)
        bound_factor(states, trust.factor_sigma)
        shared = min(max(1.0 - states[SPEED] / wheels, LOWEST_SLIP), 1.0)
        sigma = math.sqrt(max(covariance[SPEED, SPEED], 0.0)) / wheels
        for i in range(count):
            expected = levers[i] * coefficient(machine.curves[kinds[i]], min(believed, 1.0))
            if expected > IDLE_EXPECTED and pulling[i] < trust.idle_torque * expected and standing[i] < 0.5:
                idle[i] = old.idle_for[i] + lasting
    if observable:
        way += max(states[SPEED], 0.0) * dt
    elif fastest >= least_speed:  # on the spot, out of the ruts
        way = 0.0
    ground = 1.0 - shared
    for i in range(count):
        x, y, w, known = rolling_line(table[i], angles[i], 0.0)
        over_ground = (x * v_x + y * v_y) * ground + w * gyro[2] + known
        rim = table[i, 2] * rates[i]
        largest = max(abs(rim), abs(over_ground))
        if largest >= least_speed:
            slip[i] = (rim - over_ground) / largest * (1.0 if rim + over_ground >= 0.0 else -1.0)
        if observable and slip[i] > trust.stuck_slip and slip[i] - CERTAIN * sigma > HEADWAY_LOST:
            stuck[i] = old.stuck_for[i] + lasting
        if standing[i] > 0.5 and abs(table[i, 2] * seen.commanded_rates[i]) >= least_speed and fastest >= least_speed:
            blocked[i] = old.blocked_for[i] + lasting
    return SlipState(
        states, covariance, gravity, rest_rate, torques, rates, slip, observable, shared, sigma, ahead, tilting,
        rocking, way, pace, standing_for, stuck, idle, blocked,
    )  # fmt: skip
