"""The ground of a run that was read from a file: a bag carries what is needed to draw it again."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import yaml

from sojourn_bags.definitions import CONFIGURATION_NAME
from sojourn_bags.description import Run
from sojourn_bags.reading import Bag
from sojourn_config.scenario import load_scenario


def test_the_ground_from_a_file_comes_back_out_of_the_bag(tmp_path: Path) -> None:
    np.save(tmp_path / "dem.npy", np.random.default_rng(2).normal(scale=0.05, size=(40, 50)).cumsum(axis=0))
    np.save(tmp_path / "soil.npy", np.arange(2000, dtype=np.int16).reshape(40, 50) // 1000)
    classes = [{"value": 0, "soil": "lunar_nominal"}, {"value": 1, "soil": "mars"}]
    file = {"path": "dem.npy", "cell": 0.5, "soil_path": "soil.npy", "soil_classes": classes}
    terrain = {"kind": "file", "size_x": 10.0, "size_y": 8.0, "resolution": 0.1, "file": file}
    document = {
        "description": "stand on a model", "seed": 1, "machine": "explorer", "body": "moon", "terrain": terrain,
        "soil": "lunar_nominal", "duration_limit_s": 10.0,
    }  # fmt: skip
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    loaded = load_scenario(str(path))
    attachments: dict[str, Any] = {item.name: item.data for item in Run.of_scenario(loaded).attachments()}
    assert json.loads(attachments[CONFIGURATION_NAME])["digests"] == loaded.digests
    assert set(loaded.digests) == {"dem.npy", "soil.npy"}
    for name in ("dem.npy", "soil.npy"):
        (tmp_path / name).unlink()  # the bag needs no other file
    again = Run.of_bag(cast(Bag, SimpleNamespace(attachments=attachments, path=tmp_path))).terrain()
    ground = loaded.height_field()
    assert np.array_equal(again.heights, ground.heights) and np.array_equal(again.soil_index, ground.soil_index)
    assert again.soil_names == ground.soil_names and len(np.unique(ground.soil_index)) == 2
