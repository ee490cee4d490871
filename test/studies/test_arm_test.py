"""scripts/arm_test: figures, errors in one sentence, any arm, and a picture."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from sojourn_config.arms import dh_file
from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.paths import urdf_folder
from sojourn_flight.arm.control_laws import LAWS
from sojourn_studies import arm_control
from sojourn_studies.arm_test import KEYS, main, parser

NOMINAL = ["--q", "0", "0.7853981634", "3.1415926536", "0", "0.7853981634", "0"]


def _json(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert main([*arguments, "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def test_the_puma_at_its_nominal_pose(capsys: pytest.CaptureFixture[str]) -> None:
    found = _json(capsys, "puma560", *NOMINAL, "--gravity", "9.81")
    np.testing.assert_allclose(found["tip_position_m"], [0.5963, -0.1501, 0.6576], atol=1e-4)
    np.testing.assert_allclose(found["gravity_torques_n_m"], [0, 31.6399, 6.0351, 0, 0.0283, 0], atol=1e-4)
    assert found["mass_matrix_kg_m2"][1][1] == pytest.approx(4.4137, abs=1e-4)
    assert np.array(found["jacobian"]).shape == (6, 6)
    documented = set(re.split(r",\s*", ", ".join(KEYS)))
    assert set(found) == documented - {"inverse_kinematics"}


def test_motion_degrees_payload_and_gravity(capsys: pytest.CaptureFixture[str]) -> None:
    posture = ["--q", "10", "40", "-140", "20", "30", "5", "--degrees"]
    moved = _json(capsys, "puma560", *posture, "--qd", "-1e-3", "20", "-3e1", "0", "0", "0", "--qdd", "1,2,3,4,5,6")
    assert moved["q"][1] == pytest.approx(math.radians(40)) and moved["qd"][0] == pytest.approx(-1e-3 * math.pi / 180)
    parts = np.array(moved["mass_matrix_kg_m2"]) @ moved["qdd"] + moved["coriolis_torques_n_m"]
    np.testing.assert_allclose(parts + moved["gravity_torques_n_m"], moved["inverse_dynamics_n_m"], atol=1e-9)
    drive = np.array(moved["inverse_dynamics_n_m"]) + moved["friction_torques_n_m"]
    np.testing.assert_allclose(drive, moved["drive_torques_n_m"], atol=1e-12)
    light = _json(capsys, "puma560", *posture, "--gravity", "3.71")
    loaded = _json(capsys, "puma560", *posture, "--gravity", "0", "0", "-3.71", "--payload", "2.5")
    weight = np.array(light["jacobian"])[2] * 2.5 * 3.71
    difference = np.array(loaded["gravity_torques_n_m"]) - light["gravity_torques_n_m"]
    np.testing.assert_allclose(difference, weight, atol=1e-9)
    assert loaded["largest_payload_kg"] == pytest.approx(light["largest_payload_kg"] - 2.5, abs=1e-9)
    assert _json(capsys, "puma560", *posture, "--gravity", "0")["largest_payload_kg"] is None


def test_every_arm_at_zero_and_by_file(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for name in ("cartesian", "cylindrical", "explorer_arm", "scara", "srms", "ssrms"):
        assert _json(capsys, name)["arm"] == name
    table = tmp_path / "other.yaml"
    table.write_text(dh_file("puma560").read_text(encoding="utf-8"), encoding="utf-8")
    expected = _json(capsys, "puma560", *NOMINAL)
    for path in (table, urdf_folder() / "puma560.urdf"):
        found = _json(capsys, str(path), *NOMINAL)
        np.testing.assert_allclose(found["mass_matrix_kg_m2"], expected["mass_matrix_kg_m2"], atol=1e-9)


def test_inverse_kinematics_with_all_branches(capsys: pytest.CaptureFixture[str]) -> None:
    to = ["--to", "0.6", "-0.15", "0.65"]
    found = _json(capsys, "puma560", *to, "--rpy", "0", "1.0", "0")["inverse_kinematics"]
    assert found["status"] == "solved" and len(found["branches"]) == 8
    inside = [branch["q"] for branch in found["branches"] if branch["inside_limits"]]
    assert any(np.allclose(q, found["q"], atol=1e-4) for q in inside)
    pointing = _json(capsys, "explorer_arm", "--to", "1.1", "-0.1", "-0.3", "--pointing", "0", "0", "-2")
    assert pointing["inverse_kinematics"]["status"] == "solved" and pointing["inverse_kinematics"]["branches"]
    far = _json(capsys, "puma560", "--to", "9", "0", "0")["inverse_kinematics"]
    assert far["status"] == "unreachable" and "branches" not in far


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["puma560", "--q", "1", "2"], "--q has 2 values: puma560 has 6 joints \\(waist_joint"),
        (["puma560", "--q", "0", "0", "nan", "0", "0", "0"], "--q: 'nan' is no number: allowed are finite numbers"),
        (["puma560", "--qd", "0", "0", "-inf", "0", "0", "0"], "--qd: '-inf' is no number"),
        (["puma560", "--qdd", "a", "0", "0", "0", "0", "0"], "--qdd: 'a' is no number"),
        (["puma560", "--gravity", "-9.81"], "--gravity -9.81: allowed is one number of at least 0, or three"),
        (["puma560", "--gravity", "1", "2"], "--gravity 1 2: allowed is one number"),
        (["puma560", "--payload", "-1"], "--payload -1: allowed is a mass of at least 0 kg"),
        (["puma560", "--payload-at", "0", "0", "1"], "--payload-at goes with --payload"),
        (["puma560", "--to", "1", "2"], "--to has 2 values: allowed is 3"),
        (["puma560", "--rpy", "1", "2", "3"], "--rpy goes with --to"),
        (["puma560", "--workspace", "map.txt"], "ends in .png"),
        (["puma560", "--workspace", "/no/such/map.png"], "there is no folder /no/such"),
    ],
)
def test_what_is_wrong_is_one_sentence(arguments: list[str], words: str) -> None:
    with pytest.raises(UsageError, match=words) as caught:
        main(arguments)
    assert caught.value.exit_status == 2 and "\n" not in str(caught.value)


def test_an_unknown_arm_is_answered_with_the_list() -> None:
    with pytest.raises(ConfigError, match=r"allowed is one of cartesian, cylindrical, .* srms, ssrms"):
        main(["puma", "--json"])


def test_the_table_for_people(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    assert main(["puma560", *NOMINAL, "--to", "0.6", "-0.15", "0.65", "--rpy", "0", "-1", "0"]) == 0
    out = capsys.readouterr().out
    assert "31.6399" in out and "0.5963 -0.1500 0.6576 m" in out and "-0.0000" not in out
    assert "-3.142 is the same posture" in out and "branch" in out
    assert main(["ssrms", "--dh"]) == 0
    out = capsys.readouterr().out
    assert "modified Denavit-Hartenberg table" in out and "7.11" in out


def test_help_names_every_key(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parser().parse_args(["--help"])
    out = capsys.readouterr().out
    for key in KEYS:
        assert key in out


def test_control_laws_are_compared(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    found = _json(capsys, "cartesian", "--control", "--mass-error", "0.3")
    exact, wrong = found["results"]["exact"], found["results"]["wrong_masses"]
    assert set(exact) == set(wrong) == set(LAWS)
    assert exact["computed_torque"]["tip_rms_m"] < 0.2 * exact["pd"]["tip_rms_m"]
    assert wrong["feedforward"]["tip_rms_m"] > exact["feedforward"]["tip_rms_m"]
    assert exact["open_loop"]["gain_margin"] is None and exact["pd"]["gain_margin"] > 1.0
    arm_control.print_comparison(found)
    out = capsys.readouterr().out
    assert "computed_torque" in out and "[mm]" in out and "links +30 % in the law" in out
    with pytest.raises(UsageError, match=r"srms has not the effort .* \(see --gravity\)"):
        main(["srms", "--control"])
    with pytest.raises(UsageError, match="--mass-error -1: allowed is a share above -1"):
        main(["puma560", "--control", "--mass-error", "-1"])


def test_every_form_of_an_orientation_asks_for_the_same_pose(capsys: pytest.CaptureFixture[str]) -> None:
    to = ["puma560", "--to", "0.5", "0.1", "0.6"]
    half = math.sin(0.5), math.cos(0.5)
    forms = (
        ["--rpy", "0", "1", "0"],
        ["--quaternion", "0", str(half[0]), "0", str(half[1])],
        ["--rotation-vector", "0", "1", "0"],
        ["--euler", "0", "1", "0"],
        ["--degrees", "--euler", "0", str(math.degrees(1.0)), "0"],
    )
    first, *others = (_json(capsys, *to, *form)["inverse_kinematics"] for form in forms)
    assert first["status"] == "solved"
    for other in others:
        np.testing.assert_allclose(other["q"], first["q"], atol=1e-6)


def test_joints_to_spare_are_used_as_asked(capsys: pytest.CaptureFixture[str]) -> None:
    to = ["ssrms", "--to", "8", "1", "3", "--quaternion", "0", "0", "0", "1"]
    obstacle = ["--prefer", "clear", "--obstacle", "4", "1", "2", "0.5"]
    for prefer in (["--prefer", "centred"], ["--prefer", "manipulability"], obstacle):
        found = _json(capsys, *to, *prefer)["inverse_kinematics"]
        second = found["secondary"]
        assert second["measure"] > second["measure_of_first"]
        there = _json(capsys, "ssrms", "--q", *(str(q) for q in second["q"]))
        np.testing.assert_allclose(there["tip_position_m"], [8.0, 1.0, 3.0], atol=1e-5)
        np.testing.assert_allclose(there["tip_rotation"], np.eye(3), atol=1e-6)
    assert main([*to, "--prefer", "centred"]) == 0
    assert "centred:" in capsys.readouterr().out
    for wrong in (["--prefer", "clear"], ["--obstacle", "1", "1", "1", "1"]):
        with pytest.raises(UsageError, match="both or neither"):
            main([*to, *wrong])


def test_a_pose_that_is_reached_only_in_collision_is_told_apart(capsys: pytest.CaptureFixture[str]) -> None:
    """The SRMS folded up: every way to be there has the wrist in the lower arm."""
    folded = ["--q", "0.848", "0.67", "-2.638", "-1.964", "1.273", "6.368"]
    posture = _json(capsys, "srms", *folded)
    assert "lower_arm_link and wrist_yaw_link overlap" in posture["collision"]
    to = ["--to", *(str(value) for value in posture["tip_position_m"])]
    turn = ["--quaternion", *(str(value) for value in posture["tip_quaternion_xyzw"])]
    found = _json(capsys, "srms", *folded, *to, *turn)["inverse_kinematics"]
    assert found["status"] == "collision" and "lower_arm_link and wrist_yaw_link" in found["message"]
    assert main(["srms", *folded, *to, *turn]) == 0
    assert "inverse kinematics: collision" in capsys.readouterr().out


def test_motions_on_one_way_are_compared(capsys: pytest.CaptureFixture[str]) -> None:
    """The fastest is that under torque; power makes it slower; a trapezoid is as fast where torque is ample."""
    start, goal = ["--q", "0.1", "0.6", "-2.6", "0.3", "0.9", "0.2"], ["1", "0.9", "-2", "0", "-0.5", "1"]
    rows = _json(capsys, "puma560", *start, "--move-to", *goal, "--power", "60")["motions"]
    assert {"trapezoid", "cubic", "quintic", "cycloidal", "seven_segments"} < set(rows)
    fastest = rows["time_optimal"]
    for name, row in rows.items():
        assert row["duration_s"] >= fastest["duration_s"] * 0.999, name
        assert row["largest_share_of_speed"] <= 1.001 and row["largest_share_of_effort"] <= 1.001
    assert rows["trapezoid"]["duration_s"] == pytest.approx(fastest["duration_s"], rel=1e-3)
    limited = rows["time_optimal_power"]
    assert limited["largest_power_w"] <= 60.5 < fastest["largest_power_w"]
    assert limited["duration_s"] > fastest["duration_s"]
    assert main(["puma560", *start, "--move-to", *goal]) == 0
    assert "seven_segments" in capsys.readouterr().out


def test_the_tip_moves_on_a_line_or_says_why_not(capsys: pytest.CaptureFixture[str]) -> None:
    start = ["--q", ".3", ".4", ".2", ".9", ".5", "1.2", ".2", "--gravity", "0"]
    found = _json(capsys, "ssrms", *start, "--line-to", "5", "3", "4")
    arrived = _json(capsys, "ssrms", "--q", *(str(q) for q in found["to"]))
    np.testing.assert_allclose(arrived["tip_position_m"], [5.0, 3.0, 4.0], atol=1e-4)
    assert found["motions"]["time_optimal"]["largest_share_of_effort"] <= 1.001
    assert found["collision"] == ""
    folding = [
        "--q",
        "0",
        "0.5",
        "-0.5",
        "0",
        "0",
        "0",
        "--move-to",
        "0.848",
        "0.67",
        "-2.638",
        "-1.964",
        "1.273",
        "6.368",
    ]
    assert "lower_arm_link and wrist_yaw_link overlap" in _json(capsys, "srms", *folding, "--gravity", "0")["collision"]
    far = _json(capsys, "puma560", "--line-to", "5", "5", "5")
    assert "% of the path the arm stays" in far["refused"]
    with pytest.raises(UsageError, match="--power goes with"):
        main(["puma560", "--power", "5"])
    with pytest.raises(UsageError, match="--move-to has 2 values: puma560 has 6 joints"):
        main(["puma560", "--move-to", "5", "5"])


def test_the_workspace_is_drawn(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "ws.png"
    found = _json(capsys, "explorer_arm", "--workspace", str(picture), "--gravity", "3.71")
    # from the azimuth axis: bracket, upper arm and forearm in one line, then the tool's tip straight from the wrist
    assert found["reach_from_axis_m"] == pytest.approx(0.05 + 0.41 + 0.4 + math.hypot(0.12, 0.1), abs=0.01)
    assert found["largest_payload_kg"] > 5.0
    with Image.open(picture) as image:
        assert image.width > 1000 and len(image.convert("RGB").getcolors(1 << 20) or []) > 100
