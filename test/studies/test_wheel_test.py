"""scripts/wheel_test and scripts/fit_soil as a user types them: numbers, files, and one sentence for what is wrong."""

import csv
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from sojourn_analysis.wheels.examples import WHEELS
from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.load import load_params
from sojourn_config.machine_reader import machine_config
from sojourn_machine.contact_choice import CONTACT_LAWS
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams
from sojourn_studies import fit_soil, wheel_test

ROOT = Path(__file__).parents[2]
MEASURED = ROOT / "test" / "validation" / "measured"
SMOOTH = MEASURED / "wheel_tests_smooth.csv"
DING_KLS1 = MEASURED / "wheel_tests_ding_kls1.csv"


def run_json(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    assert wheel_test.main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.published
def test_published_wheel_with_every_parameter_set(capsys: pytest.CaptureFixture[str]) -> None:
    """JSC-1A: z 27.07 mm, DP 6.589 N, T 2.422 N m at slip 0.2, from another soil and wheel by --set alone."""
    changes = {
        "wheel.radius": 0.1, "wheel.width": 0.06, "wheel.grouser_height": 0, "wheel.grouser_count": 0, "soil.n": 1,
        "soil.k_c": 1400, "soil.k_phi": 820e3, "soil.cohesion": 1000, "soil.friction_angle_deg": 45,
        "soil.shear_modulus": 0.018, "soil.theta_m_c1": 0.4, "soil.theta_m_c2": 0.2, "soil.exit_angle": "zero",
        "soil.form": "bekker",
    }  # fmt: skip
    texts = [text for key, value in changes.items() for text in ("--set", f"{key}={value}")]
    (found,) = run_json(capsys, "--wheel", "lrv", "--soil", "dry_sand", "--load", "50", "--slip", "0.2", *texts)
    assert found["sinkage_m"] == pytest.approx(0.02707, rel=0.01)
    assert found["drawbar_pull_n"] == pytest.approx(6.589, rel=0.01)
    assert found["torque_nm"] == pytest.approx(2.422, rel=0.01)
    assert found["entry_angle_rad"] == pytest.approx(math.acos(1.0 - found["sinkage_m"] / 0.1))
    assert found["exit_angle_rad"] == 0.0 and found["side_force_n"] == 0.0
    assert found["resistances"]["compaction_n"] > 0.0 and found["resistances"]["bulldozing_n"] == 0.0


def test_reece_form_is_bekker_with_its_moduli_changed(capsys: pytest.CaptureFixture[str]) -> None:
    wheel = ["--wheel", "jsc_1a", "--load", "50", "--slip", "0.3", "--soil", "jsc_1a", "--set", "soil.n=0.8"]
    (bekker,) = run_json(capsys, *wheel, "--set", "soil.k_c=0", "--set", "soil.k_phi=4e5")
    reece = 4e5 * 0.06 ** (0.8 - 1.0)  # b k_phi / b^n
    (other,) = run_json(
        capsys, *wheel, "--set", "soil.form=reece", "--set", "soil.k_c=0", "--set", f"soil.k_phi={reece}"
    )
    assert other["sinkage_m"] == pytest.approx(bekker["sinkage_m"], rel=1e-9)


def test_radius_and_width_alone_are_a_smooth_wheel(capsys: pytest.CaptureFixture[str]) -> None:
    size = ["--set", "wheel.radius=0.1", "--set", "wheel.width=0.06"]
    (found,) = run_json(capsys, "--soil", "jsc_1a", "--load", "50", "--slip", "0.5", *size)
    assert (found["wheel"], found["drawbar_pull_n"]) == ("custom", pytest.approx(13.70, rel=0.01))


def test_one_object_for_each_slip_and_angle(capsys: pytest.CaptureFixture[str]) -> None:
    found = run_json(
        capsys, "--wheel", "pavlov_smooth", "--soil", "cmu_sand", "--load", "24", "--slip", "-0.5,0,0.5",
        "--slip-angle", "-15,0,15",
    )  # fmt: skip
    assert [(one["slip"], one["slip_angle_deg"]) for one in found[:4]] == [(-0.5, -15), (0, -15), (0.5, -15), (-0.5, 0)]
    left, _, right = (found[k] for k in (0, 3, 6))
    assert left["side_force_n"] == pytest.approx(-right["side_force_n"]) and right["side_force_n"] < 0.0
    assert left["drawbar_pull_n"] == pytest.approx(right["drawbar_pull_n"]) and left["drawbar_pull_n"] < 0.0


def test_grousers_raise_the_pull_on_measured_soils(capsys: pytest.CaptureFixture[str]) -> None:
    for soil, wheel, load in (("cmu_sand", "pavlov_smooth", "24"), ("ding_2011", "ding_2011", "80")):
        common = ["--wheel", wheel, "--soil", soil, "--load", load, "--slip", "0.4"]
        pulls = [
            run_json(
                capsys, *common, "--set", f"wheel.grouser_height={height}", "--set", f"wheel.grouser_count={count}"
            )[0]["drawbar_pull_n"]
            for height, count in ((0.0, 0), (0.002, 12), (0.005, 24), (0.010, 24))
        ]
        assert pulls[1] - pulls[0] > 0.04 * float(load)
        assert pulls[2] - pulls[0] > 0.08 * float(load)
        # once soil slides on soil, higher grousers gain little more, and dig
        assert abs(pulls[3] - pulls[2]) < 0.03 * float(load)


def test_rows_of_a_file_with_their_predictions(capsys: pytest.CaptureFixture[str]) -> None:
    found = run_json(capsys, "--soil", "ding_2011", "--csv", str(DING_KLS1))
    lines = [line for line in DING_KLS1.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    assert [row["case_id"] for row in found["rows"]] == [row["case_id"] for row in csv.DictReader(lines)]
    first = found["rows"][1]
    (alone,) = run_json(capsys, "--wheel", "ding_2011", "--soil", "ding_2011", "--load", "80", "--slip", "0.1")
    for name in ("drawbar_pull_n", "side_force_n", "sinkage_m", "torque_nm"):
        assert first[name] == pytest.approx(alone[name])
    assert found["statistics"]["all"]["trials"] == 11


def test_statistics_are_the_medians_of_the_rows(capsys: pytest.CaptureFixture[str]) -> None:
    found = run_json(capsys, "--wheel", "pavlov_smooth", "--soil", "cmu_sand", "--csv", str(SMOOTH))
    assert len(found["rows"]) == 189
    errors = sorted(abs(r["side_force_n"] - float(r["lateral_force_n"])) / float(r["load_n"]) for r in found["rows"])
    assert found["statistics"]["all"]["side_force_error_percent"] == pytest.approx(100.0 * errors[94])
    deep = sorted(abs(1e3 * r["sinkage_m"] - float(r["sinkage_mm"])) / 58.0 for r in found["rows"])
    assert found["statistics"]["all"]["sinkage_error_percent"] == pytest.approx(100.0 * deep[94])


def test_table_and_plot(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    plot = tmp_path / "curves.png"
    arguments = ["--soil", "cmu_sand", "--load", "60", "--slip", "0.1,0.4", "--plot", str(plot)]
    assert wheel_test.main(arguments) == 0
    text = capsys.readouterr().out
    assert "explorer" in text and "[mm]" in text and str(plot) in text
    assert plot.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", CONTACT_LAWS.names())
def test_every_contact_law(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Whatever is registered can be put on the bed; what the motor gives is no less than what the wheel gives on."""
    example = next(one for one in WHEELS.values() if one["contact"]["model"] == name)
    size = {key: value for key, value in example.items() if key != "contact"}
    own = {key: value for key, value in example["contact"].items() if key != "model"}
    texts = [f"wheel.{key}={value}" for key, value in size.items()] + [
        f"law.{key}={value}" for key, value in own.items()
    ]
    load = 50.0
    bed = ["--law", name, "--soil", "lunar_nominal", "--load", str(load), "--gravity", "1.62"]
    bed += [word for text in texts for word in ("--set", text)]
    found = run_json(capsys, *bed, "--slip", "-0.5,0,0.05,0.5", "--slip-angle", "0,20")
    assert {one["law"] for one in found} == {name} and len(found) == 8
    for one in found:
        assert all(math.isfinite(value) for value in (*one["resistances"].values(), one["sinkage_m"]))
        rim, travel = 1.0 + min(one["slip"], 0.0), 1.0 - max(one["slip"], 0.0)
        angle = math.radians(one["slip_angle_deg"])
        given = one["torque_nm"] * rim / size["radius"]
        given -= one["drawbar_pull_n"] * travel * math.cos(angle) + one["side_force_n"] * travel * math.sin(angle)
        assert given >= -1e-6 * load, one
    straight = [one["drawbar_pull_n"] for one in found[:4]]
    assert straight[0] < straight[1] < straight[2]
    assert found[2]["torque_nm"] > 0.0 and found[1]["drawbar_pull_n"] < 0.01 * load
    assert wheel_test.main([*bed, "--slip", "0.1"]) == 0
    assert name in capsys.readouterr().out


@pytest.mark.parametrize("rover", ["explorer", "lrv", "omni"])
def test_the_wheel_of_a_rover(rover: str, capsys: pytest.CaptureFixture[str]) -> None:
    wheel = machine_config(rover).wheels[0]
    (found,) = run_json(capsys, "--machine", rover, "--load", "50", "--slip", "0.1")
    assert (found["wheel"], found["law"]) == (wheel.name, wheel.contact.model)
    (wider,) = run_json(capsys, "--machine", rover, "--load", "50", "--slip", "0.1", "--set", "wheel.width=1.0")
    assert wider["sinkage_m"] < found["sinkage_m"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--load", "50", "--law", "rubber"], ("rubber", "brush")),
        (["--load", "50", "--law", "wheel_and_ground_in_series"], ("--set law.stiffness=", "missing", "N/m")),
        (["--load", "50", "--law", "roller_wheel"], ("--set law.roller_angle_deg=", "omni 90")),
        (["--load", "50", "--set", "law.stifness=3"], ("--set law.stifness=3", "unknown key", "model")),
        (["--load", "50", "--law", "rigid_wheel_on_rigid_ground", "--set", "law.grip=1"], ("grip", "break_away")),
        (["--load", "50", "--machine", "lrv", "--law", "brush"], ("--law", "--machine")),
        (["--load", "50", "--machine", "zebra"], ("zebra", "explorer")),
        (["--load", "1e7", "--soil", "snow", "--law", "bekker_wheel_on_soil"], ("1e+07", "does not carry")),
        (["--csv", str(DING_KLS1), "--law", "bekker_wheel_on_soil"], ("--law", "--csv")),
        (["--soil", "porridge", "--load", "50"], ("porridge", "lunar_nominal")),
        (["--wheel", "cog", "--load", "50"], ("cog", "explorer")),
        (["--load", "50", "--set", "soil.stickiness=3"], ("stickiness",)),
        (["--load", "50", "--set", "machine.mass=3"], ("machine", "wheel.KEY")),
        (["--load", "50", "--set", "soil.exit_angle=late"], ("exit_angle", "lambda")),
        (["--load", "50", "--slip", "1.2"], ("slip", "1.2")),
        (["--load", "50", "--slip", "0.1,-1.01"], ("slip", "-1.01")),
        (["--load", "50", "--slip", "nan"], ("nan",)),
        (["--load", "50", "--slip-angle", "95"], ("slip angle", "95")),
        (["--load", "0"], ("load", "more than 0")),
        (["--load", "-3"], ("load", "more than 0")),
        (["--load", "1e7", "--soil", "snow"], ("1e+07", "does not carry")),
        ([], ("--load",)),
        (["--csv", "nowhere.csv"], ("nowhere.csv",)),
        (["--csv", str(SMOOTH)], ("wheel_radius_m", "--wheel")),
        (["--csv", str(DING_KLS1), "--load", "3"], ("--load", "--csv")),
        (["--csv", str(DING_KLS1), "--where", "colour=red"], ("colour", "soil_simulant")),
    ],
)
def test_one_sentence_for_what_is_wrong(
    arguments: list[str], words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        wheel_test.main(arguments)
    except (UsageError, ConfigError) as error:
        message = str(error)
    except SystemExit as ended:
        assert ended.code == 2
        message = capsys.readouterr().err
    else:
        pytest.fail("nothing was refused")
    assert len(message.strip().splitlines()) == 1
    for word in words:
        assert word in message


def test_every_key_that_a_law_lacks_is_named_with_the_option_that_gives_it() -> None:
    with pytest.raises(ConfigError) as refused:
        wheel_test.main(["--load", "50", "--law", "brush"])
    lines = str(refused.value).splitlines()
    for line, key in zip(lines, ("stiffness", "longitudinal_stiffness", "cornering_stiffness"), strict=True):
        assert f"give --set law.{key}=VALUE" in line


@pytest.mark.parametrize("key", ["cohesion", "shear_modulus", "density", "theta_m_c1"])
def test_a_soil_without_what_shears_and_flows_is_refused(key: str, tmp_path: Path) -> None:
    """It would stand for no soil at all: cohesion 0, a shear modulus of its own."""
    soil = yaml.safe_load((ROOT / "config" / "soils" / "lunar_nominal.yaml").read_text(encoding="utf-8"))
    del soil[key]
    file = tmp_path / "half.yaml"
    file.write_text(yaml.safe_dump(soil), encoding="utf-8")
    with pytest.raises(ConfigError, match=f"missing: {key}"):
        wheel_test.main(["--soil", str(file), "--load", "50"])
    with pytest.raises(ConfigError, match=f"missing: {key}"):
        fit_soil.main([str(SMOOTH), "--wheel", "pavlov_smooth", "--soil", str(file)])


def test_exit_status_of_the_script() -> None:
    command = [sys.executable, "-m", "sojourn_studies.wheel_test", "--load", "1e9"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1800.0)
    assert done.returncode == 2 and done.stdout == "" and "does not carry" in done.stderr.splitlines()[-1]


def test_a_bad_number_in_a_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "trials.csv"
    path.write_text("load_n,slip_ratio,wheel_radius_m,wheel_width_m\n50,0.1,0.1,0.06\n50,fast,0.1,0.06\n")
    with pytest.raises(UsageError, match=r"trial 2: slip_ratio = 'fast'"):
        wheel_test.main(["--csv", str(path)])
    path.write_text("load_n,slip_ratio,wheel_radius_m,wheel_width_m\n50,1.5,0.1,0.06\n")
    with pytest.raises(UsageError, match=r"slip = 1.5"):
        wheel_test.main(["--csv", str(path)])
    path.write_text("load_n\n50\n")
    with pytest.raises(UsageError, match="slip_ratio or slip"):
        wheel_test.main(["--csv", str(path), "--wheel", "lrv"])


def test_every_wheel_loads() -> None:
    files = sorted((ROOT / "config" / "wheels").glob("*.yaml"))
    assert len(files) >= 7
    assert [load_params("wheels", path.stem, WheelShape).name for path in files] == [path.stem for path in files]


def test_fit_finds_the_soil_that_made_the_trials(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Trials predicted from a soil with other parameters than the start's: the fit finds them, and writes a soil."""
    made = ["soil.theta_m_c1=0.3", "soil.slip_sinkage=1.2", "soil.shear_modulus=0.009"]
    texts = [text for change in made for text in ("--set", change)]
    rows = run_json(capsys, "--wheel", "ding_2011", "--soil", "ding_2011", "--load", "80", "--slip",
                    "0.0,0.05,0.1,0.2,0.3,0.4,0.5,0.6,0.8", *texts)  # fmt: skip
    path, written = tmp_path / "made.csv", tmp_path / "found.yaml"
    lines = [f"80,{r['slip']},{r['drawbar_pull_n']},{1e3 * r['sinkage_m']},{r['torque_nm']}" for r in rows]
    path.write_text("load_n,slip_ratio,tractive_force_n,sinkage_mm,torque_nm\n" + "\n".join(lines) + "\n")
    arguments = [
        str(path), "--wheel", "ding_2011", "--soil", "ding_2011", "--starts", "1", "--json", "--write", str(written),
        "--free", "theta_m_c1,slip_sinkage,shear_modulus",
    ]  # fmt: skip
    assert fit_soil.main(arguments) == 0
    report = json.loads(capsys.readouterr().out)
    found = {name: one["value"] for name, one in report["parameters"].items()}
    assert found == pytest.approx({"theta_m_c1": 0.3, "slip_sinkage": 1.2, "shear_modulus": 0.009}, rel=0.02)
    assert report["fitted"]["all"]["drawbar_pull_error_percent"] < 0.1
    assert report["cross_validated"]["all"]["sinkage_error_percent"] < 0.5
    assert len(report["covariance"]["matrix"]) == 3
    soil = load_params("soils", str(written), SoilParams)
    assert soil.slip_sinkage == pytest.approx(1.2, rel=0.02)
    assert {"theta_m_c1", "slip_sinkage", "shear_modulus"} <= set(soil.spread)
    assert yaml.safe_load(written.read_text())["name"] == "ding_2011"


def test_fit_refuses_what_it_cannot_identify() -> None:
    common = [str(SMOOTH), "--wheel", "pavlov_smooth", "--soil", "cmu_sand"]
    with pytest.raises(UsageError, match="colour"):
        fit_soil.main([*common, "--free", "colour"])
    with pytest.raises(UsageError, match="twice"):
        fit_soil.main([*common, "--free", "k_phi,k_phi"])
    with pytest.raises(UsageError, match="--wheel"):
        fit_soil.main([str(SMOOTH), "--soil", "cmu_sand"])


def test_rows_may_say_their_grousers_where_the_options_say_the_size(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "trials.csv"
    path.write_text("slip,load_n,grouser_height_m,grouser_count\n0.3,20,0,0\n0.3,20,0.006,12\n")
    size = ["--soil", "cmu_sand", "--set", "wheel.radius=0.058", "--set", "wheel.width=0.05"]
    smooth, lugged = run_json(capsys, *size, "--csv", str(path))["rows"]
    for row, height, count in ((smooth, 0.0, 0), (lugged, 0.006, 12)):
        lugs = ["--set", f"wheel.grouser_height={height}", "--set", f"wheel.grouser_count={count}"]
        (alone,) = run_json(capsys, *size, *lugs, "--load", "20", "--slip", "0.3")
        assert row["drawbar_pull_n"] == pytest.approx(alone["drawbar_pull_n"], rel=1e-9)
    assert lugged["drawbar_pull_n"] > smooth["drawbar_pull_n"] + 1.0
