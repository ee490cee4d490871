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
    stereo_depth,
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
    assert (expose(eye, np.full((120, 160), 1e9, dtype=np.float32), 1.0, pixel_noise(0, "a", 0)) == FULL).all()


@pytest.mark.parametrize("read_noise", [0.0, 100.0, 400.0])
def test_the_full_well_cuts_off_last(read_noise: float) -> None:
    """What has twice the light of the full well is flat; what just fills it is as noisy as its light is."""
    eye = optics(LENS, LINEAR.model_copy(update={"read_noise": read_noise}))
    well = np.full((150, 200), LINEAR.full_well / LINEAR.sensitivity, dtype=np.float32)
    assert (expose(eye, 2.0 * well, 1.0, pixel_noise(0, "a", 0)) == FULL).all()
    at_the_well = expose(eye, well, 1.0, pixel_noise(0, "a", 0))
    assert (at_the_well == FULL).mean() == pytest.approx(0.5, abs=0.2) and at_the_well.min() < FULL


def matched(detector: DetectorParams, electrons: float) -> float:
    """Part of the pixels of an even wall 3 m ahead in which a pair finds a depth, where its light has so many
    electrons, of those that the right camera sees too.
    """
    eye = optics(LENS, detector)
    radiance = np.full((150, 200), electrons / detector.sensitivity, dtype=np.float32)
    distance = np.full((150, 200), 3.0, dtype=np.float32)
    depth = stereo_depth(eye, StereoParams(baseline=0.1), (radiance, distance), 1.0, pixel_noise(0, "a", 0))
    return float((depth[:, 40:] > 0).mean())


@pytest.mark.parametrize("read_noise", [0.0, 25.0, 100.0, 1000.0])
def test_no_noise_makes_a_dark_place_one_that_is_matched(read_noise: float) -> None:
    """However noisy the numbers are: in the dark none is matched, nor is one of less than five of the read-out's."""
    detector = DetectorParams(read_noise=read_noise, vignetting=0.0)
    assert matched(detector, 0.0) == 0.0
    assert matched(detector, 4.9 * read_noise) == 0.0
    assert matched(detector, max(5.1 * read_noise, 100.0)) == 1.0


@pytest.mark.parametrize("read_noise", [25.0, 1000.0])
def test_what_is_blown_out_is_not_matched_in_any_pixel(read_noise: float) -> None:
    detector = DetectorParams(read_noise=read_noise, vignetting=0.0)
    assert [matched(detector, part * detector.full_well) for part in (1.0, 3.0)] == [0.0, 0.0]
    assert matched(detector, 0.9 * detector.full_well) == 1.0


@given(st.floats(0.5, 20.0), st.floats(0.02, 0.4))
def test_what_is_beyond_the_edge_of_the_right_image_is_not_matched(ahead: float, baseline: float) -> None:
    """A wall across the axis: there are as many columns without depth as its disparity."""
    eye = optics(LENS, DetectorParams(vignetting=0.0))
    distance = (ahead / eye.rays[:, :, 2]).astype(np.float32)
    pair = StereoParams(baseline=baseline, disparity_noise_px=0.0)
    depth = stereo_depth(eye, pair, (np.ones_like(distance), distance), 1.0, pixel_noise(0, "a", 0))
    disparity = eye.lens.focal_length * baseline / ahead
    seen = np.arange(200) >= disparity
    sure = np.abs(np.arange(200) - disparity) > 0.01
    assert np.array_equal((depth > 0)[:, sure], np.broadcast_to(seen[sure], (150, sure.sum())))


def test_a_pair_of_fisheyes_sees_together_what_both_see() -> None:
    """Of a wall 2 m before them, to 80 degrees aside: only beside the left edge something is missing."""
    eye = optics(LensParams(columns=161, rows=3, horizontal_view_deg=161.0, model="equidistant"), DetectorParams())
    distance = (2.0 / eye.rays[:, :, 2]).astype(np.float32)
    pair = StereoParams(baseline=0.2, disparity_noise_px=0.0)
    depth = stereo_depth(eye, pair, (np.full((3, 161), 3.0, dtype=np.float32), distance), 1.0, pixel_noise(0, "a", 0))
    aside = distance[1] * eye.rays[1, :, 0] - 0.2
    wanted = (aside >= distance[1, 0] * eye.rays[1, 0, 0]) & (np.abs(np.arange(161) - 80) < 60)
    near = np.abs(np.arange(161) - 80) < 60
    assert np.array_equal(depth[1, near] > 0, wanted[near])


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
