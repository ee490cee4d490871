"""Articulated steering: two bodies with one axle each and a steered joint about the vertical between them.

Distances from the joint: front axle a ahead, rear axle b behind; articulation g = heading of the front - of the rear
body.

Kinematics (low speed): both axles point at one centre,
    R_f = (a cos g + b)/sin g,   R_r = (b cos g + a)/sin g
    yaw rate of the front body with the front axle at V:  r = (V sin g + b g')/(a cos g + b)

Linear dynamics at constant V, v side speed of the joint in the front body, r_1, r_2 yaw rates, masses m_i with the
centres of mass d_1 ahead and d_2 behind the joint, axle cornering stiffness C_i, joint with spring k and damper c about
the angle asked for:
    F_1 = -C_1 (v + a r_1)/V,   F_2 = -C_2 (v + V g - b r_2)/V,   T = -k (g - g_0) - c (r_1 - r_2)
    m_1 (v' + V r_1 + d_1 r_1') + m_2 (v' + V r_1 - d_2 r_2') = F_1 + F_2
    J_1 r_1' + m_1 d_1 (v' + V r_1 + d_1 r_1') = a F_1 + T
    J_2 r_2' - m_2 d_2 (v' + V r_1 - d_2 r_2') = -b F_2 - T,      g' = r_1 - r_2
A pair of complex eigenvalues that crosses to the right is snaking (oscillation), a real one is folding (jack-knife)
(Crolla and Horton 1983, Proc. IMechE D 197:179; Genta and Genta 2017, sec. 5.6).
Assumptions: small angles in the dynamics, no roll, massless joint. Range: |g| below a right angle; V more than 0.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


class VehicleUnit(NamedTuple):
    """One half: mass [kg], yaw inertia [kg m^2], distance of its centre of mass and of its axle from the joint [m],
    axle cornering stiffness [N/rad]."""

    mass: float
    yaw_inertia: float
    centre: float
    axle: float
    stiffness: float


class Joint(NamedTuple):
    """Steering actuator: stiffness [N m/rad] and damping [N m s/rad] about the angle that is asked for."""

    stiffness: float
    damping: float


def turning_radii(front_axle: float, rear_axle: float, angle: float) -> tuple[float, float]:
    """Radii of the paths of the front and the rear axle's middle [m], signed, positive to the left; infinite at 0.

    Args:
        front_axle, rear_axle: distances of the axles from the joint [m]. angle: articulation [rad].
    """
    if not abs(angle) < 0.5 * math.pi:
        raise InvalidValueError("angle", angle, "less than a right angle")
    sine, cosine = math.sin(angle), math.cos(angle)
    if sine == 0.0:
        return math.inf, math.inf
    return (front_axle * cosine + rear_axle) / sine, (rear_axle * cosine + front_axle) / sine


def yaw_rate(front_axle: float, rear_axle: float, speed: float, angle: float, angle_rate: float = 0.0) -> float:
    """Yaw rate of the front body [rad/s], its axle moving at `speed` [m/s] along it, both axles without side slip."""
    return (speed * math.sin(angle) + rear_axle * angle_rate) / (front_axle * math.cos(angle) + rear_axle)


def state_matrix(front: VehicleUnit, rear: VehicleUnit, joint: Joint, speed: float) -> FloatArray:
    """A (4, 4) of the state (v, r_1, r_2, g) at a speed of more than 0 [m/s], with the angle g_0 at 0."""
    return _matrices(front, rear, joint, speed)[0]


def steady_turn(front: VehicleUnit, rear: VehicleUnit, joint: Joint, speed: float, asked: float) -> FloatArray:
    """Steady state (v, r_1, r_2, g) for an asked articulation [rad], shape (4,)."""
    a, b = _matrices(front, rear, joint, speed)
    return np.asarray(np.linalg.solve(a, -b * asked))


def eigenvalues(front: VehicleUnit, rear: VehicleUnit, joint: Joint, speed: float) -> FloatArray:
    """Eigenvalues [1/s], complex, shape (4,)."""
    return np.asarray(np.linalg.eigvals(state_matrix(front, rear, joint, speed)).astype(np.complex128))


def stable_speed(front: VehicleUnit, rear: VehicleUnit, joint: Joint, highest: float = 50.0) -> tuple[float, str]:
    """Speed [m/s] beyond which it is unstable and how: snaking, folding; or `highest` and stable."""

    def worst(speed: float) -> complex:
        values = eigenvalues(front, rear, joint, speed)
        return complex(values[np.argmax(values.real)])

    grid = np.linspace(highest / 400.0, highest, 400)
    for low, high in itertools.pairwise(grid):
        if worst(float(low)).real < 0.0 <= worst(float(high)).real:
            while high - low > 1e-9 * highest:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if worst(float(middle)).real < 0.0 else (low, middle)
            return float(low), "snaking" if abs(worst(float(high)).imag) > 1e-6 else "folding"
    return (highest, "stable") if worst(highest).real < 0.0 else (0.0, "unstable at any speed")


def _matrices(front: VehicleUnit, rear: VehicleUnit, joint: Joint, speed: float) -> tuple[FloatArray, FloatArray]:
    if not (math.isfinite(speed) and speed > 0.0):
        raise InvalidValueError("speed", speed, "a finite number more than 0 m/s")
    one, two = front.mass * front.centre, rear.mass * rear.centre
    mass = np.array(
        [
            [front.mass + rear.mass, one, -two],
            [one, front.yaw_inertia + one * front.centre, 0.0],
            [-two, 0.0, rear.yaw_inertia + two * rear.centre],
        ]
    )
    force_1 = -front.stiffness / speed * np.array([1.0, front.axle, 0.0, 0.0])
    force_2 = -rear.stiffness / speed * np.array([1.0, 0.0, -rear.axle, speed])
    torque = np.array([0.0, -joint.damping, joint.damping, -joint.stiffness])
    turning = np.array([0.0, speed, 0.0, 0.0])
    right = np.array(
        [
            force_1 + force_2 - (front.mass + rear.mass) * turning,
            front.axle * force_1 + torque - one * turning,
            -rear.axle * force_2 - torque + two * turning,
        ]
    )
    asked = np.array([0.0, joint.stiffness, -joint.stiffness])
    a = np.zeros((4, 4))
    a[:3] = np.linalg.solve(mass, right)
    a[3] = [0.0, 1.0, -1.0, 0.0]
    b = np.zeros(4)
    b[:3] = np.linalg.solve(mass, asked)
    return a, b
