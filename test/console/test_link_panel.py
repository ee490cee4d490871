"""The link on the page: what is on its way, light time, the next window; nothing without a link."""

import pytest
from deaf_feed import DeafFeed

from sojourn_config.scenario import load_scenario
from sojourn_console.feed import FeedMessage
from sojourn_console.gate import GuardedServer
from sojourn_console.link_ahead import LinkAhead
from sojourn_console.page import Page
from sojourn_console.panels.link_panel import LinkPanel, command_words, link_rows
from sojourn_console.world import World
from sojourn_contract.codecs import encode
from sojourn_contract.link_topics import LINK_STATUS
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus
from sojourn_physics.link.window import AnyOf

PASSES = "link={light_time_s: 600.0, windows: [{kind: times, from_s: 100.0, to_s: 160.0, every_s: 1000.0}]}"


def ahead_of(*overrides: str, name: str = "flat_drive") -> LinkAhead:
    scenario = load_scenario(name, overrides)
    assert scenario.link is not None
    return LinkAhead(scenario.link, scenario.link_sky)


def status(**values: str) -> DiagnosticArray:
    link = {"window": "closed", "light_time_s": "600.000"}
    for way in ("up", "down"):
        link |= {f"{way}_waiting": "1", f"{way}_waiting_bits": "16000"}
    command = DiagnosticStatus("command 3", tuple({"topic": "/goal_pose", **values}.items()), values.get("state", ""))
    return DiagnosticArray(7, (DiagnosticStatus("link", tuple(link.items()), "closed"), command))


@pytest.mark.parametrize(
    ("now", "is_open", "change"), [(0, False, 100), (99, False, 100), (120, True, 160), (160, False, 1100)]
)
def test_the_next_window_is_that_of_the_scenario(now: int, is_open: bool, change: int) -> None:
    ahead = ahead_of(PASSES)
    ahead.look(now * NANOSECONDS, 0.0, 0.0)
    assert (ahead.is_open, ahead.changes_at) == (is_open, change * NANOSECONDS)
    ahead.look((change + 1) * NANOSECONDS, 0.0, 0.0)  # it has changed since
    assert ahead.is_open is not is_open


def test_the_earth_comes_up_when_the_link_itself_says_so() -> None:
    """Against the windows asked one after the other, every 10 s."""
    scenario, ahead = load_scenario("link_moon"), ahead_of(name="link_moon")
    for _ in range(10):
        ahead.look(0, 0.0, 0.0)
    assert scenario.link is not None
    windows = AnyOf([window.build(scenario.link_sky) for window in scenario.link.windows])
    opened = next(time for time in range(0, 200, 10) if windows.at(time * NANOSECONDS, 0.0, 0.0)[0])
    assert not ahead.is_open and ahead.changes_at == opened * NANOSECONDS and opened > 0
    assert 1.2 < ahead.light_time_s(0) < 1.4


def test_a_link_without_windows_is_open_for_good() -> None:
    ahead = ahead_of("link={light_time_s: 2.0}")
    ahead.look(0, 0.0, 0.0)
    assert link_rows(None, 0, ahead)[0] == ("link", "open for good")


def test_where_a_command_is() -> None:
    sent = {"topic": "/goal_pose", "state": "sent", "sent_s": "100.00"}
    assert command_words(sent, 400 * NANOSECONDS, 600.0) == "/goal_pose, on its way, there in 300.0 s"
    assert command_words(sent, 800 * NANOSECONDS, 600.0).endswith(
        "should be there, word of it in 500.0 s at the soonest"
    )
    assert command_words(sent, 1400 * NANOSECONDS, 600.0).endswith("word of it is due")
    assert "waits on Earth since 5.00 s" in command_words({"state": "queued", "queued_s": "5.00"}, 0, 1.0)
    over = {"topic": "/goal_pose", "state": "executed", "outcome": "refused", "reason": "too far"}
    assert command_words(over, 0, 1.0) == "/goal_pose, executed (refused: too far)"


def test_the_page_shows_what_comes(feed: DeafFeed) -> None:
    linked = World.of_scenario(load_scenario("flat_drive", [PASSES]))
    page = Page(GuardedServer("link", 8870), linked, feed)
    try:
        panel = next(one for one in page._tabs if isinstance(one, LinkPanel))
        assert panel.topics() == {LINK_STATUS.name}
        message = status(state="sent", sent_s="100.00")
        feed.poll = lambda: [FeedMessage(LINK_STATUS, encode(LINK_STATUS, message), 400 * NANOSECONDS)]  # type: ignore[method-assign]
        for _ in range(12):
            page.look()
        rows = dict(link_rows(message, page.bench.scene.stamp, panel._ahead))  # type: ignore[arg-type]
        assert rows["command 3"] in panel._words.content and rows["to the machine"] == "1 waiting, 2.00 kB"
        assert "there and back 1200.00 s" in panel._words.content
    finally:
        page.close()


def test_without_a_link_there_is_none(world: World, feed: DeafFeed) -> None:
    page = Page(GuardedServer("none", 8880), world, feed)
    try:
        panel = next(one for one in page._tabs if isinstance(one, LinkPanel))
        page.look()
        assert not panel.topics() and "stands beside the machine" in panel._words.content
    finally:
        page.close()
