"""Craters: number and size against the law, shape against its formula, wear against diffusion."""

import math

import numpy as np
import pytest
from scipy.special import j0

from sojourn_physics.terrain.craters import (
    OLDEST_DIFFUSION,
    RADIAL_CELLS,
    REACH,
    Crater,
    draw_craters,
    expected_count,
    fresh_bowl,
    fresh_rim,
    placed_crater,
    profile,
    stamp_craters,
)
from sojourn_physics.terrain.params import CraterLawParams, CraterParams

AREA = (0.0, 200.0, 0.0, 150.0)
RADII = np.linspace(0.0, REACH, RADIAL_CELLS + 1)


@pytest.mark.parametrize("exponent", [1.8, 2.0, 3.0])
def test_size_frequency_follows_the_power_law(exponent: float) -> None:
    law = CraterLawParams(exponent=exponent, density_at_1m=0.1, diameter_min=0.5, diameter_max=50.0)
    craters = draw_craters(law, AREA, np.random.default_rng(5))
    assert len(craters) == pytest.approx(expected_count(law, 30000.0), rel=0.05)
    diameters = np.sort([crater.diameter for crater in craters])
    assert diameters[0] >= 0.5 and diameters[-1] <= 50.0
    sizes = np.array([0.5, 0.7, 1.0, 1.4, 2.0, 2.8])
    at_least = len(diameters) - np.searchsorted(diameters, sizes)
    slope = np.polyfit(np.log(sizes), np.log(at_least), 1)[0]
    assert slope == pytest.approx(-exponent, abs=0.12)
    assert at_least[2] / 30000.0 == pytest.approx(0.1, rel=0.08)


def test_craters_lie_evenly_and_from_oldest_to_youngest() -> None:
    craters = draw_craters(CraterLawParams(age_min=0.2), AREA, np.random.default_rng(1))
    x, y, age = (np.array([getattr(crater, name) for crater in craters]) for name in ("x", "y", "age"))
    assert float(x.mean()) == pytest.approx(100.0, abs=3.0) and float(y.mean()) == pytest.approx(75.0, abs=3.0)
    assert float(x.std()) == pytest.approx(200.0 / math.sqrt(12.0), rel=0.03)
    assert bool((np.diff(age) <= 0.0).all()) and age.min() >= 0.2 and age.max() <= 1.0
    assert float(age.mean()) == pytest.approx(0.6, abs=0.02)


def test_new_crater_has_the_stated_depth_rim_and_ejecta() -> None:
    heights = np.zeros((401, 401))
    crater = placed_crater(CraterParams(x=0.0, y=0.0, diameter=4.0, depth=0.7, rim_height=0.15))
    stamp_craters(heights, (-10.0, -10.0), 0.05, [crater])
    assert heights[200, 200] == pytest.approx(-0.7, abs=1e-9)
    assert heights[200, 240] == pytest.approx(0.15, abs=1e-3)
    assert heights[240, 200] == pytest.approx(0.15, abs=1e-3)
    assert heights.max() <= 0.15 + 1e-9
    half_way = heights[200, 220]
    assert half_way == pytest.approx(-0.7 + 0.85 * 0.25, abs=1e-3)
    # Ejecta fall off with the cube of the distance, a little faster because they end at four radii.
    assert 0.8 * 0.15 / 1.5**3 < heights[200, 260] < 0.15 / 1.5**3
    assert not heights[200, 362:].any() and not heights[:30].any()
    assert np.allclose(heights, heights.T) and np.allclose(heights, heights[::-1])


def test_profile_is_continuous_at_the_rim() -> None:
    edge = np.array([1.0 - 1e-9, 1.0 + 1e-9, REACH - 1e-9])
    assert fresh_bowl(edge) == pytest.approx([0.0, 0.0, 0.0], abs=1e-8)
    assert fresh_rim(edge) == pytest.approx([1.0, 1.0, 0.0], abs=1e-8)


@pytest.mark.parametrize("age", [0.1, 0.5, 1.0])
def test_wear_solves_the_diffusion_equation(age: float) -> None:
    """Independent route: Hankel transform on the plane, h(r, t) = int H(q) exp(-q^2 kappa t) J0(q r) q dq."""
    rho = (np.arange(4000) + 0.5) / 4000 * REACH
    waves = (np.arange(3000) + 0.5) / 3000 * 60.0
    start = fresh_bowl(rho) * rho * (REACH / 4000)
    transform = np.array([float(np.sum(start * j0(wave * rho))) for wave in waves])
    decayed = transform * np.exp(-(waves**2) * OLDEST_DIFFUSION * age) * waves * (60.0 / 3000)
    for radius in (0.0, 0.6, 1.2, 2.0):
        expected = float(np.sum(decayed * j0(waves * radius)))
        got = float(np.interp(radius, RADII, profile(age)[0]))
        assert got == pytest.approx(expected, abs=0.012)


def test_wear_keeps_the_volume_and_only_lowers_relief() -> None:
    ring = RADII * (REACH / RADIAL_CELLS)
    volumes = [float(np.sum(profile(age)[0] * ring)) for age in (0.0, 0.3, 0.6)]
    assert volumes[1:] == pytest.approx([volumes[0]] * 2, rel=0.02)
    depths = [0.17 * profile(age)[0] + 0.036 * profile(age)[1] for age in np.linspace(0.0, 1.0, 21)]
    relief = [float(depth.max() - depth[0]) for depth in depths]
    assert bool((np.diff(relief) < 0.0).all())
    assert relief[0] == pytest.approx(0.206) and relief[-1] == pytest.approx(0.035, abs=0.002)


def test_craters_at_and_off_the_edge_do_not_reach_over() -> None:
    heights = np.zeros((41, 41))
    stamp_craters(heights, (0.0, 0.0), 0.05, [Crater(0.0, 0.0, 0.5, 0.1, 0.02, 0.0)])
    assert heights[0, 0] == pytest.approx(-0.1) and not heights[25:, :].any()
    before = heights.copy()
    stamp_craters(heights, (0.0, 0.0), 0.05, [Crater(-5.0, 50.0, 1.0, 0.1, 0.02, 0.0)])
    assert np.array_equal(heights, before)
