"""Paths: continuous, within the limits of curvature, past every point within its tolerance; else refused."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.odometry.odometry import wrap_angle
from sojourn_flight.planning.clothoid import Piece, Pose
from sojourn_flight.planning.corner import gentlest_corner, needed_curvature, round_corner
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.path import Leg, PlannedPath
from sojourn_flight.planning.path_planner import plan_path
from sojourn_flight.supervision.params import DriveParams

ROVER = TurningLimits(curvature=0.7, sharpness=2.7, on_the_spot=True)
CAR = ROVER._replace(on_the_spot=False)
START = Pose(0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def params(drive_params: DriveParams) -> GoalFollowerParams:
    return drive_params.follower


def check(params: GoalFollowerParams, machine: TurningLimits, start: Pose, goal: Goal, path: PlannedPath) -> None:
    """What holds for every path."""
    joint = start
    for leg in path.legs:
        assert math.dist(leg.start[:2], joint[:2]) < 1e-6
        s, x, y, heading, curvature = leg.samples.T
        step = np.diff(s)
        assert (step >= -1e-12).all()
        assert np.hypot(np.diff(x), np.diff(y)) == pytest.approx(step, abs=1e-4)  # no gap, no kink
        assert np.diff(heading) == pytest.approx(0.5 * (curvature[1:] + curvature[:-1]) * step, abs=1e-6)
        assert np.abs(curvature).max() <= params.planned_curvature * machine.curvature + 1e-9
        assert np.abs(np.diff(curvature)).max() <= machine.sharpness * step.max() + 1e-9  # no jump
        joint = leg.end
    places = np.concatenate([leg.samples[:, 1:3] for leg in path.legs])
    for point in goal.points:
        assert np.hypot(*(places - point).T).min() <= params.corner_cut + 0.03
    assert math.dist(joint[:2], goal.points[-1]) < 1e-6
    assert len(path.marks) == len(goal.points)
    assert list(path.marks) == sorted(path.marks)
    assert path.marks[-1] == pytest.approx(path.length)


turns = st.lists(st.tuples(st.floats(0.05, 6.0), st.floats(-3.1, 3.1)), min_size=1, max_size=8)


def chain(legs: list[tuple[float, float]]) -> list[tuple[float, float]]:
    points, x, y, heading = [], 0.0, 0.0, 0.0
    for length, turn in legs:
        heading += turn
        x, y = x + length * math.cos(heading), y + length * math.sin(heading)
        points.append((x, y))
    return points


@settings(max_examples=80, deadline=None)
@given(turns, st.floats(-3.1, 3.1))
@example([(2.0, 0.5), (2.0, 0.0)], 0.0)  # the first point in line with start and end, but not with the heading
@example([(2.0, 0.5), (1.0, 0.0), (1.0, 0.0)], 0.1)
@example([(1.0, 0.0), (2.0, 1e-5), (2.0, 1.1875)], 0.0)  # what is hardly a corner is one all the same
@example([(6.0, 0.0), (6.0, 3e-7), (6.0, 3e-8), (6.0, 1.2)], 0.0)
def test_a_machine_that_turns_on_the_spot_gets_a_path_through_any_points(
    params: GoalFollowerParams, legs: list[tuple[float, float]], yaw: float
) -> None:
    start, goal = START._replace(heading=yaw), Goal.along(chain(legs))
    path = plan_path(params, ROVER, start, goal)
    assert isinstance(path, PlannedPath), path
    if path.legs:
        check(params, ROVER, start, goal, path)


@settings(max_examples=60, deadline=None)
@given(turns, st.floats(-3.1, 3.1), st.one_of(st.none(), st.floats(-3.1, 3.1)))
def test_a_machine_that_cannot_gets_one_leg_from_its_heading_or_a_reason(
    params: GoalFollowerParams, legs: list[tuple[float, float]], yaw: float, end: float | None
) -> None:
    start, goal = START._replace(heading=yaw), Goal.along(chain(legs), end)
    path = plan_path(params, CAR, start, goal)
    if isinstance(path, str):
        assert "1/m" in path
        return
    if not path.legs:
        return
    check(params, CAR, start, goal, path)
    (leg,) = path.legs
    assert abs(wrap_angle(leg.start.heading - yaw)) <= params.align_tolerance
    if end is not None:
        assert abs(wrap_angle(leg.end.heading - end)) <= params.align_tolerance


def test_a_gentle_route_is_one_leg_and_a_right_angle_a_stop(params: GoalFollowerParams) -> None:
    path = plan_path(params, ROVER, START, Goal.along([(2.6, 1.0), (4.5, 2.5), (6.2, 2.2), (8.6, 0.5)]))
    assert isinstance(path, PlannedPath) and len(path.legs) == 1
    path = plan_path(params, ROVER, START, Goal.along([(4.0, 0.0), (4.0, 4.0)]))
    assert isinstance(path, PlannedPath) and [leg.start.heading for leg in path.legs] == pytest.approx(
        [0.0, math.pi / 2]
    )
    assert path.marks == pytest.approx((4.0, 8.0))


def test_a_circle_sampled_densely_has_no_corners(params: GoalFollowerParams) -> None:
    angles = np.linspace(0.05, 6.0, 300)
    points = [(3.0 * math.sin(angle), 3.0 - 3.0 * math.cos(angle)) for angle in angles]
    path = plan_path(params, CAR, START, Goal.along(points))
    assert isinstance(path, PlannedPath) and len(path.legs) == 1
    radius = np.hypot(path.legs[0].samples[:, 1], path.legs[0].samples[:, 2] - 3.0)
    assert radius.min() > 3.0 - params.corner_cut and radius.max() < 3.0 + params.corner_cut
    # every point is passed where it lies on the circle
    assert path.marks == pytest.approx(3.0 * angles, abs=0.5)


def test_what_cannot_be_joined_is_refused_with_the_point_and_the_numbers(params: GoalFollowerParams) -> None:
    reason = plan_path(params, CAR, START, Goal.along([(4.0, 0.0), (4.0, 4.0)]))
    assert reason == (
        "point 0 (4.00, 0.00 m): a corner of 90 deg passed within 0.30 m, with 4.00 m to turn in, needs a curvature of "
        "1.38 1/m, planned are at most 0.56, and this machine does not turn on the spot"
    )
    reason = plan_path(params, CAR, START, Goal.at(0.0, 1.0))
    assert isinstance(reason, str) and reason.startswith("point 0 is 1.00 m away at 90 deg to the heading: inside")
    reason = plan_path(params, CAR, START, Goal.at(3.0, 0.0, 3.0))
    assert isinstance(reason, str) and reason.startswith("the heading of 3.00 rad at the end: no curve of at most 0.56")
    path = plan_path(params, CAR, START, Goal.at(-8.0, 0.0))  # behind: round and back
    assert isinstance(path, PlannedPath) and path.length > 8.0 + math.pi * 1.0


def test_a_goal_where_the_rover_stands_needs_no_path(params: GoalFollowerParams) -> None:
    for goal in (Goal.at(0.02, 0.0), Goal.at(-0.08, 0.0)):
        path = plan_path(params, ROVER, START, goal)
        assert isinstance(path, PlannedPath) and not path.legs and path.length == 0.0
    path = plan_path(params, ROVER, START, Goal.at(0.08, 0.0))
    assert isinstance(path, PlannedPath) and path.length == pytest.approx(0.08)


@given(st.floats(0.02, 2.9), st.floats(0.05, 0.7))
def test_corners_against_the_arc_alone(angle: float, curvature: float) -> None:
    """With clothoids so short that they hardly count, tangent and cut are those of a circle."""
    corner = round_corner(angle, curvature, 1e5)
    assert corner.tangent == pytest.approx(math.tan(angle / 2) / curvature, rel=1e-3)
    assert corner.cut == pytest.approx((1.0 / math.cos(angle / 2) - 1.0) / curvature, rel=1e-3, abs=1e-6)
    assert needed_curvature(angle, corner.tangent, corner.cut) == pytest.approx(curvature, rel=2e-3)


@given(st.floats(0.02, 2.0), st.floats(0.3, 5.0), st.floats(0.1, 1.0))
def test_the_gentlest_corner_uses_what_it_may(angle: float, room: float, cut: float) -> None:
    corner = gentlest_corner(angle, room, cut, ROVER)
    if corner is None:
        sharpest = round_corner(angle, ROVER.curvature, ROVER.sharpness)
        assert sharpest.tangent > room or sharpest.cut > cut
        return
    assert corner.tangent <= room and corner.cut <= cut
    if corner.curvature > 0.02:
        gentler = round_corner(angle, corner.curvature - 0.012, ROVER.sharpness)
        assert gentler.tangent > room or gentler.cut > cut


def test_the_nearest_place_follows_a_path_that_crosses_itself() -> None:
    """Once round a circle: at its begin and end the same point is two places."""
    leg = Leg.of(START, (Piece(4.0 * math.pi, 0.5, 0.0),))
    for s in np.linspace(0.0, leg.length, 400):
        x, y = 2.0 * math.sin(s / 2.0), 2.0 - 2.0 * math.cos(s / 2.0)
        place = leg.nearest(0.9 * x, 2.0 + 0.9 * (y - 2.0), near=s)
        assert place.distance == pytest.approx(s, abs=5e-3)
        assert place.lateral == pytest.approx(0.2, abs=1e-3)
        assert place.curvature == pytest.approx(0.5)


def test_turns_on_the_spot_are_added_up(params: GoalFollowerParams) -> None:
    path = plan_path(params, ROVER, START, Goal.along([(4.0, 0.0), (4.0, 4.0)], 0.0))
    assert isinstance(path, PlannedPath)
    assert path.turns(0.1, 0.0) == pytest.approx((0.1, math.pi / 2, math.pi / 2))
    assert path.turns(0.0, None) == pytest.approx((math.pi / 2,))
