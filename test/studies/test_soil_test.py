"""scripts/soil_test as a user types it."""

import json
import math
from typing import Any

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_studies import soil_test


def run_json(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    assert soil_test.main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_pad_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    """0.2 m under 50 N on nominal lunar soil: (1400/0.1 + 820e3) z = 50/(pi 0.01)."""
    found = run_json(capsys, "--diameter", "0.2", "--load", "50", "--safety", "2")
    (pad,) = found["pads"]
    pressure = 50.0 / (math.pi * 0.01)
    assert pad["pressure_kpa"] == pytest.approx(pressure / 1e3)
    assert pad["sinkage_mm"] == pytest.approx(1e3 * pressure / 834e3)
    assert pad["safe_load_n"] == pytest.approx(0.5 * 1e3 * pad["fails_at_kpa"] * math.pi * 0.01)
    assert 0.0 <= pad["rut_mm"] < pad["sinkage_mm"]
    shear = found["shear"]
    limit = 170.0 + pressure * math.tan(math.radians(35.0))
    expected = [limit * (1.0 - math.exp(-mm / 17.8)) for mm in shear["displacement_mm"]]
    assert shear["stress_pa"] == pytest.approx(expected)


def test_lunar_soil_is_denser_and_stronger_below(capsys: pytest.CaptureFixture[str]) -> None:
    depths = run_json(capsys, "--depth", "0.05,0.3,0.6")["depths"]
    for key in ("density_kg_m3", "mean_density_kg_m3", "cohesion_pa", "friction_angle_deg", "fails_at_kpa"):
        values = [row[key] for row in depths]
        assert values == sorted(values) and values[0] < values[-1]
    assert all(row["mean_density_kg_m3"] < row["density_kg_m3"] for row in depths)


def test_digging_is_a_pile_that_is_pushed_up(capsys: pytest.CaptureFixture[str]) -> None:
    """Without cohesion it grows with the square of the depth, but for what breaks out at the sides."""
    wide = ("--blade", "10", "--rake", "90", "--set", "cohesion=0", "--cut", "0.05,0.1")
    shallow, deep = run_json(capsys, *wide)["digging"]
    assert deep["blade_n"] / shallow["blade_n"] == pytest.approx(4.0, rel=0.02)
    # Coulomb's wall with friction on it (tables of textbooks: K_p 5.69 at 35 degrees, 15 on the wall)
    phi, on_wall = math.radians(35.0), math.radians(15.0)
    root = math.sqrt(math.sin(phi + on_wall) * math.sin(phi) / math.cos(on_wall))
    passive = math.cos(phi) ** 2 / (math.cos(on_wall) * (1.0 - root) ** 2)
    wall = 0.5 * 1520.9 * 1.6248 * 0.1**2 * 10.0 * passive * math.cos(on_wall)
    assert deep["blade_n"] == pytest.approx(wall, rel=0.02)
    (cohesive,) = run_json(capsys, "--blade", "10", "--rake", "90", "--cut", "0.1")["digging"]
    assert cohesive["blade_n"] > deep["blade_n"] and cohesive["bucket_n"] > deep["bucket_n"] > deep["blade_n"]


def test_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert soil_test.main(["dry_sand", "--body", "earth"]) == 0
    text = capsys.readouterr().out
    assert "dry_sand" in text and "safe_load_n" in text and "9.82" in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["porridge"], ("porridge", "lunar_nominal")),
        (["rigid_rock"], ("rigid_rock", "rock")),
        (["snow", "--depth", "0.1"], ("snow", "lunar_")),
        (["--depth", "5"], ("depth", "3 m")),
        (["--load", "-1"], ("--load", "more than 0")),
        (["--rake", "120"], ("rake", "90 degrees")),
        (["--blade", "0"], ("width", "above 0")),
        (["--safety", "0.5"], ("safety", "at least 1")),
        (["--set", "stickiness=1"], ("stickiness",)),
    ],
)
def test_one_sentence_for_what_is_wrong(arguments: list[str], words: tuple[str, ...]) -> None:
    with pytest.raises((UsageError, ConfigError)) as caught:
        soil_test.main(arguments)
    for word in words:
        assert word in str(caught.value)
