"""The ground of a look as a plane, by which windows of one image are made to look as another camera sees them.

Of points on a plane the disparity is linear in the image, d = a u + b v + c, and what the left camera sees of it at
(u, v) another camera sees at H (u, v, 1), a homography. An image that is drawn anew by it (`image_features.follow`)
shows the ground in the first camera's perspective, so that a window on slanting ground can be compared as it is; what
stands out of the plane is off by a little, which is what is looked for.

Source: Hartley & Zisserman (2004), Multiple View Geometry, sec. 13.1 (homography of a plane). Assumptions: rectified
pairs; most of the points are on one surface, none of which is level with the camera.
"""

from typing import NamedTuple

import numpy as np

from sojourn_flight.odometry.stereo_geometry import (
    CameraPlace,
    Motion,
    PinholePair,
    projected,
    seen_after,
    triangulated,
)
from sojourn_machine.params import FloatArray

ROUNDS, TRIMMED = 5, 2.5
"""Of the fit; medians of the residuals beyond which a point is left out of the next."""
LEAST_OFF = 0.5
"""Of a residual that leaves a point out [px]."""
LEAST_DISPARITY = 0.5
"""Of the plane's points by which a homography is made [px]."""


class DisparityPlane(NamedTuple):
    """d = across u + down v + level [px]."""

    across: float
    down: float
    level: float

    def at(self, places: FloatArray) -> FloatArray:
        """Disparities of places u, v in the left image, shape (..., 2) [px]."""
        return np.asarray(self.across * places[..., 0] + self.down * places[..., 1] + self.level)


def plane_of(seen: FloatArray) -> DisparityPlane:
    """Through most of the points u, v, u', shape (n, 3) [px]; of fewer than three points as far as their median."""
    disparities = seen[:, 0] - seen[:, 2]
    level = float(np.median(disparities))
    if len(seen) < 3:
        return DisparityPlane(0.0, 0.0, level)
    rows = np.column_stack([seen[:, :2], np.ones(len(seen))])
    kept = np.ones(len(seen), dtype=bool)
    found = np.array((0.0, 0.0, level))
    for _ in range(ROUNDS):
        found = np.linalg.lstsq(rows[kept], disparities[kept], rcond=None)[0]
        off = np.abs(disparities - rows @ found)
        kept = off <= max(TRIMMED * float(np.median(off)), LEAST_OFF)
    return DisparityPlane(*found.tolist())


def into_right(plane: DisparityPlane) -> FloatArray:
    """From the left image into the right one of the same look, shape (3, 3)."""
    return np.array([[1.0 - plane.across, -plane.down, -plane.level], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def into_later(
    plane: DisparityPlane, pair: PinholePair, camera: CameraPlace, motion: Motion, size: tuple[int, int]
) -> tuple[FloatArray, FloatArray] | None:
    """From the left image of a look into both images after a motion, shape (3, 3) each; None where the plane is not in
    view, before or after. size: rows and columns of the images [px].
    """
    rows, columns = size
    u, v = np.meshgrid(np.linspace(0.0, columns - 1.0, 8), np.linspace(0.0, rows - 1.0, 8))
    places = np.column_stack([u.ravel(), v.ravel()])
    disparities = plane.at(places)
    places, disparities = places[disparities > LEAST_DISPARITY], disparities[disparities > LEAST_DISPARITY]
    points = triangulated(pair, np.column_stack([places, places[:, 0] - disparities]))
    there = seen_after(camera, motion, points)
    ahead = there[:, 2] > 0.25 * points[:, 2]
    if ahead.sum() < 6:
        return None
    later = projected(pair, there[ahead])
    return homography(places[ahead], later[:, :2]), homography(places[ahead], later[:, [2, 1]])


def homography(places: FloatArray, images: FloatArray) -> FloatArray:
    """The homography from places to their images, shapes (n, 2), exact to rounding where there is one; by the direct
    linear transform (Hartley & Zisserman, algorithm 4.2).
    """
    (onto, first), (back, second) = _normalised(places), _normalised(images)
    zero, one = np.zeros(len(places)), np.ones(len(places))
    x, y = first.T
    rows = [
        np.column_stack([x, y, one, zero, zero, zero, -u * x, -u * y, -u])
        if i == 0
        else np.column_stack([zero, zero, zero, x, y, one, -u * x, -u * y, -u])
        for i, u in enumerate(second.T)
    ]
    matrix = np.concatenate(rows)
    flattest = np.linalg.eigh(matrix.T @ matrix)[1][:, 0]
    found = np.linalg.inv(back) @ flattest.reshape(3, 3) @ onto
    return np.asarray(found / found[2, 2])


def mapped(onto: FloatArray, places: FloatArray) -> FloatArray:
    """Places of shape (n, 2) by a homography."""
    images = places @ onto[:, :2].T + onto[:, 2]
    return np.asarray(images[:, :2] / images[:, 2:])


def _normalised(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A similarity that centres places and makes them of size one, and the places by it."""
    middle = places.mean(axis=0)
    scale = 1.0 / max(float(np.abs(places - middle).mean()), 1e-9)
    onto = np.array([[scale, 0.0, -scale * middle[0]], [0.0, scale, -scale * middle[1]], [0.0, 0.0, 1.0]])
    return onto, mapped(onto, places)
