"""Rough ground and ride: profiles against their spectrum, spectra against simulated motion, weights against the
standard.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import cont2discrete, lsim, welch

from sojourn_analysis.vehicle.ground_roughness import Roughness, iso_8608, lunar, self_affine
from sojourn_analysis.vehicle.quarter_car import QuarterCar, responses, state_matrices
from sojourn_analysis.vehicle.ride import (
    HORIZONTAL,
    VERTICAL,
    acceleration_over,
    comfort,
    iso_2631_gain,
    rms,
    shock_spectrum,
    weighted_acceleration,
)
from sojourn_machine.errors import InvalidValueError


def random_profile(
    roughness: Roughness, length: float, spacing: float, generator: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Distances [m] and heights [m] of a periodic profile, waves from `length` down to twice `spacing`.

    Cosines with amplitudes sqrt(2 G dn) and random phases (Rice 1944): shape (n,) each.
    """
    count = round(length / spacing)
    step = 1.0 / (count * spacing)
    waves = np.arange(1, count // 2, dtype=np.float64) * step
    amplitude = np.sqrt(2.0 * roughness.spectrum(waves) * step)
    phases = generator.uniform(0.0, 2.0 * math.pi, len(waves))
    half = np.zeros(count // 2 + 1, dtype=np.complex128)
    half[1 : count // 2] = 0.5 * count * amplitude * np.exp(1j * phases)
    heights = np.fft.irfft(half, n=count)
    return np.arange(count, dtype=np.float64) * spacing, np.asarray(heights, dtype=np.float64)


@pytest.mark.parametrize("roughness", [iso_8608("C"), lunar("maria"), Roughness(1e-4, 3.0)])
def test_a_profile_has_its_spectrum(roughness: Roughness) -> None:
    """Welch's estimate with windows, over many stretches, against the formula."""
    _, heights = random_profile(roughness, 4096.0, 0.1, np.random.default_rng(4))
    frequencies, found = welch(np.diff(heights) / 0.1, fs=10.0, nperseg=2048, detrend=False)
    band = (frequencies > 0.05) & (frequencies < 2.0)
    n = frequencies[band]
    # the difference over a spacing multiplies the spectrum by (2 sin(pi n d)/d)^2
    expected = roughness.spectrum(n) * (2.0 * np.sin(math.pi * n * 0.1) / 0.1) ** 2
    assert np.mean(found[band] / expected) == pytest.approx(1.0, abs=0.05)
    slope = np.polyfit(np.log(n), np.log(found[band] / (2.0 * np.sin(math.pi * n * 0.1) / 0.1) ** 2), 1)[0]
    assert slope == pytest.approx(-roughness.exponent, abs=0.1)


@settings(max_examples=20)
@given(hurst=st.floats(0.2, 0.95), slope=st.floats(0.01, 0.3), baseline=st.floats(0.5, 50.0))
def test_self_affine_ground_has_its_slope(hurst: float, slope: float, baseline: float) -> None:
    """nu(L)^2 = int G 4 sin^2(pi n L) dn, over the logarithm of n L; beyond n L = 20 by the mean of the sine."""
    ground = self_affine(slope, baseline, hurst)
    step = 5e-4
    u = np.exp(np.arange(-12.0 / (1.0 - hurst), math.log(20.0), step))
    density = ground.spectrum(u / baseline) / baseline
    structure = float(np.sum(density * 4.0 * np.sin(math.pi * u) ** 2 * u)) * step
    structure += 2.0 * float(density[-1]) * u[-1] / (2.0 * hurst)
    assert math.sqrt(structure) / baseline == pytest.approx(math.tan(slope), rel=2e-3)


def test_classes_and_regions() -> None:
    assert iso_8608("a").spectrum(np.array([0.1]))[0] == pytest.approx(16e-6)
    assert iso_8608("C").level == pytest.approx(256e-6)
    n = np.array([1.0 / 17.0])  # where they were measured; highlands are the smoother of both at a wheel's size
    assert lunar("highlands").spectrum(n)[0] > lunar("maria").spectrum(n)[0]
    for wrong in ("Z", "AB", ""):
        with pytest.raises(InvalidValueError, match="class"):
            iso_8608(wrong)
    with pytest.raises(InvalidValueError, match="region"):
        lunar("poles")
    with pytest.raises(InvalidValueError, match="hurst"):
        self_affine(0.1, 1.0, 1.0)


def test_ride_by_spectrum_and_by_simulation() -> None:
    """RMS of body acceleration and suspension travel of a quarter car driven over a random profile."""
    car = QuarterCar(240.0, 16e3, 1500.0, 160e3, 25.0)
    ground, speed, spacing = iso_8608("B"), 10.0, 0.02
    _, heights = random_profile(ground, 4000.0, spacing, np.random.default_rng(7))
    a, b = state_matrices(car)
    dt = spacing / speed
    ad, bd, *_ = cont2discrete((a, b[:, None], np.eye(4), np.zeros((4, 1))), dt, method="foh")
    state, states = np.zeros(4), []
    for height in heights:
        state = ad @ state + bd[:, 0] * height
        states.append(state)
    path = np.array(states)[20000:]
    acceleration = np.gradient(path[:, 1], dt)
    frequencies = np.linspace(speed / 4000.0, 60.0, 30000)
    found = responses(car, frequencies)
    spectrum = ground.at_speed(speed, frequencies)
    assert acceleration.std() == pytest.approx(rms(frequencies, found.acceleration, spectrum), rel=0.03)
    assert (path[:, 0] - path[:, 2]).std() == pytest.approx(rms(frequencies, found.travel, spectrum), rel=0.05)
    weighted = weighted_acceleration(frequencies, found.acceleration, spectrum)
    assert weighted < rms(frequencies, found.acceleration, spectrum) * 1.06


def test_quiet_weightings() -> None:
    """Nearly no weight at the ends of the band; comfort words grow with the acceleration."""
    ends = np.array([0.02, 400.0])
    for weighting in (VERTICAL, HORIZONTAL):
        assert iso_2631_gain(weighting, ends).max() < 0.03
    words = [comfort(value) for value in (0.1, 0.4, 0.8, 1.2, 2.0, 5.0)]
    assert len(set(words)) == 6
    with pytest.raises(InvalidValueError, match="weighted"):
        comfort(-1.0)


def test_shock_spectrum_of_a_half_sine() -> None:
    """Without damping: the largest of the forced part and of the free vibration after it, in closed form."""
    duration, dt = 0.1, 2e-4
    time = np.arange(0.0, duration + dt / 2, dt)
    base = 10.0 * np.sin(math.pi * time / duration)
    frequencies = np.array([1.0, 3.0, 8.0, 16.0])
    found = shock_spectrum(base, dt, frequencies, damping=0.0)
    for frequency, value in zip(frequencies, found, strict=True):
        w, p = 2.0 * math.pi * frequency, math.pi / duration
        t = np.linspace(0.0, duration, 20001)
        during = np.abs(w**2 / (w**2 - p**2) * (np.sin(p * t) - p / w * np.sin(w * t))).max()
        after = abs(2.0 * w * p / (w**2 - p**2) * math.cos(0.5 * w * duration))
        assert value == pytest.approx(10.0 * max(during, after), rel=3e-3)
    assert shock_spectrum(base, dt, np.array([8.0]), 0.1)[0] < found[2]
    with pytest.raises(InvalidValueError, match="damping"):
        shock_spectrum(base, dt, frequencies, 1.0)


def test_acceleration_over_a_bump_is_that_of_the_simulated_car() -> None:
    car = QuarterCar(240.0, 16e3, 1500.0, 160e3, 25.0)
    count, dt = 4096, 2e-3
    times = np.arange(count) * dt
    bump = np.where(times < 0.5, 0.02 * (1.0 - np.cos(4.0 * math.pi * times)), 0.0)
    lines = np.arange(1, count // 2) / (count * dt)
    found = acceleration_over(bump, responses(car, lines).acceleration)
    a, b = state_matrices(car)
    _, expected, _ = lsim((a, b[:, None], a[1:2], [[0.0]]), bump, times)
    assert found == pytest.approx(expected, abs=1e-3 * np.abs(found).max())
    with pytest.raises(InvalidValueError, match="lines"):
        acceleration_over(bump, np.ones(count))
