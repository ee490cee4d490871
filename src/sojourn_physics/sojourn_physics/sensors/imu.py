"""Inertial measurement unit: gyroscopes, accelerometers, and the attitude that its electronics work out.

Errors (IEEE Std 952-1997, annex C; Titterton and Weston 2004, ch. 4 and 6). For each triad, in the IMU frame:

    measured = (1 + S + X) truth + bias + N / sqrt(dt) n

S scale factors, X cross-axis terms from misalignment and bias are drawn at the reset; n is standard normal.
N is the random walk coefficient: for the gyros ARW [rad/sqrt(s)], for the accelerometers the noise density,
taken two-sided, so that the Allan variance over an averaging time T is N^2 / T for both. Flicker, rate
random walk, temperature and quantisation are not modelled; the bias is constant after the reset.

Attitude (Mahony, Hamel and Pflimlin 2008, eq. 32 without bias estimate; complementary filter). In each period
the quaternion is turned by the measured rate, exactly, and then by k dt (f x u), where f is the direction of
the measured specific force and u the direction of "up" that the attitude predicts. This correction is at
right angles to u: it turns roll and pitch and never the heading, which is therefore the integral of the gyro
from the given start. It is left out while |f| is off gravity by more than the gate. The first reading sets
roll and pitch, with the noise of a machine that has stood still for the alignment time; the gain then falls as
1/t, t from the begin of the alignment, to its steady value, which is the mean of the readings so far, as a
Kalman filter would start. Without an alignment the acceleration of a machine that drives off at once is taken for tilt.

Covariances: roll and pitch from the balance of the filter, heading growing as ARW^2 t + (bias t)^2.
Without gravity there is nothing to level by: the attitude starts level at the given heading and goes by the gyros.

Range: rates well under 1/dt; mean acceleration small against gravity over 1/k seconds.
"""

from dataclasses import dataclass
from math import atan2, isfinite, pi, sqrt

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.imu_kernels import attitude_from_specific_force, attitude_step, measure
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream
from sojourn_physics.sensors.truth import require_numbers

STANDARD_GRAVITY = 9.80665
"""The g of "micro g" in data sheets [m/s^2]."""


class ImuParams(Params):
    """Error budget of the IMU (one standard deviation each) and gain of its attitude filter."""

    gyro_arw_deg_per_sqrt_hour: float = Field(ge=0.0, le=10.0, description="angular random walk [deg/sqrt(h)]")
    gyro_bias_deg_per_hour: float = Field(ge=0.0, le=1e4, description="bias of a gyro [deg/h]")
    gyro_scale_factor_ppm: float = Field(default=0.0, ge=0.0, le=1e5, description="scale factor of a gyro [1e-6]")
    accelerometer_noise_micro_g_per_sqrt_hz: float = Field(
        ge=0.0, le=1e5, description="noise density of an accelerometer [1e-6 g/sqrt(Hz)]"
    )
    accelerometer_bias_micro_g: float = Field(ge=0.0, le=1e6, description="bias of an accelerometer [1e-6 g]")
    accelerometer_scale_factor_ppm: float = Field(
        default=0.0, ge=0.0, le=1e5, description="scale factor of an accelerometer [1e-6]"
    )
    misalignment: float = Field(default=0.0, ge=0.0, le=0.1, description="misalignment of an axis [rad]")
    attitude_gain: float = Field(gt=0.0, le=10.0, description="gain k of the levelling by gravity [1/s]")
    alignment_time: float = Field(
        default=0.0, ge=0.0, le=1e5, description="time for which the machine has stood still before the start [s]"
    )
    attitude_gate: float = Field(
        gt=0.0, le=1.0, description="levelling stops when specific force is off gravity by this part [1]"
    )

    @property
    def gyro_random_walk(self) -> float:
        """Angular random walk [rad/sqrt(s)]."""
        return self.gyro_arw_deg_per_sqrt_hour * pi / 180.0 / 60.0

    @property
    def gyro_bias(self) -> float:
        """Standard deviation of a gyro's bias [rad/s]."""
        return self.gyro_bias_deg_per_hour * pi / 180.0 / 3600.0

    @property
    def accelerometer_random_walk(self) -> float:
        """Velocity random walk [m/s/sqrt(s)]."""
        return self.accelerometer_noise_micro_g_per_sqrt_hz * 1e-6 * STANDARD_GRAVITY

    @property
    def accelerometer_bias(self) -> float:
        """Standard deviation of an accelerometer's bias [m/s^2]."""
        return self.accelerometer_bias_micro_g * 1e-6 * STANDARD_GRAVITY


@dataclass(frozen=True, eq=False, slots=True)
class ImuState:
    """Drawn errors, random stream, and the attitude estimate."""

    gyro_matrix: FloatArray
    """1 + S + X of the gyros, shape (3, 3)."""
    gyro_bias: FloatArray
    """Shape (3,) [rad/s]."""
    accelerometer_matrix: FloatArray
    """1 + S + X of the accelerometers, shape (3, 3)."""
    accelerometer_bias: FloatArray
    """Shape (3,) [m/s^2]."""
    stream: NoiseStream
    gravity: float
    """Gravity on the body that the rover is on [m/s^2]."""
    heading: float
    """Heading at the reset [rad]."""
    orientation: FloatArray | None
    """Estimated attitude in the world, quaternion x y z w, shape (4,); None before the first reading."""
    elapsed: float
    """Time since the begin of the alignment [s]."""


@dataclass(frozen=True, eq=False, slots=True)
class ImuReading:
    """What the IMU sends. Variances are the diagonals of the covariances, whose other entries are 0."""

    angular_velocity: FloatArray
    """In the IMU frame, shape (3,) [rad/s]."""
    specific_force: FloatArray
    """In the IMU frame, what the accelerometers feel: + gravity upward at rest, shape (3,) [m/s^2]."""
    orientation: FloatArray
    """Of the IMU in the world, quaternion x y z w, shape (4,)."""
    angular_velocity_variance: FloatArray
    """Shape (3,) [rad^2/s^2]."""
    specific_force_variance: FloatArray
    """Shape (3,) [m^2/s^4]."""
    orientation_variance: FloatArray
    """About x, y, z of the world, shape (3,) [rad^2]."""


def initial_state(params: ImuParams, seed: int, heading: float, gravity: float, name: str = "imu") -> ImuState:
    """Errors drawn from the stream of `name`; `heading` [rad], about the vertical from x of the world.

    Raises:
        InvalidValueError: heading not finite, gravity [m/s^2] negative or not finite.
    """
    if not isfinite(heading):
        raise InvalidValueError("initial heading [rad]", heading, "a finite number")
    if not (isfinite(gravity) and gravity >= 0.0):
        raise InvalidValueError("gravity [m/s^2]", gravity, "a finite number, at least 0")
    _, row = draw(initial_stream(seed, f"{name}.reset", 24))
    return ImuState(
        gyro_matrix=_error_matrix(row[0:3] * params.gyro_scale_factor_ppm * 1e-6, row[3:9] * params.misalignment),
        gyro_bias=row[9:12] * params.gyro_bias,
        accelerometer_matrix=_error_matrix(
            row[12:15] * params.accelerometer_scale_factor_ppm * 1e-6, row[15:21] * params.misalignment
        ),
        accelerometer_bias=row[21:24] * params.accelerometer_bias,
        stream=initial_stream(seed, name, 6),
        gravity=float(gravity),
        heading=float(heading),
        orientation=None,
        elapsed=params.alignment_time,
    )


def heading_of(orientation: FloatArray) -> float:
    """Heading of a quaternion x y z w, shape (4,): angle of its x axis about the vertical [rad]."""
    x, y, z, w = (float(value) for value in orientation)
    return atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def step(
    params: ImuParams, state: ImuState, angular_velocity: FloatArray, specific_force: FloatArray, dt: float
) -> tuple[ImuState, ImuReading]:
    """Read the true rate [rad/s] and specific force [m/s^2] in the IMU frame, shape (3,), after `dt` [s].

    Raises:
        InvalidValueError: a truth of another shape, or not finite.
    """
    require_numbers("truth angular_velocity_imu_in_imu", angular_velocity, (3,))
    require_numbers("truth specific_force_imu_in_imu", specific_force, (3,))
    stream, noise = draw(state.stream)
    root = sqrt(dt)
    gyro_sigma = params.gyro_random_walk / root
    force_sigma = params.accelerometer_random_walk / root
    # Fresh arrays: a read-only or strided one would make the compiler start in the middle of a run.
    true_rate, true_force = angular_velocity.astype(np.float64), specific_force.astype(np.float64)
    rate = measure(state.gyro_matrix, true_rate, state.gyro_bias, gyro_sigma, noise[:3])
    force = measure(state.accelerometer_matrix, true_force, state.accelerometer_bias, force_sigma, noise[3:])
    if state.orientation is None:
        mean_sigma = params.accelerometer_random_walk / sqrt(max(params.alignment_time, dt))
        mean = measure(state.accelerometer_matrix, true_force, state.accelerometer_bias, mean_sigma, noise[3:])
        if state.gravity == 0.0:
            mean = np.zeros(3)
        orientation = attitude_from_specific_force(mean, state.heading)
    else:
        orientation = attitude_step(
            state.orientation,
            rate,
            force,
            dt,
            _gain(params, state.elapsed),
            params.attitude_gate,
            state.gravity,
        )
    elapsed = state.elapsed + dt
    after = replace(state, stream=stream, orientation=orientation, elapsed=elapsed)
    tilt, heading = _attitude_variance(params, state.gravity, elapsed)
    return after, ImuReading(
        angular_velocity=rate,
        specific_force=force,
        orientation=orientation,
        angular_velocity_variance=np.array((gyro_sigma**2 + params.gyro_bias**2,) * 3),
        specific_force_variance=np.array((force_sigma**2 + params.accelerometer_bias**2,) * 3),
        orientation_variance=np.array((tilt, tilt, heading)),
    )


def _gain(params: ImuParams, elapsed: float) -> float:
    """Gain of the levelling [1/s]: at first 1/t, the mean of all readings so far, then the steady one."""
    return max(params.attitude_gain, 1.0 / elapsed)


def _attitude_variance(params: ImuParams, gravity: float, elapsed: float) -> tuple[float, float]:
    """Variances of tilt and of heading [rad^2]: a first-order filter of gain k, white inputs and biases."""
    gain, gyro_random_walk, gyro_bias = _gain(params, elapsed), params.gyro_random_walk, params.gyro_bias
    turned_for = elapsed - params.alignment_time
    drift = gyro_random_walk**2 * turned_for + (gyro_bias * turned_for) ** 2
    if gravity == 0.0:
        return drift, drift
    tilt = (params.accelerometer_bias / gravity) ** 2 + (gyro_bias / gain) ** 2
    tilt += gyro_random_walk**2 / (2.0 * gain)
    tilt += (params.accelerometer_random_walk / gravity) ** 2 * gain
    return tilt, drift


def _error_matrix(scale: FloatArray, cross: FloatArray) -> FloatArray:
    matrix = np.diag(1.0 + scale)
    matrix[~np.eye(3, dtype=np.bool_)] = cross
    return matrix
