"""Linear handling of a vehicle of any number of axles: single-track model with stability derivatives.

State (b side slip of the centre of mass, r yaw rate), steer angle d, of axle i  d_i = k_i d; C_i cornering stiffness of
a whole axle, x_i forward of the centre of mass, V constant:

    m V (b' + r) = Y_b b + Y_r r + Y_d d + F_y
        Y_b = -sum C_i        Y_r = -sum x_i C_i / V      Y_d = sum k_i C_i
    J r'         = N_b b + N_r r + N_d d + M_z
        N_b = -sum x_i C_i    N_r = -sum x_i^2 C_i / V    N_d = sum k_i x_i C_i

    curvature      1/R = G_0 d/(1 + K V^2),   K = m N_b/(Y_b N_r V - N_b Y_r V)
    two axles      K = (m/l^2)(b/C_1 - a/C_2)
                   K > 0: understeer, characteristic speed 1/sqrt(K);  K < 0: critical speed 1/sqrt(-K)
    static margin  -N_b/(Y_b l), positive where a side force at the centre of mass turns the vehicle away from it

(Segel 1956; Genta and Morello 2009, vol. 2, sec. 25.4 to 25.9; Mitschke and Wallentowitz 2004.)
Assumptions: small angles, constant speed, no roll, no aligning moment, linear side force. Range: side slip up to some
degrees, lateral acceleration up to about 0.4 mu g; V more than 0. Rovers at 0.1 m/s roll kinematically: see
`steering_geometry`.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

NEUTRAL = 1e-6
"""A static margin of less than this, over what the axles would have alone, is rounding: the vehicle is neutral."""


class SingleTrack(NamedTuple):
    """Mass [kg], yaw inertia [kg m^2]; of each axle: place x [m], cornering stiffness [N/rad], share of the steer
    angle.
    """

    mass: float
    yaw_inertia: float
    x: tuple[float, ...]
    stiffness: tuple[float, ...]
    steer_ratio: tuple[float, ...]


class Derivatives(NamedTuple):
    """Stability derivatives: forces [N] and moments [N m] for one rad, rad/s, rad."""

    y_beta: float
    y_rate: float
    y_steer: float
    n_beta: float
    n_rate: float
    n_steer: float


class SteadyStateGains(NamedTuple):
    """Steady response to one rad of steering: curvature [1/m], yaw rate [1/s], side slip [-], acceleration [m/s^2]."""

    curvature: float
    yaw_rate: float
    side_slip: float
    lateral_acceleration: float


def derivatives(car: SingleTrack, speed: float) -> Derivatives:
    """Stability derivatives at a speed of more than 0 [m/s]."""
    x, stiffness, ratio = _arrays(car)
    _check_speed(speed)
    return Derivatives(
        -float(stiffness.sum()),
        -float(x @ stiffness) / speed,
        float(ratio @ stiffness),
        -float(x @ stiffness),
        -float((x * x) @ stiffness) / speed,
        float((ratio * x) @ stiffness),
    )


def state_matrices(car: SingleTrack, speed: float) -> tuple[FloatArray, FloatArray]:
    """A (2, 2) and B (2, 3) of d/dt (b, r) = A (b, r) + B (d, F_y, M_z)."""
    d = derivatives(car, speed)
    momentum, inertia = car.mass * speed, car.yaw_inertia
    a = np.array([[d.y_beta / momentum, d.y_rate / momentum - 1.0], [d.n_beta / inertia, d.n_rate / inertia]])
    b = np.array([[d.y_steer / momentum, 1.0 / momentum, 0.0], [d.n_steer / inertia, 0.0, 1.0 / inertia]])
    return a, b


def poles(car: SingleTrack, speed: float) -> FloatArray:
    """Eigenvalues [1/s], shape (2,), complex."""
    return np.asarray(np.linalg.eigvals(state_matrices(car, speed)[0]).astype(np.complex128))


def understeer_gradient(car: SingleTrack) -> float:
    """K [s^2/m^2]: more than 0 understeers, less oversteers."""
    d = derivatives(car, 1.0)
    if abs(d.n_beta) < NEUTRAL * float(np.abs(car.x) @ np.abs(car.stiffness)):
        return 0.0
    return car.mass * d.n_beta / (d.y_beta * d.n_rate - d.n_beta * d.y_rate)


def characteristic_speed(car: SingleTrack) -> float:
    """Speed at which the curvature gain has fallen to half [m/s]; infinite where the vehicle does not understeer."""
    gradient = understeer_gradient(car)
    return 1.0 / math.sqrt(gradient) if gradient > 0.0 else math.inf


def critical_speed(car: SingleTrack) -> float:
    """Speed beyond which the vehicle is unstable [m/s]; infinite where it does not oversteer."""
    gradient = understeer_gradient(car)
    return 1.0 / math.sqrt(-gradient) if gradient < 0.0 else math.inf


def neutral_steer_point(car: SingleTrack) -> float:
    """Place of a side force that does not turn the vehicle, forward of the centre of mass [m]; negative: understeer."""
    x, stiffness, _ = _arrays(car)
    return float(x @ stiffness / stiffness.sum())


def steady_gains(car: SingleTrack, speed: float) -> SteadyStateGains:
    """Steady response to the steer angle.

    Raises:
        InvalidValueError: at the critical speed there is none.
    """
    a, b = state_matrices(car, speed)
    if abs(np.linalg.det(a)) < 1e-12 * np.abs(a).max() ** 2:
        raise InvalidValueError("speed", speed, "any but the critical speed")
    side_slip, rate = np.linalg.solve(a, -b[:, 0])
    return SteadyStateGains(float(rate) / speed, float(rate), float(side_slip), float(rate) * speed)


def step_response(car: SingleTrack, speed: float, steer: float, times: FloatArray) -> FloatArray:
    """Side slip [rad] and yaw rate [rad/s] after a step of the steer angle [rad]: shape (times, 2), exact.

    Through the exponential of [[A, B d], [0, 0]], which also holds at the critical speed.
    """
    a, b = state_matrices(car, speed)
    system = np.zeros((3, 3))
    system[:2, :2], system[:2, 2] = a, b[:, 0] * steer
    return np.array([expm(system * float(time))[:2, 2] for time in np.asarray(times)])


def frequency_response(car: SingleTrack, speed: float, frequencies: FloatArray) -> FloatArray:
    """Side slip and yaw rate over the steer angle, complex, shape (frequencies, 2); frequencies in Hz."""
    a, b = state_matrices(car, speed)
    s = 2j * math.pi * np.asarray(frequencies, dtype=np.float64)
    return np.array([np.linalg.solve(value * np.eye(2) - a, b[:, 0]) for value in s])


def _arrays(car: SingleTrack) -> tuple[FloatArray, FloatArray, FloatArray]:
    x, stiffness, ratio = (np.asarray(part, dtype=np.float64) for part in (car.x, car.stiffness, car.steer_ratio))
    if not (x.shape == stiffness.shape == ratio.shape and x.ndim == 1 and len(x) >= 2):
        shapes = (x.shape, stiffness.shape, ratio.shape)
        raise InvalidValueError("x, stiffness, steer_ratio", shapes, "one number an axle, two axles or more")
    if np.any(stiffness <= 0.0) or not np.all(np.isfinite(stiffness)):
        raise InvalidValueError("stiffness", car.stiffness, "finite numbers more than 0")
    return x, stiffness, ratio


def _check_speed(speed: float) -> None:
    if not (math.isfinite(speed) and speed > 0.0):
        raise InvalidValueError("speed", speed, "a finite number more than 0 m/s")
