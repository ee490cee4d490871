"""Octaves of the grain against their logarithm, and their sum against one that is taken place by place."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.texture import (
    FINEST,
    OCTAVES,
    SCALE,
    SIZE,
    Grain,
    Grains,
    add_grain,
    grain,
    grains_for,
    octave_for,
)

LOOK = grain(0.05, 0.04, 0.1)


@settings(max_examples=200, deadline=None)
@given(st.floats(np.float32(1e-6).item(), 1e3, width=32))
def test_the_first_octave_is_that_of_the_logarithm(width: float) -> None:
    expected = max(math.frexp(width / FINEST)[1], 0)
    assert octave_for(LOOK, width) == min(expected, LOOK.octaves)


def _grain_at(x: float, y: float, width: float) -> tuple[float, float, float]:
    """The sum over octaves as the module has it, place by place and octave by octave."""
    bytes_of = np.stack([(LOOK.noise >> shift & 255).astype(np.uint8).view(np.int8) for shift in (0, 8, 16)], axis=-1)
    noise, sums = bytes_of.reshape(SIZE, SIZE, 3).astype(np.float64), np.zeros(3)
    first = octave_for(LOOK, width)
    for k in range(first, min(first + OCTAVES, LOOK.octaves)):
        bump = FINEST * 2.0**k
        u, v = (x, y) if k % 2 else (y, -x)
        along, across, bright = noise[math.floor(v * 4 / bump) + 97 * k & 255, math.floor(u * 4 / bump) + 193 * k & 255]
        weight = min(max(bump / width - 1.0, 0.0), 1.0) if k == first else 1.0
        sums += weight * np.array([along if k % 2 else -across, across if k % 2 else along, bright])
    return tuple(sums / SCALE * (LOOK.slope, LOOK.slope, LOOK.contrast))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32))
def test_grain_is_the_sum_of_its_octaves(seed: int) -> None:
    """But within single precision of the edge of a texel."""
    random = np.random.default_rng(seed)
    x, y = random.uniform(-30.0, 30.0, (2, 64))
    width = 10.0 ** random.uniform(-4.0, 0.5, 64)
    grains = grains_for(64)
    _grain_of(LOOK, x, y, width, grains)
    found = np.stack([grains.slope_x, grains.slope_y, grains.bright], axis=-1)
    expected = np.array([_grain_at(*place) for place in zip(x, y, width, strict=True)])
    assert (np.abs(found - expected).max(axis=1) < 1e-6).sum() >= 62


@njit
def _grain_of(look: Grain, x: FloatArray, y: FloatArray, width: FloatArray, grains: Grains) -> None:
    add_grain(look, x, y, width, grains)
