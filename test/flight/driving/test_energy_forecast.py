"""The energy forecast by hand, and what the drive does with it."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.energy_forecast import (
    EnergyLeft,
    EnergyUse,
    Forecast,
    account_status,
    forecast_way,
    on_grade,
    shortage,
)
from sojourn_flight.planning.energy_params import EnergyParams
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.path import PlannedPath
from sojourn_flight.planning.path_planner import plan_path
from wheel_drive import WheelDrive, WheelInput

COSTS = EnergyParams(
    grades_deg=(-4.0, 0.0, 4.0),
    energy_per_metre=(300.0, 400.0, 600.0),
    time_per_metre=(10.0, 10.0, 12.0),
    stop_energy=30.0,
    stop_time=3.0,
    turn_energy=50.0,
    turn_time=6.0,
    energy_per_radian=200.0,
    time_per_radian=9.0,
    house_power=90.0,
    margin=0.2,
    refuse=True,
)

START = Pose(0.0, 0.0, 0.0)


def way(model: WheelDrive, goal: Goal, z: float = 0.0) -> Forecast:
    path = plan_path(model.params.follower, TurningLimits(0.7, 2.7, True), START, goal)
    assert isinstance(path, PlannedPath)
    return forecast_way(COSTS, path, goal, z, 0.0)


def test_a_level_way_with_turns(model: WheelDrive) -> None:
    """Straight, a right angle, straight, and back to the first heading."""
    found = way(model, Goal.along([(4.0, 0.0), (4.0, 3.0)], 0.0))
    assert found.motion == pytest.approx(7.0 * 400.0 + 2 * 30.0 + 2 * 50.0 + math.pi * 200.0)
    assert found.seconds == pytest.approx(7.0 * 10.0 + 2 * 3.0 + 2 * 6.0 + math.pi * 9.0)
    assert found.house == pytest.approx(90.0 * found.seconds)
    assert found.climb is None


def test_known_heights_make_grades(model: WheelDrive) -> None:
    goal = replace(Goal.along([(2.0, 0.0), (5.0, 0.0), (9.0, 0.0)]), heights=(None, 1.0 + 5.0 * math.sin(0.05), None))
    found = way(model, goal, z=1.0)
    expected = 5.0 * (400.0 + 200.0 * 0.05 / math.radians(4.0)) + 4.0 * 400.0 + 30.0
    assert found.motion == pytest.approx(expected)
    assert found.climb is None, "the end is not known"
    up = way(model, replace(Goal.at(6.0, 0.0), heights=(0.3,)))
    assert up.climb == pytest.approx(0.3)


def test_beyond_the_measured_grades_it_goes_on_straight_and_never_below_nothing() -> None:
    assert on_grade(COSTS, COSTS.energy_per_metre, math.radians(6.0)) == pytest.approx(700.0)
    assert on_grade(COSTS, COSTS.energy_per_metre, math.radians(-8.0)) == pytest.approx(200.0)
    assert on_grade(COSTS, COSTS.energy_per_metre, math.radians(-40.0)) == 0.0
    assert on_grade(COSTS, COSTS.energy_per_metre, math.radians(2.0)) == pytest.approx(500.0)


def supply(left: float) -> EnergyLeft:
    return EnergyLeft(left=left, soc=0.3, reserve=0.1, power=100.0)


def test_the_margin_and_the_switch_decide() -> None:
    forecast = Forecast(motion=2000.0, house=1000.0, seconds=60.0, length=5.0, climb=0.2)
    assert shortage(COSTS, forecast, supply(3601.0)) is None
    reason = shortage(COSTS, forecast, supply(3599.0))
    assert reason == (
        "the charge does not suffice: forecast 0.83 Wh (driving 0.56 Wh, everything else 0.28 Wh in 60 s; 5.0 m, "
        "climbs +0.20 m), with 20 % margin 1.00 Wh; left are 1.00 Wh, from 30.0 % of charge down to the reserve of "
        "10.0 %"
    )
    assert shortage(COSTS.model_copy(update={"refuse": False}), forecast, supply(-1.0)) is None


def driving(model: WheelDrive, **changes: object) -> WheelDrive:
    costs = COSTS.model_copy(update=changes)
    return WheelDrive(model.params.model_copy(update={"energy": costs}), model.geometry)


def test_a_goal_that_the_charge_does_not_allow_is_refused_unless_told_otherwise(
    model: WheelDrive, machine: Callable
) -> None:
    poor = supply(1000.0)
    state, output = machine().run(driving(model).initial_state(), 0.02, goal=Goal.at(5.0, 0.0), supply=poor)
    state, output = driving(model).step(
        model.initial_state(), machine().measure(goal=Goal.at(5.0, 0.0), supply=poor), 0.02
    )
    assert [outcome.kind for outcome in output.outcomes] == ["refused"]
    assert "left are 0.28 Wh" in output.outcomes[0].reason
    assert state.mode == "idle" and not output.wheel_rates.any()
    bold = driving(model, refuse=False)
    state, output = bold.step(model.initial_state(), machine().measure(goal=Goal.at(5.0, 0.0), supply=poor), 0.02)
    assert state.mode == "goal" and not output.outcomes


def test_a_goal_from_before_the_first_reading_is_judged_by_it(model: WheelDrive, machine: Callable) -> None:
    for left, kinds in ((1000.0, ["refused"]), (1e6, [])):
        rover, careful = machine(), driving(model)
        state, output = careful.step(careful.initial_state(), rover.measure(goal=Goal.at(5.0, 0.0)), 0.02)
        assert state.mode == "goal"
        state, output = careful.step(state, rover.measure(supply=supply(left)), 0.02)
        assert [outcome.kind for outcome in output.outcomes] == kinds


def test_what_the_goal_takes_is_counted_until_it_ends(model: WheelDrive, machine: Callable) -> None:
    rover, careful = machine(), driving(model)
    rover.model = careful
    state, output = rover.run(careful.initial_state(), 10.0, goal=Goal.at(3.0, 0.0), supply=supply(1e6))
    assert output.status["energy_used_wh"] == pytest.approx(100.0 * 10.0 / 3600.0)
    assert state.follower is not None
    part = state.follower.distance_to_go / 3.0
    assert output.status["energy_to_go_wh"] == pytest.approx(output.status["energy_forecast_wh"] * part)
    while not output.outcomes:
        state, output = rover.run(state, 0.02, supply=supply(1e6))
    used = output.status["energy_used_wh"]
    state, output = rover.run(state, 5.0, supply=supply(1e6))
    assert output.status["energy_used_wh"] == pytest.approx(used)
    assert output.status["energy_to_go_wh"] == 0.0
    assert account_status(EnergyUse(), 1.0) == {}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"energy_per_metre": (1.0, 2.0)}, "energy_per_metre: 2 numbers, allowed are 3"),
        ({"grades_deg": (0.0, 0.0, 4.0)}, "allowed are rising numbers"),
        ({"time_per_metre": (1.0, -2.0, 3.0)}, "allowed are numbers from 0"),
    ],
)
def test_tables_that_do_not_fit_are_refused(changes: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        EnergyParams.model_validate(COSTS.model_dump() | changes)


@pytest.mark.parametrize("rover", ["articulated", "explorer", "lrv", "lunokhod", "micro", "omni", "skid"])
def test_every_rover_knows_what_a_way_will_cost_and_refuses_one_beyond_its_charge(rover: str) -> None:
    scenario = load_scenario("flat_drive", [f"machine={rover}", "steps=[]"])
    model = WheelDrive(scenario.drive, scenario.steering)
    wheels = np.zeros(len(scenario.steering.wheels))
    for left, kind in ((1e9, None), (10.0, "refused")):
        supply = EnergyLeft(left, 0.5, 0.2, 50.0)
        goal = Goal.at(6.0, 0.0)
        inputs = WheelInput(
            wheels, wheels, wheels, gyro=(0.0, 0.0, 0.0), roll_pitch=(0.0, 0.0), goal=goal, supply=supply
        )
        state, output = model.step(model.initial_state(), inputs, 0.02)
        assert [outcome.kind for outcome in output.outcomes] == ([] if kind is None else [kind])
        if kind is None:
            assert state.energy.forecast is not None and state.energy.forecast.total > 10.0
        else:
            assert "Wh" in output.outcomes[0].reason
