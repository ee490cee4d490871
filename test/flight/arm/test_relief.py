"""Ground that a camera has seen: found again in base_link, and held against the arm as a slow look does."""

import math
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.goals import JointGoal, PoseGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import GroundRelief, relief_of
from sojourn_flight.arm.trajectory import at_rest
from sojourn_flight.arm.ways import Departure
from sojourn_flight.hazards.obstacle_map import LAYERS, CellGrid, ObstacleMap, add_points

PLANE = GroundPlane(-0.47)


def relief(height: Any, cell: float = 0.05) -> GroundRelief:
    """All of it seen: z of base_link over x and y."""
    line = cell * np.arange(-50, 51)
    x, y = np.meshgrid(line, line, indexing="ij")
    return GroundRelief(PLANE, (float(line[0]), float(line[0])), cell, height(x, y), np.ones(x.shape, dtype=np.bool_))


def rock(x: Any, y: Any) -> Any:
    return np.where(np.hypot(x - 1.0, y) < 0.2, -0.2, -0.47)


@given(
    yaw=st.floats(-3.0, 3.0),
    roll=st.floats(-0.2, 0.2),
    pitch=st.floats(-0.2, 0.2),
    lift=st.floats(-0.1, 0.1),
)
@settings(max_examples=20, deadline=None)
def test_what_was_seen_is_where_it_was_seen(yaw: float, roll: float, pitch: float, lift: float) -> None:
    """Points of a wavy ground, put into a map in odom, from a rover that stands tilted anywhere."""
    size, cell = 100, 0.05
    position, rotation = np.array([3.0, -2.0, 1.0]), pin.rpy.rpyToMatrix(roll, pitch, yaw)
    line = np.arange(-2.0, 2.0, 0.02)
    x, y = (axis.ravel() for axis in np.meshgrid(line + position[0], line + position[1]))
    heights = 0.5 + 0.05 * np.sin(2.0 * x) * np.cos(3.0 * y)
    layers = np.zeros((LAYERS, size, size))
    corner = position[:2] - 0.5 * size * cell
    points = np.column_stack([x, y, heights + lift])
    grid = CellGrid(float(corner[0]), float(corner[1]), cell)
    add_points(layers, grid, points, np.ones(len(x)), np.ones(len(x)), 0.0)
    found = relief_of(ObstacleMap(corner[0], corner[1], cell, layers, lift), position, rotation, PLANE, 1.5)
    for at in ((0.8, 0.3), (-0.5, 0.9), (1.0, -1.0), (0.0, 0.0)):
        z, seen = found.height(*at)
        place = rotation @ np.array([*at, z]) + position
        assert seen
        assert place[2] == pytest.approx(0.5 + 0.05 * math.sin(2.0 * place[0]) * math.cos(3.0 * place[1]), abs=0.012)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_a_flat_relief_is_the_plane(explorer: Any, seed: int) -> None:
    """Points on the shapes against the support function of each of them, exact for a plane."""
    params = explorer.params.model_copy(update={"seen_ground_depth": explorer.params.ground_contact_depth})
    posture = explorer.random_posture(np.random.default_rng(seed))
    flat = relief(lambda x, _: np.full(x.shape, PLANE.height))
    over_plane, over_relief = (check_posture(params, explorer.model, posture, ground) for ground in (PLANE, flat))
    if (over_plane is None) != (over_relief is None):  # a corner of a shape may be a few mm from the nearest point
        one = over_plane or over_relief
        assert one is not None and "ground" in (one.first, one.second) and one.distance > one.clearance - 0.003


def test_the_arm_keeps_clear_of_a_rock(explorer: Any) -> None:
    """Over flat ground the posture is free; a rock that stands up to its forearm names forearm and ground."""
    posture = np.array(explorer.params.named_poses["unfold"])
    assert check_posture(explorer.params, explorer.model, posture, PLANE) is None
    high = relief(lambda x, y: np.where(np.hypot(x - 0.9, y) < 0.3, 0.5, -0.47))
    found = check_posture(explorer.params, explorer.model, posture, high)
    assert found is not None and found.second == "ground" and found.distance < 0.0


def test_a_place_in_a_rock_is_refused_as_such(explorer: Any) -> None:
    start = np.array(explorer.params.named_poses["unfold"])

    def plan(goal: Any, ground: Any) -> Any:
        return plan_goal(explorer.params, explorer.model, goal, Departure(at_rest(start), start), ground)

    with pytest.raises(GoalRefusedError, match="120 mm below the ground that the camera has seen: at most 25 mm"):
        plan(PoseGoal((1.0, 0.0, -0.32)), relief(rock))
    with pytest.raises(GoalRefusedError, match="130 mm below the plane on which the machine stands: at most 50 mm"):
        plan(PoseGoal((1.0, 0.0, -0.60)), PLANE)
    assert plan(PoseGoal((1.0, 0.0, -0.19)), relief(rock)).target is not None


def test_the_way_leads_over_a_wall(explorer: Any) -> None:
    """From one side of a wall in front of the rover to the other: straight it would go through."""
    start, end = np.array([-0.7, -0.5, 1.6, 0.0, 0.0]), np.array([0.7, -0.5, 1.6, 0.0, 0.0])
    wall = relief(lambda x, y: np.where((np.abs(y) < 0.1) & (x > 0.75), -0.05, -0.47))
    for posture in (start, end):
        assert check_posture(explorer.params, explorer.model, posture, wall) is None
    goal = JointGoal(explorer.model.joint_names, tuple(float(q) for q in end))
    plan = plan_goal(explorer.params, explorer.model, goal, Departure(at_rest(start), start), wall)
    assert plan.note
    for time in np.linspace(0.0, plan.path.duration, 40):
        assert check_posture(explorer.params, explorer.model, plan.path.sample(time)[0], wall) is None
