"""What a terrain description accepts and refuses."""

from typing import Any

import pytest
from pydantic import ValidationError

from sojourn_physics.terrain.params import TerrainParams


@pytest.mark.parametrize(
    ("values", "word"),
    [
        ({}, "kind"),
        ({"kind": "hilly"}, "kind"),
        ({"kind": "flat", "slope_deg": 5.0}, "slope_deg"),
        ({"kind": "flat", "roughness": {"rms_slope_deg": 2.0}}, "roughness"),
        ({"kind": "slope"}, "slope_deg"),
        ({"kind": "slope", "slope_deg": 61.0}, "slope_deg"),
        ({"kind": "slope", "slope_deg": 5.0, "step_height": 0.1}, "step_height"),
        ({"kind": "step"}, "step_height"),
        ({"kind": "generated", "step_height": 0.1}, "step_height"),
        ({"kind": "flat", "resolution": 0.0}, "resolution"),
        ({"kind": "flat", "resolution": 0.005, "size_x": 1000.0, "size_y": 1000.0}, "resolution"),
        ({"kind": "flat", "size_x": float("nan")}, "size_x"),
        ({"kind": "flat", "center_x": float("inf")}, "center_x"),
        (
            {"kind": "flat", "craters": [{"x": 25.0, "y": 0.0, "diameter": 2.0, "depth": 0.3}]},
            r"craters\[0\]",
        ),
        ({"kind": "flat", "craters": [{"x": 0.0, "y": 0.0, "diameter": 2.0, "depth": 1.1}]}, "depth"),
        ({"kind": "flat", "rocks": [{"x": 0.0, "y": -20.1, "diameter": 0.5, "height": 0.3}]}, r"rocks\[0\]"),
        ({"kind": "flat", "rocks": [{"x": 0.0, "y": 0.0, "diameter": 0.5}]}, "height"),
        ({"kind": "flat", "keep_clear": [{"x": 0.0, "y": 0.0, "radius": 0.0}]}, "radius"),
        ({"kind": "generated", "roughness": {"hurst": 1.0, "rms_slope_deg": 2.0}}, "hurst"),
        ({"kind": "generated", "roughness": {}}, "rms_slope_deg"),
        ({"kind": "generated", "crater_law": {"diameter_min": 6.0}}, "diameter_max"),
        ({"kind": "generated", "rock_law": {"area_fraction": 0.02, "diameter_max": 0.1}}, "diameter_max"),
        ({"kind": "generated", "rock_law": {"area_fraction": 0.6}}, "area_fraction"),
        ({"kind": "generated", "rock_laws": {}}, "rock_laws"),
    ],
)
def test_bad_terrain_is_refused_by_name(values: dict[str, Any], word: str) -> None:
    with pytest.raises(ValidationError, match=word):
        TerrainParams(**values)


def test_size_is_rounded_to_whole_cells_about_the_center() -> None:
    params = TerrainParams(kind="flat", size_x=3.02, size_y=2.0, resolution=0.1, center_x=10.0, center_y=-4.0)
    assert params.node_counts == (21, 31)
    assert params.origin == pytest.approx((8.5, -5.0))
