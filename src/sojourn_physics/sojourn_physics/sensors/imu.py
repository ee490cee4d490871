"""Inertial measurement unit: gyroscopes, accelerometers, and the attitude that its electronics work out.

Errors of the triads: see `inertial_errors`. All but random walk and bias are zero where a file does not ask for them.

Attitude (Mahony, Hamel and Pflimlin 2008, eq. 32 without bias estimate; complementary filter). In each period
the quaternion is turned by the measured rate, exactly, and then by k dt (f x u), where f is the direction of
the measured specific force and u the direction of "up" that the attitude predicts. This correction is at
right angles to u: it turns roll and pitch and never the heading, which is therefore the integral of the gyro
from the given start. It is left out while |f| is off gravity by more than the gate. The first reading sets
roll and pitch, with the noise of a machine that has stood still for the alignment time; the gain then falls as
1/t, t from the begin of the alignment, to its steady value, which is the mean of the readings so far, as a
Kalman filter would start. Without an alignment the acceleration of a machine that drives off at once is taken for tilt.

Covariances, see `imu_variance`: roll and pitch from the balance of the filter, heading growing without bound.
Without gravity there is nothing to level by: the attitude starts level at the given heading and goes by the gyros.

Range: rates well under 1/dt; mean acceleration small against gravity over 1/k seconds.
"""

from dataclasses import dataclass
from functools import cached_property
from math import atan2, inf, isfinite, pi

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.imu_kernels import (
    attitude_from_specific_force,
    attitude_step,
    levelling_force,
    read_triads,
)
from sojourn_physics.sensors.imu_variance import variances
from sojourn_physics.sensors.inertial_errors import (
    BIAS,
    BIAS_PER_KELVIN,
    FLICKER,
    G_SENSITIVITY,
    MISALIGNMENT,
    QUANTUM,
    RANDOM_WALK,
    RANGE,
    RATE_WALK,
    SCALE_FACTOR,
    SCALE_PER_KELVIN,
    STATED,
    WALK,
    drawn,
    has_drift,
)
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_streams
from sojourn_physics.sensors.truth import require_numbers

STANDARD_GRAVITY = 9.80665
"""The g of "micro g" in data sheets [m/s^2]."""


class ImuParams(Params):
    """Error budget of the IMU (one standard deviation each) and gain of its attitude filter."""

    gyro_arw_deg_per_sqrt_hour: float = Field(ge=0.0, le=10.0, description="angular random walk [deg/sqrt(h)]")
    gyro_bias_deg_per_hour: float = Field(ge=0.0, le=1e4, description="bias of a gyro [deg/h]")
    gyro_scale_factor_ppm: float = Field(default=0.0, ge=0.0, le=1e5, description="scale factor of a gyro [1e-6]")
    gyro_bias_instability_deg_per_hour: float = Field(
        default=0.0, ge=0.0, le=1e4, description="coefficient B of the flicker of a gyro [deg/h]"
    )
    gyro_rate_random_walk_deg_per_hour_per_sqrt_hour: float = Field(
        default=0.0, ge=0.0, le=1e4, description="rate random walk K [deg/h/sqrt(h)]"
    )
    gyro_angle_quantum: float = Field(default=0.0, ge=0.0, le=0.01, description="least bit of an angle [rad]; 0: none")
    gyro_range_deg_per_second: float = Field(default=0.0, ge=0.0, le=1e5, description="largest rate [deg/s]; 0: any")
    gyro_bias_deg_per_hour_per_kelvin: float = Field(
        default=0.0, ge=0.0, le=1e3, description="what a gyro's bias changes with the temperature [deg/h/K]"
    )
    gyro_scale_factor_ppm_per_kelvin: float = Field(
        default=0.0, ge=0.0, le=1e4, description="what its scale factor changes with the temperature [1e-6/K]"
    )
    gyro_bias_deg_per_hour_per_g: float = Field(
        default=0.0, ge=0.0, le=1e4, description="bias of a gyro by specific force, along each axis [deg/h/g]"
    )
    accelerometer_noise_micro_g_per_sqrt_hz: float = Field(
        ge=0.0, le=1e5, description="noise density of an accelerometer [1e-6 g/sqrt(Hz)]"
    )
    accelerometer_bias_micro_g: float = Field(ge=0.0, le=1e6, description="bias of an accelerometer [1e-6 g]")
    accelerometer_scale_factor_ppm: float = Field(
        default=0.0, ge=0.0, le=1e5, description="scale factor of an accelerometer [1e-6]"
    )
    accelerometer_bias_instability_micro_g: float = Field(
        default=0.0, ge=0.0, le=1e6, description="coefficient B of the flicker of an accelerometer [1e-6 g]"
    )
    accelerometer_random_walk_micro_g_per_sqrt_hour: float = Field(
        default=0.0, ge=0.0, le=1e6, description="acceleration random walk K [1e-6 g/sqrt(h)]"
    )
    accelerometer_velocity_quantum: float = Field(
        default=0.0, ge=0.0, le=1.0, description="least bit of a velocity [m/s]; 0: none"
    )
    accelerometer_range_g: float = Field(default=0.0, ge=0.0, le=1e4, description="largest specific force [g]; 0: any")
    accelerometer_bias_micro_g_per_kelvin: float = Field(
        default=0.0, ge=0.0, le=1e5, description="what its bias changes with the temperature [1e-6 g/K]"
    )
    accelerometer_scale_factor_ppm_per_kelvin: float = Field(
        default=0.0, ge=0.0, le=1e4, description="what its scale factor changes with the temperature [1e-6/K]"
    )
    misalignment: float = Field(default=0.0, ge=0.0, le=0.1, description="misalignment of an axis [rad]")
    calibration_temperature: float = Field(
        default=293.15, gt=0.0, le=1000.0, description="temperature at which scale factors and biases are as stated [K]"
    )
    attitude_gain: float = Field(gt=0.0, le=10.0, description="gain k of the levelling by gravity [1/s]")
    alignment_time: float = Field(
        default=0.0, ge=0.0, le=1e5, description="time for which the machine has stood still before the start [s]"
    )
    attitude_gate: float = Field(
        gt=0.0, le=1.0, description="levelling stops when specific force is off gravity by this part [1]"
    )

    @cached_property
    def stated(self) -> FloatArray:
        """Errors of gyros and accelerometers in SI units, columns of `inertial_errors`, shape (2, STATED)."""
        per_hour, micro_g = pi / 180.0 / 3600.0, 1e-6 * STANDARD_GRAVITY
        gyros = {
            RANDOM_WALK: self.gyro_arw_deg_per_sqrt_hour * pi / 180.0 / 60.0,
            BIAS: self.gyro_bias_deg_per_hour * pi / 180.0 / 3600.0,
            FLICKER: self.gyro_bias_instability_deg_per_hour * per_hour,
            RATE_WALK: self.gyro_rate_random_walk_deg_per_hour_per_sqrt_hour * per_hour / 60.0,
            QUANTUM: self.gyro_angle_quantum,
            RANGE: self.gyro_range_deg_per_second * pi / 180.0 or inf,
            BIAS_PER_KELVIN: self.gyro_bias_deg_per_hour_per_kelvin * per_hour,
            SCALE_PER_KELVIN: self.gyro_scale_factor_ppm_per_kelvin * 1e-6,
            G_SENSITIVITY: self.gyro_bias_deg_per_hour_per_g * per_hour / STANDARD_GRAVITY,
            SCALE_FACTOR: self.gyro_scale_factor_ppm * 1e-6,
            MISALIGNMENT: self.misalignment,
        }
        accelerometers = {
            RANDOM_WALK: self.accelerometer_noise_micro_g_per_sqrt_hz * 1e-6 * STANDARD_GRAVITY,
            BIAS: self.accelerometer_bias_micro_g * 1e-6 * STANDARD_GRAVITY,
            FLICKER: self.accelerometer_bias_instability_micro_g * micro_g,
            RATE_WALK: self.accelerometer_random_walk_micro_g_per_sqrt_hour * micro_g / 60.0,
            QUANTUM: self.accelerometer_velocity_quantum,
            RANGE: self.accelerometer_range_g * STANDARD_GRAVITY or inf,
            BIAS_PER_KELVIN: self.accelerometer_bias_micro_g_per_kelvin * micro_g,
            SCALE_PER_KELVIN: self.accelerometer_scale_factor_ppm_per_kelvin * 1e-6,
            G_SENSITIVITY: 0.0,
            SCALE_FACTOR: self.accelerometer_scale_factor_ppm * 1e-6,
            MISALIGNMENT: self.misalignment,
        }
        return np.array([[triad[column] for column in range(STATED)] for triad in (gyros, accelerometers)])


@dataclass(frozen=True, eq=False, slots=True)
class ImuState:
    """Drawn errors, random stream, and the attitude estimate."""

    axes: FloatArray
    """Errors of gyros and accelerometers about x, y, z, columns of `inertial_errors`, shape (6, DRAWN)."""
    memory: FloatArray
    """Flicker, rate random walk and rest of the quantisation of each, shape (6, 1 + WALK), or (6, 1) without drift."""
    stream: NoiseStream
    gravity: float
    """Gravity on the body that the rover is on [m/s^2]."""
    heading: float
    """Heading at the reset [rad]."""
    orientation: FloatArray | None
    """Estimated attitude in the world, quaternion x y z w, shape (4,); None before the first reading."""
    elapsed: float
    """Time since the begin of the alignment [s]."""
    heat: float = 0.0
    """Temperature over that of the calibration, integrated since the reset [K s]."""


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
    axes, memory = drawn(params.stated, seed, name)
    widths = {name: 6} | ({f"{name}.drift": 6 * WALK} if has_drift(params.stated) else {})
    return ImuState(
        axes=axes,
        memory=memory,
        stream=initial_streams(seed, widths),
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
    params: ImuParams,
    state: ImuState,
    angular_velocity: FloatArray,
    specific_force: FloatArray,
    dt: float,
    temperature: float | None = None,
) -> tuple[ImuState, ImuReading]:
    """Read the true rate [rad/s] and specific force [m/s^2] in the IMU frame, shape (3,), after `dt` [s].

    Args:
        temperature: of the IMU [K]; None: that of its calibration.

    Raises:
        InvalidValueError: a truth of another shape, or not finite; a temperature that is not finite.
    """
    require_numbers("truth angular_velocity_imu_in_imu", angular_velocity, (3,))
    require_numbers("truth specific_force_imu_in_imu", specific_force, (3,))
    warmer = 0.0 if temperature is None else temperature - params.calibration_temperature
    if not isfinite(warmer):
        raise InvalidValueError("temperature of the IMU [K]", temperature, "a finite number")
    stream, noise = draw(state.stream)
    # A fresh array: a read-only or strided one would make the compiler start in the middle of a run.
    truth = np.empty(6)
    truth[:3], truth[3:] = angular_velocity, specific_force
    reading, memory = read_triads(state.axes, state.memory, truth, warmer, dt, noise)
    rate, force = reading[:3], reading[3:]
    if state.orientation is None:
        mean = np.zeros(3)
        if state.gravity > 0.0:
            averaged = max(params.alignment_time, dt)
            mean = levelling_force(state.axes, memory, truth, warmer, averaged, noise)
        orientation = attitude_from_specific_force(mean, state.heading)
    else:
        gain, gate = min(_gain(params, state.elapsed), 1.0 / dt), params.attitude_gate
        orientation = attitude_step(state.orientation, rate, force, dt, gain, gate, state.gravity)
    elapsed, heat = state.elapsed + dt, state.heat + warmer * dt
    after = replace(state, memory=memory, stream=stream, orientation=orientation, elapsed=elapsed, heat=heat)
    since = elapsed - params.alignment_time
    variance = variances(params.stated, _gain(params, elapsed), state.gravity, dt, since, warmer, heat)
    return after, ImuReading(rate, force, orientation, variance[0], variance[1], variance[2])


def _gain(params: ImuParams, elapsed: float) -> float:
    """Gain of the levelling [1/s]: at first 1/t, the mean of all readings so far, then the steady one."""
    return max(params.attitude_gain, 1.0 / elapsed)
