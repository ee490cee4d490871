"""The whole page over the reference bag, without a browser: what it hears is drawn."""

from collections.abc import Iterator

import pytest

from sojourn_bags.reading import Bag
from sojourn_console.bag_feed import BagFeed
from sojourn_console.gate import GuardedServer
from sojourn_console.page import FRAMES, Page
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


def test_a_slow_machine_leaves_the_browsers_their_turn(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    """Looks of a tenth of a second, on a clock that only they and sleep move on: viser sends every 1/60 s."""
    now, rests = [100.0], list[float]()

    def look() -> None:
        now[0] += 0.1 if len(rests) < 5 else 0.004

    def sleep(time: float) -> None:
        rests.append(time)
        now[0] += time

    monkeypatch.setattr(page, "look", look)
    monkeypatch.setattr("sojourn_console.page.time.monotonic", lambda: now[0])
    monkeypatch.setattr("sojourn_console.page.time.sleep", sleep)
    page.run(lambda: len(rests) < 10)
    assert min(rests) > 1.0 / 60.0
    assert rests[-1] == pytest.approx(1.0 / FRAMES - 0.004)  # a fast one has its frames


def test_the_machine_stands_on_its_ground(page: Page, world: World) -> None:
    page.look()
    pose = page.bench.scene.pose
    assert pose is not None
    ground = on_ground(world, pose.position[None])[0, 2] - ABOVE
    assert pose.position[2] - ground == pytest.approx(0.47, abs=0.02)
