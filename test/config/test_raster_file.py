"""Elevation models from files: what is read where, and what is refused with which words."""

import hashlib
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
import yaml
from rasterio.transform import Affine, from_origin

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_physics.terrain.height_field import HeightField

EAST, NORTH, CELL = 501_000.0, 4_200_000.0, 0.5
METRES = "EPSG:32633"
SHAPE = (60, 80)


def value(east: np.ndarray | float, north: np.ndarray | float) -> Any:
    """Height of the model: a quadratic, so that both interpolations can be told apart and orientation shows."""
    x, y = east - EAST, north - NORTH
    return 1200.0 + 0.05 * x - 0.08 * y + 0.004 * x * x + 0.001 * x * y


LOCAL = 'LOCAL_CS["of the landing site",UNIT["metre",1]]'
"""A projection of no planet."""


def heights() -> np.ndarray:
    east = EAST + CELL * (np.arange(SHAPE[1]) + 0.5)
    north = NORTH - CELL * (np.arange(SHAPE[0]) + 0.5)
    return np.asarray(value(east[np.newaxis, :], north[:, np.newaxis]))


def write_tif(path: Path, values: np.ndarray, **changes: Any) -> Path:
    profile = dict(
        driver="GTiff", height=values.shape[0], width=values.shape[1], count=1, dtype=values.dtype, crs=METRES,
        transform=from_origin(EAST, NORTH, CELL, CELL),
    )  # fmt: skip
    with rasterio.open(path, "w", **{**profile, **changes}) as file:
        for band in range(1, file.count + 1):
            file.write(values, band)
    return path


def scenario(folder: Path, file: dict[str, Any], **terrain: Any) -> Path:
    """A scenario on an elevation model, as a user would write it."""
    ground = {"kind": "file", "size_x": 12.0, "size_y": 10.0, "resolution": 0.25, "file": file, **terrain}
    document = {
        "description": "drive on a model", "seed": 1, "machine": "explorer", "body": "moon", "terrain": ground,
        "soil": "lunar_nominal", "start": {"x": 0.0, "y": 0.0}, "duration_limit_s": 10.0,
    }  # fmt: skip
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    return path


def load(folder: Path, file: dict[str, Any], **terrain: Any) -> LoadedScenario:
    return load_scenario(str(scenario(folder, file, **terrain)))


def ground(folder: Path, file: dict[str, Any], **terrain: Any) -> HeightField:
    return load(folder, file, **terrain).height_field()


def refusal(folder: Path, file: dict[str, Any], **terrain: Any) -> str:
    with pytest.raises(ConfigError) as caught:
        load(folder, file, **terrain)
    assert len(caught.value.problems) == 1
    return str(caught.value)


@pytest.mark.parametrize("how", ["bilinear", "bicubic"])
def test_geotiff_is_placed_by_its_georeference(tmp_path: Path, how: str) -> None:
    write_tif(tmp_path / "dem.tif", heights(), compress="lzw")
    file = {"path": "dem.tif", "east": EAST + 18.0, "north": NORTH - 16.0, "height_offset": 0.0}
    field = ground(tmp_path, file, interpolation=how, resolution=0.5 if how == "bilinear" else 0.2)
    for x, y in ((0.0, 0.0), (3.5, -2.0), (-5.0, 4.5)):
        expected = value(EAST + 18.0 + x, NORTH - 16.0 + y)
        assert field.height(x, y) == pytest.approx(expected, abs=2e-3 if how == "bilinear" else 1e-9)


def test_the_middle_of_the_file_and_of_its_heights_by_default(tmp_path: Path) -> None:
    write_tif(tmp_path / "dem.tif", heights().astype(np.float32))
    field = ground(tmp_path, {"path": "dem.tif"})
    assert field.height(0.0, 0.0) == pytest.approx(0.0, abs=1e-9)
    rise = value(EAST + 22.0, NORTH - 15.0) - value(EAST + 20.0, NORTH - 15.0)
    assert field.height(2.0, 0.0) == pytest.approx(rise, abs=2e-3)


def test_sixteen_bit_png_with_scale_and_offset(tmp_path: Path) -> None:
    counts = np.round((heights() - 1190.0) / 0.001).astype(np.uint16)
    with rasterio.open(
        tmp_path / "dem.png", "w", driver="PNG", height=60, width=80, count=1, dtype="uint16",
        transform=Affine.identity(),
    ) as file:  # fmt: skip
        file.write(counts, 1)
    asked = {
        "path": "dem.png",
        "cell": CELL,
        "height_scale": 0.001,
        "height_offset": 1190.0,
        "east": 20.0,
        "north": 15.0,
    }
    field = ground(tmp_path, asked)
    assert field.height(2.0, 1.0) == pytest.approx(value(EAST + 22.0, NORTH - 30.0 + 16.0), abs=2e-3)
    assert "no georeference" in refusal(tmp_path, {"path": "dem.png"})


def test_npy_with_its_resolution(tmp_path: Path) -> None:
    np.save(tmp_path / "dem.npy", heights())
    field = ground(tmp_path, {"path": "dem.npy", "cell": CELL, "height_offset": 0.0})
    assert field.height(1.0, 2.0) == pytest.approx(value(EAST + 21.0, NORTH - 13.0), abs=2e-3)
    assert "no georeference: give the side of its pixels" in refusal(tmp_path, {"path": "dem.npy"})
    np.save(tmp_path / "flat.npy", np.zeros(5))
    assert "shape (5,)" in refusal(tmp_path, {"path": "flat.npy", "cell": 1.0})


def test_an_npy_of_objects_is_not_unpickled(tmp_path: Path) -> None:
    np.save(tmp_path / "bad.npy", np.array([[{}]], dtype=object), allow_pickle=True)
    assert "cannot be read as .npy" in refusal(tmp_path, {"path": "bad.npy", "cell": 1.0})


def holed() -> np.ndarray:
    values = heights()
    values[30:33, 40:44] = -32768.0
    values[25, 45] = math.nan
    return values


def test_holes_are_refused_and_filled_only_where_asked(tmp_path: Path) -> None:
    write_tif(tmp_path / "dem.tif", holed(), nodata=-32768.0)
    text = refusal(tmp_path, {"path": "dem.tif"})
    assert "terrain.file.fill = 'no': allowed is nearest or linear: 13 of the pixels" in text
    true = value(EAST + 20.9, NORTH - 15.6) - value(EAST + 20.0, NORTH - 15.0)
    nearest = ground(tmp_path, {"path": "dem.tif", "fill": "nearest"})
    linear = ground(tmp_path, {"path": "dem.tif", "fill": "linear"})
    offset = linear.height(-3.0, 0.0) - (value(EAST + 17.0, NORTH - 15.0) - value(EAST + 20.0, NORTH - 15.0))
    assert linear.height(0.9, -0.6) - offset == pytest.approx(true, abs=0.02)
    assert abs(nearest.height(0.9, -0.6) - offset - true) < 0.3
    assert np.isfinite(nearest.heights).all()


def test_holes_outside_the_part_that_is_used_do_not_matter(tmp_path: Path) -> None:
    write_tif(tmp_path / "dem.tif", holed(), nodata=-32768.0)
    file = {"path": "dem.tif", "east": EAST + 10.0, "north": NORTH - 8.0}
    assert math.isfinite(ground(tmp_path, file).height(0.0, 0.0))


def test_a_number_can_be_named_as_a_hole(tmp_path: Path) -> None:
    values = heights()
    values[30, 40] = 0.0
    write_tif(tmp_path / "dem.tif", values)
    assert "fill" in refusal(tmp_path, {"path": "dem.tif", "no_data": 0.0})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"crs": "EPSG:4326", "transform": from_origin(15.0, 38.0, 1e-5, 1e-5)}, "is in degrees"),
        ({"crs": "EPSG:2263"}, "is in the unit US survey foot"),
        ({"crs": LOCAL}, "has a local projection: allowed is a map projection, or none and the key cell"),
        ({"crs": None}, "does not say its projection: if its unit is the metre, give its pixel, 0.5"),
        ({"transform": from_origin(EAST, NORTH, 0.5, 0.6)}, "pixels of 0.5 x 0.6 m: allowed are square ones"),
        ({"transform": from_origin(EAST, NORTH, 0.5, 0.5) @ Affine.rotation(20.0)}, "is turned"),
        ({"transform": from_origin(EAST, NORTH, 3000.0, 3000.0)}, "has pixels of 3000 m: allowed is 0.001 to 1000 m"),
        ({"count": 3}, "has 3 bands: allowed is 1"),
    ],
)  # fmt: skip
def test_files_that_are_no_map_in_metres_are_refused(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    write_tif(tmp_path / "dem.tif", heights(), **changes)
    assert words in refusal(tmp_path, {"path": "dem.tif"})


def test_an_unnamed_projection_counts_where_its_pixel_is_confirmed(tmp_path: Path) -> None:
    write_tif(tmp_path / "dem.tif", heights(), crs=None)
    assert math.isfinite(ground(tmp_path, {"path": "dem.tif", "cell": 0.5}).height(0.0, 0.0))
    assert "give its pixel, 0.5" in refusal(tmp_path, {"path": "dem.tif", "cell": 1.0})


def test_absurd_heights_are_refused(tmp_path: Path) -> None:
    write_tif(tmp_path / "dem.tif", 1000.0 * heights())
    assert "at most 30000 m" in refusal(tmp_path, {"path": "dem.tif"})
    rough = heights() + np.random.default_rng(1).normal(size=SHAPE)
    write_tif(tmp_path / "dem.tif", rough)
    assert "are the heights in metres?" in refusal(tmp_path, {"path": "dem.tif"})


def test_a_map_larger_than_its_file_is_refused_with_what_there_is(tmp_path: Path) -> None:
    write_tif(tmp_path / "dem.tif", heights())
    text = refusal(tmp_path, {"path": "dem.tif"}, size_x=60.0)
    assert "covers x -19.75 to 19.75 m and y -14.75 to 14.75 m" in text
    assert ground(tmp_path, {"path": "dem.tif"}, size_x=39.5, size_y=29.5).bounds[1] == pytest.approx(19.75)


def test_files_that_are_missing_or_broken_are_refused(tmp_path: Path) -> None:
    assert "there is no such file" in refusal(tmp_path, {"path": "nosuch.tif"})
    (tmp_path / "text.tif").write_text("no tiff at all")
    assert "cannot be read as GeoTIFF or PNG" in refusal(tmp_path, {"path": "text.tif"})
    whole = write_tif(tmp_path / "dem.tif", heights()).read_bytes()
    (tmp_path / "cut.tif").write_bytes(whole[: len(whole) // 2])
    assert "cut.tif" in refusal(tmp_path, {"path": "cut.tif"})


def test_soils_from_a_second_raster(tmp_path: Path) -> None:
    write_tif(tmp_path / "dem.tif", heights())
    numbers = np.ones(SHAPE, dtype=np.uint8)
    numbers[:, 42:] = 7
    write_tif(tmp_path / "soil.tif", numbers)
    classes = [{"value": 1, "soil": "lunar_nominal"}, {"value": 7, "soil": "mars"}]
    file = {"path": "dem.tif", "soil_path": "soil.tif", "soil_classes": classes}
    loaded = load(tmp_path, file)
    field = loaded.height_field()
    assert field.soil_name(-3.0, 0.0) == "lunar_nominal" and field.soil_name(3.0, 0.0) == "mars"
    assert set(loaded.soils) == {"lunar_nominal", "rigid_rock", "mars"}
    assert "also has 7" in refusal(tmp_path, {**file, "soil_classes": classes[:1]})
    assert "soil_classes" in refusal(tmp_path, {"path": "dem.tif", "soil_path": "soil.tif"})
    write_tif(tmp_path / "soil.tif", numbers[:-1])
    assert "same area and resolution" in refusal(tmp_path, file)


def test_a_soil_that_does_not_exist_is_refused(tmp_path: Path) -> None:
    patch = {"soil": "nosuch_sand", "x": 0.0, "y": 0.0, "length": 1.0, "width": 1.0}
    write_tif(tmp_path / "dem.tif", heights())
    assert "nosuch_sand" in refusal(tmp_path, {"path": "dem.tif"}, soil_patches=[patch])


def test_the_digests_of_the_files_are_kept(tmp_path: Path) -> None:
    path = write_tif(tmp_path / "dem.tif", heights())
    assert load(tmp_path, {"path": "dem.tif"}).digests == {"dem.tif": hashlib.sha256(path.read_bytes()).hexdigest()}
