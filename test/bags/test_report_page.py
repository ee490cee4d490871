"""The page of a bag: what it says is what happened, it needs nothing beside itself, and nothing missing stops it."""

import math
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer
from nav_msgs.msg import Odometry
from synthetic import PERIOD, SyntheticRun, cdr
from test_run_summary import make_run

from sojourn_bags.completeness import RECORD, account
from sojourn_bags.definitions import definition
from sojourn_bags.machine import euler_angles
from sojourn_bags.page.chart import LEFT, RIGHT, ChartLine, Span, TimeAxis, chart, strips, ticks
from sojourn_bags.page.page import write_page
from sojourn_bags.page.story import Story
from sojourn_bags.reading import read_bag
from sojourn_contract.heartbeat import Counters, heartbeat_message, status_message
from sojourn_contract.topics import TOPICS, topic


class Page(HTMLParser):
    """A page as its words and its links; a tag that is not closed as it should be is an error."""

    EMPTY = frozenset({"meta", "img"})

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.words: list[str] = []
        self.sources: list[str] = []
        self._open: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))
        assert not self._open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.sources += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in self.EMPTY:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self._open and self._open[-1] not in ("style", "script"):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(self.words)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Bag of the made-up run of the summary's test."""
    return make_run(tmp_path_factory.mktemp("page") / "bag")


def test_page_of_a_run(run: Path, tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    story = write_page(read_bag(run), page, judged=False)
    found = Page(page)
    assert story.summary is not None and "PASSED" in found.text and story.summary["verdict"] in found.text
    for title in ("Goals", "Map", "Wheels", "Power and charge", "Arm", "Diagnostics", "Contract", "Completeness"):
        assert title in found.text
    assert "drive along 2 points" in found.text and "Commanded less" not in found.text  # no /arm_command in this bag
    assert "Sinkage of each wheel" in found.text and "No wheel has turned" in found.text
    assert "Not judged by the contract: it was not asked for." in found.text
    assert all(source.startswith(("data:image/", "#")) for source in found.sources)
    assert page.stat().st_size < 3e6


def test_violations_are_told(run: Path, tmp_path: Path) -> None:
    page = tmp_path / "report.html"
    story = write_page(read_bag(run), page)
    assert story.judgement is not None and story.judgement.violations  # the made-up run lacks most of the contract
    assert f"{story.judgement.violations} violations of the contract" in Page(page).text


def test_refusals_stalls_and_texts_of_nodes(tmp_path: Path) -> None:
    run = SyntheticRun(tmp_path / "bag", "flat_drive")
    counters = Counters()
    for period in range(1, 201):
        stamp = period * PERIOD
        run.truth(stamp, (0.0, 0.0, 0.4, 0.0), {"wheel_front_left_joint": 0.0}, 0.0)
        if period == 100:
            counters.count_refused("/drive_command", "velocity = nan: <b>allowed</b> is a number")
        if period % 50 == 0 and period != 150:
            run.write("/diagnostics", stamp, heartbeat_message("plant", "running", stamp, counters))
        if period in (50, 150):
            off = "off" if period == 150 else "on"
            run.write("/power/switches", stamp, status_message(stamp, "switches", {"arm": off, "drive": "0.5"}))
    run.close(200 * PERIOD)
    page = tmp_path / "report.html"
    write_page(read_bag(tmp_path / "bag"), page, judged=False)
    text = Page(page).text
    assert "1 of /drive_command" in text and "velocity = nan: <b>allowed</b> is a number" in text
    assert "2.00" in text  # the longest gap between heartbeats [s]
    assert "off, 3.00 to 4.00 s" in text and "50 %, 1.00 to 4.00 s" in text
    assert "the arm was not asked to move" in text.lower() or "tells of no arm" in text


def test_gaps_of_the_recorders_account_are_told(tmp_path: Path) -> None:
    """Also of a topic that lacks what lock-step asks for, though nobody counts it as published."""
    run = SyntheticRun(tmp_path / "bag", "flat_drive")
    run.truth(PERIOD, (0.0, 0.0, 0.4, 0.0), {"wheel_front_left_joint": 0.0}, 0.0)
    recorded = run.writer.recorded()
    account_of_run = account(TOPICS, recorded, {"/truth/odom": 4}, 2 * PERIOD, [topic("/imu/data")])
    run.writer.close({RECORD: account_of_run.as_record()})
    write_page(read_bag(tmp_path / "bag"), tmp_path / "report.html", judged=False)
    text = Page(tmp_path / "report.html").text
    assert "RECORD NOT COMPLETE" in text or "FAILED" in text
    assert "/truth/odom: 1 recorded of 4 published" in text
    assert "/imu/data: 0 recorded of an unknown number published, 2 due" in text


def test_margin_is_that_of_the_machine_by_hand(tmp_path: Path) -> None:
    """Wheels on a level plane at the corners of a known rectangle; the centre of mass as Pinocchio has it."""
    run = SyntheticRun(tmp_path / "bag", "flat_drive")
    wheels = run.run.machine.wheels
    points = np.zeros((len(wheels), 11))
    points[:, 0] = [1.0, 1.0, 0.0, 0.0, -1.0, -1.0]
    points[:, 1] = [0.6, -0.6] * 3
    points[:, 8] = 50.0
    run.truth(PERIOD, (0.0, 0.0, 0.5, 0.0), {wheel.joint: 0.0 for wheel in wheels}, 0.0)
    run.contacts(PERIOD, points)
    run.close(PERIOD)
    story = Story(read_bag(tmp_path / "bag"))
    assert story.machine is not None and story.margin is not None
    x, y, z = story.machine.centres_of_mass(np.array([PERIOD * 1e-9]))[0]
    expected = min(math.atan2(0.6 - abs(y), z), math.atan2(1.0 - abs(x), z))
    assert story.margin.values[0] == pytest.approx(expected, abs=1e-6)
    assert 0.3 < z < 0.7 and abs(x) < 0.3 and abs(y) < 0.1


@pytest.mark.parametrize("share", [0.3, 0.6, 0.97])
def test_page_of_a_bag_that_is_cut_off(run: Path, share: float, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    data = run.read_bytes()
    cut.write_bytes(data[: int(share * len(data))])
    page = tmp_path / "report.html"
    write_page(read_bag(cut), page)
    text = Page(page).text
    assert "cut off or damaged" in text
    assert "PASSED" not in text


def test_page_of_another_robots_bag(tmp_path: Path) -> None:
    """Its odometry is drawn, on the time of its wall clock; the rest is said to be missing."""
    path = tmp_path / "theirs.mcap"
    begin = 1_700_000_000
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="theirs")
        kind = "nav_msgs/msg/Odometry"
        channel = writer.register_channel(
            "/wheel_odom", "cdr", writer.register_schema(kind, "ros2msg", definition(kind).encode())
        )
        other = writer.register_channel("/odom", "cdr", writer.register_schema("theirs/msg/Odom", "", b"?"))
        for number in range(20):
            message = Odometry()
            message.header.stamp.sec = begin + number
            message.pose.pose.position.x = float(number)
            message.pose.pose.orientation.w = 1.0
            writer.add_message(channel, (begin + number) * 10**9, cdr(message), (begin + number) * 10**9)
            writer.add_message(other, (begin + number) * 10**9, b"\0\1\0\0?", 0)
        writer.finish()
    page = tmp_path / "report.html"
    story = write_page(read_bag(path), page)
    text = Page(page).text
    assert story.summary is None and "No verdict" in text and "/wheel_odom" in text
    assert "no heartbeats on /diagnostics" in text and "Not judged by the contract" in text
    assert story.axis.begin == 0.0 and story.axis.end == pytest.approx(19.0)


def test_empty_bag_has_a_page(tmp_path: Path) -> None:
    path = tmp_path / "empty.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="theirs")
        writer.finish()
    write_page(read_bag(path), tmp_path / "report.html")
    assert "No verdict" in Page(tmp_path / "report.html").text


def test_curves_are_where_their_values_are() -> None:
    axis = TimeAxis(0.0, 10.0, (Span(2.0, 4.0, "#0072b2", "a goal"),))
    times = np.array([0.0, 5.0, 6.0, 10.0])
    drawn = chart(axis, [ChartLine(times, np.array([0.0, 10.0, np.nan, 5.0]), "speed & more")], "speed [m/s]")
    path = re.search(r'<path class="curve"[^>]* d="(M[^"]+L[^"]+)"', drawn)
    assert path is not None
    points = [tuple(map(float, point.split())) for point in re.findall(r"[ML]([\d.]+ [\d.]+)", path[1])]
    assert [x for x, _ in points] == [LEFT, 0.5 * (LEFT + RIGHT), RIGHT]
    low, high, half = (y for _, y in points)
    assert low > half > high and half == pytest.approx(0.5 * (low + high), abs=0.11)
    assert path[1].count("M") == 2  # the gap is left open
    assert "speed &amp; more" in drawn and drawn.count('class="shade"') == 1


def test_every_peak_of_a_long_curve_is_drawn() -> None:
    times = np.arange(100_000) / 100.0
    values = np.zeros_like(times)
    values[54_321] = 7.0
    drawn = chart(TimeAxis(0.0, 1000.0), [ChartLine(times, values, "force")], "force [N]")
    heights = [float(y) for y in re.findall(r"[ML][\d.]+ ([\d.]+)", drawn[drawn.index('class="band"') :])]
    assert max(heights) - min(heights) > 120.0
    assert len(drawn) < 40_000


def test_ticks_are_round_and_strips_name_their_stretches() -> None:
    assert ticks(0.0, 1.0, 5) == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    assert ticks(-0.013, 0.031, 5) == pytest.approx([-0.01, 0.0, 0.01, 0.02, 0.03])
    assert ticks(209.7, 210.2, 5) == pytest.approx([209.7, 209.8, 209.9, 210.0, 210.1, 210.2])
    drawn = strips(TimeAxis(0.0, 10.0), [("arm", [Span(0.0, 5.0, "#333333", "off")])], "switching")
    assert "<title>off, 0.00 to 5.00 s</title>" in drawn and "arm" in drawn


def test_euler_angles_against_the_rotation_matrix() -> None:
    random = np.random.default_rng(4)
    angles = random.uniform([-3.0, -1.5, -3.0], [3.0, 1.5, 3.0], (50, 3))
    half = 0.5 * angles
    (cr, cp, cy), (sr, sp, sy) = np.cos(half).T, np.sin(half).T
    quaternions = np.stack([sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                            cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy], axis=1)  # fmt: skip
    found = euler_angles(quaternions)
    np.testing.assert_allclose(found[:, :2], angles[:, :2], atol=1e-9)
    np.testing.assert_allclose(np.remainder(found[:, 2] - angles[:, 2] + 1.0, 2.0 * np.pi), 1.0, atol=1e-9)
