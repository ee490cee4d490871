"""Random numbers of a sensor as a value: the state of a model can be saved, restored and branched.

Each sensor draws from its own PCG64 stream, seeded by `SeedSequence([seed, crc32(name)])` (O'Neill 2014;
numpy), so that adding or removing one sensor changes no number of another. A stream holds the generator's
state as plain integers and a block of standard normal numbers; a draw returns the next row and a new
stream, and never changes the old one. Blocks make a draw cheap: numpy is entered once for `ROWS` rows.
"""

from collections.abc import Mapping, Sequence
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


@njit(cache=True)
def quantise_within(
    truth: FloatArray,
    offset: FloatArray,
    sigma: FloatArray,
    noise: FloatArray,
    resolution: FloatArray,
    least: FloatArray,
    most: FloatArray,
) -> FloatArray:
    """As `quantise`, kept within the range from `least` to `most`."""
    reading: FloatArray = quantise(truth, offset, sigma, noise, resolution)
    for i in range(truth.shape[0]):
        reading[i] = min(max(reading[i], least[i]), most[i])
    return reading


@dataclass(frozen=True, slots=True)
class GeneratorPlace:
    """Where a generator stands, and how many numbers of a row are its."""

    state: int
    """Of PCG64."""
    increment: int
    """Of PCG64: the stream."""
    width: int


@dataclass(frozen=True, eq=False, slots=True)
class NoiseStream:
    """Where sensors that are read together are in their sequences of random numbers. `block` is never written to after
    it was drawn.
    """

    generators: tuple[GeneratorPlace, ...]
    """One for each sensor, after `block` was drawn."""
    block: FloatArray
    """Standard normal numbers, shape (ROWS, width of all)."""
    row: int
    """The next row of `block` to hand out."""


def initial_stream(seed: int, name: str, width: int) -> NoiseStream:
    """The stream of the sensor `name`: rows of `width` standard normal numbers. Raises as `initial_streams`."""
    return initial_streams(seed, {name: width})


def initial_streams(seed: int, widths: Mapping[str, int]) -> NoiseStream:
    """The streams of sensors that are read together, side by side: so many standard normal numbers by sensor's name.

    Raises:
        InvalidValueError: a negative seed.
    """
    if seed < 0:
        raise InvalidValueError("seed", seed, "a whole number, 0 or above")
    return _next_block(
        [
            (np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, crc32(name.encode())]))), width)
            for name, width in widths.items()
        ]
    )


def draw(stream: NoiseStream) -> tuple[NoiseStream, FloatArray]:
    """The stream after the draw, and a row of standard normal numbers, shape (width,), read-only."""
    if stream.row == ROWS:
        stream = _next_block([(_generator_at(place), place.width) for place in stream.generators])
    return NoiseStream(stream.generators, stream.block, stream.row + 1), stream.block[stream.row]


def draw_rows(stream: NoiseStream) -> tuple[NoiseStream, FloatArray]:
    """As `draw`, of all the rows that are left of a block, or of the next: shape (n, width), n from 1 to ROWS."""
    after, _ = draw(stream)
    return NoiseStream(after.generators, after.block, ROWS), after.block[after.row - 1 :]


def _generator_at(place: GeneratorPlace) -> np.random.Generator:
    bits = np.random.PCG64(0)
    bits.state = {
        "bit_generator": "PCG64",
        "state": {"state": place.state, "inc": place.increment},
        "has_uint32": 0,
        "uinteger": 0,
    }
    return np.random.Generator(bits)


def _next_block(generators: Sequence[tuple[np.random.Generator, int]]) -> NoiseStream:
    """Of generators and their widths: their next rows, side by side."""
    blocks = [generator.standard_normal((ROWS, width)) for generator, width in generators]
    block = np.concatenate([np.zeros((ROWS, 0)), *blocks], axis=1)  # there may be none
    block.flags.writeable = False
    return NoiseStream(tuple(_place(generator, width) for generator, width in generators), block, 0)


def _place(generator: np.random.Generator, width: int) -> GeneratorPlace:
    words = generator.bit_generator.state["state"]
    return GeneratorPlace(int(words["state"]), int(words["inc"]), width)
