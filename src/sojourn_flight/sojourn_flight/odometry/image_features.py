"""Places in images: corners, where they are in the other camera's image of the same moment, and in later images.

Corners are where the ground's brightness changes in every direction: the smaller eigenvalue of the sum of g g^T over a
window, g its gradient. It has to be above what the noise of the image makes by itself, so that the grain of a dark
image is no corner; the noise is measured in the image, by a mask that neither edges nor slopes of brightness pass.

Of each image the slow changes of brightness are taken out first. They stay with the camera (its lens is darker
outwards) and the Sun (ground is brighter where the Sun is behind), while the ground moves on: left in, they hold all
places back by some hundredths of a pixel towards where they were.

The other image is drawn anew in the perspective of the first, by what is known of the ground (`disparity_plane`). There
a corner is searched for by comparing its window with those around, where it may be far off, and then followed by the
brightness to a fraction of a pixel. One that does not come back to its place when it is followed the other way, or that
has another window nearly as like, is given up.

Sources: Shi & Tomasi (1994), IEEE CVPR, p. 593 (corners); Immerkaer (1996), Computer Vision and Image Understanding
64:300 (noise); Goldberg, Maimone & Matthies (2002), IEEE Aerospace Conf. 5:2025 (slow changes out); Lucas & Kanade
(1981), IJCAI, p. 674 (following). The work is done by OpenCV. Assumptions: rectified images, the grain of the ground
looks alike from both places.
"""

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sojourn_flight.odometry.disparity_plane import mapped
from sojourn_machine.params import FloatArray

GreyImage = NDArray[np.uint8]
Found = NDArray[np.bool_]

NOISE_MASK = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], dtype=np.float64)
CORNER_BLOCK = 7
"""Window of the sum over the gradients [px]."""
LEAST_NOISE = 0.3
"""Of an image in whole numbers [-]."""
OVER_NOISE = 4.0
"""Mean square of a gradient over that of the noise's, that a corner must have in every direction [-]."""
ROUND_TRIP = 0.3
"""By how much a place may be missed that is followed there and back [px]."""
LIKENESS, RIVAL = 0.6, 0.95
"""Correlation that a window needs, and part of it that none farther than NEXT px may have [-]."""
NEXT = 2
SMOOTHED, GREY = 8.0, 128.0
"""Standard deviation of the weights of the mean that is taken out [px]; what is put there for it."""
FAR = 5.0
"""Beyond it following does not lead [px]."""

cv2.setNumThreads(1)


def grain_of(image: GreyImage) -> GreyImage:
    """An image without its slow changes of brightness, which go with camera and Sun and not with the ground."""
    smooth = cv2.GaussianBlur(image, (0, 0), SMOOTHED)
    return np.asarray(cv2.addWeighted(image, 1.0, smooth, -1.0, GREY), dtype=np.uint8)


def noise_of(image: GreyImage) -> float:
    """Standard deviation of the noise of an image, in its own numbers."""
    passed = cv2.filter2D(image, cv2.CV_32F, NOISE_MASK)[1:-1, 1:-1]
    return max(math.sqrt(0.5 * math.pi) / 6.0 * float(np.abs(passed).mean()), LEAST_NOISE)


def corners(image: GreyImage, most: int) -> FloatArray:
    """u, v of the best corners, spread over the image, at most so many; shape (n, 2) [px]."""
    strengths = cv2.cornerMinEigenVal(image, CORNER_BLOCK)
    strongest = float(strengths.max())
    # that of noise alone: OpenCV's gradients have 12 times its variance, over (4 x 255)^2, summed over the window
    least = OVER_NOISE * 12.0 * noise_of(image) ** 2 / (4.0 * 255.0) ** 2
    if strongest <= least:
        return np.zeros((0, 2))
    apart = 0.6 * math.sqrt(image.size / most)
    found = cv2.goodFeaturesToTrack(image, most, least / strongest, apart, blockSize=CORNER_BLOCK)
    return np.zeros((0, 2)) if found is None else found.reshape(-1, 2).astype(np.float64)


def redrawn(image: GreyImage, onto: FloatArray) -> GreyImage:
    """An image in the perspective of another one; onto: from the other into it, shape (3, 3)."""
    rows, columns = image.shape
    drawn = cv2.warpPerspective(image, onto, (columns, rows), flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)
    return np.asarray(drawn, dtype=np.uint8)


def searched(
    first: GreyImage, second: GreyImage, places: FloatArray, window: int, reach: tuple[int, int, int]
) -> tuple[FloatArray, Found]:
    """Places of the first image in the second to the whole pixel, shape (n, 2), and whether each was found.

    Args:
        window: width of what is compared [px]. reach: how far to the left and to the right, and up or down [px].
    """
    half, (to_left, to_right, upright) = window // 2, reach
    framed = cv2.copyMakeBorder(second, upright, upright, to_left, to_right, cv2.BORDER_CONSTANT, value=0)
    rows, columns = first.shape
    there, found = places.copy(), np.zeros(len(places), dtype=bool)
    for i, (u, v) in enumerate(np.rint(places).astype(int).tolist()):
        if not (half <= u < columns - half and half <= v < rows - half):
            continue
        patch = first[v - half : v + half + 1, u - half : u + half + 1]
        around = framed[
            v - half : v + half + 1 + 2 * upright,
            u - half : u + half + 1 + to_left + to_right,
        ]
        likeness = cv2.matchTemplate(around, patch, cv2.TM_CCOEFF_NORMED)
        row, column = np.unravel_index(int(likeness.argmax()), likeness.shape)
        best = float(likeness[row, column])
        likeness[max(row - NEXT, 0) : row + NEXT + 1, max(column - NEXT, 0) : column + NEXT + 1] = -1.0
        found[i] = best > LIKENESS and likeness.max() < RIVAL * best
        there[i] += column - to_left, row - upright
    return there, found


def follow(
    first: GreyImage, second: GreyImage, places: FloatArray, onto: FloatArray, window: int
) -> tuple[FloatArray, Found]:
    """Places of the first image in the second, shape (n, 2) [px], and whether each was found.

    Args:
        onto: where they are expected there, a homography, shape (3, 3). window: width of what is followed [px].
    """
    if not len(places):
        return places, np.zeros(0, dtype=bool)
    drawn, start = redrawn(second, onto), places.astype(np.float32)
    ending = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 0.003)
    how: dict[str, Any] = {"winSize": (window, window), "maxLevel": 1, "criteria": ending}
    there, found, _ = cv2.calcOpticalFlowPyrLK(first, drawn, start, start.copy(), **how)
    back, found_back, _ = cv2.calcOpticalFlowPyrLK(drawn, first, there, start.copy(), **how)
    returned = np.hypot(*(back - start).T) < ROUND_TRIP
    near = np.hypot(*(there - start).T) < FAR
    result = mapped(onto, there.astype(np.float64))
    rows, columns = second.shape
    inside = (result > 0.0).all(axis=1) & (result[:, 0] < columns - 1) & (result[:, 1] < rows - 1)
    return result, (found[:, 0] == 1) & (found_back[:, 0] == 1) & inside & returned & near
