"""What makes an image of light: noise, exposure, the fall of light to the corners."""

import math

import numpy as np
import pytest
from camera_scenes import camera
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_physics.imaging.camera import (
    FULL,
    DetectorParams,
    StereoParams,
    expose,
    exposure_for,
    noise_of,
    optics,
)
from sojourn_physics.imaging.lens import LensParams
from sojourn_physics.imaging.pixel_noise import pixel_noise

LENS = LensParams(columns=200, rows=150, horizontal_view_deg=40.0)
LINEAR = DetectorParams(gamma=1.0, vignetting=0.0, full_well=5_000.0, read_noise=25.0)


@settings(max_examples=20)
@given(st.floats(0.1, 0.9))
def test_noise_is_that_of_photons_and_read_out(part: float) -> None:
    """Photon transfer: the variance in electrons is the mean and the square of the read-out's noise."""
    eye = optics(LENS, LINEAR)
    electrons = part * LINEAR.full_well
    radiance = np.full((150, 200), electrons / LINEAR.sensitivity, dtype=np.float32)
    image = expose(eye, radiance, 1.0, pixel_noise(3, "camera", 7)).astype(np.float64)
    unit = LINEAR.full_well / FULL
    variance = (image.var() - 1.0 / 12.0) * unit**2
    assert image.mean() * unit == pytest.approx(electrons, rel=0.01, abs=0.05 * unit)
    assert variance == pytest.approx(electrons + 25.0**2, rel=0.06)


@given(st.floats(1e-3, 1e4))
def test_exposure_brings_the_bright_part_to_its_aim(bright: float) -> None:
    eye = optics(LENS, LINEAR)
    radiance = np.linspace(0.0, bright, 150 * 200, dtype=np.float32).reshape(150, 200)
    time = exposure_for(eye, radiance)
    wanted = LINEAR.aim * LINEAR.full_well / (LINEAR.sensitivity * LINEAR.bright_part * bright)
    assert time == pytest.approx(min(max(wanted, 1e-4), 5.0), rel=0.01)


def test_exposure_in_the_dark_is_the_longest() -> None:
    eye = optics(LENS, LINEAR)
    assert exposure_for(eye, np.zeros((150, 200), dtype=np.float32)) == 5.0


def test_corners_are_darker_by_the_fourth_power_of_the_cosine() -> None:
    eye = optics(LENS, DetectorParams(gamma=1.0, vignetting=4.0, read_noise=0.0))
    radiance = np.full((150, 200), 0.5 * 170_000.0 / 5e4, dtype=np.float32)
    image = expose(eye, radiance, 1.0, pixel_noise(0, "camera", 0)).astype(np.float64)
    corner = math.atan(math.hypot(99.5, 74.5) / eye.lens.focal_length)
    assert image[:10, :10].mean() / image[70:80, 95:105].mean() == pytest.approx(math.cos(corner) ** 4, rel=0.05)


def test_the_root_keeps_the_noise_of_photons_the_same() -> None:
    eye = optics(LENS, DetectorParams(gamma=0.5, vignetting=0.0, read_noise=0.0, full_well=20_000.0))
    spread = []
    for part in (0.1, 0.5, 0.9):
        radiance = np.full((150, 200), part * 20_000.0 / 5e4, dtype=np.float32)
        spread.append(expose(eye, radiance, 1.0, pixel_noise(0, "camera", 0)).std())
    assert max(spread) == pytest.approx(FULL / 2.0 / math.sqrt(20_000.0), rel=0.15)
    assert min(spread) == pytest.approx(max(spread), rel=0.15)


def test_numbers_belong_to_sensor_and_stamp_alone() -> None:
    one, same, later, other = (
        noise_of(1, name, stamp).standard_normal(4) for name, stamp in (("a", 5), ("a", 5), ("a", 6), ("b", 5))
    )
    assert (one == same).all() and (one != later).all() and (one != other).all()


def test_an_image_of_more_than_the_full_well_is_white() -> None:
    eye = camera()
    assert (expose(eye, np.full((120, 160), 1e9, dtype=np.float32), 1.0, pixel_noise(0, "a", 0)) >= FULL - 1).all()


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda: DetectorParams(shortest_exposure=2.0, longest_exposure=1.0), "at most longest_exposure"),
        (lambda: StereoParams(baseline=0.1, nearest=5.0, range=4.0), "less than range"),
        (lambda: StereoParams(baseline=0.0), "greater than 0"),
    ],
)
def test_parameters_that_cannot_be_are_refused(made: object, words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        made()  # type: ignore[operator]
