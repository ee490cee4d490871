"""The link on the page: what is on its way, light time, the next window; nothing without a link."""

from collections.abc import Iterator

import pytest
from deaf_feed import DeafFeed

from sojourn_config.scenario import load_scenario
from sojourn_console.draft import Draft
from sojourn_console.errors import GoalError, SequenceError
from sojourn_console.feed import FeedMessage
from sojourn_console.gate import GuardedServer
from sojourn_console.link_ahead import LinkAhead
from sojourn_console.link_words import command_words, link_rows, span
from sojourn_console.page import Page
from sojourn_console.panels.head import HeadPanel
from sojourn_console.panels.link_panel import LinkPanel
from sojourn_console.panels.sequence import SequencePanel
from sojourn_console.uplink import LinkMoment, Uplink
from sojourn_console.world import World
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_message
from sojourn_contract.link_topics import LINK_STATUS
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus
from sojourn_physics.link.params import STATUSES
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
    scenario, ahead = load_scenario("flat_drive", ["link={light_time_s: 2.0}"]), ahead_of("link={light_time_s: 2.0}")
    ahead.look(0, 0.0, 0.0)
    assert link_rows(Uplink(DeafFeed(), scenario.link, STANDARD), 0, ahead)[0] == ("link", "open for good")


def test_where_a_command_is() -> None:
    link = LinkMoment(600.0, True, 300.0)
    sent = {"topic": "/goal_pose", "state": "sent", "sent_s": "100.00"}
    assert command_words(sent, 400 * NANOSECONDS, link) == "on its way, there in 5 min 0 s"
    assert command_words(sent, 800 * NANOSECONDS, link) == "should be there, word of it in 8 min 20 s at the soonest"
    assert command_words(sent, 1302 * NANOSECONDS, link) == "should be there, word of it is due"
    assert (
        command_words(sent, 1400 * NANOSECONDS, link)
        == "no word of it, due for 1 min 40 s: it may be lost, or its word"
    )
    closed = link._replace(is_open=False)
    assert command_words(sent, 1400 * NANOSECONDS, closed) == "should be there, word of it waits for the window"
    waits = {"state": "queued", "queued_s": "5.00"}
    assert command_words(waits, 15 * NANOSECONDS, link) == "waits on Earth since 5.0 s, expires in 4 min 50 s"
    assert command_words(waits, 0, link._replace(expires_s=None)) == "waits on Earth since 5.0 s"
    got = {"state": "received", "received_s": "7.12"}
    assert command_words(got, 0, link) == "received at 7.1 s; of its end nothing is known yet"
    over = {"topic": "/goal_pose", "state": "executed", "outcome": "refused", "reason": "too far"}
    assert command_words(over, 0, link) == "executed (refused: too far)"


@pytest.mark.parametrize(
    ("time", "words"),
    [(-1.0, "0.0 s"), (59.96, "60.0 s"), (119.6, "2 min 0 s"), (7199.6, "2 h 0 min"), (90000.0, "1 d 1 h")],
)
def test_a_length_of_time_in_words(time: float, words: str) -> None:
    assert span(time) == words


def test_a_window_is_told_by_the_date_and_for_how_long_it_has_been_looked_ahead() -> None:
    scenario, at = load_scenario("link_moon"), 0
    assert scenario.link is not None
    ahead = LinkAhead(scenario.link, scenario.link_sky, scenario.config.sun.time)
    uplink = Uplink(DeafFeed(), scenario.link, STANDARD)
    ahead.look(at, 0.0, 0.0)
    assert link_rows(uplink, at, ahead)[0] == ("link", "closed, opens in 50.0 s, at 50 s, 2028-03-18 20:38:50 UTC")
    ahead.look(60 * NANOSECONDS, 0.0, 0.0)
    rows = dict(link_rows(uplink, 60 * NANOSECONDS, ahead))
    assert rows["link"] == "open for 6 min 50 s at least"  # forty-one looks of ten seconds
    assert rows["carries"] == "up 2 kbit/s; down 16 kbit/s, 2 % lost"


@pytest.fixture
def linked(feed: DeafFeed) -> Iterator[Page]:
    """A page beside a run with a link of ten minutes."""
    page = Page(GuardedServer("link", 8870), World.of_scenario(load_scenario("flat_drive", [PASSES])), feed)
    yield page
    page.close()


def hear(page: Page, feed: DeafFeed, *heard: FeedMessage) -> str:
    """The page a little later, when something has come: what its tab says."""
    feed.poll = lambda: list(heard)  # type: ignore[method-assign]
    for _ in range(12):
        page.look()
    return panel_of(page)._words.content


def panel_of(page: Page) -> LinkPanel:
    return next(one for one in page._tabs if isinstance(one, LinkPanel))


def said(message: DiagnosticArray, time: int = 400) -> FeedMessage:
    return FeedMessage(LINK_STATUS, encode(LINK_STATUS, message), time * NANOSECONDS)


@pytest.mark.parametrize(
    ("of_link", "of_command"),
    [
        ({"light_time_s": "soon"}, {}),
        ({"up_waiting": "1.5"}, {}),
        ({"down_waiting_bits": ""}, {}),
        ({}, {"goal_stamp": "now"}),
        ({}, {"state": "sent", "sent_s": "then"}),
        (None, {}),
    ],
)
def test_a_stranger_s_word_on_the_link_is_passed_over(
    linked: Page, feed: DeafFeed, of_link: dict[str, str] | None, of_command: dict[str, str]
) -> None:
    before = hear(linked, feed, said(status(state="sent", sent_s="100.00")))
    sound = status(**of_command)
    link, command = sound.status
    values = () if of_link is None else tuple((dict(link.values) | of_link).items())
    after = hear(linked, feed, said(DiagnosticArray(8, (DiagnosticStatus("link", values, ""), command))))
    assert "command 3" in before and after == before


def test_the_page_shows_what_comes(linked: Page, feed: DeafFeed) -> None:
    panel, table = panel_of(linked), linked.bench.world.table
    assert panel.topics() == {LINK_STATUS.name, *(f"/earth{name}" for name in STATUSES)}
    row = table.topic("/earth/drive/status")
    old = status_message(300 * NANOSECONDS, "drive", {"state": "moving", "reason": "", "goal_stamp": "0"})
    now = FeedMessage(table.topic("/arm/status"), encode(table.topic("/arm/status"), old), 405 * NANOSECONDS)
    message = status(state="sent", sent_s="100.00")
    words = hear(linked, feed, said(message), FeedMessage(row, encode(row, old), 300 * NANOSECONDS), now)
    assert linked.bench.scene.stamp == 405 * NANOSECONDS
    for told in ("there and back 1200.00 s", "1 waiting, 2.00 kB; 1 on its way", "/goal_pose: on its way, there in"):
        assert told in words
    assert "/drive/status, 1 min 45 s old" in words and "moving; 1 min 45 s old" in words


def test_what_is_sent_goes_over_the_link_unless_it_is_switched_off(linked: Page, feed: DeafFeed) -> None:
    bench, panel = linked.bench, panel_of(linked)
    here = Draft("drive", ((1.0, 0.0, 0.0),))
    stamp = bench.desk.send(here)
    bench.uplink.name(here.topic, stamp, here.words())
    bench.desk.ask(here)
    bench.desk.stop()
    names = [name for name, _ in feed.said]
    assert names == ["/earth/goal_pose", "/drive/question", "/earth/cmd_vel", "/earth/arm/stop"]
    assert bench.uplink.moves() == {"drive"}  # the Earth has not told of it yet
    words = hear(linked, feed, said(status(state="received", received_s="300.00", goal_stamp=str(stamp))))
    assert "drive to (1.00, 0.00): received at 300.0 s" in words and bench.uplink.moves() == {"drive"}
    hear(linked, feed, said(status(state="executed", outcome="reached", goal_stamp=str(stamp), machine_stamp="77")))
    assert not bench.uplink.moves() and bench.uplink.machine_stamp("/goal_pose", stamp) == "77"
    assert bench.uplink.machine_stamp("/waypoints", 5) == "5"  # has gone round the link
    panel._over.value = False
    panel._switched()
    bench.desk.send(here)
    assert feed.said[-1][0] == "/goal_pose"


def test_what_waits_is_taken_back_by_its_number(linked: Page, feed: DeafFeed) -> None:
    """One by one: all at once would be a stop, too, that has been sent since."""
    head, panel = linked._head[0], panel_of(linked)
    assert isinstance(head, HeadPanel)
    with pytest.raises(GoalError, match="nothing of that waits on Earth"):
        panel._taken_back()
    hear(linked, feed, said(status(state="queued", queued_s="390.00")))
    assert panel._back.visible and panel._which.handle.options == ("all", "3")
    assert panel._taken_back() == head._cancel() == "command 3 is taken back"
    assert [(name, message.frame) for name, message in feed.said] == [("/earth/cancel", "3")] * 2
    hear(linked, feed, said(status(state="sent", sent_s="399.00")))
    assert not panel._back.visible
    assert (
        head._cancel()
        == "goal of drive cancelled, over the link, which is closed: it waits on Earth; light takes 600.0 s"
    )
    assert feed.said[-1][0] == "/earth/cmd_vel"


def test_a_sequence_goes_round_the_link_and_says_so(linked: Page) -> None:
    bench, panel = linked.bench, panel_of(linked)
    sequence = next(one for one in linked._tabs if isinstance(one, SequencePanel))
    sequence._text.value = "steps:\n  - wait_s: 100.0\n"
    with pytest.raises(SequenceError, match="switch off “Over the link” in the tab Link"):
        sequence._run()
    bench.uplink.is_used = False
    assert sequence._run() == "1 steps begin"
    panel._over.value = True
    with pytest.raises(GoalError, match="a sequence is under way"):
        panel._switched()
    assert not bench.uplink.is_used


def test_without_a_link_there_is_none(world: World, feed: DeafFeed) -> None:
    page = Page(GuardedServer("none", 8880), world, feed)
    try:
        panel = next(one for one in page._tabs if isinstance(one, LinkPanel))
        page.look()
        assert not panel.topics() and "stands beside the machine" in panel._words.content
    finally:
        page.close()
