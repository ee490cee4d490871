"""Serial chain in arrays: forward kinematics and tip Jacobian, compiled.

Joint i moves its link by a rotation about (or a translation along) the unit axis `axis[i]` of its own
frame, which is placed in the frame of link i-1 by (`rotation[i]`, `translation[i]`):  T_0i = T_0,i-1 P_i
exp(axis_i q_i) (product of exponentials; Lynch & Park, Modern Robotics, 2017, section 4.1.2). Geometric
Jacobian columns: revolute [z x (p_tip - p_i); z], prismatic [z; 0] (Siciliano et al., Robotics, 2009,
equation 3.30).

Valid for chains of revolute and prismatic joints of one degree of freedom; no loops.
"""

from typing import NamedTuple, Protocol

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray


class Chain(NamedTuple):
    """Geometry of a chain of n joints. Arrays are C-contiguous float64."""

    rotation: FloatArray  # (n, 3, 3) of joint frame i in link i-1
    translation: FloatArray  # (n, 3) [m]
    axis: FloatArray  # (n, 3) unit axis in the joint frame
    revolute: FloatArray  # (n,) 1.0 revolute, 0.0 prismatic
    tip_rotation: FloatArray  # (3, 3) of the tip frame in the last link
    tip_translation: FloatArray  # (3,) [m]
    tool_axis: FloatArray  # (3,) unit vector in the tip frame


class ChainArm(Protocol):
    """What every arm has, however it was read: SerialArm, ArmModel."""

    @property
    def chain(self) -> Chain:
        """Its geometry."""

    @property
    def lower(self) -> FloatArray:
        """Lowest position of each joint (n,) [rad or m]."""

    @property
    def upper(self) -> FloatArray:
        """Highest position of each joint (n,) [rad or m]."""

    @property
    def joint_count(self) -> int:
        """Number of joints [-]."""

    @property
    def reach(self) -> float:
        """Length of the chain stretched out, without what lies before its first joint [m]; 1 where it has none."""


def stretched_length(chain: Chain, lower: FloatArray, upper: FloatArray) -> float:
    """`reach` of an arm."""
    links = np.linalg.norm(chain.translation[1:], axis=1).sum() + np.linalg.norm(chain.tip_translation)
    travel = np.maximum(np.abs(lower), np.abs(upper))[chain.revolute < 0.5].sum()
    return float(links + travel) or 1.0


@njit(cache=True)
def tip_kinematics(
    chain: Chain, q: FloatArray, rotation_tip: FloatArray, position_tip: FloatArray, jacobian: FloatArray
) -> None:
    """Tip pose and geometric Jacobian in the base frame, written to the last three arguments.

    Args:
        q: joint positions (n,) [rad or m].
        rotation_tip: (3, 3) out.
        position_tip: (3,) out [m].
        jacobian: (6, n) out, rows 0-2 linear velocity of the tip point, rows 3-5 angular velocity.
    """
    # Written out in loops: a product of small matrices by a library call costs ten times the arithmetic.
    n = q.shape[0]
    here, there = np.eye(3), np.empty((3, 3))
    joint = np.empty((3, 3))
    origins = np.empty((n, 3))
    x, y, z = 0.0, 0.0, 0.0
    for i in range(n):
        t = chain.translation[i]
        x += here[0, 0] * t[0] + here[0, 1] * t[1] + here[0, 2] * t[2]
        y += here[1, 0] * t[0] + here[1, 1] * t[1] + here[1, 2] * t[2]
        z += here[2, 0] * t[0] + here[2, 1] * t[1] + here[2, 2] * t[2]
        _multiply(here, chain.rotation[i], there)
        ax, ay, az = chain.axis[i, 0], chain.axis[i, 1], chain.axis[i, 2]
        for k in range(3):
            jacobian[k, i] = there[k, 0] * ax + there[k, 1] * ay + there[k, 2] * az  # the axis, for now
        if chain.revolute[i] > 0.5:
            s, c = np.sin(q[i]), np.cos(q[i])
            v = 1.0 - c
            joint[0, 0] = c + ax * ax * v
            joint[0, 1] = ax * ay * v - az * s
            joint[0, 2] = ax * az * v + ay * s
            joint[1, 0] = ax * ay * v + az * s
            joint[1, 1] = c + ay * ay * v
            joint[1, 2] = ay * az * v - ax * s
            joint[2, 0] = ax * az * v - ay * s
            joint[2, 1] = ay * az * v + ax * s
            joint[2, 2] = c + az * az * v
            _multiply(there, joint, here)
        else:
            x += jacobian[0, i] * q[i]
            y += jacobian[1, i] * q[i]
            z += jacobian[2, i] * q[i]
            here, there = there, here
        origins[i, 0], origins[i, 1], origins[i, 2] = x, y, z
    t = chain.tip_translation
    x += here[0, 0] * t[0] + here[0, 1] * t[1] + here[0, 2] * t[2]
    y += here[1, 0] * t[0] + here[1, 1] * t[1] + here[1, 2] * t[2]
    z += here[2, 0] * t[0] + here[2, 1] * t[1] + here[2, 2] * t[2]
    position_tip[0], position_tip[1], position_tip[2] = x, y, z
    _multiply(here, chain.tip_rotation, rotation_tip)
    for i in range(n):
        zx, zy, zz = jacobian[0, i], jacobian[1, i], jacobian[2, i]
        if chain.revolute[i] > 0.5:
            rx, ry, rz = x - origins[i, 0], y - origins[i, 1], z - origins[i, 2]
            jacobian[0, i] = zy * rz - zz * ry
            jacobian[1, i] = zz * rx - zx * rz
            jacobian[2, i] = zx * ry - zy * rx
            jacobian[3, i], jacobian[4, i], jacobian[5, i] = zx, zy, zz
        else:
            jacobian[3, i], jacobian[4, i], jacobian[5, i] = 0.0, 0.0, 0.0


@njit(cache=True)
def joint_frames(chain: Chain, q: FloatArray, rotations: FloatArray, positions: FloatArray) -> None:
    """Write T_0i of every joint, moved by q (n,): rotations (n, 3, 3) and positions (n, 3) [m] in the base frame."""
    n = q.shape[0]
    here, there, turn = np.eye(3), np.empty((3, 3)), np.empty((3, 3))
    at = np.zeros(3)
    for i in range(n):
        t = chain.translation[i]
        for k in range(3):
            at[k] += here[k, 0] * t[0] + here[k, 1] * t[1] + here[k, 2] * t[2]
        _multiply(here, chain.rotation[i], there)
        x, y, z = chain.axis[i, 0], chain.axis[i, 1], chain.axis[i, 2]
        if chain.revolute[i] > 0.5:
            s, c = np.sin(q[i]), np.cos(q[i])
            v = 1.0 - c
            turn[0, 0], turn[0, 1], turn[0, 2] = c + x * x * v, x * y * v - z * s, x * z * v + y * s
            turn[1, 0], turn[1, 1], turn[1, 2] = x * y * v + z * s, c + y * y * v, y * z * v - x * s
            turn[2, 0], turn[2, 1], turn[2, 2] = x * z * v - y * s, y * z * v + x * s, c + z * z * v
            _multiply(there, turn, here)
        else:
            for k in range(3):
                at[k] += (there[k, 0] * x + there[k, 1] * y + there[k, 2] * z) * q[i]
            here, there = there, here
        rotations[i], positions[i] = here, at


@njit(cache=True)
def _multiply(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b for (3, 3) matrices."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]
