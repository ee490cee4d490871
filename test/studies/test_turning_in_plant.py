"""Skid-steered machines in the plant turn as their drive expects."""

import numpy as np
import pytest

from sojourn_flight.mobility.kinematics import wheel_rates
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_studies.measure_slip import on_plane
from sojourn_studies.measure_turning import MeasuredTurn, track_ratio, turn


@pytest.mark.parametrize("rover", ["lunokhod", "micro", "skid"])
def test_a_machine_turns_at_the_rate_that_is_asked_for(rover: str) -> None:
    """On the spot, at the wheel rates that the drive commands; with a track ratio of 1 it was about half."""
    scenario = on_plane("flat_drive", [f"machine={rover}"], 0.0, 0.0)
    table, asked = (
        scenario.steering.table(scenario.drive.mobility.track_ratio),
        0.8 * scenario.drive.limits.max_yaw_rate,
    )
    none = np.zeros(len(table))
    rates = wheel_rates(table, PlanarTwist(0.0, 0.0, asked), none, none) / (1.0 - scenario.drive.odometry.mean_slip)
    right = [wheel.y < 0.0 for wheel in scenario.steering.wheels].index(True)
    wheel = scenario.steering.wheels[right]
    ground = float(rates[right]) * wheel.radius / -wheel.y  # yaw rate of such wheels without slip
    found = turn(scenario, 0.0, ground, angle=1.0)
    assert found.yaw_rate == pytest.approx(asked, rel=0.12)


def test_the_ratio_is_the_fit_of_all_motions() -> None:
    turns = [MeasuredTurn(0.4, 0.1, 0.0, 0.0), MeasuredTurn(-0.2, -0.05, 0.0, 0.0)]
    assert track_ratio(turns, track=1.6, slip=0.2) == pytest.approx(0.4 * 0.8 / (0.1 * 1.6))
