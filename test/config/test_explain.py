"""A wrong key of a table that names its kind is answered with what that kind allows."""

import pytest
from pydantic import BaseModel, Field

from sojourn_config.errors import ConfigError
from sojourn_config.load import validate
from sojourn_config.scenario import load_scenario
from sojourn_config.yaml_file import parse_yaml


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


class _Step(BaseModel):
    at: float = Field(description="time [s]")


class _Steps(BaseModel):
    steps: tuple[_Step, ...] = Field(min_length=1, max_length=2, description="in order")
    name: str | None = Field(default=None, min_length=1, description="of them")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("steps: [{at: soon}]", ["steps[0].at = 'soon': is text: allowed is a number (time [s]), with no quotes"]),
        ("steps: [{at: a}, {at: b}]", ["steps[0].at = 'a': is text", "steps[1].at = 'b': is text"]),
        ("steps: []", ["steps = []: allowed is a list of at least 1 values, of at most 2 values (in order)"]),
        ("steps: [{at: 1}, {at: 2}, {at: 3}]", ["allowed is a list of at least 1 values, of at most 2 values (in"]),
        ("{steps: [{at: 1}], name: ''}", ["name = '': allowed is text of at least 1 characters (of them)"]),
    ],
)
def test_a_list_is_told_once_what_is_wrong_with_it(text: str, said: list[str]) -> None:
    """Each mistake by itself, in our own words: a list whose values are refused is not told to be empty as well."""
    with pytest.raises(ConfigError) as raised:
        validate(parse_yaml(text, "steps.yaml"), _Steps)
    told = [str(problem) for problem in raised.value.problems]
    assert len(told) == len(said) and all(words in line for words, line in zip(said, told, strict=True))
    assert not any("should" in line for line in told)
