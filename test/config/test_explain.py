"""A wrong key of a table that names its kind is answered with what that kind allows."""

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario


def told(*overrides: str) -> str:
    """What is said of the explorer on flat ground with these overrides."""
    with pytest.raises(ConfigError) as raised:
        load_scenario("flat_drive", list(overrides))
    return str(raised.value)


@pytest.mark.parametrize(
    ("kind", "key", "words"),
    [
        ("hazcam", "range", "at most 100 (longest distance of a point [m])"),
        ("lidar", "range", "at most 5000 (R_0: longest distance, to a target of `reflectance` [m])"),
        ("magnetometer", "range", "at most 10 (largest flux density of an axis that it reads [T])"),
        ("hazcam", "columns", "a whole number at least 2, at most 512 (rays across [-])"),
        ("lidar", "columns", "a whole number at least 1, at most 4096 (beams from left to right [-])"),
        ("magnetometer", "resolution", "a number above 0, at most 0.001 (least bit [T])"),
    ],
)
def test_a_key_that_kinds_share_has_the_bounds_of_the_kind_that_is_told(kind: str, key: str, words: str) -> None:
    assert f"eye.{key} = -1: allowed is a" in (said := told(f"sensors.eye.kind={kind}", f"sensors.eye.{key}=-1"))
    assert words in said


def test_an_unknown_key_is_answered_with_the_keys_of_its_own_kind() -> None:
    said = told("machine=explorer_cameras", "sensors.navcam.range=5")
    assert said.endswith("allowed is one of detector, faults, kind, lens, link, on_demand, stereo, timing")


def test_the_kind_that_is_told_counts_before_that_of_the_name() -> None:
    said = told("sensors.sun.kind=hazcam", "sensors.sun.rows=1")
    assert "sun.rows = 1: allowed is a whole number at least 2, at most 512 (rays from bottom to top [-])" in said
    assert "sun.baseline: the key is missing: allowed is a number above 0, at most 2" in said


def test_a_kind_that_is_not_there_is_told_with_those_that_are() -> None:
    assert "did you mean lidar?" in told("sensors.eye.kind=lidr", "sensors.eye.range=-1")
