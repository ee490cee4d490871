"""The fine grain of the ground, below the nodes of a height field: its slopes and its light and dark.

The ground has relief at all scales (Shepard et al. 2001, JGR 106(E12):32777: self-affine over centimetres to metres),
which shows as texture where it is too small to be seen as shape. Here it is a sum of octaves of smooth noise, each
twice as wide as the one before, fixed to the ground: every camera sees the same grain on the same spot. Octaves
narrower than a pixel fade out, so that a picture far away does not sparkle; those wider than a node are left to the
height field.

One square of noise repeats itself, turned and shifted from octave to octave.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import small_kernel

SIZE = 256
"""Texels along the side of the noise, a power of two."""
MASK = SIZE - 1
UNIT = np.uint64(1)
WAVE = 4
"""Texels of a bump."""
FINEST = 2.0**-10
"""Width of the narrowest bump [m]."""
OCTAVES = 3
"""That are seen at once."""
SCALE = 32.0
"""Of the numbers in the noise: one standard deviation."""


class Grain(NamedTuple):
    """For the kernels."""

    noise: NDArray[np.int8]
    """(SIZE, SIZE, 3): slope along x, along y, brightness, in units of SCALE."""
    slope: float
    """Standard deviation of the slope of one octave [-]."""
    contrast: float
    """Standard deviation of the brightness of one octave, of the whole [-]."""
    widest: float
    """Of a bump that the height field does not have [m]."""


@cache
def _noise() -> NDArray[np.int8]:
    """Smooth noise that goes on at its edges, from a fixed seed."""
    random = np.random.Generator(np.random.PCG64(1))
    frequency = np.fft.fftfreq(SIZE) * WAVE
    square = frequency[:, np.newaxis] ** 2 + frequency[np.newaxis, :] ** 2
    band = square * np.exp(-2.0 * square)  # a bump of WAVE texels, nothing wider or much narrower
    planes = []
    height = np.fft.fft2(random.standard_normal((SIZE, SIZE))) * band
    albedo = np.fft.fft2(random.standard_normal((SIZE, SIZE))) * band
    for spectrum in (height * 1j * frequency[np.newaxis, :], height * 1j * frequency[:, np.newaxis], albedo):
        plane = np.real(np.fft.ifft2(spectrum))
        planes.append(np.clip(np.rint(SCALE * plane / plane.std()), -127, 127))
    return np.ascontiguousarray(np.stack(planes, axis=2).astype(np.int8))


def grain(slope: float, contrast: float, node: float) -> Grain:
    """Of ground whose height field has nodes so far apart [m]; slope and contrast: see `Grain`."""
    return Grain(_noise(), slope, contrast, 2.0 * node)


@small_kernel
def octave_for(look: Grain, width: float, octave: int) -> int:
    """First octave whose bumps are wider than `width` [m], or than all that the ground has not.

    Args:
        octave: a guess, from 0 on, as that of a neighbour is.
    """
    bump = FINEST * (UNIT << np.uint64(octave))
    while bump <= width and bump <= look.widest:
        octave, bump = octave + 1, 2.0 * bump
    while octave > 0 and 0.5 * bump > width:
        octave, bump = octave - 1, 0.5 * bump
    return octave


@small_kernel
def grain_at(look: Grain, x: float, y: float, width: float, octave: int) -> tuple[float, float, float]:
    """Slope along x and y, and brightness less 1, at (x, y) in map, of all that is wider than `width` [m], from an
    octave on, see `octave_for`.
    """
    bump = FINEST * (UNIT << np.uint64(octave))
    weight = np.float32(min(max(bump / width - 1.0, 0.0), 1.0))
    slope_x, slope_y, bright = np.float32(0.0), np.float32(0.0), np.float32(0.0)
    texels = WAVE / bump
    for k in range(octave, octave + OCTAVES):
        if bump > look.widest:
            break
        # turned by quarter turns, shifted by a fixed amount for each octave
        odd = k & 1
        u, v = (x, y) if odd else (y, -x)
        i = np.uint64(math.floor(v * texels) + 97 * k & MASK)
        j = np.uint64(math.floor(u * texels) + 193 * k & MASK)
        a, b = weight * look.noise[i, j, 0], weight * look.noise[i, j, 1]
        slope_x += a if odd else -b
        slope_y += b if odd else a
        bright += weight * look.noise[i, j, 2]
        weight = np.float32(1.0)
        bump *= 2.0
        texels *= 0.5
    unit = look.slope / SCALE
    return float(slope_x * unit), float(slope_y * unit), float(bright * look.contrast / SCALE)
