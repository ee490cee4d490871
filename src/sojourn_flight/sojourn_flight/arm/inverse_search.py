"""Damped least squares search for joint positions, compiled: one search, and a row of searches from many starts.

Levenberg-Marquardt with the damping of Sugihara (IEEE T-RO 27(5), 2011, equation 19), that is the weighted squared
residual plus a small bias:
    dq = (J' W J + (e' W e + bias) I)^-1 J' W e.
A joint at a limit whose step points outward is held for that iteration. The residual e has the position of the tip
and, by task,
    POSITION   nothing else;
    POINTING   the rotation vector that turns the tool axis t onto the wanted direction; J_point = (I - t t')
               J_rotation, so that the roll about t is free (five-joint arms);
    POSE       the rotation vector of R_wanted R'.
One radian weighs as much as a given length. A start that stops getting better is given up for the next one.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sojourn_flight.arm.chain import Chain, tip_kinematics
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

POSITION, POINTING, POSE = 0, 1, 2
"""Tasks."""
STALE = 8
"""Iterations without progress after which a start is given up."""


class TipTarget(NamedTuple):
    """Where the tip is wanted."""

    task: int
    """POSITION, POINTING or POSE."""
    position: FloatArray
    """In the base (3,) [m]."""
    rotation: FloatArray
    """Of the tip (3, 3) for POSE; its last column is the tool direction for POINTING."""
    weight: float
    """Length that one radian counts for [m]."""


class SearchSettings(NamedTuple):
    """When a search ends, and how it steps."""

    position_tolerance: float
    """[m]"""
    angle_tolerance: float
    """[rad]"""
    bias: float
    """Of the damping [m^2]."""
    largest_step: float
    """Of any joint in an iteration [rad or m]."""
    iterations: int


@lru_cache(maxsize=32)
def spread(dimensions: int, count: int) -> FloatArray:
    """The same `count` points of the unit cube every time, evenly spread: (count, dimensions), the middle first.

    Additive recurrence on the generalised golden ratio (M. Roberts, 2018, after Kronecker).
    """
    root = 2.0
    for _ in range(40):  # fixed point of x^(n+1) = x + 1
        root = (1.0 + root) ** (1.0 / (dimensions + 1.0))
    steps = (1.0 / root) ** np.arange(1, dimensions + 1)
    points: FloatArray = np.remainder(0.5 + np.outer(np.arange(count), steps), 1.0)
    points.setflags(write=False)
    return points


@njit(cache=True)
def search(
    chain: Chain,
    start: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    target: TipTarget,
    settings: SearchSettings,
) -> tuple[FloatArray, float, float]:
    """One search from `start`.

    Args:
        start: joint positions (n,), as their limits `lower` and `upper`.

    Returns:
        joint positions (n,) of the best iterate, its position error [m], its angle error [rad].
    """
    n = start.shape[0]
    q = np.minimum(np.maximum(start, lower), upper)
    rotation, position, jacobian = np.empty((3, 3)), np.empty(3), np.empty((6, n))
    residual, gradient, normal = np.zeros(6), np.empty(n), np.empty((n, n))
    rows = 3 if target.task == POSITION else 6
    best_q, best_cost, best_distance, best_angle = q.copy(), np.inf, np.inf, np.inf
    stale = 0
    for _ in range(settings.iterations):
        tip_kinematics(chain, q, rotation, position, jacobian)
        _residual(chain, target, rotation, position, jacobian, residual)
        distance = np.sqrt(residual[0] ** 2 + residual[1] ** 2 + residual[2] ** 2)
        turn = residual[3] ** 2 + residual[4] ** 2 + residual[5] ** 2
        cost = distance**2 + turn
        angle = np.sqrt(turn) / target.weight
        stale = 0 if cost < 0.999 * best_cost else stale + 1
        if cost < best_cost:
            best_cost, best_distance, best_angle = cost, distance, angle
            best_q[:] = q
        if stale > STALE or (distance < settings.position_tolerance and angle < settings.angle_tolerance):
            break
        for i in range(n):
            total = 0.0
            for k in range(rows):
                total += jacobian[k, i] * residual[k]
            gradient[i] = total
            if (q[i] <= lower[i] and total < 0.0) or (q[i] >= upper[i] and total > 0.0):
                gradient[i] = 0.0
                jacobian[:, i] = 0.0
        for i in range(n):
            for j in range(i + 1):
                total = 0.0
                for k in range(rows):
                    total += jacobian[k, i] * jacobian[k, j]
                normal[i, j] = total
            normal[i, i] += cost + settings.bias
        _solve_symmetric(normal, gradient)
        largest = np.max(np.abs(gradient))
        scale = settings.largest_step / largest if largest > settings.largest_step else 1.0
        for i in range(n):
            q[i] = min(max(q[i] + scale * gradient[i], lower[i]), upper[i])
    return best_q, best_distance, best_angle


@njit(cache=True)
def search_from_many(
    chain: Chain,
    starts: FloatArray,
    lower: FloatArray,
    upper: FloatArray,
    target: TipTarget,
    settings: SearchSettings,
) -> tuple[FloatArray, float, float, int]:
    """Searches from each of `starts` (m, n) until one arrives. Arguments and errors as `search`.

    Every other start is searched with the turning joints free, and its result is turned back into the limits by
    whole turns: a way that limits would block is open to it.

    Returns:
        joint positions (n,), position error [m], angle error [rad], number of the start that arrived (-1: none).
    """
    n = starts.shape[1]
    wide_lower, wide_upper = lower.copy(), upper.copy()
    for i in range(n):
        if chain.revolute[i] > 0.5:
            wide_lower[i], wide_upper[i] = -1e6, 1e6
    best_q, best_cost, best_distance, best_angle = starts[0].copy(), np.inf, np.inf, np.inf
    for k in range(starts.shape[0]):
        free = k % 2 == 1
        q, distance, angle = search(
            chain,
            starts[k],
            wide_lower if free else lower,
            wide_upper if free else upper,
            target,
            settings,
        )
        if free and not turn_into_limits(chain, lower, upper, q):
            continue
        if distance < settings.position_tolerance and angle < settings.angle_tolerance:
            return q, distance, angle, k
        cost = distance**2 + (target.weight * angle) ** 2
        if cost < best_cost:
            best_cost, best_distance, best_angle = cost, distance, angle
            best_q = q
    return best_q, best_distance, best_angle, -1


@njit(cache=True)
def turn_into_limits(chain: Chain, lower: FloatArray, upper: FloatArray, q: FloatArray) -> bool:
    """Turn revolute joints of q (n,) by whole turns, in place; whether all joints are then within their limits."""
    inside = True
    for i in range(q.shape[0]):
        if chain.revolute[i] > 0.5:
            middle = 0.5 * (lower[i] + upper[i])
            q[i] -= 2.0 * np.pi * np.round((q[i] - middle) / (2.0 * np.pi))
        inside = inside and lower[i] <= q[i] <= upper[i]
    return inside


@njit(cache=True)
def _residual(
    chain: Chain,
    target: TipTarget,
    rotation: FloatArray,
    position: FloatArray,
    jacobian: FloatArray,
    residual: FloatArray,
) -> None:
    """Weighted residual (6,), and the weights put into the Jacobian's last rows."""
    task, wanted, weight = target.task, target.rotation, target.weight
    for k in range(3):
        residual[k] = target.position[k] - position[k]
        residual[3 + k] = 0.0
    if task == POSITION:
        return
    if task == POSE:
        turn = _rotation_error(wanted, rotation)
    else:
        tool = np.empty(3)
        for k in range(3):
            tool[k] = 0.0
            for m in range(3):
                tool[k] += rotation[k, m] * chain.tool_axis[m]
        turn = pointing_error(tool, wanted[:, 2])
        for i in range(jacobian.shape[1]):
            along = tool[0] * jacobian[3, i] + tool[1] * jacobian[4, i] + tool[2] * jacobian[5, i]
            for k in range(3):
                jacobian[3 + k, i] -= tool[k] * along
    for k in range(3):
        residual[3 + k] = weight * turn[k]
        for i in range(jacobian.shape[1]):
            jacobian[3 + k, i] *= weight


@njit(cache=True)
def _rotation_error(wanted: FloatArray, rotation: FloatArray) -> FloatArray:
    """Rotation vector (3,) [rad] in the base that turns `rotation` into `wanted`."""
    error = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            error[i, j] = wanted[i, 0] * rotation[j, 0] + wanted[i, 1] * rotation[j, 1] + wanted[i, 2] * rotation[j, 2]
    vector: FloatArray = np.array([error[2, 1] - error[1, 2], error[0, 2] - error[2, 0], error[1, 0] - error[0, 1]])
    sine = 0.5 * np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    cosine = 0.5 * (error[0, 0] + error[1, 1] + error[2, 2] - 1.0)
    if sine > 1e-9:
        vector *= 0.5 * np.arctan2(sine, cosine) / sine
        return vector
    if cosine > 0.0:
        vector *= 0.5
        return vector
    # Half a turn: the axis is the column of R + I that is not zero.
    k = 0
    for m in range(1, 3):
        if error[m, m] > error[k, k]:
            k = m
    axis: FloatArray = error[:, k].copy()
    axis[k] += 1.0
    axis *= np.pi / np.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    return axis


@njit(cache=True)
def pointing_error(tool: FloatArray, wanted: FloatArray) -> FloatArray:
    """Rotation vector (3,) [rad] that turns unit vector `tool` onto unit vector `wanted` the short way."""
    cross: FloatArray = np.array(
        [
            tool[1] * wanted[2] - tool[2] * wanted[1],
            tool[2] * wanted[0] - tool[0] * wanted[2],
            tool[0] * wanted[1] - tool[1] * wanted[0],
        ]
    )
    sine = np.sqrt(cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2)
    cosine = tool[0] * wanted[0] + tool[1] * wanted[1] + tool[2] * wanted[2]
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
def _solve_symmetric(matrix: FloatArray, x: FloatArray) -> None:
    """Solve a positive definite system by Cholesky, in place; the lower half of matrix (n, n) is read."""
    n = x.shape[0]
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
