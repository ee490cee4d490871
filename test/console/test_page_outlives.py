"""What cannot be read or drawn is left out and told; the page, and the sequence that it carries out, go on."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from told_feed import ToldFeed, head_of, show

from sojourn_bags.reading import read_bag
from sojourn_console.failures import STAYS_S
from sojourn_console.feed import FeedMessage
from sojourn_console.gate import GuardedServer
from sojourn_console.machine_shape import MachineShape
from sojourn_console.model import RunScene, after_all
from sojourn_console.page import Page
from sojourn_console.panels.head import HeadPanel
from sojourn_console.panels.scene_panel import ScenePanel
from sojourn_console.views.sensor_views import LINK_TO_OPTICAL, CameraView, pixels, quaternion
from sojourn_console.views.way_view import UncertaintyView
from sojourn_console.world import World, world_of_bag
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import BatteryState, Image

SEEING = Path(__file__).parents[1] / "replay" / "themes" / "sight"
CAMERA = "/navcam/left/image"


@pytest.fixture(scope="module")
def seeing() -> World:
    """Of a machine with cameras."""
    return world_of_bag(read_bag(SEEING))


@pytest.fixture
def page(world: World) -> Iterator[Page]:
    page = Page(GuardedServer("outlives", 9040), world, ToldFeed(world.table))
    yield page
    page.close()


def told(page: Page) -> ToldFeed:
    feed = page.bench.feed
    assert isinstance(feed, ToldFeed)
    return feed


def test_a_camera_that_turns_about_its_own_place_is_drawn_as_it_looks(
    seeing: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was drawn as it had looked before: its turn was sent with a new place alone."""
    server = GuardedServer("looks", 9060)
    try:
        view = CameraView(server, seeing)
        for turn in (np.eye(3), np.diag([-1.0, -1.0, 1.0])):
            monkeypatch.setattr(MachineShape, "link", lambda *_, turn=turn: (np.ones(3), turn))
            view.show(RunScene())
            for frustum in view._frustums.values():
                assert np.allclose(frustum.wxyz, quaternion(turn @ LINK_TO_OPTICAL), atol=1e-4)
        assert view._frustums
    finally:
        server.stop()


def image(encoding: str, width: int, step: int, data: bytes, is_bigendian: int = 0) -> Image:
    return Image(1, "camera", len(data) // step, width, encoding, step, data, is_bigendian)


def seen(world: World, message: Image) -> RunScene:
    row = world.table.topic(CAMERA)
    return after_all(RunScene(), [FeedMessage(row, encode(row, message), message.stamp)])


def test_a_word_in_place_of_a_number_is_shown_as_it_came(page: Page) -> None:
    """A drive of somebody else said "n/a", and the console ended."""
    for word, shown in (("n/a", "n/a to go"), ("nan", "nan to go"), ("3.2", "3.20 m to go")):
        values = {"state": "moving", "distance_to_go": word, "goal_stamp": "1"}
        told(page).tell("/drive/status", status_message(3, "drive", values))
        show(page)
        assert shown in head_of(page)._words.content
        assert not page.bench.failures.words()


@pytest.mark.parametrize("part", [HeadPanel, ScenePanel, UncertaintyView])
def test_a_part_that_fails_is_named_and_nothing_else_ends(
    world: World, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], part: type
) -> None:
    def fail(*_: object) -> None:
        raise ValueError("a word that nobody knows")

    monkeypatch.setattr(part, "show", fail)
    page = Page(GuardedServer("fails", 9050), world, ToldFeed(world.table))
    board = page.bench.sequences
    try:
        board.begin("steps:\n  - drive_to: {x: 2.0, y: 0.5}\n")
        show(page)
        show(page)
        assert [name for name, _ in told(page).said] == ["/goal_pose"]  # its first step has begun
        (words,) = page.bench.failures.words()
        assert words.endswith("fails: ValueError: a word that nobody knows")
        if part is not HeadPanel:
            assert words in head_of(page)._note.content
        if part is UncertaintyView:
            assert UncertaintyView.title in words
        assert capsys.readouterr().err.count("Traceback") == 1  # though it fails with every look
    finally:
        page.close()


def test_a_state_that_cannot_be_told_leaves_the_notes(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> str:
        raise ValueError("a word that nobody knows")

    monkeypatch.setattr("sojourn_console.panels.head.head_html", fail)
    show(page)
    assert "the state of the run fails: ValueError: a word that nobody knows" in head_of(page)._note.content


def test_a_failure_is_told_for_some_time_after_it_is_over(page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("sojourn_console.failures.time.monotonic", lambda: now[0])
    failures = page.bench.failures
    with failures.of("the view cameras"):
        raise ValueError("no image")
    now[0] += 0.9 * STAYS_S
    assert failures.words() == ["the view cameras fails: ValueError: no image"]
    now[0] += 0.2 * STAYS_S
    assert not failures.words()
    with pytest.raises(KeyboardInterrupt), failures.of("the view cameras"):
        raise KeyboardInterrupt


@pytest.mark.parametrize(
    "wrong",
    [
        image("mono8", 10, 10, bytes(30))._replace(height=4),  # cut off
        image("mono8", 10, 5, bytes(40)),  # rows shorter than they are wide
        image("32FC1", 10, 40, bytes(160)),
        image("rgb8", 10, 10, bytes(40)),
        image("", 10, 10, bytes(40)),
    ],
)
def test_an_image_that_cannot_be_drawn_is_counted(seeing: World, wrong: Image) -> None:
    scene = seen(seeing, wrong)
    assert scene.refused == {CAMERA: 1} and not scene.images


def test_images_are_drawn_by_their_encoding(seeing: World) -> None:
    row = bytes((10, 20, 30, 40, 50, 60, 0, 0))  # two pixels of three, or six of one; two bytes beyond
    colors = [[10, 20, 30], [40, 50, 60]]
    assert pixels(seen(seeing, image("rgb8", 2, 8, 2 * row)).images[CAMERA]).tolist() == [colors] * 2
    assert pixels(seen(seeing, image("bgr8", 2, 8, row)).images[CAMERA]).tolist() == [[one[::-1] for one in colors]]
    grey = pixels(seen(seeing, image("mono8", 6, 8, row)).images[CAMERA])
    assert grey.tolist() == [[[10 * place] * 3 for place in range(1, 7)]]
    depths = np.array([[0, 100, 200, 300]])
    for is_bigendian, kind in enumerate(("<u2", ">u2")):
        sent = image("16UC1", 4, 8, depths.astype(kind).tobytes(), is_bigendian)
        assert pixels(seen(seeing, sent).images[CAMERA])[0, :, 0].tolist() == [0, 0, 127, 255]
    off = seen(seeing, Image(1, "camera", 0, 0, "mono8", 0, b""))  # a camera that has no power
    assert CAMERA in off.images and not off.refused


def test_a_short_image_ends_no_page(seeing: World) -> None:
    page = Page(GuardedServer("short", 9060), seeing, ToldFeed(seeing.table))
    try:
        told(page).tell(CAMERA, image("mono8", 10, 10, bytes(30))._replace(height=4))
        show(page)
        assert f"1 of {CAMERA}" in head_of(page)._note.content
    finally:
        page.close()


@pytest.mark.parametrize(("charge", "shown"), [(np.nan, "charge not known"), (0.5, "50.0 %"), (87.0, "")])
def test_a_charge_that_is_none(page: Page, charge: float, shown: str) -> None:
    """By the contract 0 to 1, or NaN where it is not known: it read "nan %" and "8700.0 %"."""
    told(page).tell("/battery_state", BatteryState(5, percentage=charge))
    show(page)
    words = head_of(page)._words.content
    assert shown in words and "nan" not in words and "8700" not in words
    assert page.bench.scene.refused == ({} if shown else {"/battery_state": 1})


def test_what_could_not_be_read_is_told(page: Page, world: World) -> None:
    row = world.table.topic("/odom")
    for _ in range(2):
        told(page)._waiting.append(FeedMessage(row, b"\0\1\0\0nonsense", 5))
        page.look()
    show(page)
    assert "messages that could not be read: 2 of /odom" in head_of(page)._note.content
