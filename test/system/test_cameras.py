"""Cameras in whole runs: the same images in every layout, of the ground as the wheels leave it."""

from collections.abc import Iterator

import numpy as np
import pytest
from programs import LAYOUTS, PATIENT, Program
from verdicts import require_same

from domains import domain_to_keep
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag

SET = {
    "machine": "explorer_cameras",
    "duration_limit_s": "12",
    "sensors.navcam.lens": "{columns: 64, rows: 48, horizontal_view_deg: 60.0}",
    "sensors.front": "null",
    "sensors.powered_by": "{navcam: cameras, rear: cameras, hazcam: cameras}",
    "sensors.belly": "null",
    "sensors.rear": "{kind: camera, link: hazcam_link, lens: {columns: 48, rows: 32, horizontal_view_deg: 90.0}}",
}
PAIR = tuple(f"/navcam/{name}" for name in ("left/image", "right/image", "depth"))


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Bag]]:
    """A run of each layout."""
    base = tmp_path_factory.mktemp("cameras")
    settings = [text for key, value in SET.items() for text in ("--set", f"{key}={value}")]
    programs = []
    try:
        for name, options in LAYOUTS.items():
            given = [*PATIENT, "--domain", str(domain_to_keep()), *options, *settings, "--run-dir", str(base / name)]
            programs.append(Program("start", ["flat_drive", *given], base / f"{name}.log"))
        for program in programs:
            program.wait()
        yield {name: read_bag(base / name) for name in LAYOUTS}
    finally:
        for program in programs:
            program.end()


def test_images_are_the_same_in_every_layout(bags: dict[str, Bag]) -> None:
    require_same(bags["direct"], bags["processes"])


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_contract_is_kept(bags: dict[str, Bag], layout: str) -> None:
    report, _ = judge_bag(bags[layout])
    assert not list(report.lines())
    assert {*PAIR, "/rear/image", "/rear/camera_info", "/truth/ground"} <= set(report.messages)


def test_there_is_an_image_a_second_and_it_shows_something(bags: dict[str, Bag]) -> None:
    bag = bags["direct"]
    for name in (*PAIR, "/rear/image"):
        messages = bag[name]
        assert len(messages) == len(bag["/clock"]) // 50
        image = messages.decode(3)
        rows, columns = (32, 48) if name == "/rear/image" else (48, 64)
        assert (image.height, image.width) == (rows, columns)
        pixels = np.frombuffer(image.data, dtype="<u2" if image.encoding == "16UC1" else "u1")
        assert pixels.size == rows * columns and np.ptp(pixels) > 60


def test_camera_info_is_that_of_the_lens(bags: dict[str, Bag]) -> None:
    left, right = (bags["direct"][f"/navcam/{side}/camera_info"].decode(0) for side in ("left", "right"))
    focal = 32.0 / np.tan(np.radians(30.0))
    assert left.k == pytest.approx([focal, 0.0, 31.5, 0.0, focal, 23.5, 0.0, 0.0, 1.0])
    assert left.p == pytest.approx([focal, 0.0, 31.5, 0.0, 0.0, focal, 23.5, 0.0, 0.0, 0.0, 1.0, 0.0])
    assert right.p[3] == pytest.approx(-focal * 0.2) and right.header.frame_id == left.header.frame_id
    assert left.header.frame_id == "navcam_link_optical" and left.distortion_model == "plumb_bob"


def test_the_sensors_are_told_of_the_wheels_ruts(bags: dict[str, Bag]) -> None:
    """Nodes under the way of the wheels, and no others: none of the first second is told again."""
    points = bags["direct"]["/truth/ground"].points()
    x, y, lowered = (points[name] for name in ("x", "y", "lowered"))
    told = np.isfinite(lowered).sum(axis=1)
    assert (told > 20).sum() >= 8
    assert 0.001 < np.nanmax(lowered) < 0.1
    assert np.nanmax(np.abs(y)) < 1.2 and np.nanmin(x) > -3.0 and np.nanmax(x) < 3.0
