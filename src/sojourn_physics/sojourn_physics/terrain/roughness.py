"""Fractal roughness by spectral synthesis.

A self-affine surface has the structure function <(h(x + L) - h(x))^2> = nu(L)^2 with nu(L) = nu_0 L^H, H
the Hurst exponent, and the two-dimensional power spectrum S(k) ~ k^-(2 H + 2) (Turcotte 1997, Fractals and
Chaos in Geology, ch. 7; Saupe 1988 in The Science of Fractal Images, sec. 2.5). The RMS slope at baseline L
is atan(nu(L) / L) (Shepard et al. 2001, J. Geophys. Res. 106:32777): it grows as the baseline shrinks, so a
slope without its baseline says nothing.

White noise is filtered on a grid twice as long as the map and the map is cut out of it, so that opposite
edges do not match. Waves longer than that grid matter for H above 0.5 and are added one by one: the cell of
the wave number plane about zero is split in three by three, again and again, with one wave in each outer
cell. Last, the heights are scaled to have exactly the stated RMS slope at the baseline.

Assumptions: isotropic, Gaussian heights. Range: baselines from two nodes to about a quarter of the map; the
Hurst exponent measured on it is within 0.05 of the stated one on average for H from 0.3 to 0.9, and
scatters by as much from one seed to the next.
"""

import math

import numpy as np
from scipy import fft

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.params import RoughnessParams

LONG_WAVE_LEVELS = 10
"""The longest waves are 3^10 times as long as the grid: nothing but a tilt of the map."""


def fractal_surface(shape: tuple[int, int], hurst: float, generator: np.random.Generator) -> FloatArray:
    """Self-affine surface of shape (ny, nx) with mean 0 and an arbitrary scale."""
    rows = fft.next_fast_len(2 * shape[0], real=True)
    columns = fft.next_fast_len(2 * shape[1], real=True)
    # Real transform of white noise: its Hermitian symmetry comes out right without bookkeeping.
    spectrum = fft.rfft2(generator.standard_normal((rows, columns)))
    wave_y = np.fft.fftfreq(rows)[:, np.newaxis]
    wave_x = np.fft.rfftfreq(columns)[np.newaxis, :]
    wave_squared = wave_y * wave_y + wave_x * wave_x
    wave_squared[0, 0] = 1.0
    spectrum *= wave_squared ** (-0.5 * (hurst + 1.0))
    spectrum[0, 0] = 0.0
    surface = np.asarray(fft.irfft2(spectrum, s=(rows, columns)), dtype=np.float64)
    cut = surface[: shape[0], : shape[1]] + _long_waves(shape, (rows, columns), hurst, generator)
    return np.ascontiguousarray(cut - float(cut.mean()))


def _long_waves(
    shape: tuple[int, int], grid: tuple[int, int], hurst: float, generator: np.random.Generator
) -> FloatArray:
    """Waves longer than the grid (rows, columns), on the map (ny, nx); scale as the filtered noise."""
    rows, columns = grid
    half_plane = np.array([(1, -1), (1, 0), (1, 1), (0, 1)], dtype=np.float64)
    scale = np.repeat(3.0 ** -np.arange(1, LONG_WAVE_LEVELS + 1), len(half_plane))
    wave_x = np.tile(half_plane[:, 0], LONG_WAVE_LEVELS) * scale / columns
    wave_y = np.tile(half_plane[:, 1], LONG_WAVE_LEVELS) * scale / rows
    spectral_density = (wave_x * wave_x + wave_y * wave_y) ** -(hurst + 1.0)
    # A pair of waves k, -k of the filtered noise has the variance 2 density / nodes; here cells are smaller.
    deviation = np.sqrt(2.0 * spectral_density / (rows * columns)) * scale
    cosine, sine = generator.standard_normal((2, wave_x.size)) * deviation
    turn = 2j * np.pi
    along_y = np.exp(turn * np.outer(np.arange(shape[0]), wave_y)) * (cosine - 1j * sine)
    along_x = np.exp(turn * np.outer(wave_x, np.arange(shape[1])))
    return np.asarray((along_y @ along_x).real, dtype=np.float64)


def rms_slope(heights: FloatArray, resolution: float, baseline: float) -> float:
    """RMS slope [rad] between points one baseline [m] apart, along x and y; heights of shape (ny, nx) [m].

    The baseline is rounded to whole nodes and held between one node and the shorter side of the map.
    """
    nodes = min(max(1, round(baseline / resolution)), min(heights.shape) - 1)
    along_x = heights[:, nodes:] - heights[:, :-nodes]
    along_y = heights[nodes:, :] - heights[:-nodes, :]
    variance = 0.5 * (float(np.mean(along_x * along_x)) + float(np.mean(along_y * along_y)))
    return math.atan(math.sqrt(variance) / (nodes * resolution))


def rough_surface(
    params: RoughnessParams, shape: tuple[int, int], resolution: float, generator: np.random.Generator
) -> FloatArray:
    """Heights [m], shape (ny, nx), mean 0, with the stated Hurst exponent and RMS slope."""
    surface = fractal_surface(shape, params.hurst, generator)
    measured = math.tan(rms_slope(surface, resolution, params.baseline))
    surface *= math.tan(math.radians(params.rms_slope_deg)) / measured
    return surface
