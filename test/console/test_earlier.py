"""A page that joins a run under way: what the run has left behind comes from its bag."""

import os
import subprocess
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from told_feed import ToldFeed
from told_ground import ground_told

from sojourn_bags.definitions import ChannelSpec, qos_entry
from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.writer import BagWriter
from sojourn_console import beside, earlier
from sojourn_console.bag_feed import BagFeed
from sojourn_console.feed import FeedMessage
from sojourn_console.gate import GuardedServer
from sojourn_console.model import RunScene, after_all
from sojourn_console.page import Page
from sojourn_console.ruts import deepest_of_each
from sojourn_console.traces import LEFT_BY, Traces, traces_of
from sojourn_console.views import ground_view
from sojourn_console.views.ground_view import GroundView
from sojourn_console.world import RunFiles, World
from sojourn_contract import qos
from sojourn_contract.codecs import decode, encode
from sojourn_contract.ground import GROUND
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import topic

ROWS = [topic(name) for name in LEFT_BY[:2]] + [GROUND]
CHANNELS = [ChannelSpec(row.name, row.type, qos_entry(qos.profile(row, True))) for row in ROWS]


@pytest.fixture(params=["contacts", "ground"])
def recorded(request: pytest.FixtureRequest, reference: Bag) -> Bag:
    """A run whose ruts are told by /truth/contacts, or by /truth/ground."""
    topics = {name: reference[name] for name in LEFT_BY[:2]}
    if request.param == "ground":
        contacts = topics.pop("/truth/contacts")
        told = [(time, _as_ground(time, data)) for time, data in zip(contacts.log_times, contacts.data, strict=True)]
        topics[GROUND.name] = Messages(GROUND.name, "sensor_msgs/msg/PointCloud2", *map(list, zip(*told, strict=True)))
    return Bag(reference.path, attachments=reference.attachments, topics=topics)


def _as_ground(time: int, data: bytes) -> bytes:
    """What has touched the ground, as the ground tells it."""
    contacts = after_all(RunScene(), [FeedMessage(topic("/truth/contacts"), data, time)]).passed[0]
    return encode(GROUND, ground_told(time, contacts))


@pytest.fixture
def running(recorded: Bag, tmp_path: Path) -> Iterator[Path]:
    """The folder of that run while it is recorded: nine tenths are written, the bag is not finished."""
    writer = BagWriter(tmp_path / "bag", CHANNELS)
    places = {spec.topic: place for place, spec in enumerate(CHANNELS)}
    said = [
        (time, places[name], data)
        for name, messages in recorded.topics.items()
        for time, data in zip(messages.log_times, messages.data, strict=True)
    ]
    said.sort()
    for stamp, place, data in said[: len(said) * 9 // 10]:
        writer.write(place, stamp, stamp, data)
    writer.flush()
    yield tmp_path
    writer.close()


def whole_scene(bag: Bag, world: World, until: int) -> RunScene:
    """By the feed of a bag, which is another way through it."""
    feed = BagFeed(bag, TopicTable([*world.table, GROUND]))
    feed.want((), LEFT_BY)
    feed.jump(until)
    return after_all(RunScene(), feed.poll())


def deepest(parts: tuple[np.ndarray, ...]) -> np.ndarray:
    return deepest_of_each(np.concatenate([np.zeros((0, 3)), *parts]))


def test_what_is_left_is_what_a_page_would_have_seen(recorded: Bag, running: Path, world: World) -> None:
    newest = read_bag(running)["/odom"].log_times[-1]
    found = traces_of(running, newest // 2)
    track = whole_scene(recorded, world, newest // 2).track
    assert len(found.track) > 1 and np.array_equal(found.track, track)
    scene = whole_scene(read_bag(running), world, newest)  # each message tells what is new: there is no gap to the next
    assert len(found.passed) + len(found.lowered) > 10
    assert np.array_equal(found.passed, deepest(scene.passed))
    assert np.array_equal(found.lowered, deepest(scene.lowered))
    assert found.newest >= newest


def test_a_finished_bag_is_of_no_run_that_goes_on(reference: Bag) -> None:
    assert traces_of(reference.path, 10**18).newest == 0


@pytest.fixture
def page(world: World, running: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Page]:
    """That hears a run which it has not heard from its beginning."""
    monkeypatch.setattr(earlier, "WAIT_S", 0.0)
    monkeypatch.setattr(earlier, "PORTION", 20)
    monkeypatch.setattr(ground_view, "REDRAW_S", -1.0)  # with every look
    world = replace(world, run=RunFiles(running, running / "bag", 0, {}))
    page = Page(GuardedServer("earlier", 9120), world, ToldFeed(world.table))
    yield page
    page.close()


def hear(page: Page, bag: Bag, place: int) -> int:
    """A message of /odom by its place in a bag; until nothing more is read of what was before. Its time [ns]."""
    feed, messages = page.bench.feed, bag["/odom"]
    assert isinstance(feed, ToldFeed)
    feed.tell("/odom", decode(page.bench.world.table.topic("/odom"), messages.data[place]))
    page.look()
    page.look()
    while not page._earlier._is_read:
        page.look()
        time.sleep(0.01)
    return messages.log_times[place]


def ruts_of(page: Page) -> int:
    """Pixels of the ground that lie lower."""
    view = next(view for view in page._views if isinstance(view, GroundView))
    return sum(int((tile > 0.0).sum()) for tile in view.tiles._lowered.values())


def test_a_page_that_joins_late_shows_what_was_before(page: Page, recorded: Bag, running: Path, world: World) -> None:
    until = hear(page, recorded, len(read_bag(running)["/odom"]) - 1)
    expected, track = whole_scene(recorded, world, until).track, page.bench.scene.track
    assert len(track) >= len(expected) > 1 and np.array_equal(track[: len(expected)], expected)
    ruts = [ruts_of(page)]
    for _ in range(20):
        page.look()
        ruts.append(ruts_of(page))
    assert 0 == ruts[0] < ruts[1] < ruts[-1] and ruts == sorted(ruts)  # by portions, so that STOP is never waited for
    assert not page.bench.failures.words()


@pytest.mark.parametrize(("place", "behind_s"), [(150, 30.0), (-1, 0.01)], ids=["ahead", "behind"])
def test_a_page_lays_nothing_of_another_run_under_it(
    page: Page, recorded: Bag, monkeypatch: pytest.MonkeyPatch, place: int, behind_s: float
) -> None:
    """The bag in the folder goes further than the run that is heard, or not as far: it is of one that was cut off."""
    monkeypatch.setattr(earlier, "BEHIND_NS", round(behind_s * 1e9))
    started, start = [], beside.start
    monkeypatch.setattr(beside, "start", lambda *words, **pipes: started.append(words) or start(*words, **pipes))
    hear(page, recorded, place)
    for _ in range(3):
        page.look()
    assert started and len(page.bench.scene.track) == 1 and ruts_of(page) == 0


@pytest.mark.parametrize("what", ["start", "read"])
def test_a_page_goes_on_where_traces_cannot_be_read(
    page: Page, recorded: Bag, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    """It is tried once, and the page says so."""

    def fails(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(*((beside, "start") if what == "start" else (Traces, "load")), fails)
    hear(page, recorded, 150)
    assert page._earlier._reader is None
    assert len(page.bench.failures.words()) == 1 and "No space left" in page.bench.failures.words()[0]


def test_traces_are_read_as_they_were_saved(tmp_path: Path) -> None:
    traces = Traces(np.ones((2, 3)), np.zeros((0, 3)), np.full((1, 3), 0.5), 7)
    with (tmp_path / "file").open("wb+") as stream:
        traces.save(stream)
        stream.seek(0)
        again = Traces.load(stream)
    assert all(np.array_equal(one, other) for one, other in zip(traces, again, strict=True))


def test_what_reads_yields_to_other_sessions() -> None:
    """A page that was opened slowed a run beside it, for `nice` counts in one session only."""
    reader = beside.start("json.tool", in_background=True, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL)
    try:
        assert os.getsid(reader.pid) == reader.pid
        group = Path(f"/proc/{reader.pid}/autogroup")
        assert not group.exists() or group.read_text().endswith(" nice 10\n")
    finally:
        reader.kill()
        reader.communicate()
