"""A rover that is not ours, from a folder outside of the repository (test/system/stranger): its own soil, contact law
and sensor, over an elevation model; nothing of this repository is edited, and what its files do not say follows.
"""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import rasterio
from outside import Stranger, known_by
from programs import LAYOUTS, PATIENT, PATIENT_BENCH
from rasterio.transform import Affine
from verdicts import require_same

from domains import domain_to_keep

BROUGHT = Path(__file__).parent / "stranger"


def make_hills(file: Path) -> None:
    """Hills of half a metre, up to 6 degrees steep: 30 m by 20 m, a pixel 0.25 m wide, in a projection in metres."""
    x, y = np.meshgrid(np.arange(0.0, 30.0, 0.25), np.arange(20.0, 0.0, -0.25))
    heights = 0.25 * np.sin(2.0 * np.pi * x / 18.0) * np.cos(2.0 * np.pi * y / 23.0)
    raster = {
        "driver": "GTiff", "height": heights.shape[0], "width": heights.shape[1], "count": 1, "dtype": "float32",
        "crs": "EPSG:32633", "transform": Affine.translation(4.0e5, 5.0e6) @ Affine.scale(0.25, -0.25),
    }  # fmt: skip
    with rasterio.open(file, "w", **raster) as dataset:
        dataset.write(heights.astype(np.float32), 1)


@pytest.fixture(scope="module")
def stranger(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stranger]:
    """With what was measured of his machine, and a run in each layout."""
    base = tmp_path_factory.mktemp("stranger")
    known_by(base, "wanderer_parts", (BROUGHT / "parts" / "entry_points.txt").read_text("utf-8"))
    shutil.copytree(BROUGHT / "parts", base / "wanderer_parts", ignore=shutil.ignore_patterns("*.txt", "__pycache__"))
    (base / "wanderer_parts" / "__init__.py").write_text("", encoding="utf-8")
    shutil.copytree(BROUGHT / "machine", base / "machine")
    for name in ("ochre.yaml", "wandering.yaml"):
        shutil.copy(BROUGHT / name, base)
    make_hills(base / "hills.tif")
    one = Stranger(base, base / "wandering.yaml")
    try:
        tuned = one.call("tune", base / "machine", "--soil", base / "ochre.yaml", "--body", "mars")
        assert tuned.wait() == 0, tuned.text  # the first compiles his law
        for name, options in LAYOUTS.items():
            given = (*PATIENT, "--domain", domain_to_keep(), *options, "--run-dir", base / name)
            one.call("start", one.scenario, *given)
            assert one.programs[-1].wait() == 0, one.programs[-1].text
        yield one
    finally:
        one.end()


def test_it_reaches_its_goals_over_his_hills(stranger: Stranger) -> None:
    bag = stranger.bag("direct")
    status = bag["/drive/status"]
    said = stranger.programs[1].text
    assert said.count("reached") == 2 and "not reached" not in said, said
    x, y = (bag["/truth/odom"].column(f"pose.pose.position.{axis}") for axis in "xy")
    assert np.hypot(x[-1] - 4.5, y[-1] + 0.5) < 0.3
    assert len(status) > 20
    height = bag["/truth/odom"].column("pose.pose.position.z")
    assert np.ptp(height) > 0.2, "it goes up and down"
    lean = np.abs([bag["/inclinometer"].column(f"vector.{axis}") for axis in "xy"]).max(axis=1)
    assert lean.min() > 0.01 and lean.max() < 0.2


def test_every_field_is_the_same_in_every_layout(stranger: Stranger) -> None:
    require_same(stranger.bag("direct"), stranger.bag("processes"))


def test_contract_replay_report_data_sheet_and_bench_work_on_it(stranger: Stranger) -> None:
    run, page, domain = stranger.base / "processes", stranger.base / "page.html", domain_to_keep()
    bench = ("--exact", *PATIENT_BENCH, "--domain", domain)
    for role in ("plant", "sensors", "drive", "power"):
        replay = stranger.call("replay", run, "--node", role, *bench)
        assert replay.wait() == 0 and "identical" in replay.text, replay.text
    check = stranger.call("contract_tool", "check", "--bag", run)
    report = stranger.call("report", run, "--html", "--out", page)
    ground = ("--soil", stranger.base / "ochre.yaml", "--body", "mars")
    sheet = stranger.call("datasheet", stranger.base / "machine", *ground, "--out", stranger.base / "sheet.html")
    figures, parts = stranger.base / "figures.json", ("--only", "step", "--only", "period")
    times = stranger.call("bench", "--scenario", stranger.scenario, *parts, "--json", figures, "--domain", domain)
    for program in (check, report, sheet, times):
        assert program.wait() == 0, program.text
    assert json.loads(figures.read_text("utf-8"))["app of drive [us]"] > 0.0
    assert "keeps the contract: no violation" in check.text
    assert "inclinometer" in page.read_text("utf-8")
    assert "figures" in sheet.text and "Turning" in (stranger.base / "sheet.html").read_text("utf-8")


def test_what_he_did_not_say_says_from_what_it_follows(stranger: Stranger) -> None:
    resolved = stranger.call("start", stranger.scenario, "--resolved")
    assert resolved.wait() == 0, resolved.text
    measured = (stranger.base / "machine" / "measured.yaml").read_text("utf-8").splitlines()
    slip = next(number for number, line in enumerate(measured, 1) if line.strip().startswith("mean_slip"))
    for key, why in (
        ("max_speed", "0.3 wheelbases a second at most"),
        ("max_steer_rate", "0.85 of the velocity of the steering joints in the URDF"),
        ("mean_slip", f"machine/measured.yaml:{slip}"),
        ("model: crust", "wheel.yaml"),
    ):
        line = next(line for line in resolved.text.splitlines() if line.strip().startswith(key))
        assert why in line, line
    assert json.dumps("inclinometer").strip('"') in resolved.text
