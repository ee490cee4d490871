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

from sojourn_machine.kernels import njit, small_kernel, vector_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.single import ONE, ZERO, constant, narrowed

SIZE = 256
"""Texels along the side of the noise, a power of two."""
MASK = SIZE - 1
WAVE = 4
"""Texels of a bump."""
FIRST = 10
FINEST = 2.0**-FIRST
"""Width of the narrowest bump [m]."""
NARROWEST, TEXELS = constant(FINEST), constant(WAVE)
OCTAVES = 3
"""That are seen at once."""
SCALE = 32.0
"""Of the numbers in the noise: one standard deviation."""


class Grain(NamedTuple):
    """For the kernels."""

    noise: NDArray[np.int32]
    """(SIZE * SIZE,), row by row: slope along x, along y and brightness, each a byte, the first lowest, in units of
    SCALE."""
    slope: float
    """Standard deviation of the slope of one octave [-]."""
    contrast: float
    """Standard deviation of the brightness of one octave, of the whole [-]."""
    octaves: int
    """Whose bumps the height field does not have: up to two nodes."""


class Grains(NamedTuple):
    """Of places on the ground, for the kernels: the grain there, and room to work it out."""

    slope_x: NDArray[np.float32]
    """[-], (n,) as all of these."""
    slope_y: NDArray[np.float32]
    bright: NDArray[np.float32]
    """Brightness less 1 [-]."""
    octave: NDArray[np.int32]
    """The first that is seen."""
    weight: NDArray[np.float32]
    """Of that [-]."""
    scale: NDArray[np.float32]
    """Its texels a metre."""
    texel: NDArray[np.int32]
    """Place in the noise, then what is there: (OCTAVES, n)."""


@cache
def _noise() -> NDArray[np.int32]:
    """Smooth noise that goes on at its edges, from a fixed seed; see `Grain.noise`."""
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
    low, middle, high = (plane.astype(np.int8).view(np.uint8).astype(np.int32).ravel() for plane in planes)
    return np.asarray(low | middle << 8 | high << 16)


def grain(slope: float, contrast: float, node: float) -> Grain:
    """Of ground whose height field has nodes so far apart [m]; slope and contrast: see `Grain`."""
    return Grain(_noise(), slope, contrast, math.floor(math.log2(2.0 * node / FINEST)) + 1)


@njit(cache=True)
def grains_for(count: int) -> Grains:
    """Room for so many places."""
    row = np.empty((5, count), dtype=np.float32)
    texel = np.empty((OCTAVES, count), dtype=np.int32)
    return Grains(row[0], row[1], row[2], np.empty(count, dtype=np.int32), row[3], row[4], texel)


@vector_kernel
def octave_for(look: Grain, width: float) -> np.int32:
    """First octave whose bumps are wider than `width` [m], or than all that the ground has not."""
    above = (np.float32(width).view(np.int32) >> np.int32(23)) - np.int32(126)  # of the powers of 2 above it the lowest
    return np.int32(min(max(above + np.int32(FIRST), np.int32(0)), np.int32(look.octaves)))


@small_kernel
def add_grain(look: Grain, x: FloatArray, y: FloatArray, width: FloatArray, grains: Grains) -> None:
    """Write the grain of places in map, of all that is wider than a width there, all in metres, (n,).

    Each step does one thing for all places, so that the processor takes several at once, or has the memory of several
    under way.
    """
    _octaves(look, width, grains)
    _texels(x, y, grains)
    for k in range(OCTAVES):
        for j in range(x.shape[0]):
            grains.texel[k, j] = look.noise[np.uint64(grains.texel[k, j])]
    _sums(look, grains)


@vector_kernel
def _octaves(look: Grain, width: FloatArray, grains: Grains) -> None:
    """Of each place its first octave, the weight of it, and texels a metre."""
    for j in range(width.shape[0]):
        octave = octave_for(look, width[j])
        bump = NARROWEST * np.float32(np.int32(1) << octave)
        grains.octave[j] = octave
        grains.weight[j] = min(max(bump / narrowed(width[j]) - ONE, ZERO), ONE)
        grains.scale[j] = TEXELS / bump


@vector_kernel
def _texels(x: FloatArray, y: FloatArray, grains: Grains) -> None:
    """Of each place the texel of each of its octaves."""
    scale = np.float32(1.0)
    for k in range(OCTAVES):
        for j in range(x.shape[0]):
            texels, octave = grains.scale[j] * scale, grains.octave[j] + k
            right, up = np.float32(x[j]) * texels, np.float32(y[j]) * texels
            # turned by quarter turns, shifted by a fixed amount for each octave
            odd = octave & 1 != 0
            u, v = right if odd else up, up if odd else -right
            row, column = np.int32(np.floor(v)) + 97 * octave, np.int32(np.floor(u)) + 193 * octave
            grains.texel[k, j] = np.int32((row & MASK) * SIZE | (column & MASK))
        scale *= np.float32(0.5)


@vector_kernel
def _sums(look: Grain, grains: Grains) -> None:
    """Of each place the slopes and the brightness of all its octaves, of what their texels hold."""
    slope, contrast = np.float32(look.slope / SCALE), np.float32(look.contrast / SCALE)
    for j in range(grains.octave.shape[0]):
        slope_x, slope_y, bright, weight = np.float32(0.0), np.float32(0.0), np.float32(0.0), grains.weight[j]
        for k in range(OCTAVES):
            octave, texel = grains.octave[j] + k, grains.texel[k, j]
            weight = weight if octave < look.octaves else np.float32(0.0)  # no bump is wider than the nodes' own
            along, across = weight * np.float32(np.int8(texel)), weight * np.float32(np.int8(texel >> 8))
            odd = octave & 1 != 0
            slope_x += along if odd else -across
            slope_y += across if odd else along
            bright += weight * np.float32(np.int8(texel >> 16))
            weight = np.float32(1.0)
        grains.slope_x[j], grains.slope_y[j] = slope_x * slope, slope_y * slope
        grains.bright[j] = bright * contrast
