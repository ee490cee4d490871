"""Bump switches: how far the ground is before a plate, and when the contact is closed."""

import math

import numpy as np
import pytest
from camera_scenes import MOON, UNTOUCHED, flat, ground
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_physics.imaging.scenery import Scenery
from sojourn_physics.imaging.touch import BumpSwitchParams, face_of, is_closed

PLATE = BumpSwitchParams(width=0.4, height=0.2, travel=0.05)
AHEAD = np.array([1.0, 0.0, 0.0])


def test_the_plate_is_looked_over_at_half_a_node_and_to_its_edges() -> None:
    places = face_of(PLATE, 0.1)
    assert len(places) == 9 * 5 and (places[:, 0] == 0.0).all()
    assert np.abs(places).max(axis=0) == pytest.approx([0.0, 0.2, 0.1])
    assert np.diff(np.unique(places[:, 1])).max() <= 0.05 + 1e-12


@settings(max_examples=25, deadline=None)
@given(st.floats(15.0, 60.0), st.floats(0.5, 2.0), st.floats(0.05, 1.5))
def test_a_slope_is_as_far_ahead_as_geometry_has_it(slope_deg: float, height: float, back: float) -> None:
    """Its lower edge meets the plane first, the plane's foot so far ahead."""
    rise = math.tan(math.radians(slope_deg))
    x = 0.05 * (np.arange(401) - 200.0)
    scenery = Scenery(ground(np.tile(rise * np.maximum(x, 0.0), (401, 1))), MOON)
    middle = np.array([-back, 0.0, height])
    way = scenery.way_ahead(face_of(PLATE, scenery.node) + middle, AHEAD, UNTOUCHED, 20.0)
    assert way == pytest.approx(back + (height - 0.1) / rise, abs=0.03)


def test_a_stone_before_one_corner_of_the_plate_is_enough() -> None:
    heights = np.zeros((201, 201))
    heights[102:105, 120:130] = 0.5  # 0.1 to 0.2 m to the left, from 1 m on
    scenery = Scenery(ground(heights), MOON)
    for y, ahead in ((0.0, 1.0), (0.15, 1.0), (-0.4, math.inf)):
        way = scenery.way_ahead(face_of(PLATE, scenery.node) + np.array([0.0, y, 0.3]), AHEAD, UNTOUCHED, 2.0)
        assert way == (pytest.approx(ahead, abs=0.05) if math.isfinite(ahead) else math.inf)


def test_what_stands_in_the_ground_touches_and_what_is_beyond_the_way_does_not() -> None:
    scenery = Scenery(flat(), MOON)
    assert scenery.way_ahead(np.array([[0.0, 0.0, -0.01]]), AHEAD, UNTOUCHED, 1.0) == 0.0
    down = np.array([0.0, 0.0, -1.0])
    assert scenery.way_ahead(np.array([[0.0, 0.0, 0.5]]), down, UNTOUCHED, 1.0) == pytest.approx(0.5, abs=1e-6)
    assert scenery.way_ahead(np.array([[0.0, 0.0, 0.5]]), down, UNTOUCHED, 0.49) == math.inf


def test_the_contact_closes_at_the_travel_give_or_take_its_repeatability() -> None:
    random = np.random.default_rng(3)
    assert is_closed(PLATE, 0.05, random) and not is_closed(PLATE, 0.0501, random)
    assert not is_closed(PLATE, math.inf, random)
    rough = BumpSwitchParams(width=0.4, height=0.2, travel=0.05, repeatability=0.004)
    closed = np.mean([is_closed(rough, 0.054, random) for _ in range(20_000)])
    assert closed == pytest.approx(0.1587, abs=0.01), "one deviation beyond"


@pytest.mark.parametrize("key", ["width", "height", "travel"])
def test_a_plate_without_extent_is_refused(key: str) -> None:
    with pytest.raises(ValidationError, match=key):
        BumpSwitchParams.model_validate({**PLATE.model_dump(), key: 0.0})
