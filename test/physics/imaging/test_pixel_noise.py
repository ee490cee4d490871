"""Normal numbers of pixels: known answers of the generator, their distribution, streams that are independent."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import stats

from sojourn_machine.kernels import njit
from sojourn_physics.imaging.pixel_noise import PixelNoise, fill_normals, philox, pixel_noise, room_for

ROWS, COLUMNS = 200, 321


@njit
def _image(noise: PixelNoise, rows: int, columns: int) -> NDArray[np.float32]:
    words, normals = room_for(columns)
    image = np.empty((rows, columns), dtype=np.float32)
    for i in range(rows):
        fill_normals(noise, i, words, normals)
        image[i] = normals
    return image


def numbers(seed: int = 1, name: str = "navcam", stamp: int = 10**9) -> NDArray[np.float64]:
    return np.asarray(_image(pixel_noise(seed, name, stamp), ROWS, COLUMNS), dtype=np.float64)


@pytest.mark.parametrize(
    ("counter", "stream", "key", "words"),
    [
        (0, 0, 0, (0x257A3673, 0xCD26BE2A)),
        (0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, (0xAB302C4D, 0x3DC9D239)),
        (0x243F6A88, 0x85A308D3, 0x13198A2E, (0xBEDBBE6B, 0xE4C770B3)),
    ],
)
def test_philox_gives_the_known_answers(counter: int, stream: int, key: int, words: tuple[int, int]) -> None:
    """Those of Salmon et al.'s own library for Philox2x32 with seven rounds."""
    found = int(philox.py_func(np.uint64(counter), np.uint64(stream), np.uint64(key)))
    assert (found & 0xFFFFFFFF, found >> 32) == words


def test_numbers_are_normal() -> None:
    many = np.concatenate([numbers(stamp=stamp).ravel() for stamp in range(20)])
    assert stats.kstest(many, "norm").pvalue > 1e-3
    assert many.mean() == pytest.approx(0.0, abs=4.0 / np.sqrt(many.size))
    assert many.var() == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / many.size))
    assert stats.kurtosis(many) == pytest.approx(0.0, abs=4.0 * np.sqrt(24.0 / many.size))
    for beyond in (2.0, 3.0):
        expected = 2.0 * stats.norm.sf(beyond) * many.size
        assert (np.abs(many) > beyond).sum() == pytest.approx(expected, abs=4.0 * np.sqrt(expected))


@settings(max_examples=10)
@given(st.integers(0, 2**32), st.integers(0, 2**62))
def test_pixels_know_nothing_of_their_neighbours_nor_of_other_images(seed: int, stamp: int) -> None:
    here = numbers(seed, "navcam", stamp)
    others = [here[:, 1:], here[1:, :], numbers(seed, "navcam.right", stamp), numbers(seed, "navcam", stamp + 1)]
    for other in [*others, numbers(seed + 1, "navcam", stamp)]:
        rows, columns = other.shape
        part = here[:rows, :columns]
        assert abs(np.corrcoef(part.ravel(), other.ravel())[0, 1]) < 5.0 / np.sqrt(other.size)


def test_numbers_belong_to_sensor_stamp_and_seed_alone() -> None:
    assert (numbers() == numbers()).all()
    for other in (numbers(name="belly"), numbers(stamp=0), numbers(seed=2)):
        assert (numbers() != other).mean() > 0.99
