"""The whole page over the reference bag, without a browser: what it hears is drawn."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from told_feed import ToldFeed
from told_ground import ground_told

from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag, read_bag
from sojourn_console import model
from sojourn_console.bag_feed import BagFeed
from sojourn_console.frames import FRAMES
from sojourn_console.gate import GuardedServer
from sojourn_console.model import RunScene
from sojourn_console.page import Page
from sojourn_console.ruts import deepest_of_each
from sojourn_console.views import ground_view
from sojourn_console.views.ground_view import GroundView
from sojourn_console.views.way_view import ABOVE, on_ground
from sojourn_console.world import World, world_of_bag
from sojourn_contract.codecs import encode
from sojourn_contract.ground import GROUND
from sojourn_contract.values import Message, PointCloud2

SEEING = Path(__file__).parents[1] / "replay" / "themes" / "sight"


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


def test_a_jump_does_not_copy_all_that_has_passed_with_every_message(
    page: Page, reference: Bag, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a run of 15 minutes a jump took 17 s, and so did a step back."""
    take, held = model._TAKES["/truth/contacts"], list[int]()

    def counting(scene: RunScene, name: str, message: Message) -> RunScene:
        held.append(len(scene.passed))
        return take(scene, name, message)

    monkeypatch.setitem(model._TAKES, "/truth/contacts", counting)  # type: ignore[arg-type]
    feed = page.bench.feed
    assert isinstance(feed, BagFeed)
    feed.jump(feed.end)
    page.look()
    count = len(reference["/truth/contacts"])
    assert len(held) == len(page.bench.scene.passed) == count
    assert sum(held) < 64 * count


def lowered(second: int) -> PointCloud2:
    """A patch of 0.2 m that has been pressed down by 5 cm, another with each second."""
    x, y = np.meshgrid(0.5 * second + 0.02 * np.arange(10), 0.02 * np.arange(10))
    nodes = np.stack([x, y, np.full_like(x, 0.05)], axis=2).reshape(-1, 3)
    return ground_told(second * 1_000_000_000, nodes)


def ruts_of(page: Page) -> int:
    """Pixels of the ground that lie lower."""
    view = next(view for view in page._views if isinstance(view, GroundView))
    return sum(int((tile > 0.04).sum()) for tile in view.tiles._lowered.values())


def test_ruts_that_the_ground_tells_are_all_there_after_a_jump_and_live(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each message has what is new since the one before: after a jump those of the newest alone were drawn."""
    monkeypatch.setattr(ground_view, "REDRAW_S", -1.0)  # with every look
    world = world_of_bag(read_bag(SEEING))
    clouds = [lowered(second) for second in range(1, 9)]
    times = [cloud.stamp for cloud in clouds]
    messages = Messages(GROUND.name, "sensor_msgs/msg/PointCloud2", times, [encode(GROUND, cloud) for cloud in clouds])
    bag = Bag(SEEING, topics={GROUND.name: messages})
    live = ToldFeed(world.table)
    for feed in (BagFeed(bag, world.table), live):
        page = Page(GuardedServer("ruts", 9110), world, feed)
        try:
            if isinstance(feed, BagFeed):
                feed.jump(feed.begin)
                page.look()
                one = ruts_of(page)
                assert one > 0
                feed.jump(feed.end)
            else:
                for cloud in clouds:  # a run in lock-step says many seconds from one look to the next
                    live.tell(GROUND.name, cloud)
            page.look()
            assert ruts_of(page) > 6 * one
            page.look()
            assert not page.bench.scene.lowered  # they have been shown
        finally:
            page.close()


def test_ruts_wait_for_the_next_drawing_and_are_forgotten_with_a_jump(monkeypatch: pytest.MonkeyPatch) -> None:
    """They were pressed down with every look, to be drawn two seconds later: a fifth of what a look took."""
    now = [1000.0]
    monkeypatch.setattr(ground_view.time, "monotonic", lambda: now[0])
    world = world_of_bag(read_bag(SEEING))
    live = ToldFeed(world.table)
    page = Page(GuardedServer("waiting", 9115), world, live)
    try:
        page.look()
        for second in (1, 2, 3):
            live.tell(GROUND.name, lowered(second))
            page.look()
            now[0] += 0.5
        first = ruts_of(page)  # the first drawing is due at once
        now[0] += ground_view.REDRAW_S
        page.look()
        assert ruts_of(page) > 2 * first > 0
        live.tell(GROUND.name, lowered(4))
        page.look()
        page._clear()
        now[0] += 2.0 * ground_view.REDRAW_S
        page.look()
        assert ruts_of(page) == 0
    finally:
        page.close()


def test_of_places_close_together_the_deepest_stands_for_all() -> None:
    nodes = np.array([[0.001, 0.001, 0.01], [0.015, 0.002, 0.03], [0.021, 0.001, 0.02], [-0.001, 0.0, 0.005]])
    assert deepest_of_each(nodes).tolist() == [nodes[3].tolist(), nodes[1].tolist(), nodes[2].tolist()]
    assert deepest_of_each(np.zeros((0, 3))).shape == (0, 3)
