"""Zones, waypoints and layers on the page: colours of slopes, closed cells, goals that lie in a zone."""

import json
from collections.abc import Iterator

import numpy as np
import pytest
from deaf_feed import DeafFeed

from sojourn_console.draft import Draft
from sojourn_console.errors import GoalError
from sojourn_console.gate import GuardedServer
from sojourn_console.ground_layers import STEEP, slope_colors, slopes_of
from sojourn_console.model import RunScene
from sojourn_console.page import Page
from sojourn_console.views.layer_views import ClosedView, SlopeView
from sojourn_console.views.zone_view import edge_of
from sojourn_console.world import World, world_named
from sojourn_contract.values import OccupancyGrid
from sojourn_operator.far_goal import closed_places
from sojourn_physics.terrain.height_field import HeightField

LANDER = {"name": "lander", "points": [[1.0, -1.0], [2.0, -1.0], [2.0, 1.0], [1.0, 1.0]]}


@pytest.fixture(scope="module")
def zoned() -> World:
    told = [f"keep_out={json.dumps([LANDER])}", "waypoints={rim: {x: -2.0, y: 1.0}}", "steps=[]"]
    return world_named("flat_drive", told)


@pytest.fixture
def page(zoned: World, feed: DeafFeed) -> Iterator[Page]:
    page = Page(GuardedServer("zones", 8990), zoned, feed)
    yield page
    page.close()


def test_slopes_are_those_of_planes_whatever_their_noise() -> None:
    y, x = np.mgrid[-5.0:5.01:0.1, -8.0:8.01:0.1]
    noise = np.random.default_rng(5).normal(0.0, 0.005, x.shape)
    ground = HeightField(0.2 * x - 0.1 * y + noise, np.zeros(x.shape, dtype=np.uint8), 0.1, -8.0, -5.0, ("one",))
    inner = slopes_of(ground, 0.5)[6:-6, 6:-6]
    assert inner == pytest.approx(np.degrees(np.arctan(np.hypot(0.2, 0.1))), abs=0.5)
    # against the plane of least squares through one window
    part = (slice(20, 31), slice(40, 51))
    matrix = np.column_stack([x[part].ravel(), y[part].ravel(), np.ones(121)])
    a, b, _ = np.linalg.lstsq(matrix, ground.heights[part].ravel(), rcond=None)[0]
    assert slopes_of(ground, 0.5)[25, 45] == pytest.approx(np.degrees(np.arctan(np.hypot(a, b))), abs=1e-9)


def test_colors_end_at_the_limit() -> None:
    colors = slope_colors(np.array([0.0, 5.0, 10.0, 20.0, 40.0]), 20.0)
    assert (colors[3] == STEEP).all() and (colors[4] == STEEP).all() and (np.diff(colors[:4, 0].astype(int)) >= 0).all()


def test_closed_cells_are_where_the_map_has_them(page: Page, zoned: World) -> None:
    cells = np.full((4, 6), -1, dtype=np.int8)
    cells[1, 2], cells[3, 5] = 100, 100
    grid = OccupancyGrid(0, "odom", 0.5, 6, 4, np.array([-1.0, 2.0, 0.0]), cells.tobytes())
    assert closed_places(grid).tolist() == [[0.25, 2.75], [1.75, 3.75]]
    api = page.bench.server.scene
    view = ClosedView(page.bench.server, zoned)
    view.show(RunScene(costmap=grid))
    assert api.get_handle_by_name("/layers/closed") is not None
    view.show(RunScene(costmap=grid._replace(data=bytes(24))))
    assert api.get_handle_by_name("/layers/closed") is None
    slope = SlopeView(page.bench.server, zoned)
    slope.show(RunScene())
    assert api.get_handle_by_name("/layers/slope") is not None
    slope.hide()
    assert api.get_handle_by_name("/layers/slope") is None


def test_zones_and_waypoints_are_drawn_and_kept(page: Page, zoned: World) -> None:
    page.look()
    for name in ("/zones/0", "/zones/0/name", "/waypoints/rim", "/waypoints/rim/name"):
        assert page.bench.server.scene.get_handle_by_name(name) is not None
    page.bench.draft = Draft("drive", ((1.5, 0.0, 0.0),))
    with pytest.raises(GoalError, match=r"\(1.50, 0.00\): it lies in the keep-out zone lander"):
        page.bench.checked_draft()
    page.bench.draft = Draft("route", ((0.5, 0.0, 0.0), (3.0, 0.0, 0.0)))
    assert page.bench.checked_draft().kind == "route"
    edge = edge_of(np.array(LANDER["points"]))
    assert (edge[0] == edge[-1]).all() and np.linalg.norm(np.diff(edge, axis=0), axis=1).max() <= 0.25
