"""Where a cloud of points lies on a surface seen before: displacement by least squares of the heights.

The points p of the cloud, in level axes about base_link, lie on the surface h where base_link has moved by d = (x, y,
z) and the axes have turned by a small rotation t = (t_x, t_y, t_z) against those of the surface:

    r = [p + d + t x p]_z - h([p + d + t x p]_xy),
    dr / d(x, y, z, t) = (-h_x, -h_y, 1,  p_y,  -p_x,  h_x p_y - h_y p_x)   (first order in the tilt and its slopes)

The sum of r^2 / s^2 is made least by Gauss-Newton, with Huber's weights, none beyond three times their limit, and with
what is known of t (IMU, gyro) as a prior. The weight holds the error of the stereo camera, which moves the point along
its ray by q for one standard deviation (`stereo_eye`), and that of the surface:

    s^2 = (q_z - h_x q_x - h_y q_y)^2 + sharing s_h^2

Points nearer to each other than the surface's radius share its error: `sharing` is how many. The slopes are those of
the planes of `ground_surface`, not the derivative of their blend: they have less noise.

Information. z and t are marginalised from the normal matrix; what is left for x and y is S. Noise of the slopes makes
it too large by N = sum var(h_x, h_y) / s^2, so S - N is what the relief gives; the estimate's own covariance follows as
that of an equation S^1/2-noisy with the gradient S - N:

    information = (S - N) S^-1 (S - N),  over the mean square of the weighted residuals where that is above one.

On flat ground S - N goes to zero and the match says nothing of x and y; on an even ramp z takes all, likewise.

Sources: Gauss-Newton on heights: Lucas & Kanade (1981), IJCAI 2:674; Rusinkiewicz & Levoy (2001), 3DIM, p. 145 (point
to plane); Olson, Matthies, Schoppers & Maimone (2003), Robotics and Autonomous Systems 43:215 (a rover's motion from
stereo points, with their errors); noisy slopes: Fuller (1987), Measurement Error Models, sec. 2.2; Huber (1964), Annals
of Mathematical Statistics 35:73. Assumptions: rotations of a few hundredths of a radian, first guess within about the
surface's radius, points within some metres of base_link.
"""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_flight.odometry.ground_surface import GroundSurface, surface_at
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

UNKNOWNS = 6
HUBER = 2.0
"""Residual over its deviation from which a point counts less; none beyond three times that."""
CAPTURE = 0.1
"""Sigma of the weak prior on x and y that keeps an even ground's solution near the guess [m]; taken out at the end."""
ITERATIONS, FULL_STEPS, CONVERGED = 16, 5, 5e-4
"""At most; so many of them whole, then half, since points that come and go can make it swing; change of x and y below
which the search ends [m]."""


@dataclass(frozen=True, slots=True)
class Match:
    """Result of a match; arrays in the axes of the surface."""

    shift: FloatArray
    """x, y, z [m] and t [rad] by which the cloud has to be moved beyond the guess, shape (6,)."""
    information: FloatArray
    """Of x and y, shape (2, 2) [1/m^2]; zero where the ground is even."""
    points: int
    """That lie on known surface."""
    outliers: int
    """Of them, those off by more than three times the Huber limit."""
    misfit: float
    """Mean square of the weighted residuals [-]."""
    converged: bool


def match(
    surface: GroundSurface,
    points: FloatArray,
    errors: FloatArray,
    place: FloatArray,
    sharing: float,
    turn_sigmas: tuple[float, float],
) -> Match:
    """The cloud on the surface.

    Args:
        points: about base_link in the surface's axes, shape (n, 3) [m].
        errors: by which a point is off for one standard deviation of its match, likewise.
        place: first guess of base_link on the surface, shape (3,) [m].
        sharing: [-]. turn_sigmas: of tilt and heading against the surface's [rad].
    """
    return Match(*_match(surface, points, errors, place, sharing, turn_sigmas))


@njit(cache=True)
def normal_equations(
    surface: GroundSurface,
    points: FloatArray,
    errors: FloatArray,
    place: FloatArray,
    shift: FloatArray,
    sharing: float,
) -> tuple[FloatArray, FloatArray, FloatArray, int, int, float]:
    """J^T W J, -J^T W r, the part of the noise of the slopes (x x, x y, y y), points, outliers, sum of squares."""
    matrix, side, noise = np.zeros((UNKNOWNS, UNKNOWNS)), np.zeros(UNKNOWNS), np.zeros(2)
    row = np.empty(UNKNOWNS)
    count = outliers = 0
    squares = 0.0
    for i in range(points.shape[0]):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        x = place[0] + shift[0] + px + shift[4] * pz - shift[5] * py
        y = place[1] + shift[1] + py + shift[5] * px - shift[3] * pz
        z = place[2] + shift[2] + pz + shift[3] * py - shift[4] * px
        known, height, slope_x, slope_y, variance, variance_x, variance_y = surface_at(surface, x, y)
        if not known:
            continue
        count += 1
        residual = z - height
        along = errors[i, 2] - slope_x * errors[i, 0] - slope_y * errors[i, 1]
        weight = 1.0 / (along * along + sharing * variance)
        off = abs(residual) * math.sqrt(weight)
        if off > 3.0 * HUBER:
            outliers += 1
            continue
        if off > HUBER:
            weight *= HUBER / off
        squares += weight * residual * residual
        row[0], row[1], row[2] = -slope_x, -slope_y, 1.0
        row[3], row[4], row[5] = py + slope_y * pz, -px - slope_x * pz, slope_x * py - slope_y * px
        for j in range(UNKNOWNS):
            side[j] -= weight * row[j] * residual
            for k in range(j + 1):
                matrix[j, k] += weight * row[j] * row[k]
        noise[0] += weight * variance_x
        noise[1] += weight * variance_y
    for j in range(UNKNOWNS):
        for k in range(j):
            matrix[k, j] = matrix[j, k]
    return matrix, side, noise, count, outliers, squares


@njit(cache=True)
def _match(
    surface: GroundSurface,
    points: FloatArray,
    errors: FloatArray,
    place: FloatArray,
    sharing: float,
    turn_sigmas: tuple[float, float],
) -> tuple[FloatArray, FloatArray, int, int, float, bool]:
    """The fields of a Match."""
    tilt_sigma, heading_sigma = turn_sigmas
    prior = np.array((CAPTURE**-2, CAPTURE**-2, 0.0, tilt_sigma**-2, tilt_sigma**-2, heading_sigma**-2))
    shift, nothing = np.zeros(UNKNOWNS), np.zeros((2, 2))
    matrix, side, noise, count, outliers, squares = normal_equations(surface, points, errors, place, shift, sharing)
    converged = False
    for iteration in range(ITERATIONS):
        if count - outliers < 2 * UNKNOWNS:
            return shift, nothing, count, outliers, 0.0, False
        change = np.linalg.solve(matrix + np.diag(prior), side - prior * shift)
        shift = shift + (change if iteration < FULL_STEPS else 0.5 * change)
        matrix, side, noise, count, outliers, squares = normal_equations(surface, points, errors, place, shift, sharing)
        if abs(change[0]) + abs(change[1]) < CONVERGED:
            converged = True
            break
    if count - outliers < 2 * UNKNOWNS:
        return shift, nothing, count, outliers, 0.0, False
    misfit = squares / (count - outliers)
    full = matrix.copy()
    for i in range(2, UNKNOWNS):
        full[i, i] += prior[i]
    coupling = np.ascontiguousarray(full[2:, :2])
    gained = full[:2, :2] - coupling.T @ np.linalg.solve(np.ascontiguousarray(full[2:, 2:]), coupling)
    relief = positive_part(gained - np.diag(noise))
    # the weak prior has held x and y back: taken out where the ground says more than nothing
    free = np.linalg.solve(gained + 1e-9 * np.eye(2), prior[:2] * shift[:2])
    if relief[0, 0] + relief[1, 1] > 0.0:
        shift[:2] += np.linalg.solve(gained, relief) @ free
    information = relief @ np.linalg.solve(gained + 1e-9 * np.eye(2), relief) / max(misfit, 1.0)
    return shift, 0.5 * (information + information.T), count, outliers, misfit, converged


@njit(cache=True)
def positive_part(matrix: FloatArray) -> FloatArray:
    """A symmetric matrix, shape (2, 2), with its negative eigenvalues set to zero."""
    values, vectors = np.linalg.eigh(matrix)
    result: FloatArray = vectors @ np.diag(np.maximum(values, 0.0)) @ vectors.T
    return result
