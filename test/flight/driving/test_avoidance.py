"""The behaviour before obstacles, with a rover that is moved by hand: no plant, no wheels."""

import math
from dataclasses import replace

import numpy as np
import pytest
from obstacle_examples import PARAMS, STEREO, dense

from sojourn_config.scenario import load_scenario
from sojourn_flight.mobility.turning_limits import turning_limits
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.odometry.odometry import OdometryState, initial_odometry
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_state import FollowerLimits, FollowerState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.goal_follower import accept, follow, rerouted
from sojourn_flight.supervision.avoidance import (
    accepted,
    from_loose_ground,
    guarded,
    guide,
    initial_avoidance,
    see,
)
from sojourn_flight.supervision.avoidance_types import Avoidance, AvoidanceState, Guidance
from sojourn_flight.supervision.path_check import clearances_of, closed_ahead
from wheel_drive import rolling_limits

SCENARIO = load_scenario("flat_drive")
DRIVE = SCENARIO.drive
TURNING = turning_limits(
    SCENARIO.steering.table(DRIVE.mobility.track_ratio), rolling_limits(DRIVE), DRIVE.follower.max_curvature
)
WHEELS = np.array([(wheel.x, wheel.y) for wheel in SCENARIO.steering.wheels])
AVOIDANCE = Avoidance(PARAMS, DRIVE.follower, TURNING, STEREO, WHEELS)


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


def back_off(step: Guidance) -> tuple[Guidance, float]:
    """Driven back as it says, from the origin along x: what it says then, and where."""
    x = 0.0
    while step.twist is not None and step.twist.v_x < 0.0:
        x -= 0.02
        _, free = guarded(AVOIDANCE, step.state, step.twist, at(x, 0.0, driven=-x), by_hand=False)
        assert free, "away from the obstacle it may move"
        step = guide(AVOIDANCE, step.state, step.way, at(x, 0.0, driven=-x))
    return step, x


def test_too_near_to_turn_it_backs_off_over_its_tracks_and_then_goes_round() -> None:
    """The block begins 0.95 m from the middle: there is no room for a turn on the spot (1.04 m)."""
    state, way = sent(facing_a_block(1.02, 1.5, 1.2), Goal.at(4.0, 0.0), at(0.0, 0.0))
    step = guide(AVOIDANCE, state, way, at(0.0, 0.0))
    assert step.outcome is None and step.twist is not None
    assert step.twist.v_x == -PARAMS.back_off_speed and step.twist.yaw_rate == pytest.approx(0.0, abs=1e-9)
    assert step.text.startswith("backing off from step of 0.3")
    step, x = back_off(step)
    assert -PARAMS.back_off <= x + 1e-9 and step.state.back is None
    step = guide(AVOIDANCE, step.state, step.way, at(x, 0.0, driven=-x))
    assert step.twist is None and step.outcome is None and step.state.detours == 1
    samples = np.concatenate([leg.samples for leg in step.way.path.legs])
    assert abs(samples[:, 2]).max() > 1.2 + 0.6, "past the end of the block"
    assert (samples[-1, 1], samples[-1, 2]) == pytest.approx((4.0, 0.0), abs=0.01)


@pytest.mark.parametrize("side", [0.75, 0.85])
@pytest.mark.parametrize("end", [0.0, -0.6])
def test_from_where_there_is_no_way_on_it_backs_off_and_looks_again(side: float, end: float) -> None:
    """A lane closed ahead and, seen when the rover is in it, narrower than its margins: from there the map knows no
    way, and the goal was given up; from where the rover came it knows one."""
    cloud = dense(
        lambda x, y: np.where((x < 1.5) & (abs(y) < 1.5) & ((x > 1.02) | ((x > end) & (abs(y) > side))), 0.3, 0.0)
    )
    state = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), cloud, at(0.0, 0.0), 0.02)
    state, way = sent(state, Goal.at(4.0, 0.0), at(0.0, 0.0))
    step = guide(AVOIDANCE, state, way, at(0.0, 0.0))
    assert step.outcome is None and step.text.startswith("backing off from step of 0.3")
    step, x = back_off(step)
    assert x < -0.5
    step = guide(AVOIDANCE, step.state, step.way, at(x, 0.0, driven=-x))
    assert step.outcome is None and step.state.detours == 1
    samples = np.concatenate([leg.samples for leg in step.way.path.legs])
    assert abs(samples[:, 2]).max() > 1.5 + 0.6, "round the outside"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_rover_that_slides_downhill_needs_the_room_of_its_nose(side: float) -> None:
    """Turned off its path by 15 degrees, uphill, it would touch with a corner what it passes when straight."""
    cloud = dense(lambda x, y: np.where((x > 1.8) & (x < 3.0) & (side * y > 0.91) & (side * y < 1.4), 0.3, 0.0))
    state = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), cloud, at(0.0, 0.0), 0.02)
    state, way = sent(state, Goal.at(5.0, 0.0), at(0.0, 0.0))
    assert closed_ahead(AVOIDANCE, state, way, 0.0) is None
    assert closed_ahead(AVOIDANCE, state, replace(way, drift=-side * 0.26), 0.0) is not None
    assert closed_ahead(AVOIDANCE, state, replace(way, drift=side * 0.02), 0.0) is None
    step = guide(AVOIDANCE, state, replace(way, drift=-side * 0.26), at(0.0, 0.0))
    assert step.outcome is None and step.state.detours == 1
    assert closed_ahead(AVOIDANCE, step.state, step.way, 0.0) is None, "the way round has the room"


def test_a_curve_back_to_the_path_is_not_looked_at_for_longer_than_it_lasts() -> None:
    """A clearance of 0.1 m beside a rover that steers by 0.6 1/m towards the rock: so it is led back to an open path.

    On 8 degrees with boulders five such stops within 0.3 m of way ended the goal. An operator may mean to go on so.
    """
    cloud = dense(lambda x, y: np.where((abs(x) < 1.5) & (y > 0.91) & (y < 1.4), 0.3, 0.0))
    state = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), cloud, at(0.0, 0.0), 0.02)
    for y in np.arange(0.0, 0.2, 0.01).tolist():
        here, twist = at(0.0, y), PlanarTwist(0.1, 0.0, 0.06)
        free = guarded(AVOIDANCE, state, twist, here, by_hand=False)[1]
        by_hand = guarded(AVOIDANCE, state, twist, here, by_hand=True)[1]
        clearance = float(clearances_of(AVOIDANCE, state.clearance, np.array([(0.0, y, 0.0)]))[0])
        assert free or not by_hand
        if clearance > 0.08:
            assert free
        if clearance < 0.1:
            assert not by_hand
        if clearance < PARAMS.guard_margin:
            assert not free
            break
    else:
        raise AssertionError("no place was near enough")


def test_the_name_the_heading_and_the_end_of_a_goal_are_kept() -> None:
    goal = replace(Goal.at(4.0, 0.0, 0.5, "mine"), heights=(0.0,))
    state, way = sent(facing_a_block(2.5, 2.8, 0.5), goal, at(0.0, 0.0))
    step = guide(AVOIDANCE, state, way, at(0.0, 0.0))
    assert step.way.goal == goal
    assert step.state.detours == 1 and step.state.obstacle is not None and step.state.obstacle.kind == "step"


def follow_on(step: Guidance, here: OdometryState, fresh: bool) -> Guidance:
    return guide(AVOIDANCE, replace(step.state, fresh=fresh), step.way, here)


def test_a_detour_is_kept_while_nothing_new_is_near() -> None:
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


def test_it_looks_again_before_a_third_motion_is_stopped() -> None:
    """Six motions were stopped within 0.12 s of one look, and the goal was given up; the next look was clear."""
    state, way = sent(facing_a_block(1.02, 1.5, 1.2), Goal.at(4.0, 0.0), at(0.0, 0.0))
    step = Guidance(replace(state, fresh=False), way)
    for _ in range(40):
        twist = PlanarTwist(0.1, 0.0, 0.0) if step.twist is None else step.twist
        state, free = guarded(AVOIDANCE, step.state, twist, at(0.0, 0.0), by_hand=False)
        if twist.v_x < 0.0:  # the wheels do not get it back either
            state = replace(state, blocked=True, attempts=state.attempts + 1, back=None)
        step = guide(AVOIDANCE, state, step.way, at(0.0, 0.0))
        assert step.outcome is None
    assert step.state.attempts == 2 and step.twist == PlanarTwist(0.0, 0.0, 0.0)
    assert free and step.text.startswith("stopped before step of 0.3")
    clear = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), dense(lambda x, y: 0.0 * x), at(0.0, 0.0), 0.02)
    seen = replace(step.state, map=clear.map, ground=clear.ground, clearance=clear.clearance, fresh=True)
    step = guide(AVOIDANCE, seen, step.way, at(0.0, 0.0))
    assert step.outcome is None and not step.state.blocked


@pytest.mark.parametrize("attempts,backs_off", [(1, False), (2, True), (3, False), (4, True), (5, False)])
def test_where_it_is_stopped_again_and_again_it_tries_on_and_back_in_turn(attempts: int, backs_off: bool) -> None:
    """From the second on it tried the way back alone, though the way on had been found open meanwhile."""
    state, way = sent(facing_a_block(1.5, 1.9, 1.0), Goal.at(4.0, 0.0), at(0.0, 0.0))
    step = guide(AVOIDANCE, replace(state, blocked=True, attempts=attempts), way, at(0.0, 0.0))
    assert step.outcome is None and (step.state.back is not None) == backs_off
    assert step.state.detours == (0 if backs_off else 1)


def test_a_detour_that_gets_too_long_ends_the_goal() -> None:
    state, way = sent(facing_a_block(2.0, 2.3, 1.0), Goal.at(4.0, 0.0), at(0.0, 0.0))
    late = at(0.0, 0.0, driven=4.0 + PARAMS.max_detour + 0.1)
    step = guide(AVOIDANCE, replace(state, blocked=True), way, late)
    assert step.outcome is not None and step.outcome.kind == "stopped"
    assert step.outcome.reason.endswith("no way round with 40 m more than asked for")


def test_a_refused_goal_leaves_what_is_under_way_alone() -> None:
    state, _ = sent(facing_a_block(2.0, 2.6, 1.0), Goal.at(1.0, 3.0), at(0.0, 0.0))
    bad = Goal.at(2.3, 0.0)
    answer, after = accepted(AVOIDANCE, state, bad, GoalOutcome("refused", "other", bad, math.nan), at(0.0, 0.0))
    assert isinstance(answer, GoalOutcome) and "lies in an obstacle" in answer.reason
    assert after is state


@pytest.mark.parametrize("guarded_by_hand", [True, False])
def test_the_guard_lets_go_what_leads_away(guarded_by_hand: bool) -> None:
    params = PARAMS.model_copy(update={"guard_cmd_vel": guarded_by_hand})
    avoidance = Avoidance(params, DRIVE.follower, TURNING, STEREO, WHEELS)
    state = facing_a_block(1.02, 1.5, 1.2, avoidance)
    for twist, free in (((0.1, 0.0, 0.0), False), ((-0.1, 0.0, 0.0), True), ((0.0, 0.0, 0.0), True)):
        after, found = guarded(avoidance, state, PlanarTwist(*twist), at(0.0, 0.0), by_hand=True)
        assert found == (free or not guarded_by_hand), twist
        assert after.blocked != found
        assert guarded(avoidance, state, PlanarTwist(*twist), at(0.0, 0.0), by_hand=False)[1] == free


def test_the_guard_stops_on_what_is_too_steep_in_the_direction_of_the_motion() -> None:
    """A bank of 20 degrees from 0.9 m on: not up it, but away from it, and along a slope of 16 degrees."""
    bank = dense(lambda x, y: np.maximum(x - 0.9, 0.0) * math.tan(math.radians(20.0)))
    state = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), bank, at(0.0, 0.0), 0.02)
    foot = at(1.2, 0.0)
    ahead, back = PlanarTwist(0.1, 0.0, 0.0), PlanarTwist(-0.1, 0.0, 0.0)
    after, free = guarded(AVOIDANCE, state, ahead, foot, by_hand=True)
    assert not free and after.obstacle is not None and after.obstacle.kind == "climb"
    assert str(after.obstacle).endswith("limit 14°") and after.obstacle.measured > 14.0
    assert guarded(AVOIDANCE, state, back, foot, by_hand=True)[1]
    assert guarded(AVOIDANCE, state, ahead, at(0.0, 0.0), by_hand=True)[1], "far from it"
    side = dense(lambda x, y: y * math.tan(math.radians(16.0)))
    state = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), side, at(0.0, 0.0), 0.02)
    assert guarded(AVOIDANCE, state, ahead, at(0.0, 0.0), by_hand=False)[1]
    after, free = guarded(AVOIDANCE, state, ahead, at(0.0, 0.0, 0.5 * math.pi), by_hand=False)
    assert free, "it stands on it already, and it gets no steeper"


def test_clocks_and_errors_of_a_goal_go_on_over_a_detour() -> None:
    goal = Goal.along([(1.0, 0.0), (2.6, 0.0), (4.5, 0.0)], number=7)
    state, way = sent(facing_a_block(2.5, 2.8, 0.5), goal, at(0.0, 0.0))
    kept = {"elapsed": 70.0, "drive_stall": 50.0, "turn_stall": 20.0, "lateral_max": 0.3, "lateral_square": 0.2,
            "followed": 5.0, "drift": 0.1, "attempts": 2, "passed": 1}  # fmt: skip
    step = guide(AVOIDANCE, state, replace(way, **kept), at(0.0, 0.0))
    assert step.state.detours == 1 and step.way.path is not way.path
    assert {name: getattr(step.way, name) for name in kept} == kept
    assert step.way.goal == goal and step.way.best_distance == step.way.path.length == step.way.distance_to_go
    marks = step.way.path.marks
    assert len(marks) == 3 and marks[0] <= marks[1] <= marks[2] == pytest.approx(step.way.path.length)
    assert marks[1] == marks[2], "the point in the block is passed with the last one"


def test_the_time_out_fires_though_the_way_is_planned_again_and_again() -> None:
    """A rover that does not move: each second another way, which before had the clocks start anew."""
    params = DRIVE.follower
    here = Pose(0.0, 0.0, 0.0)
    limits = FollowerLimits(0.1, 0.1, 0.5, 0.5, TURNING)
    way = accept(params, TURNING, Goal.at(4.0, 0.0), here)
    assert isinstance(way, FollowerState)
    for second in range(200):
        points = [(2.0, 0.3 * (-1.0) ** second), (4.0, 0.0)]
        other = accept(params, TURNING, Goal.along(points), here)
        assert isinstance(other, FollowerState)
        way = rerouted(way, other, here)
        step = follow(params, way, here, None, False, limits, 1.0)
        way = step.state
        if step.outcome is not None:
            break
    assert step.outcome is not None and step.outcome.reason.startswith("no progress for 120 s")
    assert second == pytest.approx(120, abs=2)


def test_loose_ground_is_closed_and_left_backwards() -> None:
    """What the drive makes of much slip: the ground ahead is an obstacle, the way back over the track comes first."""
    policy = DRIVE.slip_policy
    assert policy is not None
    level = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), dense(lambda x, y: 0.0 * x), at(0.0, 0.0), 0.02)
    state, way = sent(level, Goal.at(4.0, 0.0), at(0.0, 0.0))
    state = from_loose_ground(AVOIDANCE, state, at(0.0, 0.0), policy, 0.7)
    assert str(state.obstacle) == "loose ground at (1.44, 0.00), slip 0.70"
    assert from_loose_ground(AVOIDANCE, state, at(0.0, 0.0), policy, 0.7) is state, "once"
    step, x = guide(AVOIDANCE, state, way, at(0.0, 0.0)), 0.0
    while step.twist is not None and step.twist.v_x < 0.0:
        x -= 0.01
        step = guide(AVOIDANCE, step.state, step.way, at(x, 0.0, driven=-x))
    assert x == pytest.approx(-policy.back, abs=0.15)
    step = guide(AVOIDANCE, step.state, step.way, at(x, 0.0, driven=-x))
    assert step.outcome is None and step.twist is None and step.state.detours == 1
    samples = np.concatenate([leg.samples for leg in step.way.path.legs])
    off = np.hypot(samples[:, 1] - 1.44, samples[:, 2])
    assert off.min() > policy.loose_radius + 0.6


def test_loose_ground_round_the_goal_is_not_closed() -> None:
    """The ground ahead reaches to 1.44 m, and a rover that keeps clear of it comes no nearer to it than 1.39 m. On 12
    degrees across, 2.4 m before its goal, it went back and then found no way."""
    policy = DRIVE.slip_policy
    assert policy is not None
    level = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), dense(lambda x, y: 0.0 * x), at(0.0, 0.0), 0.02)
    for x, closes in ((2.8, False), (3.1, True)):
        state, _ = sent(level, Goal.at(x, 0.0), at(0.0, 0.0))
        assert (from_loose_ground(AVOIDANCE, state, at(0.0, 0.0), policy, 0.7) is not state) == closes


def test_no_loose_ground_that_is_closed_takes_the_way_to_the_goal() -> None:
    """In any place of the grid. On 12 degrees, 0.08 m before its goal and 1.391 m from the middle of the loose ground,
    it closed that, went back, and then found no way: the cells of it reach farther than their middles."""
    policy = DRIVE.slip_policy
    assert policy is not None
    random, closed = np.random.default_rng(3), 0
    level = see(AVOIDANCE, initial_avoidance(AVOIDANCE, 0.0, 0.0), dense(lambda x, y: 0.0 * x), at(0.0, 0.0), 0.02)
    for _ in range(40):
        yaw, away, to_goal = random.uniform(-3.1, 3.1), random.uniform(1.38, 1.8), random.uniform(-3.1, 3.1)
        middle = np.array((math.cos(yaw), math.sin(yaw))) * (PARAMS.outline.front + policy.loose_radius)
        goal = middle + away * np.array((math.cos(to_goal), math.sin(to_goal)))
        state, _ = sent(level, Goal.at(*goal.tolist()), at(0.0, 0.0))
        after = from_loose_ground(AVOIDANCE, state, at(0.0, 0.0, yaw), policy, 0.7)
        closed += after is not state
        row, column = after.clearance.cell_of(*goal.tolist())
        assert after.clearance.distances[row, column] >= AVOIDANCE.straight
    assert closed > 10


def test_where_a_point_turn_just_fits_it_is_not_stopped() -> None:
    """The circles that cover the outline sweep 1.23 m, the outline itself 1.04 m."""
    state = facing_a_block(1.35, 1.5, 1.2)
    assert 1.07 < state.clearance.at(0.0, 0.0) < 1.23
    turn = PlanarTwist(0.0, 0.0, 0.1)
    for yaw in np.arange(-3.0, 3.1, 0.25).tolist():
        assert guarded(AVOIDANCE, state, turn, at(0.0, 0.0, yaw), by_hand=False)[1], yaw
    nearer = facing_a_block(1.05, 1.5, 1.2)
    turns = [guarded(AVOIDANCE, nearer, turn, at(0.0, 0.0, yaw), by_hand=False)[1] for yaw in (-0.4, -0.6, 0.3)]
    assert not all(turns)
