"""A smooth surface through points of the ground: a plane of least squares round each node of a square grid.

Round the node at c the points p within the radius R make, by weighted least squares (moving least squares of first
order), the plane

    h(x) = a + g . (x - c),   weight of a point w = K(r) / s^2,   K = (1 - r^2 / R^2)^2,   r = |p - c|

with s the error of the point's height. Between the nodes the planes of the four corners are blended bilinearly. The
plane is no node's if its points are few, lie on one side, nearly on a line, or far off it.

Errors. The covariance of (a, g) is A^-1 B A^-1 with A = sum w X X^T and B = sum K w X X^T. For points spread evenly
over the disc B is 3/5 of A for the height and 2/5 of A for the slopes (moments of K): that is taken here. It is scaled
up by the squares of what the points are off the plane over s^2: relief that a plane cannot follow, and so the error of
interpolation, is in it.

Source: Lancaster & Salkauskas (1981), Mathematics of Computation 37:141 (moving least squares). Range: relief that is
longer than R; a step is smeared over R, and left out.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

MOMENTS = 12
"""Of the points round a node: w, w x, w y, w x x, w x y, w y y, w z, w x z, w y z, w z z, K, and their number."""
HEIGHT, SLOPE_X, SLOPE_Y, HEIGHT_VARIANCE, SLOPE_X_VARIANCE, SLOPE_Y_VARIANCE, KNOWN, PLANE = range(8)
"""Places in a node's plane; KNOWN is 1 or 0, PLANE their number."""
KERNEL_OF_HEIGHT, KERNEL_OF_SLOPE = 0.6, 0.4
LEAST_POINTS = 5
"""Of a plane [-]."""
TORN = 4.0
"""Square of what the points are off their plane, over their variance, from which it is none [-]: at the edge of a step,
where what is seen changes with the place from which it is seen, or where looks lie on each other at different heights.
"""
LEAST_SPREAD, LARGEST_OFFSET = 0.25, 0.5
"""Of the points of a plane, over the radius: smallest deviation in any direction, distance of their mean."""


class GroundSurface(NamedTuple):
    """Nodes at (x0 + column cell, y0 + row cell); nobody writes to it after it was made."""

    x0: float
    y0: float
    cell: float
    """[m]"""
    planes: FloatArray
    """Shape (nodes, nodes, PLANE): height [m], slopes [-], their variances, and 1 where there is a plane."""


def surface_through(
    points: FloatArray, variances: FloatArray, cell: float, radius: float, reach: float
) -> GroundSurface:
    """The surface of a square of twice `reach` about the origin.

    Args:
        points: shape (n, 3) [m]. variances: of their heights, shape (n,), above 0 [m^2].
        cell, radius: distance of the nodes, and of the points that a node looks at [m].
    """
    half = math.ceil(reach / cell)
    corner = -half * cell
    moments = np.zeros((2 * half + 1, 2 * half + 1, MOMENTS))
    add_points(moments, corner, cell, radius, points, variances)
    return GroundSurface(corner, corner, cell, planes_of(moments, radius))


@njit(cache=True)
def add_points(
    moments: FloatArray, corner: float, cell: float, radius: float, points: FloatArray, variances: FloatArray
) -> None:
    """Add points to the moments of the nodes round them, shape (nodes, nodes, MOMENTS)."""
    size = moments.shape[0]
    for i in range(points.shape[0]):
        x, y, z = points[i, 0] - corner, points[i, 1] - corner, points[i, 2]
        first_row, last_row = max(math.ceil((y - radius) / cell), 0), min(math.floor((y + radius) / cell), size - 1)
        first, last = max(math.ceil((x - radius) / cell), 0), min(math.floor((x + radius) / cell), size - 1)
        for row in range(first_row, last_row + 1):
            for column in range(first, last + 1):
                dx, dy = x - column * cell, y - row * cell
                left = 1.0 - (dx * dx + dy * dy) / (radius * radius)
                if left <= 0.0:
                    continue
                kernel = left * left
                weight = kernel / variances[i]
                node = moments[row, column]
                node[0] += weight
                node[1] += weight * dx
                node[2] += weight * dy
                node[3] += weight * dx * dx
                node[4] += weight * dx * dy
                node[5] += weight * dy * dy
                node[6] += weight * z
                node[7] += weight * dx * z
                node[8] += weight * dy * z
                node[9] += weight * z * z
                node[10] += kernel
                node[11] += 1.0


@njit(cache=True)
def planes_of(moments: FloatArray, radius: float) -> FloatArray:
    """The planes of the nodes, shape (nodes, nodes, PLANE)."""
    size = moments.shape[0]
    planes = np.zeros((size, size, PLANE))
    for row in range(size):
        for column in range(size):
            node = moments[row, column]
            if node[11] < LEAST_POINTS:
                continue
            weight = node[0]
            x, y, z = node[1] / weight, node[2] / weight, node[6] / weight
            xx, xy, yy = node[3] / weight - x * x, node[4] / weight - x * y, node[5] / weight - y * y
            half, determinant = 0.5 * (xx + yy), xx * yy - xy * xy
            narrowest = half - math.sqrt(max(half * half - determinant, 0.0))
            if narrowest < (LEAST_SPREAD * radius) ** 2 or x * x + y * y > (LARGEST_OFFSET * radius) ** 2:
                continue
            xz, yz, zz = node[7] / weight - x * z, node[8] / weight - y * z, node[9] / weight - z * z
            slope_x, slope_y = (yy * xz - xy * yz) / determinant, (xx * yz - xy * xz) / determinant
            off = max(zz - slope_x * xz - slope_y * yz, 0.0) * weight
            misfit = max(1.0, off / (node[10] * (1.0 - 3.0 / max(node[11], 3.5))))
            if misfit > TORN:
                continue
            at_node = 1.0 + (x * x * yy - 2.0 * x * y * xy + y * y * xx) / determinant
            plane = planes[row, column]
            plane[HEIGHT] = z - slope_x * x - slope_y * y
            plane[SLOPE_X], plane[SLOPE_Y] = slope_x, slope_y
            plane[HEIGHT_VARIANCE] = KERNEL_OF_HEIGHT * misfit * at_node / weight
            plane[SLOPE_X_VARIANCE] = KERNEL_OF_SLOPE * misfit * yy / determinant / weight
            plane[SLOPE_Y_VARIANCE] = KERNEL_OF_SLOPE * misfit * xx / determinant / weight
            plane[KNOWN] = 1.0
    return planes


@njit(cache=True)
def surface_at(surface: GroundSurface, x: float, y: float) -> tuple[bool, float, float, float, float, float, float]:
    """Whether the surface is known at a place; height, slopes, and the variances of the three."""
    planes, cell = surface.planes, surface.cell
    size = planes.shape[0]
    across, up = (x - surface.x0) / cell, (y - surface.y0) / cell
    if not (0.0 <= across < size - 1 and 0.0 <= up < size - 1):
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    column, row = int(across), int(up)
    u, v = across - column, up - row
    height = slope_x = slope_y = height_variance = slope_x_variance = slope_y_variance = 0.0
    for j in range(2):
        for i in range(2):
            plane = planes[row + j, column + i]
            if plane[KNOWN] == 0.0:
                return False, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            share = (u if i == 1 else 1.0 - u) * (v if j == 1 else 1.0 - v)
            height += share * (plane[HEIGHT] + (plane[SLOPE_X] * (u - i) + plane[SLOPE_Y] * (v - j)) * cell)
            slope_x += share * plane[SLOPE_X]
            slope_y += share * plane[SLOPE_Y]
            height_variance += share * plane[HEIGHT_VARIANCE]
            slope_x_variance += share * plane[SLOPE_X_VARIANCE]
            slope_y_variance += share * plane[SLOPE_Y_VARIANCE]
    return True, height, slope_x, slope_y, height_variance, slope_x_variance, slope_y_variance
