"""The tab Goals: what it tells is of the goal that is on the table, or was sent; and who may change that."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from deaf_feed import DeafFeed

from sojourn_console.control import Control
from sojourn_console.draft import Draft
from sojourn_console.feed import FeedMessage
from sojourn_console.gate import GuardedServer
from sojourn_console.goal_words import ARM, DRIVE, LOOK, ROUTE, TASK
from sojourn_console.model import COSTMAP
from sojourn_console.page import Page
from sojourn_console.panels.goals import HANDLE, GoalsPanel
from sojourn_console.panels.shared_fields import NOTICE_S
from sojourn_console.rehearsed import RECKONED, RehearsedDrive
from sojourn_console.world import World
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import NANOSECONDS

PLACE = (1.0, 0.0, 0.3)


class Client:
    """A browser that looks at the page."""

    def __init__(self, number: int) -> None:
        self.client_id = number
        self.told: list[str] = []

    def add_notification(self, title: str, words: str, **_: Any) -> None:
        self.told.append(f"{title}: {words}")


@pytest.fixture
def page(world: World, feed: DeafFeed) -> Iterator[Page]:
    page = Page(GuardedServer("goals", 8930), world, feed)
    yield page
    page.close()


@pytest.fixture
def goals(page: Page) -> GoalsPanel:
    goals = page._tabs[0]
    assert isinstance(goals, GoalsPanel)
    goals._mode.value = DRIVE
    goals._put(PLACE)
    return goals


def hear(page: Page, feed: DeafFeed, state: str, stamp: int, **values: str) -> str:
    """What the tab says once the drive has told its state with the goal of a stamp [ns]."""
    row = page.bench.world.table.topic("/drive/status")
    feed.now += NANOSECONDS
    told = {"state": state, "goal_stamp": str(stamp), "reason": "", **values}
    heard = [FeedMessage(row, encode(row, status_message(feed.now, "drive", told)), feed.now)]
    feed.poll = lambda: heard
    page.look()
    feed.poll = lambda: []
    for _ in range(6):  # of which one is shown to the panels
        page.look()
    return tab_of(page)


def tab_of(page: Page) -> str:
    goals = page._tabs[0]
    assert isinstance(goals, GoalsPanel)
    return str(goals._answer.content)


def by(client: Client | None, field: Any, value: Any) -> None:
    """A browser gives a field another value, as viser takes it; None: the program does."""
    if client is None:
        field.value = value
        return
    field._impl.value = value
    for callback in field._impl.update_cb:
        callback(SimpleNamespace(client=client, target=field))


def press(client: Client, button: Any) -> None:
    for callback in button._impl.update_cb:
        callback(SimpleNamespace(client=client, target=button))


def drag(client: Client | None, page: Page, place: tuple[float, float, float], phase: str = "update") -> Any:
    handle: Any = page.bench.server.scene.get_handle_by_name(f"{HANDLE}0")
    handle.position = place
    for callback in handle._impl_aux.update_cb:
        callback(SimpleNamespace(client=client, target=handle, phase=phase))
    return handle


def click(client: Client, goals: GoalsPanel, x: float, y: float) -> None:
    goals._clicked(SimpleNamespace(ray_origin=(x, y, 9.0), ray_direction=(0.0, 0.0, -1.0), client=client))


CHANGES: dict[str, Callable[[GoalsPanel, Page], object]] = {
    "click": lambda goals, page: click(Client(1), goals, 3.0, 2.0),
    "drag": lambda goals, page: drag(None, page, (1.5, 0.5, 0.3)),
    "undo": lambda goals, page: press(Client(1), goals._undo),
    "heading": lambda goals, page: by(Client(1), goals._heading, True),
    "mode": lambda goals, page: by(Client(1), goals._mode, ROUTE),
    "over the map": lambda goals, page: goals._change(replace(page.bench.draft, kind="route", over_map=True)),
}


@pytest.mark.parametrize("change", CHANGES)
def test_an_answer_is_of_the_goal_that_was_asked_about_alone(
    page: Page, feed: DeafFeed, goals: GoalsPanel, change: str
) -> None:
    """The figures of one place stood above Send for another."""
    ended = []
    goals._rehearser.end = lambda: ended.append(True)
    goals._ask()
    goals._rehearser.found = {RECKONED: RehearsedDrive(RECKONED, "reached", is_over=True)}
    asked = {"asked_stamp": str(feed.now), "asked_state": "allowed", "asked_length_m": "1.25"}
    words = hear(page, feed, "idle", 0, **asked)
    assert "1.25 m" in words and RECKONED in words and not ended
    drag(None, page, PLACE, phase="start")
    assert tab_of(page) == words and not ended  # nothing has moved yet
    CHANGES[change](goals, page)
    assert tab_of(page) == "" and ended
    assert hear(page, feed, "idle", 0, **asked) == ""


def test_an_answer_that_comes_after_the_goal_has_changed_is_not_shown(
    page: Page, feed: DeafFeed, goals: GoalsPanel
) -> None:
    goals._ask()
    stamp = str(feed.now)
    goals._put((3.0, 2.0, 0.3))
    assert hear(page, feed, "idle", 0, asked_stamp=stamp, asked_state="allowed", asked_length_m="1.25") == ""


def test_the_tab_tells_of_a_way_as_it_was_sent_last(page: Page, feed: DeafFeed, goals: GoalsPanel) -> None:
    """It said "stopped: a velocity command" while the rover drove on after a pause, and once it was there."""
    desk = page.bench.desk
    goals._sending()
    stamp = feed.now
    assert "moving" in hear(page, feed, "moving", stamp)
    assert desk.pause(page.bench.scene) == "drive paused"
    assert "a velocity command" in hear(page, feed, "stopped", stamp, reason="a velocity command")
    desk.resume(page.bench.scene)
    again = feed.now
    words = hear(page, feed, "moving", again)
    assert "moving" in words and "a velocity command" not in words
    assert "reached" in hear(page, feed, "reached", again)


def test_the_tab_tells_that_another_goal_has_taken_the_place(page: Page, feed: DeafFeed, goals: GoalsPanel) -> None:
    goals._sending()
    stamp = feed.now
    assert "nothing is told of it yet" in hear(page, feed, "moving", 3)
    words = hear(page, feed, "moving", stamp)
    assert hear(page, feed, "refused", stamp + 1) == words  # of another, and ours goes on
    words = hear(page, feed, "moving", 0)
    assert "another goal has taken its place" in words and "moving" not in words


def test_a_goal_that_was_refused_has_its_reason_still_while_the_one_before_goes_on(
    page: Page, feed: DeafFeed, goals: GoalsPanel
) -> None:
    goals._sending()
    words = hear(page, feed, "refused", feed.now, reason="too steep")
    assert "too steep" in words and hear(page, feed, "moving", 3) == words


def test_no_page_changes_the_goal_of_the_one_that_has_the_control(
    page: Page, feed: DeafFeed, goals: GoalsPanel
) -> None:
    """A click of a page that looked on was the goal that the other one sent."""
    holder, other = Client(1), Client(2)
    page.bench.control = Control(1)
    before = page.bench.draft
    for field, value in (
        (goals._mode, ROUTE), (goals._heading, True), (goals._yaw, 45.0), (goals._values, "depth=1"),
    ):  # fmt: skip
        was = field.value
        by(other, field, value)
        assert field.value == was and page.bench.draft == before
    click(other, goals, 3.0, 2.0)
    press(other, goals._undo)
    press(other, goals._over)
    handle = drag(other, page, (2.0, 2.0, 0.3))
    assert page.bench.draft == before and tuple(handle.position) == before.points[0]
    assert other.told == ["Not done: control: page 1 has it: press “Take control” to command from here"]
    page.bench.commanding(holder, goals._sending)
    assert feed.said[-1][1].position.tolist() == list(PLACE)
    assert holder.told == ["Done: drive to a place: sent, drive to (1.00, 0.00)"]


def test_a_page_changes_the_goal_while_it_or_nobody_has_the_control(page: Page, goals: GoalsPanel) -> None:
    client = Client(2)
    click(client, goals, 3.0, 2.0)
    assert page.bench.draft.points[0][:2] == pytest.approx((3.0, 2.0))
    page.bench.control = Control(2)
    drag(client, page, (2.0, 1.0, 0.3))
    assert page.bench.draft.points[0][:2] == (2.0, 1.0)
    by(client, goals._mode, ROUTE)
    assert page.bench.draft.kind == "route" and not client.told
    page.bench.control = Control(1)
    by(None, goals._mode, DRIVE)  # what the program sets is of no page
    assert page.bench.draft.kind == "drive"
    by(client, goals._mode, ROUTE)
    assert goals._mode.value == DRIVE and page.bench.draft.kind == "drive"


def test_the_line_of_a_way_goes_through_a_point_that_was_dragged(page: Page, goals: GoalsPanel) -> None:
    """It stayed where it had been, past a rock that the way was dragged away from."""
    by(None, goals._mode, ROUTE)
    for place in ((1.0, 0.0, 0.3), (2.0, 0.0, 0.3)):
        goals._put(place)
    drag(None, page, (1.0, 2.0, 0.3))
    points = goals._line._handle.points[:, :, :2].reshape(-1, 2)
    assert np.abs(points - (1.0, 2.0)).max(axis=1).min() < 1e-6
    assert np.abs(points - (1.0, 0.0)).max(axis=1).min() > 0.5


def test_what_the_drive_found_closed_is_heard_for_ways(page: Page, feed: DeafFeed, goals: GoalsPanel) -> None:
    """A route over the map knew nothing of it unless the layer was shown."""
    heard: list[set[str]] = []
    feed.want = lambda looked_at, in_full: heard.append({*looked_at, *in_full})
    for mode, is_heard in ((DRIVE, True), (ROUTE, True), (LOOK, False)):
        by(None, goals._mode, mode)
        page.look()
        assert (COSTMAP in heard[-1]) is is_heard
    by(None, goals._mode, ROUTE)
    goals._put((2.0, 0.0, 0.3))
    goals._change(replace(page.bench.draft, over_map=True))
    goals._sending()
    by(None, goals._mode, LOOK)
    page.look()
    assert COSTMAP in heard[-1]


def test_a_page_is_told_again_after_a_while(page: Page, goals: GoalsPanel, monkeypatch: pytest.MonkeyPatch) -> None:
    other, now = Client(2), [100.0]
    clock = SimpleNamespace(monotonic=lambda: now[0])
    monkeypatch.setattr("sojourn_console.panels.shared_fields.time", clock)
    page.bench.control = Control(1)
    for passed in (0.0, 1.0, NOTICE_S):
        now[0] += passed
        click(other, goals, 3.0, 2.0)
    assert len(other.told) == 2
    goals._mode.value = LOOK
    now[0] += 2.0 * NOTICE_S
    click(other, goals, 3.0, 2.0)
    assert len(other.told) == 2  # a click that is to do nothing


def test_the_heading_that_is_shown_is_sent(page: Page, goals: GoalsPanel) -> None:
    """Another mode left the box ticked and the goal without its heading."""
    goals._heading.value, goals._yaw.value = True, 90.0
    goals._mode.value = ROUTE
    goals._put(PLACE)
    assert page.bench.draft.yaw == pytest.approx(math.pi / 2)
    for mode in (LOOK, ARM, TASK):
        if mode in goals._mode.options:
            goals._mode.value = mode
            assert page.bench.draft.yaw is None
    goals._mode.value = DRIVE
    assert page.bench.draft.yaw == pytest.approx(math.pi / 2)


def test_a_way_over_the_map_is_one_with_another_heading(page: Page, goals: GoalsPanel) -> None:
    goals._change(Draft("route", (PLACE, (2.0, 0.0, 0.3)), over_map=True))
    goals._heading.value = True
    assert page.bench.draft.over_map and page.bench.draft.yaw == 0.0
