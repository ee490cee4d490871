"""Layers over the ground: how steep the map is, and what of it the drive takes for closed.

The slope is that of the plane of least squares through the heights within half the machine's width, on which it would
stand; a Savitzky-Golay filter of first order (Savitzky & Golay 1964, Analytical Chemistry 36(8):1627) gives it.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import correlate1d, uniform_filter1d

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField

GENTLE, WARM, STEEP = np.array([40, 120, 220]), np.array([255, 214, 10]), np.array([255, 59, 48])
"""Colours of level ground, of half the limit, of the limit and beyond."""


def slopes_of(ground: HeightField, reach: float) -> FloatArray:
    """Steepness of the ground at its nodes [degree], shape (rows, columns); planes within `reach` of each [m]."""
    half = max(1, round(reach / ground.resolution))
    offsets = np.arange(-half, half + 1, dtype=np.float64)
    weights = offsets / (offsets @ offsets) / ground.resolution
    rises = [
        correlate1d(uniform_filter1d(ground.heights, 2 * half + 1, axis=1 - axis, mode="nearest"), weights, axis=axis,
                    mode="nearest")
        for axis in (0, 1)
    ]  # fmt: skip
    return np.asarray(np.degrees(np.arctan(np.hypot(*rises))))


def slope_colors(slopes: FloatArray, limit: float) -> NDArray[np.uint8]:
    """Colours of slopes of any shape, (..., 3); `limit`: steepest that the machine drives [degree]."""
    part = np.clip(slopes / limit, 0.0, 1.0)[..., None]
    low = GENTLE + 2.0 * part * (WARM - GENTLE)
    high = WARM + (2.0 * part - 1.0) * (STEEP - WARM)
    return np.where(part < 0.5, low, high).astype(np.uint8)
