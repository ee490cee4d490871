"""What a goal would come to, asked before it starts: the same answer as the goal gets, and nothing moves."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rover_in_a_loop import Loop

from sojourn_config.scenario import load_scenario
from sojourn_contract.hazcam import hazard_camera_of
from sojourn_flight.planning.energy_forecast import EnergyLeft
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.supervision.drive import DriveModel
from sojourn_flight.supervision.foresight import foresee, foresight_status

GRADE_DEG = 6.0
ROCK = (3.2, 0.1)


@pytest.fixture(scope="module")
def seen() -> Loop:
    """The explorer on a slope that rises ahead, with a rock on it, after it has looked."""
    terrain = (
        "terrain.kind=slope",
        f"terrain.slope_deg={GRADE_DEG}",
        'terrain.rocks=[{"x": 3.2, "y": 0.1, "diameter": 0.6, "height": 0.35}]',
    )
    size = ("terrain.size_y=12.0", "terrain.size_x=16.0", "terrain.center_x=4.0", "terrain.resolution=0.05")
    made = Loop(load_scenario("flat_drive", ["steps=[]", "start.x=0.0", *size, *terrain]))
    made.run(3.0)
    return made


@pytest.fixture(scope="module")
def model() -> DriveModel:
    scenario = load_scenario("flat_drive", ["steps=[]"])
    return DriveModel(scenario.drive, scenario.mobility(), hazard_camera_of(scenario))


@settings(max_examples=60, deadline=None)
@given(
    x=st.floats(-150.0, 150.0) | st.just(math.nan),
    y=st.floats(-150.0, 150.0),
    yaw=st.none() | st.floats(-3.0, 3.0),
    left=st.none() | st.floats(-1e4, 2e6),
)
def test_it_is_the_answer_that_the_goal_gets(
    model: DriveModel, x: float, y: float, yaw: float | None, left: float | None
) -> None:
    goal, state = Goal.at(x, y, yaw), model.initial_state(0.0, 0.0, 0.0)
    supply = None if left is None else EnergyLeft(left, 0.8, 0.2, 40.0)
    found = foresee(model, state.avoidance, goal, state.odometry, supply)
    told = foresight_status(model, found, supply)
    assert (told["asked_state"] == "refused") == isinstance(found.answer, GoalOutcome)
    assert (told["asked_reason"] != "") == (told["asked_state"] == "refused")
    if found.path is None:
        assert set(told) == {"asked_state", "asked_reason"}
        return
    assert told["asked_length_m"] >= math.hypot(x, y) - 1e-6 or math.hypot(x, y) < 0.2
    assert told["asked_energy_wh"] >= 0.0 and told["asked_time_s"] >= 0.0
    if supply is None:
        assert "asked_charge_at_end" not in told
    elif told["asked_state"] == "allowed" and supply.left > 0.0:
        assert 0.2 - 1e-9 <= told["asked_charge_at_end"] <= 0.8


def test_the_charge_at_the_end_is_the_reserve_where_all_above_it_is_used(model: DriveModel) -> None:
    state, goal = model.initial_state(0.0, 0.0, 0.0), Goal.at(20.0, 0.0)
    cost = foresee(model, state.avoidance, goal, state.odometry, None).forecast
    assert cost is not None
    supply = EnergyLeft(cost.total, 0.8, 0.2, 40.0)
    found = foresee(model, state.avoidance, goal, state.odometry, supply)
    assert foresight_status(model, found, supply)["asked_charge_at_end"] == pytest.approx(0.2)
    assert isinstance(found.answer, GoalOutcome) and " % margin" in found.answer.reason


def test_what_sources_give_meanwhile_is_left_in_the_battery(model: DriveModel) -> None:
    state, goal = model.initial_state(0.0, 0.0, 0.0), Goal.at(20.0, 0.0)
    cost = foresee(model, state.avoidance, goal, state.odometry, None).forecast
    assert cost is not None
    told = {}
    for part in (0.0, 0.5, 1.0, 10.0):  # of what the way takes
        supply = EnergyLeft(2.0 * cost.total, 0.8, 0.2, 40.0, part * cost.total / cost.seconds)
        told[part] = foresight_status(model, foresee(model, state.avoidance, goal, state.odometry, supply), supply)
    assert [told[part]["asked_charge_at_end"] for part in told] == pytest.approx([0.5, 0.65, 0.8, 1.0])
    assert len({told[part]["asked_energy_wh"] for part in told}) == 1, "the way takes as much from whatever gives it"
    short = EnergyLeft(0.5 * cost.total, 0.8, 0.2, 40.0, 10.0 * cost.total / cost.seconds)
    found = foresee(model, state.avoidance, goal, state.odometry, short)
    assert isinstance(found.answer, GoalOutcome), "no goal is begun that needs the Sun to go on shining"


def test_how_near_it_comes_to_its_limits_on_the_ground_that_has_been_seen(seen: Loop) -> None:
    """Straight up a slope the margin is what the climb leaves; to where the camera does not look nothing is known."""
    state, model = seen.drive, seen.model
    limit = model.params.obstacles.passable.max_climb_deg
    for goal, part in ((Goal.at(2.0, 1.0), 0.5), (Goal.at(-3.0, 0.0), 0.0)):
        found = foresee(model, state.avoidance, goal, state.odometry, None)
        told = foresight_status(model, found, None)
        assert told["asked_seen"] >= part
        if part:
            assert told["asked_tilt_margin_deg"] == pytest.approx(limit - GRADE_DEG, abs=1.0)
            assert str(told["asked_tilt"]).startswith("climb of ")
        else:
            assert "asked_tilt" not in told


def test_a_goal_in_a_rock_that_is_known_is_refused_as_the_goal_would_be(seen: Loop) -> None:
    found = foresee(seen.model, seen.drive.avoidance, Goal.at(*ROCK), seen.drive.odometry, None)
    assert isinstance(found.answer, GoalOutcome) and "lies in an obstacle" in found.answer.reason
