"""Bump switches and spectrometers as sensors of a machine: what they say, power, light, what is refused."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.ground import GROUND, ground_cloud
from sojourn_contract.heartbeat import status_values
from sojourn_contract.values import Odometry
from sojourn_machine.mounting import mounting
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, TILE
from sojourn_sensors.app import SensorsApp
from sojourn_sensors.kinds.bump import BumpSwitch
from sojourn_sensors.kinds.spectrometer import DARK, NOTHING, Spectrometer
from sojourn_sensors.sensor import Truth

BUMPER = "sensors.bumper={kind: bump_switch, link: hazcam_link, width: 0.3, height: 0.1, travel: 0.05}"
SPECTROMETER = (
    "sensors.eye={{kind: spectrometer, link: hazcam_link, range: 6.0, confusion: {{"
    "lunar_nominal: {{lunar_nominal: 0.8, rigid_rock: 0.2}}, rigid_rock: {{rigid_rock: 1.0}}}}{more}}}"
)


def told(more: str = "") -> str:
    return SPECTROMETER.format(more=f", {more}" if more else "")


def sensor(*overrides: str) -> tuple[Any, Truth]:
    """On the explorer, and a truth of it on flat ground."""
    app = SensorsApp(load_scenario("flat_drive", list(overrides)))
    (one,) = (each for each in app.sensors if isinstance(each, BumpSwitch | Spectrometer))
    return one, at(replace(app._at_rest(), stamp=10**9), 0.45)


def at(truth: Truth, height: float) -> Truth:
    pose = np.array([0.0, 0.0, height]), np.array([0.0, 0.0, 0.0, 1.0])
    return replace(truth, odometry=Odometry(0, "map", "base_link", *pose, np.zeros(3), np.zeros(3)))


def said(one: Any, truth: Truth, state: Any = None) -> tuple[dict[str, str], str]:
    """Values and words of its message."""
    reading = one.step(one.initial_state(truth) if state is None else state, truth, 0.02)[1]
    ((_, message),) = one.messages(truth.stamp, reading)
    return status_values(message), message.status[0].message


def test_a_bump_switch_is_open_before_nothing_and_closed_before_a_heap() -> None:
    one, truth = sensor(BUMPER)
    assert one.topic == "/bump/bumper" and said(one, truth)[0] == {"contact": "open"}
    before = one.initial_state(truth)
    _, place = mounting(one.site.scenario.urdf_xml, "hazcam_link")
    side = TILE * before.cell
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[:, :, DUG] = -(place[2] + 0.45 + 0.2)  # heaped up over the plate
    first = [
        int((middle - origin) / side) for middle, origin in zip(place, (before.origin_x, before.origin_y), strict=False)
    ]
    tiles = {(first[0] + i, first[1] + j): tile for i in range(2) for j in (-1, 0)}
    after = GroundMemory(before.cell, before.origin_x, before.origin_y, tiles)
    heaped = replace(truth, inputs={**truth.inputs, GROUND.name: ground_cloud(truth.stamp, before, after)})
    assert said(one, heaped, before)[0] == {"contact": "closed"}


def test_a_bump_switch_closes_on_the_ground_where_its_link_comes_down_to_it() -> None:
    one, truth = sensor(BUMPER)
    turn, place = mounting(one.site.scenario.urdf_xml, "hazcam_link")
    lowest = min((turn @ (0.0, y, z))[2] for y in (-0.15, 0.15) for z in (-0.05, 0.05)) + place[2]
    fall = -turn[2, 0] * 0.05
    assert fall > 0.0, "it looks down, and its travel takes it lower"
    for height, contact in ((fall - lowest - 0.005, "closed"), (fall - lowest + 0.005, "open")):
        assert said(one, at(truth, height))[0] == {"contact": contact}


def test_a_spectrometer_names_the_soil_before_it_as_its_matrix_has_it() -> None:
    one, truth = sensor(told())
    names = [said(one, replace(truth, stamp=10**9 * (1 + k)))[0]["soil"] for k in range(300)]
    assert set(names) == {"lunar_nominal", "rigid_rock"}
    assert names.count("lunar_nominal") / 300 == pytest.approx(0.8, abs=0.08)
    again = [said(one, replace(truth, stamp=10**9 * (1 + k)))[0]["soil"] for k in range(300)]
    assert names == again and one.topic == "/soil/eye"


def test_by_night_it_needs_a_lamp() -> None:
    assert said(*sensor(told(), "sun.elevation_deg=-30")) == ({}, DARK)
    assert said(*sensor(told("lamp: true"), "sun.elevation_deg=-30"))[0].keys() == {"soil"}


def test_too_far_or_nothing_but_the_machine_is_said() -> None:
    assert said(*sensor(told("lamp: true").replace("range: 6.0", "range: 0.2"))) == ({}, NOTHING)
    one, truth = sensor(told())
    assert said(one, at(truth, 20.0)) == ({}, NOTHING)


@pytest.mark.parametrize("override", [BUMPER, told()])
def test_without_power_they_say_nothing(override: str) -> None:
    one, truth = sensor(override)
    ((_, message),) = one.messages(0, one.step_without_power(one.initial_state(truth), truth, 0.02)[1])
    assert status_values(message) == {} and message.status[0].message == ""


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ((BUMPER.replace("hazcam_link", "tail_link"),), "tail_link"),
        ((BUMPER.replace("travel: 0.05", "travel: 0.0"),), "travel"),
        ((told().replace("rigid_rock: 0.2", "rigid_rock: 0.1"),), "sums to 0.9: allowed is 1"),
        ((told(), "soil=grc_1"), "is a soil that the sensor eye does not know"),
    ],
)
def test_what_cannot_be_is_said_before_the_run(overrides: tuple[str, ...], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", list(overrides))
