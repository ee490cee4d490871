"""Discs behind edges and before each other, against areas that are counted point by point."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from sojourn_physics.environment.sun.shadow import disc_radius, seen_over_edge, seen_past_disc

SIDE = np.linspace(-1.0, 1.0, 801)
X, Y = np.meshgrid(SIDE, SIDE)
DISC = X**2 + Y**2 <= 1.0


def test_the_sun_from_the_earth_is_half_a_degree_across() -> None:
    assert 2.0 * math.degrees(disc_radius(6.957e8, 1.496e11)) == pytest.approx(0.533, abs=0.001)


@given(st.floats(-1.5, 1.5))
def test_a_disc_over_an_edge_shows_what_is_above_it(above: float) -> None:
    counted = np.count_nonzero(DISC & (above + Y > 0.0)) / np.count_nonzero(DISC)
    assert seen_over_edge(0.01 * above, 0.01) == pytest.approx(counted, abs=0.003)


@given(st.floats(0.0, 4.0), st.floats(0.2, 3.0))
def test_a_disc_behind_another_shows_what_is_beside_it(apart: float, cover: float) -> None:
    counted = np.count_nonzero(DISC & ((X - apart) ** 2 + Y**2 > cover**2)) / np.count_nonzero(DISC)
    assert seen_past_disc(0.004 * apart, 0.004, 0.004 * cover) == pytest.approx(counted, abs=0.004)


@given(st.floats(-1.2, 1.2))
def test_a_very_large_cover_is_an_edge(above: float) -> None:
    assert seen_past_disc(1000.0 + above, 1.0, 1000.0) == pytest.approx(seen_over_edge(above, 1.0), abs=2e-3)


@given(st.floats(1e-3, 0.1), st.floats(1e-4, 1.0), st.floats(-9.0, 0.3), st.floats(-12.0, -1.0))
@example(
    1e-3, 1.0, -8.994687830584578, -11.663475463881188
)  # 9e-4 more was seen by the cosines of a lens, whose digits are lost here
def test_less_is_hidden_the_farther_they_are_apart(disc: float, cover: float, touch: float, more: float) -> None:
    """From where the one just hides the other, or is just before it."""
    apart = abs(cover - disc) + disc * 10.0**touch
    nearer, farther = seen_past_disc(apart, disc, cover), seen_past_disc(apart + 10.0**more, disc, cover)
    assert 0.0 <= nearer <= farther + 1e-9
    assert farther <= 1.0


def test_half_the_disc_is_seen_with_its_centre_on_the_edge() -> None:
    assert seen_over_edge(0.0, 0.00465) == 0.5
