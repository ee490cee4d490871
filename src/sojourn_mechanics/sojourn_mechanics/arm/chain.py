"""Serial chain in arrays: forward kinematics, tip Jacobian and one damped least squares search, compiled.

Joint i moves its link by a rotation about (or a translation along) the unit axis `axis[i]` of its own
frame, which is placed in the frame of link i-1 by (`rotation[i]`, `translation[i]`):  T_0i = T_0,i-1 P_i
exp(axis_i q_i) (product of exponentials; Lynch & Park, Modern Robotics, 2017, section 4.1.2). Geometric
Jacobian columns: revolute [z x (p_tip - p_i); z], prismatic [z; 0] (Siciliano et al., Robotics, 2009,
equation 3.30).

Search: Levenberg-Marquardt with the damping of Sugihara (IEEE T-RO 27(5), 2011, equation 19), that is the
weighted squared residual plus a small bias:  dq = (J' W J + (e' W e + bias) I)^-1 J' W e. A joint at a
limit whose step points outward is held for that iteration. Pointing asks only for the direction of a tool
axis t: its error is the rotation vector that turns t onto the wanted direction d, and J_point = (I - t t')
J_rotation, so that the roll about t is free.

Valid for chains of revolute and prismatic joints of one degree of freedom; no loops.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from sojourn_mechanics.params import FloatArray


class Chain(NamedTuple):
    """Geometry of a chain of n joints. Arrays are C-contiguous float64."""

    rotation: FloatArray  # (n, 3, 3) of joint frame i in link i-1
    translation: FloatArray  # (n, 3) [m]
    axis: FloatArray  # (n, 3) unit axis in the joint frame
    revolute: FloatArray  # (n,) 1.0 revolute, 0.0 prismatic
    tip_rotation: FloatArray  # (3, 3) of the tip frame in the last link
    tip_translation: FloatArray  # (3,) [m]
    tool_axis: FloatArray  # (3,) unit vector in the tip frame


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
    n = q.shape[0]
    rotation = np.eye(3)
    position = np.zeros(3)
    origins = np.empty((n, 3))
    axes = np.empty((n, 3))
    joint = np.empty((3, 3))
    for i in range(n):
        position = position + rotation @ chain.translation[i]
        rotation = rotation @ chain.rotation[i]
        axis = chain.axis[i]
        axis_in_base = rotation @ axis
        for k in range(3):
            axes[i, k] = axis_in_base[k]
            origins[i, k] = position[k]
        if chain.revolute[i] > 0.5:
            s, c = np.sin(q[i]), np.cos(q[i])
            v = 1.0 - c
            x, y, z = axis[0], axis[1], axis[2]
            joint[0, 0] = c + x * x * v
            joint[0, 1] = x * y * v - z * s
            joint[0, 2] = x * z * v + y * s
            joint[1, 0] = x * y * v + z * s
            joint[1, 1] = c + y * y * v
            joint[1, 2] = y * z * v - x * s
            joint[2, 0] = x * z * v - y * s
            joint[2, 1] = y * z * v + x * s
            joint[2, 2] = c + z * z * v
            rotation = rotation @ joint
        else:
            position = position + axis_in_base * q[i]
    position = position + rotation @ chain.tip_translation
    rotation = rotation @ chain.tip_rotation
    for k in range(3):
        position_tip[k] = position[k]
        for m in range(3):
            rotation_tip[k, m] = rotation[k, m]
    for i in range(n):
        zx, zy, zz = axes[i, 0], axes[i, 1], axes[i, 2]
        if chain.revolute[i] > 0.5:
            rx, ry, rz = position[0] - origins[i, 0], position[1] - origins[i, 1], position[2] - origins[i, 2]
            jacobian[0, i] = zy * rz - zz * ry
            jacobian[1, i] = zz * rx - zx * rz
            jacobian[2, i] = zx * ry - zy * rx
            jacobian[3, i], jacobian[4, i], jacobian[5, i] = zx, zy, zz
        else:
            jacobian[0, i], jacobian[1, i], jacobian[2, i] = zx, zy, zz
            jacobian[3, i], jacobian[4, i], jacobian[5, i] = 0.0, 0.0, 0.0


@njit(cache=True)
def solve_symmetric(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """Solution of a positive definite system by Cholesky; matrix (n, n) is overwritten by its factor."""
    n = vector.shape[0]
    x = vector.copy()
    for i in range(n):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = np.sqrt(max(total, 1e-300)) if i == j else total / matrix[j, j]
    for i in range(n):
        for k in range(i):
            x[i] -= matrix[i, k] * x[k]
        x[i] /= matrix[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= matrix[k, i] * x[k]
        x[i] /= matrix[i, i]
    return x


@njit(cache=True)
def pointing_error(tool: FloatArray, wanted: FloatArray) -> FloatArray:
    """Rotation vector (3,) [rad] that turns unit vector `tool` onto unit vector `wanted` the short way."""
    cross: FloatArray = np.cross(tool, wanted)
    sine = np.sqrt(np.sum(cross * cross))
    cosine = np.sum(tool * wanted)
    if sine > 1e-12:
        cross *= np.arctan2(sine, cosine) / sine
        return cross
    if cosine > 0.0:
        return np.zeros(3)
    helper = np.zeros(3)
    helper[np.argmin(np.abs(tool))] = 1.0
    side: FloatArray = np.cross(tool, helper)
    side *= np.pi / np.sqrt(np.sum(side * side))
    return side


@njit(cache=True)
def search(
    chain: Chain,
    start: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    target: FloatArray,
    direction: FloatArray,
    weight: float,
    settings: FloatArray,
) -> tuple[FloatArray, float, float]:
    """One search from `start`.

    Args:
        target: wanted tip position in base_link (3,) [m].
        direction: wanted tool direction in base_link (3,), used when weight > 0.
        weight: length that one radian of pointing counts for [m]; 0 leaves pointing free.
        settings: position tolerance [m], pointing tolerance [rad], damping bias, largest step, iterations.

    Returns:
        joint positions (n,) of the best iterate, its position error [m], its pointing error [rad].
    """
    n = start.shape[0]
    q = np.minimum(np.maximum(start, lower), upper)
    rotation = np.empty((3, 3))
    position = np.empty(3)
    jacobian = np.empty((6, n))
    best_q, best_cost, best_distance, best_angle = q.copy(), np.inf, np.inf, np.inf
    stale = 0
    for _ in range(int(settings[4])):
        tip_kinematics(chain, q, rotation, position, jacobian)
        residual = np.zeros(6)
        residual[:3] = target - position
        distance = np.sqrt(np.sum(residual[:3] ** 2))
        angle = 0.0
        rows = jacobian.copy()
        if weight > 0.0:
            tool = rotation @ chain.tool_axis
            turn = pointing_error(tool, direction)
            angle = np.sqrt(np.sum(turn**2))
            residual[3:] = weight * turn
            for i in range(n):
                along = tool[0] * rows[3, i] + tool[1] * rows[4, i] + tool[2] * rows[5, i]
                for k in range(3):
                    rows[3 + k, i] = weight * (rows[3 + k, i] - tool[k] * along)
        else:
            rows[3:, :] = 0.0
        cost = np.sum(residual**2)
        stale = 0 if cost < 0.999 * best_cost else stale + 1
        if cost < best_cost:
            best_cost, best_distance, best_angle = cost, distance, angle
            best_q[:] = q
        if stale > 8 or (distance < settings[0] and angle < settings[1]):
            break
        gradient = rows.T @ residual
        for i in range(n):
            if (q[i] <= lower[i] and gradient[i] < 0.0) or (q[i] >= upper[i] and gradient[i] > 0.0):
                rows[:, i] = 0.0
                gradient[i] = 0.0
        normal = rows.T @ rows
        for i in range(n):
            normal[i, i] += cost + settings[2]
        step = solve_symmetric(normal, gradient)
        largest = np.max(np.abs(step))
        if largest > settings[3]:
            step *= settings[3] / largest
        q = np.minimum(np.maximum(q + step, lower), upper)
    return best_q, best_distance, best_angle
