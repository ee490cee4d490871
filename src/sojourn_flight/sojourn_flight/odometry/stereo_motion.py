"""How a machine has moved between two looks of its stereo pair, by points that both have seen, with its covariance.

Least squares. Of n points the first look has seen the places s, the second s' (u, v, u' each, see `stereo_geometry`),
each number off by the same standard deviation s_p. With the motion m and what it predicts, g(s, m), the residuals
e = s' - g(s, m) have the covariance s_p^2 V, V = I + G G^T, G = dg/ds: the errors of the first look come through its
depths, which are worst along the ray. Gauss-Newton with A = dg/dm makes

    m <- m + (sum A^T V^-1 A)^-1 sum A^T V^-1 e,     cov m = s_p^2 (sum A^T V^-1 A)^-1,

the maximum of likelihood to the first order in the depths' errors. The deviation of a place is found from the residuals
themselves, s_p^2 = sum e^T V^-1 e / (3 n - 6), and is not believed to be below the tracker's own.

Consensus. Points that do not move with the ground (shadows of the machine, its own parts, false matches) must not
count. Of many sets of three points each gives a motion, by the same steps; the one with which most points agree says
which are kept, and a last look at all by the motion of those.

Sources: Matthies & Shafer (1987), IEEE J. Robotics and Automation 3(3):239 (motion by stereo, weighted by the errors of
depth); Maimone, Cheng & Matthies (2007), J. Field Robotics 24:169; Geiger, Ziegler & Stiller (2011), IEEE Intelligent
Vehicles, p. 963 (sets of three points, reprojection in both images); Fischler & Bolles (1981), Comm. ACM 24:381.
Assumptions: errors of different points are independent; motion between looks is known to within some pixels.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.odometry.stereo_geometry import (
    CameraPlace,
    Motion,
    PinholePair,
    motion_jacobians,
    moved_on,
    projected,
    projection_jacobian,
    seen_after,
    triangulated,
    triangulation_jacobian,
)
from sojourn_machine.params import FloatArray

SETS, OF_POINTS = 100, 3
"""Sets that are tried: with half of the points wrong one in 1e5 looks has none that is right."""
SET_STEPS, MOST_STEPS, CONVERGED = 4, 10, 1e-6
"""Steps of Gauss-Newton for a set, and at most for all; change of shift [m] and turn [rad] below which it ends."""
DAMPING = 1e-9
"""Part of the largest curvature that keeps a set of points on one line solvable [-]."""


class Looks(NamedTuple):
    """The same points in two looks."""

    camera: CameraPlace
    pair: PinholePair
    first: FloatArray
    """u, v, u' of each, shape (n, 3) [px]."""
    second: FloatArray
    """Likewise."""


class FoundMotion(NamedTuple):
    """What the points say."""

    motion: Motion
    covariance: FloatArray
    """Of shift and turn, both in the axes of base_link before, shape (6, 6) [m, rad]."""
    deviation: float
    """s_p [px]."""
    agree: NDArray[np.bool_]
    """Which points do, shape (n,)."""


def found_motion(
    looks: Looks, guess: Motion, random: np.random.Generator, outlier: float, tracking_sigma: float
) -> FoundMotion | None:
    """The motion by consensus and least squares; None where fewer points agree than make one.

    Args:
        guess: to begin with. outlier: distance from its predicted place beyond which a point does not agree [px].
        tracking_sigma: least s_p [px].
    """
    count = len(looks.first)
    if count < 2 * OF_POINTS:
        return None
    points = triangulated(looks.pair, looks.first)
    sets = np.argsort(random.random((SETS, count)), axis=1)[:, :OF_POINTS]
    tried = Motion(np.tile(guess.turn, (SETS, 1, 1)), np.tile(guess.shift, (SETS, 1)))
    for _ in range(SET_STEPS):
        tried = moved_on(tried, _step(looks, tried, points[sets], looks.second[sets]))
    off = np.linalg.norm(looks.second - projected(looks.pair, seen_after(looks.camera, tried, points)), axis=-1)
    agree: NDArray[np.bool_] = off[int(np.argmax((off < outlier).sum(axis=1)))] < outlier
    for _ in range(2):
        if agree.sum() < 2 * OF_POINTS:
            return None
        motion, information, squares = _least_squares(looks, guess, agree)
        off = np.linalg.norm(looks.second - projected(looks.pair, seen_after(looks.camera, motion, points)), axis=-1)
        before, agree = agree, off < outlier
    kept = int(before.sum())
    variance = max(squares / (3 * kept - 6), tracking_sigma**2)
    return FoundMotion(motion, np.asarray(variance * np.linalg.inv(information)), math.sqrt(variance), before)


def _least_squares(looks: Looks, guess: Motion, agree: NDArray[np.bool_]) -> tuple[Motion, FloatArray, float]:
    """Motion by the points that agree, sum A^T V^-1 A, and sum e^T V^-1 e."""
    first, second = looks.first[agree], looks.second[agree]
    points, spread = triangulated(looks.pair, first), triangulation_jacobian(looks.pair, first)
    motion, last = guess, False
    for step in range(MOST_STEPS + 1):
        there = seen_after(looks.camera, motion, points)
        by_motion, by_point = motion_jacobians(looks.camera, motion, points)
        onto = projection_jacobian(looks.pair, there)
        through = onto @ by_point @ spread
        weights = np.linalg.inv(np.eye(3) + through @ through.swapaxes(-1, -2))
        jacobian, residual = onto @ by_motion, second - projected(looks.pair, there)
        weighed = jacobian.swapaxes(-1, -2) @ weights
        information = (weighed @ jacobian).sum(axis=0)
        if last or step == MOST_STEPS:
            break
        change = np.linalg.solve(information, np.einsum("nij,nj->i", weighed, residual))
        motion, last = moved_on(motion, change), bool(np.abs(change).max() < CONVERGED)
    return motion, information, float(np.einsum("ni,nij,nj->", residual, weights, residual))


def _step(looks: Looks, motion: Motion, points: FloatArray, second: FloatArray) -> FloatArray:
    """A step of Gauss-Newton for each set of points, (sets, points, 3), all places alike; shape (sets, 6)."""
    there = seen_after(looks.camera, motion, points)
    jacobian = projection_jacobian(looks.pair, there) @ motion_jacobians(looks.camera, motion, points)[0]
    jacobian = jacobian.reshape(len(points), -1, 6)
    residual = (second - projected(looks.pair, there)).reshape(len(points), -1)
    curvature = jacobian.swapaxes(-1, -2) @ jacobian
    curvature += DAMPING * np.trace(curvature, axis1=-2, axis2=-1)[:, np.newaxis, np.newaxis] * np.eye(6)
    slope = np.einsum("sri,sr->si", jacobian, residual)
    return np.asarray(np.linalg.solve(curvature, slope[..., np.newaxis])[..., 0])
