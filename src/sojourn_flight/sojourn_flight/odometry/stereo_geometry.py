"""Points of a rectified stereo pair: where they are, where they would be seen after a motion, and the derivatives.

Both cameras have the focal length f and the principal point (u_0, v_0) [px], the right one is the baseline b to the
right of the left one. What is at X = [x, y, z] in the optical frame of the left camera (z ahead, x right, y down;
REP 103) is seen at

    u = u_0 + f x / z,    v = v_0 + f y / z,    u' = u_0 + f (x - b) / z,

so that of a place s = (u, v, u') with the disparity d = u - u' comes X = (b / d) [u - u_0, v - v_0, f].

Motion. The machine has moved by the rotation R and the shift t: of base_link then, in base_link before. With the
camera's rotation C into base_link and its place p there, a point at w = C X + p - t from the new place is at

    Y = C^T (R^T w - p)

in the camera after it; for a small turn q and shift e in the axes of base_link before, R <- exp([q]x) R, t <- t + e,

    dY = C^T R^T ([w]x q - e + C dX).

Source: Hartley & Zisserman (2004), Multiple View Geometry, sec. 6.1 and 9 (projection, rectified pairs). Assumptions:
images are rectified (`rectified`), the machine between camera and base_link does not bend.
"""

from typing import NamedTuple

import numpy as np

from sojourn_machine.params import FloatArray

NEAREST = 0.02
"""What would come to lie nearer, or behind the camera, is taken to be here [m]: it fits no match."""
LEAST_DISPARITY = 1e-3
"""[px]"""


class PinholePair(NamedTuple):
    """A rectified pair."""

    focal_length: float
    """[px]"""
    middle: tuple[float, float]
    """u_0, v_0 [px]."""
    baseline: float
    """[m]"""


class CameraPlace(NamedTuple):
    """Where the left camera sits on the machine."""

    turn: FloatArray
    """From its optical frame into base_link, shape (3, 3)."""
    place: FloatArray
    """In base_link, shape (3,) [m]."""


class Motion(NamedTuple):
    """Of base_link in base_link before; one, or several at once."""

    turn: FloatArray
    """Shape (..., 3, 3)."""
    shift: FloatArray
    """Shape (..., 3) [m]."""


def triangulated(pair: PinholePair, seen: FloatArray) -> FloatArray:
    """Points in the optical frame of the left camera [m], shape (..., 3), from their places u, v, u' [px], likewise."""
    disparity = np.maximum(seen[..., 0] - seen[..., 2], LEAST_DISPARITY)
    ahead = np.full(disparity.shape, pair.focal_length)
    rays = np.stack([seen[..., 0] - pair.middle[0], seen[..., 1] - pair.middle[1], ahead], axis=-1)
    return np.asarray((pair.baseline / disparity)[..., np.newaxis] * rays)


def triangulation_jacobian(pair: PinholePair, seen: FloatArray) -> FloatArray:
    """Derivative of `triangulated`, shape (..., 3, 3) [m/px]."""
    disparity = np.maximum(seen[..., 0] - seen[..., 2], LEAST_DISPARITY)
    points = triangulated(pair, seen) / disparity[..., np.newaxis]
    jacobian = np.zeros((*disparity.shape, 3, 3))
    jacobian[..., 0, 0] = jacobian[..., 1, 1] = pair.baseline / disparity
    jacobian[..., 0] -= points
    jacobian[..., 2] += points
    return jacobian


def projected(pair: PinholePair, points: FloatArray) -> FloatArray:
    """Places u, v, u' [px] of points in the optical frame of the left camera [m], shape (..., 3)."""
    depth = np.maximum(points[..., 2], NEAREST)
    f, (u, v) = pair.focal_length, pair.middle
    x, y = points[..., 0], points[..., 1]
    return np.stack([u + f * x / depth, v + f * y / depth, u + f * (x - pair.baseline) / depth], axis=-1)


def projection_jacobian(pair: PinholePair, points: FloatArray) -> FloatArray:
    """Derivative of `projected`, shape (..., 3, 3) [px/m]."""
    scale = pair.focal_length / np.maximum(points[..., 2], NEAREST)
    by_depth = -scale / np.maximum(points[..., 2], NEAREST)
    jacobian = np.zeros((*scale.shape, 3, 3))
    jacobian[..., 0, 0] = jacobian[..., 1, 1] = jacobian[..., 2, 0] = scale
    jacobian[..., 0, 2] = by_depth * points[..., 0]
    jacobian[..., 1, 2] = by_depth * points[..., 1]
    jacobian[..., 2, 2] = by_depth * (points[..., 0] - pair.baseline)
    return jacobian


def seen_after(camera: CameraPlace, motion: Motion, points: FloatArray) -> FloatArray:
    """Y of points X, shape (..., n, 3), after a motion, or each after its own [m]."""
    around = points @ camera.turn.T + camera.place - motion.shift[..., np.newaxis, :]
    return np.asarray((around @ motion.turn - camera.place) @ camera.turn)


def motion_jacobians(camera: CameraPlace, motion: Motion, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Derivatives of `seen_after` by e and q, shape (..., n, 3, 6), and by the points, shape (..., 1, 3, 3)."""
    around = points @ camera.turn.T + camera.place - motion.shift[..., np.newaxis, :]
    back = (motion.turn @ camera.turn).swapaxes(-1, -2)[..., np.newaxis, :, :]
    return np.concatenate(
        [np.broadcast_to(-back, (*around.shape, 3)), back @ cross(around)], axis=-1
    ), back @ camera.turn


def cross(vectors: FloatArray) -> FloatArray:
    """[v]x of vectors of shape (..., 3), so that [v]x q = v x q; shape (..., 3, 3)."""
    matrix = np.zeros((*vectors.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrix[..., i, j], matrix[..., i, k] = -vectors[..., k], vectors[..., j]
    return matrix


def moved_on(motion: Motion, step: FloatArray) -> Motion:
    """The motion with e and q, shape (..., 6): exp([q]x) by Rodrigues' formula."""
    turn = step[..., 3:]
    angle = np.linalg.norm(turn, axis=-1)[..., np.newaxis, np.newaxis]
    skew = cross(turn)
    half = np.sinc(0.5 * angle / np.pi)
    exponential = np.eye(3) + np.sinc(angle / np.pi) * skew + 0.5 * half * half * (skew @ skew)
    return Motion(exponential @ motion.turn, motion.shift + step[..., :3])
