"""Random numbers of a sensor as a value: the state of a model can be saved, restored and branched.

Each sensor draws from its own PCG64 stream, seeded by `SeedSequence([seed, crc32(name)])` (O'Neill 2014;
numpy), so that adding or removing one sensor changes no number of another. A stream holds the generator's
state as plain integers and a block of standard normal numbers; a draw returns the next row and a new
stream, and never changes the old one. Blocks make a draw cheap: numpy is entered once for `ROWS` rows.
"""

from dataclasses import dataclass
from zlib import crc32

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

ROWS = 256


@njit(cache=True)
def quantise(
    truth: FloatArray, offset: FloatArray, sigma: FloatArray, noise: FloatArray, resolution: FloatArray
) -> FloatArray:
    """The multiple of `resolution` nearest to truth + offset + sigma noise; all of one shape (n,)."""
    reading = np.empty_like(truth)
    for i in range(truth.shape[0]):
        raw = truth[i] + offset[i] + sigma[i] * noise[i]
        reading[i] = np.floor(raw / resolution[i] + 0.5) * resolution[i]
    return reading


@dataclass(frozen=True, eq=False, slots=True)
class NoiseStream:
    """Where a sensor is in its sequence of random rows. `block` is never written to after it was drawn."""

    generator_state: int
    """PCG64 state after `block` was drawn."""
    generator_increment: int
    """PCG64 increment: the stream."""
    block: FloatArray
    """Standard normal numbers, shape (ROWS, width)."""
    row: int
    """The next row of `block` to hand out."""


def initial_stream(seed: int, name: str, width: int) -> NoiseStream:
    """The stream of the sensor `name`: rows of `width` standard normal numbers.

    Raises:
        InvalidValueError: a negative seed.
    """
    if seed < 0:
        raise InvalidValueError("seed", seed, "a whole number, 0 or above")
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, crc32(name.encode())])))
    return _next_block(generator, width)


def draw(stream: NoiseStream) -> tuple[NoiseStream, FloatArray]:
    """The stream after the draw, and a row of standard normal numbers, shape (width,), read-only."""
    if stream.row == stream.block.shape[0]:
        bits = np.random.PCG64(0)
        bits.state = {
            "bit_generator": "PCG64",
            "state": {"state": stream.generator_state, "inc": stream.generator_increment},
            "has_uint32": 0,
            "uinteger": 0,
        }
        stream = _next_block(np.random.Generator(bits), stream.block.shape[1])
    after = NoiseStream(stream.generator_state, stream.generator_increment, stream.block, stream.row + 1)
    return after, stream.block[stream.row]


def _next_block(generator: np.random.Generator, width: int) -> NoiseStream:
    block = generator.standard_normal((ROWS, width))
    block.flags.writeable = False
    words = generator.bit_generator.state["state"]
    return NoiseStream(int(words["state"]), int(words["inc"]), block, 0)
