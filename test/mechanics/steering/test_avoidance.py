"""The behaviour before obstacles, with a rover that is moved by hand: no plant, no wheels."""

import math
from dataclasses import replace

import numpy as np
import pytest
from obstacle_examples import EYE, PARAMS, dense

from sojourn_config.scenario import load_scenario
from sojourn_mechanics.steering.avoidance import accepted, guarded, guide, initial_avoidance, see
from sojourn_mechanics.steering.avoidance_types import Avoidance, AvoidanceState, Guidance
from sojourn_mechanics.steering.goal import Goal, GoalOutcome
from sojourn_mechanics.steering.goal_follower import FollowerState, accept
from sojourn_mechanics.steering.kinematics import PlanarTwist
from sojourn_mechanics.steering.odometry import OdometryState, initial_odometry
from sojourn_mechanics.steering.turning_limits import turning_limits
from sojourn_mechanics.vehicle.clothoid import Pose

SCENARIO = load_scenario("flat_drive")
DRIVE = SCENARIO.drive
TURNING = turning_limits(SCENARIO.steering.table(DRIVE.track_ratio), DRIVE.limits, DRIVE.follower.max_curvature)
AVOIDANCE = Avoidance(PARAMS, DRIVE.follower, TURNING, EYE)


def at(x: float, y: float, yaw: float = 0.0, driven: float = 0.0) -> OdometryState:
    return replace(initial_odometry(DRIVE.odometry, x, y, yaw), distance=driven)


def facing_a_block(near: float, far: float, half_width: float, avoidance: Avoidance = AVOIDANCE) -> AvoidanceState:
    """What is known at the origin of level ground with a block 0.3 m high from `near` to `far`."""
    cloud = dense(lambda x, y: np.where((x > near) & (x < far) & (abs(y) < half_width), 0.3, 0.0))
    return see(avoidance, initial_avoidance(avoidance, 0.0, 0.0), cloud, at(0.0, 0.0), 0.02)


def sent(state: AvoidanceState, goal: Goal, here: OdometryState) -> tuple[AvoidanceState, FollowerState]:
    answer = accept(DRIVE.follower, TURNING, goal, Pose(here.x, here.y, here.yaw))
    answer, state = accepted(AVOIDANCE, state, goal, answer, here)
    assert isinstance(answer, FollowerState)
    return state, answer


def test_too_near_to_turn_it_backs_off_over_its_tracks_and_then_goes_round() -> None:
    """The block begins 0.95 m from the middle: there is no room for a turn on the spot (1.04 m)."""
    state, way = sent(facing_a_block(1.02, 1.5, 1.2), Goal.at(4.0, 0.0), at(0.0, 0.0))
    step = guide(AVOIDANCE, state, way, at(0.0, 0.0))
    assert step.outcome is None and step.twist is not None
    assert step.twist.v_x == -PARAMS.back_off_speed and step.twist.yaw_rate == 0.0
    assert step.text.startswith("backing off from step of 0.3")
    x = 0.0
    while step.twist is not None and step.twist.v_x < 0.0:
        x -= 0.02
        _, free = guarded(AVOIDANCE, step.state, step.twist, at(x, 0.0, driven=-x), by_hand=False)
        assert free, "away from the obstacle it may move"
        step = guide(AVOIDANCE, step.state, step.way, at(x, 0.0, driven=-x))
    assert -PARAMS.back_off <= x + 1e-9 and step.state.back_until is None
    step = guide(AVOIDANCE, step.state, step.way, at(x, 0.0, driven=-x))
    assert step.twist is None and step.outcome is None and step.state.detours == 1
    samples = np.concatenate([leg.samples for leg in step.way.path.legs])
    assert abs(samples[:, 2]).max() > 1.2 + 0.6, "past the end of the block"
    assert (samples[-1, 1], samples[-1, 2]) == pytest.approx((4.0, 0.0), abs=0.01)


def test_the_name_the_heading_and_the_end_of_a_goal_are_kept() -> None:
    goal = replace(Goal.at(4.0, 0.0, 0.5, "mine"), heights=(0.0,))
    state, way = sent(facing_a_block(2.5, 2.8, 0.5), goal, at(0.0, 0.0))
    step = guide(AVOIDANCE, state, way, at(0.0, 0.0))
    found = step.way.goal
    assert (found.name, found.yaw, found.points[-1], found.kind) == ("mine", 0.5, (4.0, 0.0), "goal")
    assert step.state.detours == 1 and step.state.obstacle is not None and step.state.obstacle.kind == "step"


def follow_on(step: Guidance, here: OdometryState, fresh: bool) -> Guidance:
    return guide(AVOIDANCE, replace(step.state, fresh=fresh), step.way, here)


def test_a_way_round_is_kept_while_nothing_new_is_near() -> None:
    state, way = sent(facing_a_block(2.5, 2.8, 0.5), Goal.at(5.0, 0.0), at(0.0, 0.0))
    step = guide(AVOIDANCE, state, way, at(0.0, 0.0))
    for fresh in (False, True):
        again = follow_on(step, at(0.0, 0.0), fresh)
        assert again.way is step.way and again.state.detours == 1


def test_a_rover_that_cannot_get_free_gives_up() -> None:
    """Each motion is stopped by the guard where it stands: in the end the goal is, with what is in the way."""
    state, way = sent(facing_a_block(1.02, 1.5, 1.2), Goal.at(4.0, 0.0), at(0.0, 0.0))
    step, looks = Guidance(state, way), 0
    while step.outcome is None:
        state, free = guarded(AVOIDANCE, step.state, PlanarTwist(0.1, 0.0, 0.0), at(0.0, 0.0), by_hand=False)
        assert not free
        step = guide(AVOIDANCE, state, step.way, at(0.0, 0.0))
        looks += 1
        assert looks < 20
    assert step.outcome.kind == "stopped" and step.outcome.reason.endswith("no room to move beside it")


def test_a_way_round_that_gets_too_long_ends_the_goal() -> None:
    state, way = sent(facing_a_block(2.0, 2.3, 1.0), Goal.at(4.0, 0.0), at(0.0, 0.0))
    late = at(0.0, 0.0, driven=4.0 + PARAMS.max_detour + 0.1)
    step = guide(AVOIDANCE, replace(state, blocked=True), way, late)
    assert step.outcome is not None and step.outcome.kind == "stopped"
    assert step.outcome.reason.endswith("no way round with 15 m more than asked for")


def test_a_refused_goal_leaves_what_is_under_way_alone() -> None:
    state, _ = sent(facing_a_block(2.0, 2.6, 1.0), Goal.at(1.0, 3.0), at(0.0, 0.0))
    bad = Goal.at(2.3, 0.0)
    answer, after = accepted(AVOIDANCE, state, bad, GoalOutcome("refused", "other", bad, math.nan), at(0.0, 0.0))
    assert isinstance(answer, GoalOutcome) and "lies in an obstacle" in answer.reason
    assert after is state


@pytest.mark.parametrize("guarded_by_hand", [True, False])
def test_the_guard_lets_go_what_leads_away(guarded_by_hand: bool) -> None:
    params = PARAMS.model_copy(update={"guard_cmd_vel": guarded_by_hand})
    avoidance = Avoidance(params, DRIVE.follower, TURNING, EYE)
    state = facing_a_block(1.02, 1.5, 1.2, avoidance)
    for twist, free in (((0.1, 0.0, 0.0), False), ((-0.1, 0.0, 0.0), True), ((0.0, 0.0, 0.0), True)):
        after, found = guarded(avoidance, state, PlanarTwist(*twist), at(0.0, 0.0), by_hand=True)
        assert found == (free or not guarded_by_hand), twist
        assert after.blocked != found
        assert guarded(avoidance, state, PlanarTwist(*twist), at(0.0, 0.0), by_hand=False)[1] == free
