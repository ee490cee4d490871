"""Images of a stereo pair on their way to the drive: whose run has them, what is taken, rectified, refused."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from sojourn_bags.contract_version import check_own_contract
from sojourn_bags.provenance import CONTRACT_NAME
from sojourn_bags.reading import Bag
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.description import contract_data
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.run_table import table_of
from sojourn_contract.stereo_pair import pair_in_use, pair_place_of
from sojourn_contract.values import CameraInfo, Image
from sojourn_drive.stereo import StereoInput
from sojourn_physics.imaging.lens import LensParams, project

SEEING = load_scenario("flat_drive", ["machine=explorer_cameras"])
ROWS = pair_in_use(SEEING)
STAMP = 10**9
K = np.array([100.0, 0.0, 31.5, 0.0, 100.0, 23.5, 0.0, 0.0, 1.0])
NO_DISTORTION = np.zeros(5)


def info(baseline: float, distortion: Any = NO_DISTORTION) -> CameraInfo:
    projection = np.column_stack([K.reshape(3, 3), [-100.0 * baseline, 0.0, 0.0]]).ravel()
    return CameraInfo(STAMP, "eye", 48, 64, "plumb_bob", distortion, K, np.eye(3).ravel(), projection)


def image(seed: int) -> Image:
    pixels = np.random.default_rng(seed).integers(0, 256, (48, 64), dtype=np.uint8)
    return Image(STAMP, "eye", 48, 64, "mono8", 64, pixels.tobytes())


def said(**other: Any) -> dict[str, Any]:
    """What the pair says; other: by the names of `PairTopics`."""
    assert ROWS is not None
    told = {"left": image(1), "left_info": info(0.0), "right": image(2), "right_info": info(0.2)} | other
    return {getattr(ROWS, name): message for name, message in told.items()}


def test_the_drive_hears_the_images_that_its_odometry_goes_by_and_no_others() -> None:
    def heard(*overrides: str) -> set[str]:
        table = table_of(load_scenario("flat_drive", ["machine=explorer_cameras", *overrides]))
        return {row.name for row in table if row.name.startswith("/navcam") and "drive" in row.subscribers}

    assert ROWS is not None and heard() == set(ROWS)
    assert not heard("drive.visual_odometry=null")
    assert all(not row.needs_listener for row in table_of(SEEING) if row.name in ROWS)
    assert pair_in_use(load_scenario("flat_drive")) is None and pair_place_of(load_scenario("flat_drive")) is None


@pytest.mark.parametrize("overrides", [(), ("drive.visual_odometry=null",)])
def test_a_bag_of_such_a_run_is_one_of_our_contract(overrides: tuple[str, ...], tmp_path: Path) -> None:
    """By the contract that it carries, which says who heard the images."""
    table = table_of(load_scenario("flat_drive", ["machine=explorer_cameras", *overrides]))
    carried = {CONTRACT_NAME: json.dumps(contract_data(table)).encode()}
    bag = SimpleNamespace(path=tmp_path, attachments=carried, topics={row.name: None for row in table})
    assert check_own_contract(cast(Bag, bag))


def test_a_pair_is_taken_once_and_in_its_period() -> None:
    pairs = StereoInput(SEEING)
    images, last = pairs.images(STAMP, said(), -1)
    assert images is not None and last == STAMP and images.left.shape == (48, 64)
    assert images.left.tobytes() == image(1).data and images.right.tobytes() == image(2).data
    assert images.pair == (100.0, (31.5, 23.5), pytest.approx(0.2))
    assert pairs.images(STAMP + 20_000_000, said(), last) == (None, last)
    assert pairs.images(STAMP + 60_000_000, said(), -1)[0] is None  # late: the machine is elsewhere now
    apart = said(right=image(2)._replace(stamp=STAMP - 20_000_000))
    assert pairs.images(STAMP, apart, -1)[0] is None
    assert pairs.images(STAMP, {**said(), "/navcam/right/image": None}, -1) == (None, -1)


def test_without_power_there_are_images_of_no_size() -> None:
    nothing = Image(STAMP, "eye", 0, 0, "mono8", 0, b"")
    images, _ = StereoInput(SEEING).images(STAMP, said(left=nothing, right=nothing), -1)
    assert images is not None and images.left.size == 0


def test_a_lens_that_bends_lines_is_straightened() -> None:
    """A spot where the distorted lens of the sensors has a direction comes to where a straight one has it."""
    distortion = np.array([-0.2, 0.05, 0.001, -0.002, 0.0])
    lens = LensParams.model_validate(
        {"columns": 64, "rows": 48, "horizontal_view_deg": 35.5, "distortion": tuple(distortion)}
    )
    direction = np.array([[0.22, 0.15, 1.0]])
    f = lens.focal_length
    matrix = np.array([f, 0.0, 31.5, 0.0, f, 23.5, 0.0, 0.0, 1.0])
    (u, v) = project(lens, direction)[0]
    columns, rows = np.meshgrid(np.arange(64), np.arange(48))
    spot = np.exp(-0.5 * ((columns - u) ** 2 + (rows - v) ** 2) / 1.5**2)
    bent = Image(STAMP, "eye", 48, 64, "mono8", 64, (200.0 * spot).astype(np.uint8).tobytes())
    left, right = (info(baseline, distortion)._replace(intrinsic=matrix) for baseline in (0.0, 0.2))
    images, _ = StereoInput(SEEING).images(STAMP, said(left=bent, right=bent, left_info=left, right_info=right), -1)
    assert images is not None
    weights = images.left.astype(float)
    middle = (columns * weights).sum() / weights.sum(), (rows * weights).sum() / weights.sum()
    assert middle == pytest.approx((31.5 + 0.22 * f, 23.5 + 0.15 * f), abs=0.1)
    assert np.hypot(u - middle[0], v - middle[1]) > 0.3


@pytest.mark.parametrize(
    ("other", "field"),
    [
        ({"left": image(1)._replace(encoding="rgb8")}, "encoding"),
        ({"left": image(1)._replace(data=b"\0")}, "data"),
        ({"left": image(1)._replace(step=10)}, "data"),
        ({"right": Image(STAMP, "eye", 1, 2, "mono8", 2, b"\0\0")}, "height width"),
        ({"left_info": info(0.0)._replace(intrinsic=np.zeros(9))}, "k"),
        ({"left_info": info(0.0)._replace(intrinsic=np.full(9, np.nan))}, "k"),
        ({"right_info": info(0.2)._replace(intrinsic=2.0 * K)}, "k d"),
        ({"right_info": info(0.0)}, "p[3]"),
        ({"right_info": info(-0.2)}, "p[3]"),
    ],
)
def test_what_is_no_rectified_pair_is_refused(other: dict[str, Any], field: str) -> None:
    with pytest.raises(RefusedMessageError, match="navcam") as refused:
        StereoInput(SEEING).images(STAMP, said(**other), -1)
    assert f".{field} =" in str(refused.value)


def test_a_lens_of_an_unknown_kind_is_refused() -> None:
    odd = [info(baseline, np.full(5, 0.01))._replace(distortion_model="odd") for baseline in (0.0, 0.2)]
    with pytest.raises(RefusedMessageError, match="plumb_bob, equidistant"):
        StereoInput(SEEING).images(STAMP, said(left_info=odd[0], right_info=odd[1]), -1)


@pytest.mark.parametrize("camera", ["navcm", "hazcam"])
def test_a_camera_that_is_no_pair_is_refused_before_the_run(camera: str) -> None:
    with pytest.raises(ConfigError, match=r"drive\.visual_odometry\.camera = .*navcam"):
        load_scenario("flat_drive", ["machine=explorer_cameras", f"drive.visual_odometry.camera={camera}"])


def test_a_machine_without_a_pair_is_told_so() -> None:
    assert SEEING.drive.visual_odometry is not None
    given = f"drive.visual_odometry={SEEING.drive.visual_odometry.model_dump_json()}"
    with pytest.raises(ConfigError, match="is no stereo pair"):
        load_scenario("flat_drive", ["machine=explorer", given])
