"""A drive reckoned: the ground under it, what it takes, and that it drives as the whole of the apps does."""

import json
import math

import pytest

from sojourn_config.scenario import load_scenario
from sojourn_console.reckoning import DT, TripAccount, reckon
from sojourn_console.rehearsal import rehearse
from sojourn_console.rehearsed import RECKONED
from sojourn_flight.planning.energy_params import EnergyParams

COSTS = EnergyParams(
    energy_per_metre=(200.0, 250.0, 300.0, 400.0, 500.0),
    time_per_metre=(10.0, 10.0, 10.0, 11.0, 15.0),
    stop_energy=30.0,
    stop_time=3.0,
    turn_energy=50.0,
    turn_time=4.0,
    energy_per_radian=300.0,
    time_per_radian=9.0,
    house_power=90.0,
)
BLOCK = {"name": "block", "points": [[1.5, -2.5], [2.5, -2.5], [2.5, 0.6], [1.5, 0.6]]}


def way(scenario: str, x: float, y: float, *others: str):
    return load_scenario(scenario, [f"steps={json.dumps([{'drive_to': {'x': x, 'y': y}}])}", *others])


def test_what_a_way_takes_is_the_sum_of_its_costs() -> None:
    account = TripAccount(COSTS)
    for speed, yaw_rate, grade in ((0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.1, 0.05, math.radians(8.0)), (0.0, 0.0, 0.0)):
        for _ in range(100):
            account.add(speed, yaw_rate, grade)
    assert account.length == pytest.approx(2.0)
    assert account.seconds == pytest.approx(10.0 + 10.0 + 10.0 * 1.5 + 10.0)  # up 8 degrees it is slower by half
    motion = 300.0 + 500.0 + 2 * 30.0 + 50.0 + 2.0 * 300.0
    assert account.energy_wh == pytest.approx((motion + 90.0 * 45.0) / 3600.0)


def test_it_comes_to_what_all_apps_come_to() -> None:
    """A turn, a drive, a rest: the same end, time and energy within the tenth that is asked."""
    loaded = way("flat_drive", 0.5, 1.2)
    *_, found = reckon(loaded)
    *_, simulated = rehearse(loaded)
    assert found.is_over and found.means == RECKONED and found.state == simulated.state == "reached"
    assert found.time_s == pytest.approx(simulated.time_s, rel=0.1)
    assert found.energy_wh == pytest.approx(simulated.energy_wh, rel=0.1)
    assert found.length_m == pytest.approx(simulated.length_m, rel=0.1)


def test_it_goes_round_what_the_drive_goes_round() -> None:
    free, led = (list(reckon(way("flat_drive", 4.0, 0.0, f"keep_out={json.dumps(zones)}"))) for zones in ([], [BLOCK]))
    assert free[-1].state == led[-1].state == "reached"
    assert led[-1].length_m > free[-1].length_m + 0.3 and led[-1].energy_wh > 1.05 * free[-1].energy_wh
    assert [found.is_over for found in led].count(True) == 1
    assert 0.9 * free[-1].time_s < DT * len(free) < 1.1 * free[-1].time_s


def test_a_goal_that_cannot_be_says_why() -> None:
    near = {**BLOCK, "points": [[2.2, -1.0], [3.0, -1.0], [3.0, 1.0]]}
    *_, found = reckon(way("flat_drive", 2.0, 0.0, f"keep_out={json.dumps([near])}"))
    assert found.is_over and found.state == "refused" and "keep-out zone block at (2." in found.reason


def test_a_machine_whose_costs_are_not_known_is_not_reckoned() -> None:
    assert not list(reckon(way("flat_drive", 1.0, 0.0, "drive.energy=null")))
