"""Keep-out zones and waypoints of a scenario: known to the flight side, refused where they cannot be."""

import json

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_flight, load_scenario

LANDER = {"name": "lander", "points": [[2.0, -1.0], [3.0, -1.0], [3.0, 1.0]]}


def told(*zones: object, **others: object) -> list[str]:
    return [f"keep_out={json.dumps(zones)}", *(f"{key}={json.dumps(value)}" for key, value in others.items())]


def test_the_flight_side_knows_the_zones() -> None:
    overrides = told(LANDER, steps=[{"drive_to": {"x": 4.0, "y": 0.0}}])
    known = load_flight("flat_drive", overrides)
    assert known.keep_out == load_scenario("flat_drive", overrides).as_believed().keep_out
    assert [zone.name for zone in known.keep_out] == ["lander"]
    assert load_flight("flat_drive").keep_out == ()


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (told(LANDER, LANDER, steps=[]), r"keep_out\[1\].name = 'lander': is there above already"),
        (told(LANDER, steps=[], start={"x": 2.9, "y": 0.0}), "start = .*lies in the keep-out zone lander"),
        (told(LANDER, steps=[{"drive_to": {"x": 2.9, "y": 0.0}}]), r"steps\[0\].drive_to = .*\(2.9, 0\).*lander"),
        (told({"name": "line", "points": [[0, 5], [1, 5], [2, 5]]}), r"keep_out\[0\].*encloses 0 m2"),
        (told({"name": "short", "points": [[0, 5], [1, 5]]}), r"keep_out\[0\].points"),
        ([*told(), "waypoints={rim: {x: 900.0, y: 0.0}}"], r"waypoints.rim.x = 900.0: is off the terrain"),
    ],
)
def test_what_cannot_be_is_told(overrides: list[str], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", overrides)
