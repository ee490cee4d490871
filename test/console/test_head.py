"""The head of the page: what stops the machine, and who of its nodes is heard no more."""

from collections.abc import Iterator

import pytest
from told_feed import ToldFeed, head_of, show

from sojourn_bags.reading import Bag
from sojourn_config.command_errors import CommandError
from sojourn_console.bag_feed import BagFeed
from sojourn_console.gate import GuardedServer
from sojourn_console.page import Page
from sojourn_console.panels.head import LOUD
from sojourn_console.world import World
from sojourn_contract.heartbeat import ENDED, RUNNING, Counters, heartbeat_message, status_message
from sojourn_contract.values import BatteryState, Message, TwistStamped

SECOND = 1_000_000_000


@pytest.fixture
def feed(world: World) -> ToldFeed:
    return ToldFeed(world.table)


@pytest.fixture
def page(world: World, feed: ToldFeed) -> Iterator[Page]:
    page = Page(GuardedServer("head", 9070), world, feed)
    yield page
    page.close()


def beat(feed: ToldFeed, second: int, *roles: str, state: str = RUNNING) -> None:
    for role in roles:
        feed.tell("/diagnostics", heartbeat_message(role, state, second * SECOND, Counters()))


@pytest.mark.parametrize("deaf", [{"/cmd_vel", "/arm/stop"}, {"/arm/stop"}, set()])
def test_a_stop_holds_the_sequence_whatever_becomes_of_it(page: Page, feed: ToldFeed, deaf: set[str]) -> None:
    """Where neither role could be told, the sequence went on."""
    sequences = page.bench.sequences
    sequences.begin("steps:\n  - wait_s: 100.0\n  - drive_to: {x: 2.0, y: 0.5}\n")
    feed.deaf = deaf
    if len(deaf) == 2:
        with pytest.raises(CommandError, match=r"not stopped: .*nobody acts on it; the sequence is held"):
            head_of(page)._stop()
    else:
        assert head_of(page)._stop().endswith("; the sequence is held")
    assert sequences.state.held


VELOCITIES = (
    "drive_velocity: {forward: 0.05, seconds: 60.0}",
    "arm_jog: {linear: [0.0, 0.0, 0.01], seconds: 60.0}",
    "begin: {step: {drive_velocity: {forward: 0.05, seconds: 60.0}}, seconds: 60.0}",
)


def moves(message: Message) -> bool:
    return isinstance(message, TwistStamped) and bool(message.linear.any() or message.angular.any())


@pytest.mark.parametrize("pressed", ["_stop", "_cancel"])
@pytest.mark.parametrize("step", VELOCITIES)
def test_no_velocity_is_said_again_after_a_stop(page: Page, feed: ToldFeed, step: str, pressed: str) -> None:
    """The look after a stop sent the velocity of the sequence once more, and the machine went on."""
    page.bench.sequences.begin(f"steps:\n  - {step}\n    on_failure: hold\n  - drive_to: {{x: 2.0, y: 0.5}}\n")
    for _ in range(5):
        page.look()
        feed.now += SECOND // 10
    assert moves(feed.said[-1][1])
    said = len(feed.said)
    getattr(head_of(page), pressed)()
    for _ in range(20):
        page.look()
        feed.now += SECOND // 10
    after = [message for _, message in feed.said[said:]]
    assert after and not any(map(moves, after))
    assert [entry.outcome for entry in page.bench.sequences.history][-1] == "stopped"
    assert page.bench.sequences.state.held


def test_a_role_that_says_nothing_more_is_told(page: Page, feed: ToldFeed) -> None:
    """After 296 s without a word of the drive the head still read: drive moving, 3.20 m to go."""
    moving = {"state": "moving", "goal_stamp": "1", "distance_to_go": "3.2", "reason": ""}
    feed.tell("/drive/status", status_message(3 * SECOND, "drive", moving))
    for second in range(1, 4):
        beat(feed, second, "plant", "drive", "arm")
    beat(feed, 3, "arm", state=ENDED)
    for second in range(4, 8):
        beat(feed, second, "plant")
    show(page)
    words = head_of(page)._words.content
    assert "silent" not in words and "arm ended" in words
    for second in range(8, 300):
        beat(feed, second, "plant")
    show(page)
    words = head_of(page)._words.content
    assert f'<div style="{LOUD}">drive silent for 296 s</div>' in words
    assert "before it fell silent: 3.20 m to go" in words
    assert "arm ended" in words and "arm silent" not in words  # it has said that it ends
    beat(feed, 300, "drive", "plant")
    show(page)
    assert "silent" not in head_of(page)._words.content


def test_nobody_is_silent_beside_a_driver_with_a_clock_of_its_own(page: Page, feed: ToldFeed) -> None:
    """Whatever tells a state under /diagnostics reads as a heartbeat; nor do roles that beat one after the other."""
    for second in range(1, 20):
        for place, role in enumerate(("plant", "drive", "arm", "power", "sensors", "operator", "recorder")):
            stamp = second * SECOND + 20_000_000 * place
            feed.tell("/diagnostics", heartbeat_message(role, RUNNING, stamp, Counters()))
            feed.tell("/diagnostics", heartbeat_message("camera", RUNNING, 1_790_000_000 * SECOND + stamp, Counters()))
            show(page)
            assert not page.bench.scene.silent
    for second in range(20, 30):
        beat(feed, second, "plant")
    show(page)
    assert "drive" in page.bench.scene.silent and "camera" not in page.bench.scene.silent


def test_time_is_that_of_the_run_beside_a_driver_with_a_clock_of_its_own(page: Page, feed: ToldFeed) -> None:
    """The head told the time of the driver from then on, and plots were not drawn any more."""
    for second in range(1, 6):
        beat(feed, second, "plant", "drive")
        feed.tell("/battery_state", BatteryState(second * SECOND, percentage=0.5))
        feed.tell("/diagnostics", status_message(1_790_000_000 * SECOND, "lidar", {"temperature": "3"}))
        page.look()
    assert page.bench.scene.stamp == 5 * SECOND
    assert not [event for event in page.bench.alarms.log if event.severity]


def test_where_the_clock_leaps_nobody_is_silent(page: Page, feed: ToldFeed) -> None:
    """A heartbeat a leap of an hour: between that of one role and the next nothing is missing."""
    for leap in range(1, 9):
        beat(feed, 3600 * leap, "plant")
        show(page)
        assert not page.bench.scene.silent
        beat(feed, 3600 * leap, "drive")
        show(page)


def test_who_ends_with_the_run_is_not_silent(reference: Bag, world: World) -> None:
    """Played slowly, fast, by jumps and by a step back, to the end: nodes that beat at one time are all heard."""
    feed = BagFeed(reference, world.table)
    page = Page(GuardedServer("ends", 9080), world, feed)
    try:
        for wall_s in (0.03, 0.7):
            feed.jump(feed.begin)
            feed.is_playing = True
            while feed.is_playing:
                feed.advance(wall_s)
                page.look()
                assert not page.bench.scene.silent
        for time in (feed.begin, feed.end, feed.end // 2):
            feed.jump(time)
            show(page)
            assert not page.bench.scene.silent
        feed.jump(feed.end)
        feed.step(-1)
        show(page)
        roles = {"plant", "sensors", "drive", "arm", "power", "operator", "recorder"}
        assert set(page.bench.scene.states) == roles and not page.bench.scene.silent
    finally:
        page.close()
