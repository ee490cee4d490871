"""The console beside a run changes nothing of it; and as its user has it, in a browser."""

import io
import re
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect, sync_playwright
from programs import PATIENT, SHORT_RUN, Program
from verdicts import require_same

from sojourn_bags.reading import read_bag
from sojourn_console.feed import FeedMessage
from sojourn_console.gate import GuardedServer
from sojourn_console.page import SLOW
from sojourn_console.page import Page as ConsolePage
from sojourn_console.world import world_of_bag
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_message
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.params import Severity

sys.path.insert(0, str(Path(__file__).parents[1] / "console"))

from deaf_feed import DeafFeed

REFERENCE = Path(__file__).parents[1] / "replay" / "short_goals"
CHROMIUM = next(
    (path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), ""
)
MOVING_IS_CRITICAL = "alarms:\n  under_way: {field: /drive/status.state, critical: {equals: moving}}\n"
SCROLLED_DOWN = """() => [...document.querySelectorAll("*")].filter(one => {
    if (/auto|scroll/.test(getComputedStyle(one).overflowY)) one.scrollTop = one.scrollHeight;
    return one.scrollTop > 0;
}).length"""
"""Scrolls whatever scrolls to its end: how many do."""
ON_TOP = """one => {
    const {left, top, width, height} = one.getBoundingClientRect();
    const there = document.elementFromPoint(left + width / 2, top + height / 2);
    return there !== null && one.contains(there);
}"""
"""Whether an element is what lies at its own middle; outside the window nothing does."""
LONGEST_MS = 300_000.0
"""For what a busy machine has to draw without a graphics card."""
WITHOUT_GRAPHICS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
in_a_browser = pytest.mark.skipif(not CHROMIUM, reason="no Chromium on this machine: sudo apt install chromium")


@pytest.fixture
def browser_page() -> Iterator[Page]:
    """A page of a small window: without a graphics card every pixel costs."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(WITHOUT_GRAPHICS))
        page = browser.new_page(viewport={"width": 640, "height": 420}, device_scale_factor=0.5)
        page.set_default_timeout(LONGEST_MS)
        expect.set_options(timeout=LONGEST_MS)
        yield page
        browser.close()


@pytest.fixture
def long_page(tmp_path: Path) -> Iterator[ConsolePage]:
    """A page with a long log, and a critical alarm that nobody has acknowledged."""
    world = world_of_bag(read_bag(REFERENCE))
    limits = tmp_path / "limits.yaml"
    limits.write_text(MOVING_IS_CRITICAL)
    page = ConsolePage(GuardedServer("long", 8990), world, DeafFeed(), limits)
    row = world.table.topic("/drive/status")
    moving = encode(row, status_message(1, "drive", {"state": "moving", "goal_stamp": "1"}))
    page.bench.alarms.hear([FeedMessage(row, moving, 1)])
    page.bench.alarms.log += [Event(at, "drive", "goal", Severity.NONE, "a goal of many words") for at in range(60)]
    for _ in range(SLOW):
        page.look()
    yield page
    page.close()


def told(program: Program, words: str) -> str:
    """What a program has printed behind some words, once it has."""
    end = time.monotonic() + LONGEST_MS * 1e-3
    while time.monotonic() < end:
        found = re.search(re.escape(words) + r"(.*)", program.text)
        if found:
            return found[1].strip()
        assert program.process.poll() is None, program.text
        time.sleep(0.1)
    pytest.fail(f"never said: {words}\n{program.text}")


def scenery(page: Page) -> np.ndarray:
    """What is seen left of the panel, rows, columns and colours."""
    data = page.screenshot(clip={"x": 0, "y": 0, "width": 300, "height": 420}, timeout=LONGEST_MS)
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), dtype=float)


def wait_for(is_so: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + LONGEST_MS * 1e-3
    while not is_so():
        assert time.monotonic() < end, what
        time.sleep(0.5)


def press(page: Page, name: str) -> None:
    """Press a button; the event itself, for a click waits until two pictures in a row have been drawn."""
    page.get_by_role("button", name=name, exact=True).dispatch_event("click")


def open_tab(page: Page, name: str) -> None:
    """By the keyboard: a tab takes no click that was not pressed before."""
    page.get_by_role("tab", name=name).focus()
    page.keyboard.press("Enter")


def hide_shadow(page: Page) -> None:
    """Several times as many pictures are drawn without it."""
    open_tab(page, "Scene")
    box = page.get_by_role("checkbox", name="shadow of the machine")
    box.dispatch_event("click")
    expect(box).not_to_be_checked()
    open_tab(page, "Goals")


def click_until(page: Page, words: str) -> None:
    """Click on the ground until the page says so: of a busy page's clicks one or another is taken for a look around."""
    end = time.monotonic() + LONGEST_MS * 1e-3
    while not page.get_by_text(words).is_visible():
        assert time.monotonic() < end, f"no click led to: {words}"
        page.mouse.click(290.0, 215.0)
        page.wait_for_timeout(3000.0)


def choose(page: Page, box: str, option: str) -> None:
    page.get_by_role("combobox", name=box).dispatch_event("click")
    page.get_by_role("option", name=option, exact=True).dispatch_event("click")


def test_a_run_with_a_console_is_the_run_without(tmp_path: Path, start: Callable[..., Program], domain: int) -> None:
    """It is there before the run begins, and hears it from then on."""
    console = start("console", SHORT_RUN, "--domain", domain)
    told(console, "the console is at")
    looked_at = start("start", SHORT_RUN, *PATIENT, "--domain", domain, "--run-dir", tmp_path / "looked_at")
    assert looked_at.wait() == 0, looked_at.text
    assert float(told(console, "the run is heard, from").split()[0]) < 5.0
    alone = start("start", SHORT_RUN, *PATIENT, "--composed", "--domain", domain, "--run-dir", tmp_path / "alone")
    assert alone.wait() == 0, alone.text
    runs = [read_bag(tmp_path / name) for name in ("looked_at", "alone")]
    require_same(runs[0], runs[1])


@in_a_browser
def test_a_bag_is_played_in_the_browser(start: Callable[..., Program], browser_page: Page) -> None:
    page = browser_page
    console = start("console", "--bag", REFERENCE)
    address = told(console, "the console is at")
    refused = page.goto(address[:-3] + "/")
    assert refused is not None and refused.status == 403
    page.goto(address)
    expect(page.get_by_text("explorer", exact=True)).to_be_visible()
    expect(page.get_by_role("button", name="STOP", exact=True)).to_have_count(0)
    end = max(messages.log_times[-1] for messages in read_bag(REFERENCE).topics.values()) * 1e-9
    expect(page.get_by_text(f"{end:.1f} s", exact=True)).to_be_visible()
    wait_for(lambda: scenery(page).mean() > 40.0, "the ground is not drawn")
    before = scenery(page)
    choose(page, "Speed", "1/4×")
    page.get_by_text("▶ / ❚❚").dispatch_event("click")  # at its end: from the beginning
    wait_for(lambda: bool((np.abs(scenery(page) - before).max(axis=2) > 30.0).mean() > 0.002), "nothing moves")
    open_tab(page, "Telemetry")
    expect(page.get_by_role("combobox", name="Field")).to_have_value("pose.pose.position.x")
    page.get_by_text("Plot", exact=True).first.dispatch_event("click")
    expect(page.locator("canvas").nth(1)).to_be_attached()
    expect(page.get_by_text("/odom.pose.pose.position.x [m]")).to_be_attached()


@in_a_browser
@pytest.mark.parametrize(("width", "height"), [(1024, 700), (390, 800)])
def test_what_stops_it_is_in_sight_wherever_the_page_is_scrolled(
    long_page: ConsolePage, browser_page: Page, width: int, height: int
) -> None:
    page, feed = browser_page, long_page.bench.feed
    assert isinstance(feed, DeafFeed)
    page.set_viewport_size({"width": width, "height": height})
    page.goto(long_page.bench.server.address)
    expect(page.get_by_text("CRITICAL").first).to_be_visible()
    open_tab(page, "Alarms")
    wait_for(lambda: page.evaluate(SCROLLED_DOWN) > 0, "nothing scrolls")
    names = ("STOP", "Pause", "Resume", "Cancel")
    buttons = {name: page.get_by_role("button", name=name, exact=True) for name in names}
    for name, one in (buttons | {"band": page.get_by_text("CRITICAL").first}).items():
        assert one.evaluate(ON_TOP), name
    box = buttons["STOP"].bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    wait_for(lambda: "/cmd_vel" in [name for name, _ in feed.said], "STOP was not pressed")


@in_a_browser
def test_a_telephone_has_the_panel_over_its_whole_width(long_page: ConsolePage, browser_page: Page) -> None:
    page = browser_page
    page.set_viewport_size({"width": 390, "height": 800})
    page.goto(long_page.bench.server.address)
    box = page.get_by_role("button", name="STOP", exact=True).bounding_box()
    assert box is not None and box["width"] > 0.9 * 390


@in_a_browser
def test_a_goal_is_clicked_foreseen_sent_and_reached(
    tmp_path: Path, start: Callable[..., Program], domain: int, browser_page: Page
) -> None:
    page = browser_page
    waiting = ("--set", "steps=[]", "--set", "duration_limit_s=3600", "--realtime", "--composed", "--console")
    run = start("start", SHORT_RUN, *PATIENT, *waiting, "--domain", domain, "--run-dir", tmp_path / "run")
    page.goto(told(run, "the console is at"))
    told(run, "the run is heard")
    expect(page.get_by_text("idle").first).to_be_visible()
    wait_for(lambda: scenery(page).mean() > 40.0, "the ground is not drawn")
    hide_shadow(page)
    choose(page, "A click is", "drive to a place")
    expect(page.get_by_text("Click on the ground.")).to_be_visible()
    click_until(page, "Drag to move")
    press(page, "Rehearse")
    expect(page.get_by_text("allowed")).to_be_attached()
    expect(page.get_by_text(re.compile(r"^\d+\.\d\d Wh$")).first).to_be_attached()  # reckoned; soon simulated as well
    press(page, "Send")
    expect(page.get_by_text("drive to a place: sent")).to_be_attached()
    expect(page.get_by_text("moving").first).to_be_attached()
    press(page, "STOP")
    expect(page.get_by_text("stopped").first).to_be_attached()
    press(page, "Send")
    expect(page.get_by_text("reached").first).to_be_attached()
    run.send(signal.SIGINT)
    assert run.wait() == 0
    assert not run.leaves_processes()
    goals = read_bag(tmp_path / "run")["/goal_pose"]
    assert len(goals) == 2


@in_a_browser
def test_a_sequence_runs_and_an_alarm_is_acknowledged(
    tmp_path: Path, start: Callable[..., Program], domain: int, browser_page: Page
) -> None:
    page = browser_page
    limits = tmp_path / "limits.yaml"
    limits.write_text(MOVING_IS_CRITICAL)
    waiting = ("--set", "steps=[]", "--set", "duration_limit_s=3600", "--realtime", "--composed")
    run = start("start", SHORT_RUN, *PATIENT, *waiting, "--domain", domain, "--run-dir", tmp_path / "run")
    console = start("console", SHORT_RUN, "--domain", domain, "--limits", limits, "--who", "Ada")
    page.goto(told(console, "the console is at"))
    told(console, "the run is heard")
    open_tab(page, "Sequence")
    steps = page.locator("textarea").first
    steps.fill("steps:\n  - drive_to: {x: 0.15, speed: 3}\n")
    press(page, "Run")
    expect(page.get_by_text(re.compile(r"sequence:2: steps\[0\].drive_to.speed")).first).to_be_attached()
    file = tmp_path / "two.yaml"
    file.write_text(
        "steps:\n  - wait_s: 0.2\n  - drive_to: {x: 0.12, y: 0.0}\n    when: /battery_state.percentage > 0.4\n"
    )
    page.locator("input[type=file]").first.set_input_files(file)
    expect(page.get_by_text("2 steps, nothing wrong").first).to_be_attached()
    press(page, "Run")
    expect(page.get_by_text(re.compile(r"✓ sequence: drive to \(0.12, 0.00\): reached"))).to_be_attached()
    expect(page.get_by_text("CRITICAL").first).to_be_visible()  # the band, whatever tab is open
    open_tab(page, "Alarms")
    expect(page.get_by_text(re.compile("over, not acknowledged")).first).to_be_attached()
    press(page, "Acknowledge")
    expect(page.get_by_text("acknowledged critical under_way")).to_be_attached()
    expect(page.locator("b", has_text=re.compile("^under_way$"))).to_have_count(0)
    run.send(signal.SIGINT)
    assert run.wait() == 0
    assert len(read_bag(tmp_path / "run")["/goal_pose"]) == 1


@in_a_browser
def test_a_goal_goes_over_the_link_and_its_way_is_told(
    tmp_path: Path, start: Callable[..., Program], domain: int, browser_page: Page
) -> None:
    """Out of a window it waits, and is taken back; round the link it is carried out at once."""
    page = browser_page
    link = "link={light_time_s: 3.0, windows: [{kind: times, from_s: 3000.0, to_s: 3100.0}]}"
    sets = ("--set", link, "--set", "waypoints={near: {x: 0.12, y: 0.0}}", "--set", "steps=[]")
    waiting = (*sets, "--set", "duration_limit_s=3600", "--realtime", "--composed", "--console")
    run = start("start", SHORT_RUN, *PATIENT, *waiting, "--domain", domain, "--run-dir", tmp_path / "run")
    page.goto(told(run, "the console is at"))
    told(run, "the run is heard")
    expect(page.get_by_text("idle").first).to_be_visible()
    open_tab(page, "Link")
    expect(page.get_by_text("none yet")).to_be_attached()  # before the link has told of itself, its window is not known
    open_tab(page, "Goals")
    choose(page, "A click is", "drive to a place")
    choose(page, "Waypoint", "near")
    expect(page.get_by_text("Drag to move")).to_be_attached()
    press(page, "Send")
    expect(page.get_by_text("over the link, which is closed: it waits on Earth")).to_be_attached()
    expect(page.get_by_text(re.compile("^waits on Earth since"))).to_be_attached()  # in the tab Goals
    open_tab(page, "Link")
    expect(page.get_by_text(re.compile("^closed, opens in .* at 3000 s"))).to_be_attached()
    expect(page.get_by_text(re.compile(r"^drive to \(0.12, 0.00\): waits on Earth"))).to_be_attached()
    press(page, "Take back")
    expect(page.get_by_text("cancelled (before it was sent)").first).to_be_attached()
    page.get_by_role("checkbox", name="Over the link").dispatch_event("click")
    expect(page.get_by_text("round the link, at once")).to_be_attached()
    open_tab(page, "Goals")
    press(page, "Send")
    expect(page.get_by_text("reached").first).to_be_attached()
    run.send(signal.SIGINT)
    assert run.wait() == 130  # the operator's role, which carries the link, would have waited on
    bag = read_bag(tmp_path / "run")
    assert len(bag["/earth/goal_pose"]) == len(bag["/earth/cancel"]) == len(bag["/goal_pose"]) == 1
