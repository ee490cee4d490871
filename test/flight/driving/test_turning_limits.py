"""How sharply a machine turns, against its geometry by hand."""

import math

import numpy as np
import pytest

from placements import geometry_from_placements
from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.turning_limits import turning_limits
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.supervision.params import DriveParams
from wheel_drive import rolling_limits

PLACES = [(x, y, 0.0) for x in (1.0, -1.0) for y in (0.5, -0.5)]


def four_wheels(front: float | None, rear: float | None) -> SteeringGeometryParams:
    """Wheelbase 2 m, track 1 m; largest angle of each axle's steering, None where it is fixed."""
    limits = [None if most is None else (-most, most) for most in (front, front, rear, rear)]
    return geometry_from_placements(["fl", "fr", "rl", "rr"], PLACES, [0.2] * 4, limits)


def test_the_explorer_turns_on_the_spot_and_its_parameters_bound_its_curves(
    drive_params: DriveParams, explorer: SteeringGeometryParams
) -> None:
    found = turning_limits(explorer.table(), rolling_limits(drive_params), drive_params.follower.max_curvature)
    assert found.on_the_spot
    assert found.curvature == drive_params.follower.max_curvature


def test_the_inner_wheel_of_ackermann_steering_bounds_the_curve(drive_params: DriveParams) -> None:
    """Both axles steered to 0.6 rad: tan 0.6 = 1 / (R - 0.5)."""
    found = turning_limits(four_wheels(0.6, 0.6).table(), rolling_limits(drive_params), 5.0)
    assert found.curvature == pytest.approx(1.0 / (0.5 + 1.0 / math.tan(0.6)), rel=1e-5)
    assert not found.on_the_spot


def test_wheels_that_slide_in_every_curve_do_not_bound_it(drive_params: DriveParams) -> None:
    """Skid steering, and a fixed rear axle behind base_link."""
    found = turning_limits(four_wheels(None, None).table(), rolling_limits(drive_params), 0.9)
    assert (found.curvature, found.on_the_spot) == (0.9, True)
    found = turning_limits(four_wheels(0.6, None).table(), rolling_limits(drive_params), 5.0)
    assert found.curvature == pytest.approx(1.0 / (0.5 + 1.0 / math.tan(0.6)), rel=1e-5)


def test_steering_at_its_fastest_just_follows_the_sharpest_clothoid(
    drive_params: DriveParams, explorer: SteeringGeometryParams
) -> None:
    """By differences of the steer angles along a clothoid at full speed."""
    limits, table = rolling_limits(drive_params), explorer.table()
    found = turning_limits(table, limits, 0.7)
    speed, dt = limits.max_speed, 0.001
    fastest = 0.0
    for curvature in np.linspace(-0.7, 0.7, 201):
        angles = [
            wheels_from_twist(table, PlanarTwist(speed, 0.0, speed * k), np.zeros(6)).steer_angles
            for k in (curvature, curvature + found.sharpness * speed * dt)
        ]
        fastest = max(fastest, float(np.abs(angles[1] - angles[0]).max()) / dt)
    assert fastest == pytest.approx(limits.max_steer_rate, rel=1e-2)
