"""What is chosen among things that go by themselves."""

from collections.abc import Iterator

import pytest
from deaf_feed import DeafFeed

from sojourn_console.alarm_board import AlarmBoard
from sojourn_console.errors import AlarmError
from sojourn_console.gate import GuardedServer
from sojourn_console.page import Page
from sojourn_console.panels.alarms import AlarmsPanel
from sojourn_console.panels.choice import ALL, Choice
from sojourn_console.world import World
from sojourn_operator.alarms.engine import Alarm
from sojourn_operator.alarms.params import Severity


@pytest.fixture
def server() -> Iterator[GuardedServer]:
    server = GuardedServer("choice", 9160)
    yield server
    server.stop()


def test_what_has_gone_stays_chosen_until_another_is(server: GuardedServer) -> None:
    choice = Choice(server.gui, "Which")
    assert choice.chosen == ""
    choice.offer(["a", "b"])
    choice.handle.value = "a"
    for there, options in ((["b"], (ALL, "b", "a")), (["c"], (ALL, "c", "a")), (["a", "c"], (ALL, "a", "c"))):
        choice.offer(there)
        assert choice.chosen == "a" and tuple(choice.handle.options) == options
    choice.handle.value = "c"
    choice.offer(["c"])
    assert choice.chosen == "c" and tuple(choice.handle.options) == (ALL, "c")
    choice.handle.value = ALL
    choice.offer([])
    assert choice.chosen == "" and tuple(choice.handle.options) == (ALL,)


def test_a_second_click_acknowledges_nothing_else(
    world: World, feed: DeafFeed, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The list fell to "all" by itself when the alarm that was chosen had gone."""
    page = Page(GuardedServer("choice of alarms", 9165), world, feed)
    try:
        (panel,) = (one for one in page._tabs if isinstance(one, AlarmsPanel))
        slip, tilt = Alarm("slip", ""), Alarm("tilt", "", worst=Severity.CRITICAL)
        monkeypatch.setattr(AlarmBoard, "open", [slip, tilt])
        panel.show(page.bench.scene)
        panel._which.handle.value = "slip"
        monkeypatch.setattr(AlarmBoard, "open", [tilt])
        panel.show(page.bench.scene)
        with pytest.raises(AlarmError, match="slip: allowed is tilt"):
            panel._acknowledged()
    finally:
        page.close()
