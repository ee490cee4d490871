"""The ground as a map from orbit shows it: coarse, and with an error of its own.

    h = mean of the ground over a cell + s f,     f Gaussian, variance 1, correlated over l

A stereo model from orbit has posts some pixels of its images apart, and a vertical error that goes over many of them: a
metre and a few tenths of one for HiRISE on Mars (Kirk et al. 2008, J. Geophys. Res. 113:E00A24), more for the LROC NAC
on the Moon (Henriksen et al. 2017, Icarus 283:122). The defaults are a choice among these. f is white noise passed
through a Gaussian filter of deviation l / sqrt(2), whose autocorrelation is exp(-d^2 / (2 l^2)).
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.orbital_params import OrbitalMapParams

STREAM = 0x0B17
"""Of the scenario's seed, so that the error is like no other noise."""


class OrbitalMap(NamedTuple):
    """Heights on a square grid."""

    x0: float
    """Middle of the first cell in map [m]."""
    y0: float
    cell: float
    """Side of a cell [m]: whole nodes of the ground, 2 cells at least along each side."""
    heights: FloatArray
    """Shape (rows, columns), row along y [m]."""


def orbital_map(ground: HeightField, params: OrbitalMapParams, seed: int) -> OrbitalMap:
    """The map of a ground; the nodes that fill no cell at its far edges are left out."""
    most = min(ground.heights.shape) // 2
    ratio = min(max(1, round(params.cell / ground.resolution)), most)
    rows, columns = (count // ratio for count in ground.heights.shape)
    cells = ground.heights[: rows * ratio, : columns * ratio].reshape(rows, ratio, columns, ratio)
    heights = cells.mean(axis=(1, 3), dtype=np.float64)
    cell, middle = ratio * ground.resolution, 0.5 * (ratio - 1) * ground.resolution
    heights += params.height_error * _error(heights.shape, params.error_length / cell, seed)
    return OrbitalMap(ground.origin_x + middle, ground.origin_y + middle, cell, heights)


def _error(shape: tuple[int, ...], length: float, seed: int) -> FloatArray:
    """f of the module. length: in cells."""
    white = np.random.default_rng((seed, STREAM)).standard_normal(shape)
    deviation = length / math.sqrt(2.0)
    impulse = np.zeros(shape)
    impulse[tuple(count // 2 for count in shape)] = 1.0
    gain = math.sqrt(float((gaussian_filter(impulse, deviation, mode="wrap") ** 2).sum()))
    return np.asarray(gaussian_filter(white, deviation, mode="wrap") / gain)
