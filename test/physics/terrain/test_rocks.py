"""Rocks: covered area and numbers against Golombek and Rapp's law."""

import math

import numpy as np
import pytest

from sojourn_physics.terrain.params import RockLawParams, RockParams
from sojourn_physics.terrain.rocks import (
    Rock,
    decay_rate,
    draw_rocks,
    expected_count,
    placed_rock,
    stamp_rocks,
)

AREA = (-100.0, 100.0, -50.0, 50.0)


def covered_fraction(area_fraction: float, diameter: float) -> float:
    """Part of the ground under rocks of this diameter [m] and more, F_k(D) of the law [-]."""
    if area_fraction == 0.0:
        return 0.0
    return area_fraction * math.exp(-decay_rate(area_fraction) * diameter)


@pytest.mark.published
def test_law_at_the_viking_sites() -> None:
    """Viking 1: 0.069 covered, q 3.99; Viking 2: 0.176, q 2.65 (Golombek & Rapp 1997, eq. 1 and 2)."""
    assert decay_rate(0.069) == pytest.approx(3.99, abs=0.01)
    assert decay_rate(0.176) == pytest.approx(2.65, abs=0.01)


@pytest.mark.parametrize("fraction", [0.01, 0.05, 0.2])
def test_covered_area_follows_the_law_at_every_size(fraction: float) -> None:
    law = RockLawParams(area_fraction=fraction, diameter_min=0.1, diameter_max=2.0)
    rocks = draw_rocks(law, AREA, np.random.default_rng(3))
    diameters = np.array([rock.diameter for rock in rocks])
    assert diameters.min() >= 0.1 and diameters.max() <= 2.0
    assert len(rocks) == pytest.approx(expected_count(law, 20000.0), rel=0.05)
    for size in (0.1, 0.15, 0.2, 0.3):
        covered = float(np.sum(math.pi / 4.0 * diameters[diameters >= size] ** 2)) / 20000.0
        expected = covered_fraction(fraction, size) - covered_fraction(fraction, 2.0)
        counted = int(np.sum(diameters >= size))
        assert covered == pytest.approx(expected, rel=0.05 + 4.0 / math.sqrt(counted))


def test_heights_are_half_the_diameter_on_average() -> None:
    rocks = draw_rocks(RockLawParams(area_fraction=0.05), AREA, np.random.default_rng(3))
    ratios = np.array([rock.height / rock.diameter for rock in rocks])
    assert float(ratios.mean()) == pytest.approx(0.5, abs=0.01)
    assert ratios.min() >= 0.35 - 1e-9 and ratios.max() <= 0.65 + 1e-9


def test_stamped_nodes_cover_the_area_of_the_law() -> None:
    law = RockLawParams(area_fraction=0.05, diameter_min=0.2, diameter_max=1.5)
    rocks = draw_rocks(law, (0.0, 60.0, 0.0, 60.0), np.random.default_rng(9))
    heights, soil = np.zeros((1201, 1201)), np.zeros((1201, 1201), dtype=np.int64)
    stamp_rocks(heights, soil, 1, (0.0, 0.0), 0.05, rocks)
    drawn = sum(math.pi / 4.0 * rock.diameter**2 for rock in rocks) / 3600.0
    # Rocks that overlap cover each other: a part 1 - exp(-F) is left of F.
    assert float(soil.mean()) == pytest.approx(1.0 - math.exp(-drawn), rel=0.03)
    assert float(soil.mean()) == pytest.approx(covered_fraction(0.05, 0.2) - covered_fraction(0.05, 1.5), rel=0.15)
    assert bool(((heights > 0.0) == (soil == 1)).all())


def test_placed_rock_is_half_an_ellipsoid_on_the_ground() -> None:
    heights = np.full((81, 81), 0.3)
    soil = np.zeros((81, 81), dtype=np.int64)
    rock = placed_rock(RockParams(x=0.0, y=0.0, diameter=1.0, height=0.4))
    stamp_rocks(heights, soil, 1, (-2.0, -2.0), 0.05, [rock])
    assert heights[40, 40] == pytest.approx(0.7)
    assert heights[40, 46] == pytest.approx(0.3 + 0.4 * math.sqrt(1.0 - 0.6**2))
    assert heights[46, 40] == pytest.approx(heights[40, 46])
    assert heights[40, 51] == 0.3 and soil[40, 51] == 0 and soil[40, 49] == 1
    volume = float(np.sum(heights - 0.3)) * 0.05**2
    assert volume == pytest.approx(2.0 / 3.0 * math.pi * 0.5**2 * 0.4, rel=0.02)


def test_long_axis_lies_in_its_direction_and_area_is_kept() -> None:
    heights, soil = np.zeros((201, 201)), np.zeros((201, 201), dtype=np.int64)
    stamp_rocks(heights, soil, 1, (-1.0, -1.0), 0.01, [Rock(0.0, 0.0, 1.0, 0.5, 1.5, math.radians(30.0))])
    row, column = np.nonzero(soil)
    covariance = np.cov(column, row)
    direction = 0.5 * math.atan2(2.0 * covariance[0, 1], covariance[0, 0] - covariance[1, 1])
    assert math.degrees(direction) == pytest.approx(30.0, abs=0.5)
    assert soil.sum() * 1e-4 == pytest.approx(math.pi / 4.0, rel=0.01)


def test_higher_rock_counts_where_two_overlap() -> None:
    heights, soil = np.zeros((41, 41)), np.zeros((41, 41), dtype=np.int64)
    pair = [Rock(0.0, 0.0, 1.0, 0.3, 1.0, 0.0), Rock(0.1, 0.0, 1.0, 0.2, 1.0, 0.0)]
    stamp_rocks(heights, soil, 1, (-1.0, -1.0), 0.05, pair)
    assert heights.max() == pytest.approx(0.3)


def test_no_rocks_where_nothing_is_covered() -> None:
    law = RockLawParams(area_fraction=0.0)
    assert draw_rocks(law, AREA, np.random.default_rng(0)) == [] and expected_count(law, 100.0) == 0.0
