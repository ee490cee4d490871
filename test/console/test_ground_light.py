"""The light in the picture of the ground: by Lambert on planes, shadows as long as geometry says, none at night."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from deaf_feed import DeafFeed
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_console.gate import GuardedServer
from sojourn_console.ground_light import SKY, SKY_COLOR, SUN, GroundLight
from sojourn_console.model import RunScene
from sojourn_console.page import Page
from sojourn_console.views.ground_view import GroundView
from sojourn_console.world import world_named
from sojourn_physics.terrain.height_field import HeightField

DISC = 0.00465
HERE = np.array([0.05]), np.array([-0.05])
SKY_ALONE = SKY * np.array(SKY_COLOR) / 255.0 / math.pi


def ground(heights: np.ndarray) -> HeightField:
    """Of 10 m by 10 m about the middle."""
    return HeightField(heights, np.zeros(heights.shape, dtype=np.uint8), 0.1, -5.0, -5.0, ("one",))


def places() -> tuple[np.ndarray, np.ndarray]:
    y, x = np.mgrid[-5.0:5.01:0.1, -5.0:5.01:0.1]
    return x, y


def towards(elevation: float, azimuth: float) -> np.ndarray:
    """Angles in degrees."""
    up, round_ = math.radians(elevation), math.radians(azimuth)
    return np.array([math.cos(up) * math.cos(round_), math.cos(up) * math.sin(round_), math.sin(up)])


@settings(max_examples=40)
@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(30.0, 85.0), st.floats(0.0, 360.0))
def test_a_plane_is_lit_by_the_cosine(rise_x: float, rise_y: float, elevation: float, azimuth: float) -> None:
    x, y = places()
    light = GroundLight(ground(rise_x * x + rise_y * y))
    sun = towards(elevation, azimuth)
    light.shine(sun, DISC)
    normal = np.array([-rise_x, -rise_y, 1.0]) / math.sqrt(1.0 + rise_x**2 + rise_y**2)
    assert light.on(*HERE)[0, 0] == pytest.approx(SUN * (normal @ sun) / math.pi + SKY_ALONE, rel=1e-6)


@settings(max_examples=20)
@given(st.floats(12.0, 60.0))
def test_a_shadow_is_as_long_as_height_over_tangent(elevation: float) -> None:
    """Of a wall 0.5 m high along y that ends at x = 0; the Sun is beyond it."""
    x, _ = places()
    light = GroundLight(ground(np.where((x > -1e-9) & (x < 0.35), 0.5, 0.0)))
    light.shine(towards(elevation, 0.0), DISC)
    length = 0.5 / math.tan(math.radians(elevation))
    inside, outside = -0.15 - 0.5 * (length - 0.15), -1.1 * length - 0.15
    lit = light.on(np.array([inside, outside]), np.array([0.0]))[0]
    assert lit[0] == pytest.approx(SKY_ALONE, rel=1e-6)
    assert lit[1] == pytest.approx(SUN * math.sin(math.radians(elevation)) / math.pi + SKY_ALONE, rel=1e-6)


def test_at_night_there_is_the_sky_alone() -> None:
    x, _ = places()
    light = GroundLight(ground(0.2 * x))
    assert light.on(*HERE)[0, 0] == pytest.approx(SKY_ALONE)  # before any Sun
    light.shine(towards(-5.0, 180.0), DISC)  # from below, on a slope that leans towards it
    assert light.on(*HERE)[0, 0] == pytest.approx(SKY_ALONE)


@pytest.fixture
def day_on_mars(feed: DeafFeed) -> Iterator[Page]:
    page = Page(GuardedServer("light", 8990), world_named("mars_sol"), feed)
    yield page
    page.close()


def test_the_ground_is_lit_anew_as_the_sun_goes_on(day_on_mars: Page) -> None:
    view = next(view for view in day_on_mars._views if isinstance(view, GroundView))
    key = next(iter(view.tiles.keys()))
    before = view.tiles.picture(key).mean()
    for minutes, is_same in ((1.0, True), (120.0, False)):
        view.show(RunScene(stamp=round(minutes * 60e9)))
        assert (abs(view.tiles.picture(key).mean() - before) < 1e-9) == is_same
        assert (key in view._changed or view._drawn[key][1] > 1) != is_same  # it is drawn again, then or soon
