"""The explorer and its ruts: rear wheels run in those of the front, states branch, nothing is lost or gained."""

import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_physics.plant.state import PlantOutput, PlantState
from sojourn_physics.plant.step import step
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.terrain.memory_tiles import DUG, RUT

Machines = Callable[..., Any]
FRONT, MIDDLE, REAR = [0, 1], [2, 3], [4, 5]
SINKAGE, TORQUE, FORCE_Z = 3, 9, 8
RATE = 0.6
K_PLATE = 1400.0 / 0.16 + 820.0e3
"""k of lunar_nominal under a wheel of 0.16 m [N/m3], n = 1."""


def compaction(sinkage: np.ndarray, greatest: float, rut: float) -> np.ndarray:
    """b times the work of Bekker's loop per area [N], by hand, for n = 1."""
    depth = np.maximum(sinkage, 0.0)
    rebound = greatest - rut
    if rut <= 0.0:
        return 0.16 * 0.5 * K_PLATE * depth**2
    stiffness = K_PLATE * greatest / rebound
    reload = 0.5 * stiffness * np.minimum(depth, rebound) ** 2
    virgin = 0.5 * K_PLATE * (np.maximum(depth + rut, greatest) ** 2 - greatest**2)
    return 0.16 * (reload + virgin)


@pytest.fixture(scope="module")
def straight(machine: Machines) -> Any:
    """Eleven seconds straight ahead: all wheels but the front ones have been in a rut for 0.2 m."""
    flat = machine("flat_drive")
    reports: list[np.ndarray] = []
    states: list[PlantState] = []

    def watch(state: PlantState, output: PlantOutput) -> None:
        reports.append(output.contacts[:6].copy())
        states.append(state)

    flat.run(15.0, flat.hold(RATE), watch=watch)
    return flat, states, np.array(reports)


def test_rear_wheels_meet_less_compaction_resistance_than_the_front_ones(straight: Any) -> None:
    _, states, reports = straight
    late = reports[-100:].mean(axis=0)
    last = states[-1].ground
    resistance = np.zeros(6)
    for wheel, report in enumerate(late):
        greatest, rut, _ = last.sample(report[0] + 0.1, report[1])  # the ground ahead of it
        resistance[wheel] = compaction(report[SINKAGE], greatest, rut)
    for side in (0, 1):
        assert last.sample(late[FRONT[side], 0] + 0.1, late[FRONT[side], 1]) == (0.0, 0.0, 0.0)
        assert resistance[MIDDLE[side]] < 0.6 * resistance[FRONT[side]]
        assert resistance[REAR[side]] < 0.75 * resistance[FRONT[side]]  # it carries 15 % more
    assert late[REAR, SINKAGE].max() < 0.5 * late[FRONT, SINKAGE].min()


def test_each_pass_deepens_the_rut_less_than_the_one_before(straight: Any) -> None:
    _, states, reports = straight
    late = reports[-1]
    y = late[0, 1]
    behind = {
        name: states[-1].ground.sample(late[wheel, 0] - 0.15, y)[1] for name, wheel in (("f", 0), ("m", 2), ("r", 4))
    }
    assert 0.010 < behind["f"] < behind["m"] <= behind["r"] + 1e-9
    assert behind["r"] - behind["m"] < behind["f"]
    assert behind["m"] - behind["f"] < 0.3 * behind["f"]


def test_a_machine_without_memory_has_no_such_effect(machine: Machines) -> None:
    flat = machine("flat_drive", "terrain.memory=false")
    reports: list[np.ndarray] = []
    end = flat.run(6.0, flat.hold(RATE), watch=lambda _, output: reports.append(output.contacts[:6].copy()))
    late = np.array(reports[-100:]).mean(axis=0)
    assert not end.ground.tiles
    assert late[REAR, SINKAGE].min() > 0.95 * late[FRONT, SINKAGE].max()


def test_the_work_on_the_soil_is_never_given_back(straight: Any) -> None:
    flat, states, _ = straight
    work = np.array([state.energy.soil_work for state in states])
    assert states[-1].energy.balance_error(flat.start.energy) < 1e-6
    assert (np.diff(work[::50]) > 0.0).all()  # second by second


def test_ruts_are_part_of_the_state(straight: Any, numbers_of: Callable[[Any], Any]) -> None:
    flat, states, _ = straight
    middle = states[400]
    saved = pickle.loads(pickle.dumps(middle))
    kept = {key: tile.copy() for key, tile in middle.ground.tiles.items()}
    end = flat.run(2.0, flat.hold(-RATE), middle)
    other = flat.run(2.0, flat.hold(RATE), middle.copy())
    again = flat.run(2.0, flat.hold(-RATE), saved)
    assert np.array_equal(numbers_of(end), numbers_of(again))
    assert not np.array_equal(numbers_of(end), numbers_of(other))
    assert end.ground.tiles.keys() == again.ground.tiles.keys()
    assert all(np.array_equal(end.ground.tiles[key], again.ground.tiles[key]) for key in end.ground.tiles)
    assert all(np.array_equal(middle.ground.tiles[key], kept[key]) for key in kept)


def test_forgotten_ruts_change_the_run(straight: Any, numbers_of: Callable[[Any], Any]) -> None:
    """So that the test above can fail: the ruts do matter to what follows."""
    flat, states, _ = straight
    middle = states[-1]
    fresh = replace(middle, ground=flat.model.untouched_ground)
    there, _ = step(flat.model, middle, flat.hold(RATE))
    here, _ = step(flat.model, fresh, flat.hold(RATE))
    assert not np.array_equal(numbers_of(here), numbers_of(there))


def test_ruts_can_be_read_as_a_height_map(straight: Any) -> None:
    flat, states, reports = straight
    ground = flat.model.terrain
    x, y = np.arange(-1.5, 1.0, 0.05), np.arange(-0.8, 0.8, 0.05)
    ruts = states[-1].ground.grid(x, y)[..., RUT]
    tracks = y[ruts.max(axis=1) > 0.005]
    wheel_y = reports[-1, :2, 1]
    assert np.abs(np.abs(tracks) - abs(wheel_y[0])).max() < 0.13
    assert ruts.max() < 0.02 and ruts.min() == 0.0
    assert ground.height(0.0, 0.0) == 0.0  # the ground itself is as it was


def test_a_drive_leaves_banks_beside_its_ruts(straight: Any) -> None:
    """A fifth of the soil of the ruts stands beside them, and nothing in the tracks that the rear wheels run in."""
    flat, states, reports = straight
    share = flat.model.soils[0, SoilColumn.COMPACTED_SHARE]
    tiles = [tile.astype(np.float64) for tile in states[-1].ground.tiles.values()]
    ruts, dug = sum(tile[..., RUT].sum() for tile in tiles), sum(tile[..., DUG].sum() for tile in tiles)
    assert share == 0.8 and -dug == pytest.approx(0.2 * ruts, rel=1e-3)
    track = abs(reports[-1, 0, 1])
    x, y = np.arange(0.0, 0.5, 0.025), np.arange(0.0, 1.0, 0.0125)
    heaped = -states[-1].ground.grid(x, y)[..., DUG].mean(axis=1)
    aside = np.abs(y - track)
    assert heaped[aside < 0.05].max() == 0.0
    assert 0.001 < heaped.max() < 0.006 and 0.07 < aside[np.argmax(heaped)] < 0.14
    assert heaped[aside > 0.2].max() == 0.0


def test_a_rover_that_stops_leaves_the_ground_alone(straight: Any) -> None:
    """Parked in its own ruts, between its own banks: after it has swung out not a node changes."""
    flat, states, _ = straight
    resting = flat.run(8.0, flat.hold(0.0), states[-1])
    later = flat.run(2.0, flat.hold(0.0), resting)
    assert later.ground.tiles.keys() == resting.ground.tiles.keys()
    for key, tile in resting.ground.tiles.items():
        assert np.abs(later.ground.tiles[key] - tile).max() < 1e-6
    assert np.abs(later.configuration - resting.configuration).max() < 1e-5
