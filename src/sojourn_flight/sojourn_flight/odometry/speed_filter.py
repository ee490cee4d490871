"""Speed over ground from wheels that slip and an IMU: a Kalman filter of speed, drift and soil.

States: speed v over ground along the heading of the wheels' motion [m/s]; drift b and flicker c, the error of the
acceleration along x of base_link [m/s^2]; soil factor q, the slip over the one that the torques speak of (`traction`)
[-].

    v' = a - d_x (b + c) + n_a,  b' = n_b,  c' = -c/T + n_c,  q: 1 + (q - 1) e^(-way / length), renewed to its sigma
    moving:   v = u (1 - s_0 - q (s - s_0)) + n_s,   u speed of the wheels, s believed slip, s_0 free slip
    standing: v = 0,  a = d_x (b + c) + n_a           what the accelerometers feel at rest is their error

The bias of an accelerometer flickers: of its coefficient B (bias instability) each decade of time has the variance
FLICKER_PART^2 B^2. Those of T = 10 s, over which a start of the machine goes, are c; faster ones are noise as good as
white, of the density 2 T_f FLICKER_PART^2 B^2, slower ones are within the walk of b. A walk that moves as much in
seconds is beyond all that flicker does in a minute: what it says of speed is too little in the first seconds or next
to nothing later.

a = (f + g).d is strapdown: specific force and gravity along the motion, gravity carried in base_link by the gyros, g' =
-w x g, from the last levelling. Gyros feel the planet's spin too, which on Mars is 15 deg/h: what they tell of a
machine at rest is taken off (`rest`), or minutes of standing would tilt gravity away. Its error keeps its direction on
the ground, while a bias of the accelerometers turns with the body: at the levelling they cancel, and after a turn by t
their difference has the variance 2 (1 - cos t) sigma^2, here 1.3 |t| sigma^2, which is more up to a half turn but for 9
% at two radians. Speed is along the motion of the wheels, with its sign: where that turns, as in going backwards after
forwards, so does it.

A body whose wheels stand still rocks for seconds: v = 0 holds within rock / ROCKING_RATE and a = d_x b within rock,
with rock^2 the variance of the acceleration that is felt, less that of the noise, averaged over ROCKING_LAG.

White noise that is correlated over a time T counts 2 T/dt times (its spectrum at zero: 2 T, Papoulis): the error of
the believed slip for seconds, the body's rocking for ROCKING_LAG. So where the wheels slow down at the end of a way,
and an error of slip is little speed, they hold the speed: with the rocking taken for as lasting as the other, the drift
of the accelerometer over a speed that goes to zero was told as a slip of 1.

After a stop, a tactical IMU on a small body knows the speed to some mm/s for some ten seconds (drift of gyros times
gravity): as long as that is better than the wheels', it finds the soil's factor, which stays.

Sources: Gelb (1974), Applied Optimal Estimation, sec. 4.2; IEEE Std 952-1997, annex C (flicker as a sum of such
processes: `sojourn_physics.sensors.inertial_errors`); Foxlin (2005), IEEE Computer Graphics and Applications
25(6):38 (zero-velocity updates); Skog et al. (2010), IEEE Trans. Biomedical Engineering 57(11):2657 (acceleration's
moving variance tells of standing); Ojeda et al. (2006), IEEE Trans. Robotics 22:366 (slip from motor current).
Assumptions: the machine moves where its wheels roll to; lever arm of the IMU times the tilt rate is small.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

SPEED, DRIFT, FACTOR, FLICKER = range(4)
STATES = 4
FLICKER_TIME, FAST_FLICKER_TIME = 10.0, 1.0
"""T and T_f [s]."""
FLICKER_PART = math.sqrt(math.log(10.0) / math.pi)
"""Standard deviation of a decade of a flicker, over its coefficient [-]."""
STANDING_SIGMA = 1e-3
"""Speed of a machine whose wheels stand [m/s]."""
ROCKING_RATE = 5.0
"""Slowest rocking of a body on its wheels, in angle [rad/s]."""
ROCKING_LAG = 0.5
"""Time over which the acceleration that is felt is averaged [s]."""
REST_PRIOR, REST_MEMORY = 10.0, 120.0
"""A rest of so long counts half against what was known before, and one of more than that is forgotten [s]."""
QUICK_TILT, SLOW_TILT = 0.5, 5.0
"""Times over which the tilt rate is averaged [s]: of a body at rest both means are the bias of the gyros."""
TILTING = 2e-4
"""Difference of these means from which on the body is not at rest [rad/s]: five standard deviations of what a gyro of
0.15 deg/sqrt(h) makes of rest, and a seventh of what steering on the spot does.
"""
FACTOR_BOUND = 3.0
"""The soil's factor is held within so many standard deviations of a new soil's [-]."""


class ProcessNoise(NamedTuple):
    """What makes the states uncertain from one period to the next."""

    force: float
    """Density of the noise of the accelerations [m/s^1.5]."""
    flicker: float
    """Coefficient of their flicker [m/s^2]."""
    drift_variance: float
    """Gained by the drift in the period [m^2/s^4]."""
    factor_sigma: float
    """Of a new soil's factor [-]."""
    factor_length: float
    """Way over which a soil is forgotten [m]."""


def level_gravity(felt: FloatArray, roll_pitch: tuple[float, float]) -> FloatArray:
    """Gravity in base_link as roll and pitch [rad] tell it, as great as `felt`; both of shape (3,) [m/s^2]."""
    size = float(np.linalg.norm(felt))
    roll_angle, pitch = roll_pitch
    level = math.cos(pitch)
    down = (math.sin(pitch), -level * math.sin(roll_angle), -level * math.cos(roll_angle))
    return size * np.array(down, dtype=np.float64)


@njit(cache=True)
def carry_gravity(gravity: FloatArray, rate: FloatArray, dt: float) -> FloatArray:
    """Gravity in base_link, shape (3,), after turning at `rate` [rad/s] for `dt`: exact for a constant rate."""
    length = math.sqrt(rate[0] ** 2 + rate[1] ** 2 + rate[2] ** 2)
    result = gravity.copy()
    angle = length * dt
    if angle == 0.0:
        return result
    x, y, z = rate[0] / length, rate[1] / length, rate[2] / length
    sine, versine = math.sin(angle), 2.0 * math.sin(0.5 * angle) ** 2
    along = x * gravity[0] + y * gravity[1] + z * gravity[2]
    cross = (
        y * gravity[2] - z * gravity[1],
        z * gravity[0] - x * gravity[2],
        x * gravity[1] - y * gravity[0],
    )
    axis = (x, y, z)
    for k in range(3):
        result[k] = gravity[k] - sine * cross[k] + versine * (axis[k] * along - gravity[k])
    return result


@njit(cache=True)
def turn_to(states: FloatArray, covariance: FloatArray, cosine: float, sigma: float) -> None:
    """The motion has another heading, with this cosine to the last one: its speed there, in place.

    Args:
        sigma: of the speed across the last heading [m/s].
    """
    across = 1.0 - cosine * cosine
    states[SPEED] *= cosine
    covariance[SPEED] *= cosine
    covariance[:, SPEED] *= cosine
    covariance[SPEED, SPEED] += across * sigma * sigma


@njit(cache=True)
def felt_rocking(felt: FloatArray, acceleration: float, dt: float) -> FloatArray:
    """Mean [m/s^2] and variance [m^2/s^4] of an acceleration over ROCKING_LAG, shape (2,), with one more reading."""
    share = dt / (ROCKING_LAG + dt)
    off = acceleration - felt[0]
    return np.array((felt[0] + share * off, (1.0 - share) * (felt[1] + share * off * off)))


@njit(cache=True)
def felt_tilting(tilting: FloatArray, rate: FloatArray, dt: float) -> FloatArray:
    """Means of the tilt rates about x and y over QUICK_TILT and SLOW_TILT, shape (2, 2) [rad/s], with one more reading.

    Args:
        rate: of the gyros, shape (3,) [rad/s].
    """
    return tilting + np.array(((dt / (QUICK_TILT + dt),), (dt / (SLOW_TILT + dt),))) * (rate[:2] - tilting)


@njit(cache=True)
def is_tilting(tilting: FloatArray) -> bool:
    """Whether the body turns about x or y though its wheels stand: they are steered, or the arm moves."""
    return bool(np.abs(tilting[0] - tilting[1]).max() > TILTING)


@njit(cache=True)
def initial_covariance(speed: float, drift: float, noise: ProcessNoise) -> FloatArray:
    """Before the first period, shape (STATES, STATES). speed, drift: standard deviations [m/s], [m/s^2]."""
    flicker = FLICKER_PART * noise.flicker
    return np.diag(np.array((speed**2, drift**2, noise.factor_sigma**2, flicker**2)))


@njit(cache=True)
def white_noise(noise: ProcessNoise) -> float:
    """Density of what is white in the accelerations, or as good as white [m^2/s^3]."""
    return noise.force**2 + 2.0 * FAST_FLICKER_TIME * (FLICKER_PART * noise.flicker) ** 2


@njit(cache=True)
def wander(states: FloatArray, covariance: FloatArray, dt: float, noise: ProcessNoise) -> None:
    """What becomes of drift and flicker in a period of dt [s], in place."""
    kept = math.exp(-dt / FLICKER_TIME)
    states[FLICKER] *= kept
    covariance[FLICKER] *= kept
    covariance[:, FLICKER] *= kept
    covariance[FLICKER, FLICKER] += (FLICKER_PART * noise.flicker) ** 2 * (1.0 - kept * kept)
    covariance[DRIFT, DRIFT] += noise.drift_variance


@njit(cache=True)
def predict(
    states: FloatArray,
    covariance: FloatArray,
    acceleration: float,
    ahead: float,
    way: float,
    dt: float,
    noise: ProcessNoise,
) -> None:
    """One period of dt [s], in place.

    Args:
        acceleration: a [m/s^2]. ahead: d_x, cosine between the motion and x of base_link. way: of the wheels [m].
    """
    kept = math.exp(-way / noise.factor_length)
    states[SPEED] += (acceleration - ahead * (states[DRIFT] + states[FLICKER])) * dt
    states[FACTOR] = 1.0 + (states[FACTOR] - 1.0) * kept
    covariance[SPEED] -= ahead * dt * (covariance[DRIFT] + covariance[FLICKER])
    covariance[:, SPEED] -= ahead * dt * (covariance[:, DRIFT] + covariance[:, FLICKER])
    covariance[FACTOR] *= kept
    covariance[:, FACTOR] *= kept
    sideways = 1.0 - ahead * ahead  # across x the drift is not estimated, and may be what it is at first
    covariance[SPEED, SPEED] += white_noise(noise) * dt + sideways * (0.01**2) * dt
    wander(states, covariance, dt, noise)
    covariance[FACTOR, FACTOR] += noise.factor_sigma**2 * (1.0 - kept * kept)


@njit(cache=True)
def update(states: FloatArray, covariance: FloatArray, row: FloatArray, innovation: float, variance: float) -> None:
    """A measurement of row . states, in place (Joseph's form)."""
    carried = covariance @ row
    total = row @ carried + variance
    gain = carried / total
    for i in range(STATES):
        states[i] += gain[i] * innovation
        for j in range(STATES):
            covariance[i, j] += gain[i] * gain[j] * total - gain[i] * carried[j] - carried[i] * gain[j]


@njit(cache=True)
def stand(
    states: FloatArray, covariance: FloatArray, felt: FloatArray, acceleration: float, dt: float, noise: ProcessNoise
) -> None:
    """Wheels that stand: no speed, and the acceleration felt along x is drift and flicker, as far as the body does not
    rock.

    Args:
        felt: from `felt_rocking`, along x. acceleration: felt along x now [m/s^2].
    """
    wander(states, covariance, dt, noise)
    rock = max(felt[1] - 2.0 * noise.force**2 / dt, 0.0)
    lasting = 1.0 / (ROCKING_RATE * dt)  # periods for which a swing goes one way
    speed_variance = STANDING_SIGMA**2 + rock / ROCKING_RATE**2 * lasting
    felt_variance = white_noise(noise) / dt + rock * lasting
    off = acceleration - states[DRIFT] - states[FLICKER]
    update(states, covariance, np.array((1.0, 0.0, 0.0, 0.0)), -states[SPEED], speed_variance)
    update(states, covariance, np.array((0.0, 1.0, 0.0, 1.0)), off, felt_variance)


@njit(cache=True)
def rest_share(rested: float, dt: float) -> float:
    """Weight of one period [-] after a rest [s], in a mean that begins with REST_PRIOR of what was known before."""
    return dt / (min(rested, REST_MEMORY) + REST_PRIOR + dt)


@njit(cache=True)
def rest(
    states: FloatArray, gravity: FloatArray, rest_rate: FloatArray, rate: FloatArray, across: float, share: float
) -> None:
    """A machine that does not move at all (`is_tilting`): what gyros tell is no turning, and what is felt is tilt, in
    place.

    The z axis of the gyros has its own bias, in the odometry.

    Args:
        gravity: in base_link, shape (3,) [m/s^2]. rest_rate: about x and y, shape (2,) [rad/s].
        rate: of the gyros, shape (3,) [rad/s]. across: felt along y [m/s^2]. share: from `rest_share`.
    """
    for k in range(2):
        rest_rate[k] += share * (rate[k] - rest_rate[k])
    levelled = share * states[DRIFT]
    states[DRIFT] -= levelled
    gravity[0] -= levelled
    gravity[1] -= share * across


@njit(cache=True)
def bound_factor(states: FloatArray, sigma: float) -> None:
    """Hold the soil's factor where soils are, in place. sigma: of a new soil's factor."""
    states[FACTOR] = min(max(states[FACTOR], max(1.0 - FACTOR_BOUND * sigma, 0.0)), 1.0 + FACTOR_BOUND * sigma)


@njit(cache=True)
def roll(states: FloatArray, covariance: FloatArray, wheels: float, slip: float, free: float, variance: float) -> None:
    """Wheels that roll at the speed `wheels` [m/s] with the believed slip; `variance` of what follows [m^2/s^2]."""
    expected = wheels * (1.0 - min(free + states[FACTOR] * (slip - free), 1.0))
    row = np.array((1.0, 0.0, wheels * (slip - free), 0.0))
    update(states, covariance, row, expected - states[SPEED], variance)
