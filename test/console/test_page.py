"""The whole page over the reference bag, without a browser: what it hears is drawn."""

from collections.abc import Iterator

import pytest

from sojourn_bags.reading import Bag
from sojourn_console.bag_feed import BagFeed
from sojourn_console.gate import GuardedServer
from sojourn_console.page import Page
from sojourn_console.views.way_view import ABOVE, on_ground
from sojourn_console.world import World


@pytest.fixture
def page(reference: Bag, world: World) -> Iterator[Page]:
    page = Page(GuardedServer("page", 8980), world, BagFeed(reference, world.table))
    yield page
    page.close()


def test_time_goes_on_and_jumps(page: Page, world: World) -> None:
    feed, bench = page.bench.feed, page.bench
    assert isinstance(feed, BagFeed)
    scene_api = bench.server.scene
    for _ in range(40):
        feed.advance(0.2)
        page.look()
    pose = bench.scene.pose
    assert pose is not None and bench.scene.stamp == feed.now and not bench.scene.refused
    machine = scene_api.get_handle_by_name("/machine")
    assert machine is not None and tuple(machine.position) == pytest.approx(tuple(pose.position), abs=1e-5)
    assert scene_api.get_handle_by_name("/track") is not None
    driven = len(bench.scene.track)
    feed.jump(feed.begin)
    page.look()
    assert bench.scene.stamp <= feed.begin + 1 and len(bench.scene.track) < driven
    feed.jump(feed.end)
    page.look()
    assert len(bench.scene.track) >= driven


def test_the_machine_stands_on_its_ground(page: Page, world: World) -> None:
    page.look()
    pose = page.bench.scene.pose
    assert pose is not None
    ground = on_ground(world, pose.position[None])[0, 2] - ABOVE
    assert pose.position[2] - ground == pytest.approx(0.47, abs=0.02)
