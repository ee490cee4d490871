"""Normal numbers for the pixels of an image, each a function of the image and of its own place alone.

A counter and a key give two words of 32 bits by Philox2x32 with seven rounds (Salmon, Moraes, Dror & Shaw 2011,
"Parallel random numbers: as easy as 1, 2, 3", Proc. SC11: fewest rounds that pass BigCrush). Of each word twice twelve
bits choose one of 4096 equally likely parts of the normal distribution, each with its mean, and

    n = (a + b)/√2

of two of them has mean 0, variance 1 and reaches to 5.3 deviations: beyond 4 it has 3 % too few. The processor has
several pixels under way at once, which it cannot where numbers come one after another.
"""

from functools import cache
from typing import NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from sojourn_machine.kernels import njit, small_kernel, vector_kernel

BITS = 12
"""That choose a part of the normal distribution."""
ROUNDS = 7
MULTIPLIER, STEP = np.uint64(0xD256D193), np.uint64(0x9E3779B9)
"""Of Philox2x32: its multiplier, and by what the key grows from round to round (the golden ratio)."""
WORD, HALF = np.uint64(0xFFFFFFFF), np.uint64(32)
MASK, SHIFT, ONE = np.uint64((1 << BITS) - 1), np.uint64(BITS), np.uint64(1)


class PixelNoise(NamedTuple):
    """Of one image, for the kernels."""

    key: np.uint64
    """Of 32 bits."""
    stream: np.uint64
    """Of 32 bits: the counter's upper word."""
    parts: NDArray[np.float32]
    """Means of the parts of the normal distribution, over √2, (2 ** BITS,)."""


def pixel_noise(seed: int, name: str, stamp: int) -> PixelNoise:
    """Of the image of a sensor at a stamp [ns]: the same whatever went before, another's for every other name."""
    key, stream = np.random.SeedSequence([seed, crc32(name.encode()), stamp]).generate_state(2, np.uint32)
    return PixelNoise(np.uint64(key), np.uint64(stream), _parts())


@cache
def _parts() -> NDArray[np.float32]:
    count = 1 << BITS
    edges = ndtri(np.arange(count + 1) / count)
    means = -count * np.diff(np.exp(-0.5 * edges**2)) / np.sqrt(2.0 * np.pi)
    return np.asarray(means / (means.std() * np.sqrt(2.0)), dtype=np.float32)


@vector_kernel
def philox(counter: np.uint64, stream: np.uint64, key: np.uint64) -> np.uint64:
    """Two words of 32 bits, the first in the lower half; all three of 32 bits, without a sign."""
    first, second = counter, stream
    for _ in range(ROUNDS):
        product = MULTIPLIER * first
        first, second = (product >> HALF) ^ key ^ second, product & WORD
        key = (key + STEP) & WORD
    return first | (second << HALF)


@njit(cache=True)
def room_for(columns: int) -> tuple[NDArray[np.uint64], NDArray[np.float32]]:
    """The words and the normal numbers of a row of pixels, not filled yet."""
    return np.empty((columns + 1) // 2, dtype=np.uint64), np.empty(columns, dtype=np.float32)


@small_kernel
def fill_normals(noise: PixelNoise, row: int, words: NDArray[np.uint64], normals: NDArray[np.float32]) -> None:
    """Write the normal numbers of a row of pixels. `words`, `normals`: see `room_for`."""
    pairs = words.shape[0]
    first = np.uint64(row) * np.uint64(pairs)
    for k in range(pairs):
        words[k] = philox(first + np.uint64(k), noise.stream, noise.key)
    parts = noise.parts
    for k in range(normals.shape[0] // 2):
        word = words[k]
        normals[2 * k] = parts[word & MASK] + parts[(word >> SHIFT) & MASK]
        word >>= HALF
        normals[2 * k + 1] = parts[word & MASK] + parts[(word >> SHIFT) & MASK]
    if normals.shape[0] % 2:
        word = words[pairs - 1]
        normals[normals.shape[0] - 1] = parts[word & MASK] + parts[(word >> SHIFT) & MASK]
