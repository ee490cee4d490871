"""Ways round what is in the way: every free posture is reached, by paths that a slow check finds free, and the same."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
import pinocchio
import pytest

from sojourn_flight.arm.collision import check_posture, check_samples, path_samples, refined
from sojourn_flight.arm.goals import JointGoal, PoseGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.sampling_planner import MOST_POSTURES, Detours, SamplingPlanner
from sojourn_flight.arm.trajectory import at_rest
from sojourn_flight.arm.ways import Departure, Plan

GROUND = GroundPlane(-0.47)
ROUND = "round what is in the way"


def free_posture(arm: Any, generator: np.random.Generator) -> Any:
    while True:
        posture = arm.random_posture(generator)
        if check_posture(arm.params, arm.model, posture, GROUND) is None:
            return posture


def nearest_pair(arm: Any, samples: Any) -> float:
    """Smallest distance of any pair of shapes on the way, every pair looked at in every posture [m]."""
    model, least = arm.model, np.inf
    for posture in samples:
        pinocchio.updateGeometryPlacements(
            model.pinocchio_model, model.data, model.geometry_model, model.geometry_data, posture
        )
        pinocchio.computeDistances(model.geometry_model, model.geometry_data)
        least = min(least, *(result.min_distance for result in model.geometry_data.distanceResults))
    return float(least)


def plans(arm: Any, start: str, count: int, seed: int, goal_of: Callable[[Any, Any], Any]) -> list[Plan]:
    """Plans from a named pose to those of `count` free places that are not refused."""
    generator, here = np.random.default_rng(seed), np.array(arm.params.named_poses[start])
    found = []
    for _ in range(count):
        goal = goal_of(arm, free_posture(arm, generator))
        with suppress(GoalRefusedError):
            found.append(plan_goal(arm.params, arm.model, goal, Departure(at_rest(here), here), GROUND))
    return found


def as_joints(arm: Any, posture: Any) -> JointGoal:
    return JointGoal(arm.model.joint_names, tuple(float(q) for q in posture))


def as_tip(arm: Any, posture: Any) -> PoseGoal:
    tip = forward_kinematics(arm.model, posture)
    return PoseGoal(tuple(tip.position), tuple(tip.tool_direction))


@pytest.mark.parametrize(("start", "goal_of", "seed", "shut_in"), [("unfold", as_tip, 4, 0), ("stow", as_joints, 3, 1)])
def test_every_free_place_has_a_way(explorer: Any, start: str, goal_of: Any, seed: int, shut_in: int) -> None:
    """Those that need a detour used to be refused. One posture, between wheel and deck, is shut in: 200 000 looks find
    no way there either.
    """
    found = plans(explorer, start, 40, seed, goal_of)
    assert len(found) == 40 - shut_in
    detours = [plan for plan in found if ROUND in plan.note]
    assert detours, "none of these goals asks for a detour: it shows nothing"
    for plan in detours[:3]:
        samples = path_samples(plan.path, 0.05)
        assert nearest_pair(explorer, samples) > explorer.params.collision_clearance - 1e-3


def test_the_same_question_has_the_same_answer(explorer: Any) -> None:
    start, end = (np.array(explorer.params.named_poses[name]) for name in ("stow", "unfold"))
    ways = [SamplingPlanner(explorer.params, explorer.model, GROUND).way(start, [end]) for _ in range(2)]
    assert ways[0] is not None and ways[1] is not None
    np.testing.assert_array_equal(np.array(ways[0]), np.array(ways[1]))
    np.testing.assert_array_equal(ways[0][-1], end)


def test_the_corners_are_joined_by_free_lines(small: Any) -> None:
    """Between postures of which the straight line collides."""
    generator, ways = np.random.default_rng(8), []
    while len(ways) < 4:
        start, end = (free_posture(small, generator) for _ in range(2))
        straight = refined(np.array([start, end]), small.params.collision_step)
        if check_samples(small.params, small.model, straight, GROUND, allow_start=False) is None:
            continue
        way = SamplingPlanner(small.params, small.model, GROUND).way(start, [end])
        assert way is not None and len(way) >= 2
        ways.append(way)
        samples = refined(np.array([start, *way]), small.params.collision_step)
        assert check_samples(small.params, small.model, samples, GROUND, allow_start=False) is None
        assert nearest_pair(small, samples) > small.params.collision_clearance - 1e-3


def test_without_a_way_it_ends_within_what_it_may_spend(explorer: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shut in by the ground just under the stowed arm nothing but a little motion is left."""
    arm, limit = explorer, 2000
    monkeypatch.setattr("sojourn_flight.arm.sampling_planner.MOST_POSTURES", limit)
    start = np.array(arm.params.named_poses["stow"])
    end = np.array([0.0, -1.5, 0.3, 0.0, 0.0])
    high = GroundPlane(float(forward_kinematics(arm.model, start).position[2]) + 0.4)
    shut = SamplingPlanner(arm.params, arm.model, high)
    assert shut.way(start, [end]) is None
    assert shut.checked < limit + 100 < MOST_POSTURES


def test_a_detour_is_looked_for_once(explorer: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    monkeypatch.setattr(SamplingPlanner, "way", lambda self, start, ends: calls.append(start))
    detours, start = Detours(explorer.params, explorer.model, None), np.zeros(5)
    for _ in range(3):
        assert detours.corners(start, [start], 0.0) is None
    assert len(calls) == 1


def test_a_target_in_a_collision_is_refused_with_the_pair(explorer: Any) -> None:
    generator = np.random.default_rng(1)
    folded = explorer.random_posture(generator)
    while check_posture(explorer.params, explorer.model, folded, GROUND) is None:
        folded = explorer.random_posture(generator)
    start = np.array(explorer.params.named_poses["unfold"])
    with pytest.raises(GoalRefusedError, match="collision of"):
        plan_goal(
            explorer.params, explorer.model, as_joints(explorer, folded), Departure(at_rest(start), start), GROUND
        )
