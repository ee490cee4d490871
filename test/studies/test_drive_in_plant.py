"""The drive in the simulated machine, over short ways: it keeps to its path in truth, and takes what was forecast."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive_types import TwistCommand
from sojourn_studies.closed_loop import ClosedLoop
from sojourn_studies.measure_energy import MeteredLoop
from sojourn_studies.measure_path import follow_path
from sojourn_studies.measure_slip import on_plane


def test_it_keeps_to_a_curved_path_on_rough_ground() -> None:
    """Into a curve and out of it, 3.7 m; the figure for 30 m is that of sojourn_studies.measure_path."""
    found = follow_path(load_scenario("lunar_route"), Goal.along([(1.8, 0.4), (3.2, 1.6)]))
    assert found.outcome == "reached", found.reason
    assert found.rms_odom < 0.02 and found.max_odom < 0.05, "what the law does"
    assert found.rms_true < 0.15, "what the machine does"
    assert 0.05 < found.slip < 0.3


def test_the_wheels_stand_half_a_second_after_the_last_velocity() -> None:
    """In truth, from full speed down a slope; the body rocks on the soil for a little longer."""
    loop = ClosedLoop(on_plane("flat_drive", [], 4.0, 180.0))
    wheels = loop.plant.joints.columns[loop.plant.reference_rows([wheel.joint for wheel in loop.plant.machine.wheels])]
    for period in range(150):
        age = max(period - 124, 0) * CONTROL_PERIOD_S  # the last one comes in period 124
        velocity = TwistCommand(PlanarTwist(0.1, 0.0, 0.0), age)
        loop.step(change=lambda measured, velocity=velocity: replace(measured, twist=velocity))
        if period == 124:
            assert loop.truth.velocity[wheels].min() > 0.75
    assert abs(loop.truth.velocity[wheels]).max() < 0.02


def test_steering_keeps_within_its_limits_and_the_body_does_not_rock_at_the_end() -> None:
    """Over rough ground with a look of the camera a second: each look corrects the place that the path is kept from."""
    loop = ClosedLoop(load_scenario("lunar_route"))
    joints = [wheel.steer_joint for wheel in loop.plant.machine.wheels if wheel.steer_joint]
    rows = loop.plant.reference_rows(joints)
    efforts, rates, commanded, after = [], [], [], []
    goal: Goal | None = Goal.along([(1.2, 0.3)])
    while len(after) < 100:
        output, goal = loop.step(goal=goal), None
        assert loop.plant_output is not None
        efforts.append(loop.plant_output.efforts[rows])
        rates.append(loop.truth.velocity[loop.plant.joints.columns[rows]])
        wheels, steers = np.split(output.references.velocity, [len(loop.plant.machine.wheels)])
        commanded.append(steers)
        if loop.drive_state.last_outcome is not None and not wheels.any():
            after.append(abs(loop.truth.velocity[0]))
    most = loop.scenario.drive.mobility.max_steer_acceleration
    assert np.abs(np.diff(commanded, axis=0)).max() <= most * CONTROL_PERIOD_S * (1.0 + 1e-9)
    assert np.abs(efforts).max() < 15.0  # of 40; with a step of the rate at each look it was 58
    assert np.abs(rates).max() < 0.35
    assert max(after) < 0.012  # [m/s]: 0.009; braked within two periods from 0.02 m/s it was 0.018


@pytest.mark.parametrize("slope_deg", [0.0, 6.0])
def test_the_forecast_is_what_the_plant_takes(slope_deg: float) -> None:
    """Level with a turn at the end, and up a slope between two that were measured."""
    loop = MeteredLoop(on_plane("flat_drive", [], slope_deg, 0.0))
    goal = Goal.along([(0.9, 0.2), (1.6, 0.3)], math.pi / 4 if slope_deg == 0.0 else None)
    if slope_deg:
        goal = replace(goal, heights=(None, 1.6 * math.tan(math.radians(slope_deg))))
    loop.reach(loop.tick(goal))
    forecast = loop.drive_state.energy.forecast
    assert forecast is not None
    spent = loop.spent
    assert forecast.total == pytest.approx(spent.motion + spent.house, rel=0.2)
    assert forecast.motion == pytest.approx(spent.motion, rel=0.2)
    assert forecast.seconds == pytest.approx(spent.seconds, rel=0.1)


def test_near_its_goal_it_waits_for_the_correction_of_its_place() -> None:
    """It went on, arrived where it was said to be, and had to come again, and again on a slope that it slides down."""
    loop = ClosedLoop(load_scenario("flat_drive"))
    for _ in range(25):
        loop.step()
    loop.drive_state = replace(loop.drive_state, behind=(0.0, 0.25, 0.0))
    goal, output, attempts, texts = Goal.at(0.8, 0.0), loop.output, 0, set[str]()
    output = loop.step(goal=goal)
    while not output.outcomes and loop.period < 3000:
        output = loop.step()
        texts.add(loop.drive_state.text.split(" by ")[0])
        way = loop.drive_state.follower
        attempts = max(attempts, way.attempts if way is not None else 0)
    assert output.outcomes[0].kind == "reached" and attempts == 0
    assert "waits: its place is being corrected" in texts
    assert math.dist(loop.true_pose[:2], goal.points[-1]) < loop.scenario.drive.follower.position_tolerance
