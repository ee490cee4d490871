"""scripts/rover_datasheet: a page that needs no network, figures as JSON, and one sentence for what is wrong."""

import json
import math
import re
from pathlib import Path

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_studies.datasheet_page import number_text
from sojourn_studies.rover_datasheet import main


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """JSON and page of the lunar roving vehicle."""
    out = tmp_path_factory.mktemp("sheet") / "lrv.html"
    with pytest.MonkeyPatch.context() as patch:
        lines: list[str] = []
        patch.setattr("sojourn_studies.datasheet_of_rover.print", lambda text: lines.append(text), raising=False)
        assert main(["lrv", "--json", "--out", str(out)]) == 0
    return "\n".join(lines), out.read_text(encoding="utf-8")


def test_figures_as_json(printed: tuple[str, str]) -> None:
    found = json.loads(printed[0], parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    assert (found["vehicle"], found["body"], found["soil"]) == ("lrv", "moon", "lunar_nominal")
    assert found["figures"]["energy_per_km"]["unit"] == "Wh/km"
    assert 55.0 < found["figures"]["energy_per_km"]["value"] < 80.0
    # its springs move on upright guides, which carry nothing of the load transfer
    assert found["figures"]["anti_dive"]["value"] == 0.0
    nose = 700.0 * 0.3 * 1.624 * 0.804 / 2.286**2 * 2.0 / 4800.0
    assert found["figures"]["pitch_braking"]["value"] == pytest.approx(-math.degrees(nose), rel=0.01)
    assert 0.0 < found["figures"]["bump_acceleration"]["value"] < found["figures"]["shock"]["value"]
    assert any(entry["source"] and entry["own"] is not None for entry in found["published"])


def test_page_is_whole_and_needs_no_network(printed: tuple[str, str]) -> None:
    text = printed[1]
    for reference in re.findall(r"""(?:src|href)\s*=\s*["']([^"']*)""", text):
        assert reference.startswith("#"), reference
    assert "<script" not in text and "@import" not in text and "url(http" not in text
    assert text.count("<svg") == text.count("</svg>") >= 10
    # inner names of one drawing do not hide those of another, and all that are asked for are there
    names = re.findall(r'\bid="([^"]+)"', text)
    assert len(names) == len(set(names))
    assert set(re.findall(r'(?:href="#|url\(#)([^")]+)', text)) <= set(names)
    assert "Published figures beside its own" in text and "Wh/km" in text


def test_a_machine_of_the_plant_shows_what_its_plant_does(capsys: pytest.CaptureFixture[str]) -> None:
    """Fixed wheels on a rigid frame: modes of the linearised plant, ruts, turns by slip alone."""
    assert main(["skid", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)["figures"]
    modes = [figure for key, figure in figures.items() if key.startswith("plant_mode_")]
    assert {"heave", "pitch", "roll", "yaw"} <= {figure["label"].split(": ")[1] for figure in modes}
    assert all(0.5 < figure["value"] < 20.0 for figure in modes)
    assert figures["roll_steer"]["value"] is None
    assert figures["width_ratio"]["value"] > 1.2
    assert 0.0 < figures["level_slip_in_ruts"]["value"] < figures["level_slip_fresh"]["value"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["lvr"], ["machine", "lvr", "lrv", "explorer"]),
        (["lrv", "--soil", "cheese"], ["cheese", "lunar_nominal"]),
        (["lrv", "--body", "krypton"], ["krypton", "moon"]),
        (["explorer", "--soil", "cheese"], ["cheese", "lunar_nominal"]),
    ],
)
def test_wrong_names_are_told_with_the_right_ones(arguments: list[str], words: list[str]) -> None:
    with pytest.raises(ConfigError) as error:
        main(arguments)
    for word in words:
        assert word in str(error.value)


def test_a_folder_is_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Nothing:
        sections = comparisons = ()

    monkeypatch.setattr("sojourn_studies.datasheet_of_rover.datasheet", lambda subject: Nothing)
    with pytest.raises(UsageError, match="cannot be written"):
        main(["lrv", "--out", str(tmp_path)])


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1.914527, "1.915"), (1136.95, "1\u202f137"), (4.5e-4, "4.5 × 10⁻⁴"), (None, "–"), ("yes", "yes"),
     (float("inf"), "none"), (-21.73, "-21.73"), (100.0, "100")],
)  # fmt: skip
def test_numbers_are_readable(value: float | str | None, text: str) -> None:
    assert number_text(value) == text


def test_a_machine_that_stands_tells_of_its_motors(capsys: pytest.CaptureFixture[str]) -> None:
    """Brushless ones with heat: what they bear for ever lies below what they give, and their magnets below the knee."""
    assert main(["srms", "--body", "low_earth_orbit", "--json"]) == 0
    figures = {key: figure["value"] for key, figure in json.loads(capsys.readouterr().out)["figures"].items()}
    for joint in ("arm_shoulder_yaw", "arm_elbow_pitch", "arm_wrist_roll"):
        assert 0.0 < figures[f"continuous_torque_{joint}"] <= figures[f"motor_torque_{joint}"]
        assert 0.0 < figures[f"demagnetisation_warm_{joint}"] < figures[f"demagnetisation_cold_{joint}"]
        assert figures[f"weakened_torque_{joint}"] > 0.0
    assert "mass" not in figures


def test_a_machine_on_tracks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "tracked.html"
    assert main(["tracked", "--json", "--out", str(out)]) == 0
    found = json.loads(capsys.readouterr().out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))
    figures = found["figures"]
    assert figures["ground_pressure"]["value"] == pytest.approx(120.0 * 1.6242 / 0.224 / 1000.0, rel=1e-3)
    assert 0.0 < figures["spin_moment"]["value"] < figures["steeds_moment"]["value"]
    assert figures["highest_step"]["value"] > 0.1, "its course has a step of 0.1 m"
    assert figures["greatest_grade"]["value"] > 15.0, "and a slope of 15 degrees"
    assert figures["spin_torque"]["value"] < figures["spin_torque_available"]["value"]
    text = out.read_text(encoding="utf-8")
    for title in ("Vehicle", "Standing", "Ground pressure and traction", "Climbing", "Turning", "Motors"):
        assert f"<h2>{title}</h2>" in text
    assert text.count("<svg") == text.count("</svg>") == 7


def test_tracks_on_rock_are_refused() -> None:
    with pytest.raises(UsageError, match="gives way"):
        main(["tracked", "--soil", "rigid_rock"])
