"""The goal follower on a machine that slips: it converges from any start, and every goal ends with a word."""

import math
from dataclasses import dataclass

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.odometry.odometry import wrap_angle
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.planning.follower_state import FollowerLimits, FollowerPhase, FollowerState, FollowerStep
from sojourn_flight.planning.goal import Goal, GoalOutcome, path_lengths
from sojourn_flight.planning.goal_follower import accept as accept_from
from sojourn_flight.planning.goal_follower import follow as follow_from
from sojourn_flight.supervision.params import DriveParams

TURNING = TurningLimits(curvature=0.7, sharpness=3.0, on_the_spot=True)
LIMITS = FollowerLimits(speed=0.1, yaw_rate=0.11, deceleration=0.2, yaw_deceleration=0.22, turning=TURNING)
DT = 0.1


@pytest.fixture(scope="module")
def params(drive_params: DriveParams) -> GoalFollowerParams:
    return drive_params.follower


def accept(params: GoalFollowerParams, goal: Goal, place: tuple[float, ...]) -> FollowerState | GoalOutcome:
    """From a place, with a heading of zero unless one is given."""
    return accept_from(params, TURNING, goal, Pose(*place, *(0.0,) * (3 - len(place))))


def follow(
    params: GoalFollowerParams,
    state: FollowerState,
    pose: tuple[float, float, float],
    moving: bool,
    limits: FollowerLimits,
    dt: float,
) -> FollowerStep:
    """Without knowing of any drift."""
    return follow_from(params, state, Pose(*pose), None, moving, limits, dt)


@dataclass
class Slipping:
    """A unicycle with inertia that loses part of its speed and of its turn, and drifts sideways."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    slip: float = 0.0
    turn_slip: float = 0.0
    drift: float = 0.0
    turn_slide: float = 0.0
    """Downhill, to the right of the map, for each radian that it turns [m]."""
    v: float = 0.0
    w: float = 0.0

    def move(self, v: float, w: float) -> None:
        self.v += min(max(v - self.v, -0.2 * DT), 0.1 * DT)
        self.w += min(max(w - self.w, -0.11 * DT), 0.11 * DT)
        forward = self.v * (1.0 - self.slip) * DT
        sideways = self.drift * forward
        self.yaw += 0.5 * self.w * (1.0 - self.turn_slip) * DT
        self.x += math.cos(self.yaw) * forward - math.sin(self.yaw) * sideways
        self.y += math.sin(self.yaw) * forward + math.cos(self.yaw) * sideways
        self.yaw += 0.5 * self.w * (1.0 - self.turn_slip) * DT
        self.y -= self.turn_slide * abs(self.w) * (1.0 - self.turn_slip) * DT


def go(
    params: GoalFollowerParams, rover: Slipping, goal: Goal, longest: float = 2000.0, limits: FollowerLimits = LIMITS
) -> tuple[GoalOutcome, list[tuple[float, float, float]], list[FollowerState]]:
    """Drives until the goal ends; outcome, track and states."""
    state = accept(params, goal, (rover.x, rover.y, rover.yaw))
    assert isinstance(state, FollowerState)
    track, states = [], []
    for _ in range(round(longest / DT)):
        moving = abs(rover.v) > 1e-3 or abs(rover.w) > 1e-3
        result = follow(params, state, (rover.x, rover.y, wrap_angle(rover.yaw)), moving, limits, DT)
        if result.outcome is not None:
            return result.outcome, track, states
        assert abs(result.v_x) <= LIMITS.speed + 1e-12
        assert abs(result.yaw_rate) <= max(LIMITS.yaw_rate, params.max_curvature * LIMITS.speed) + 1e-12
        state = result.state
        rover.move(result.v_x, result.yaw_rate)
        track.append((rover.x, rover.y, rover.yaw))
        states.append(state)
    raise AssertionError(f"goal did not end: {state}")


angles = st.floats(-math.pi, math.pi)


@settings(max_examples=30, deadline=None)
@given(st.floats(1.0, 4.0), angles, angles, angles, st.floats(0.1, 0.3), st.floats(0.93, 1.07))
def test_on_a_slope_it_ends_with_its_heading_where_its_turns_are_known_to_slide(
    params: GoalFollowerParams,
    distance: float,
    direction: float,
    start_yaw: float,
    goal_yaw: float,
    slide: float,
    true_part: float,
) -> None:
    """A turn at the goal moves the rover by decimetres off it: the way to it leaves room, so far as that is known."""
    goal = Goal.at(distance * math.cos(direction), distance * math.sin(direction), goal_yaw)
    rover = Slipping(yaw=start_yaw, turn_slide=true_part * slide)
    outcome, track, _ = go(params, rover, goal, limits=LIMITS._replace(slide=(0.0, -slide)))
    assert outcome.kind == "reached", outcome
    assert math.dist(track[-1][:2], goal.points[-1]) <= params.position_tolerance


def test_where_its_turns_are_not_known_to_slide_it_gives_up(params: GoalFollowerParams) -> None:
    outcome, _, _ = go(params, Slipping(turn_slide=0.4), Goal.at(1.0, 1.0, 3.1))
    assert outcome.kind == "stopped" and "after 5 approaches" in outcome.reason


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.0, 5.0), angles, angles, st.one_of(st.none(), angles),
    st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.1, 0.1),
)  # fmt: skip
def test_it_converges_from_any_start_with_slip(
    params: GoalFollowerParams,
    distance: float,
    direction: float,
    start_yaw: float,
    goal_yaw: float | None,
    slip: float,
    turn_slip: float,
    drift: float,
) -> None:
    rover = Slipping(yaw=start_yaw, slip=slip, turn_slip=turn_slip, drift=drift)
    goal = Goal.at(distance * math.cos(direction), distance * math.sin(direction), goal_yaw)
    outcome, _, _ = go(params, rover, goal)
    assert outcome.kind == "reached", outcome.reason
    assert math.dist((rover.x, rover.y), goal.points[0]) <= params.position_tolerance
    assert outcome.distance_to_go == pytest.approx(math.dist((rover.x, rover.y), goal.points[0]))
    if goal_yaw is not None:
        assert abs(wrap_angle(rover.yaw - goal_yaw)) <= params.yaw_tolerance


@settings(max_examples=15, deadline=None)
@given(
    st.lists(st.tuples(st.floats(1.0, 4.0), st.floats(-2.0, 2.0)), min_size=1, max_size=5),
    angles,
    st.floats(0.0, 0.3),
    st.floats(-0.05, 0.05),
)
def test_every_waypoint_is_passed_and_only_the_last_is_a_stop(
    params: GoalFollowerParams, legs: list[tuple[float, float]], start_yaw: float, slip: float, drift: float
) -> None:
    points, x, y, heading = [], 0.0, 0.0, 0.0
    for length, turn in legs:
        heading += turn
        x, y = x + length * math.cos(heading), y + length * math.sin(heading)
        points.append((x, y))
    rover = Slipping(yaw=start_yaw, slip=slip, drift=drift)
    outcome, track, states = go(params, rover, Goal.along(points))
    assert outcome.kind == "reached", outcome.reason
    for point in points[:-1]:
        assert min(math.dist(place[:2], point) for place in track) <= params.corner_cut + 0.1
    assert math.dist((rover.x, rover.y), points[-1]) <= params.position_tolerance
    assert [state.index for state in states] == sorted(state.index for state in states)
    settled = {state.index for state in states if state.phase is FollowerPhase.SETTLE}
    assert settled <= {len(points) - 1}


def test_a_gentle_path_is_driven_without_a_stop(params: GoalFollowerParams) -> None:
    points = [(2.0, 0.0), (4.0, 0.6), (6.0, 1.8), (8.0, 3.0)]
    rover = Slipping(slip=0.15)
    _, track, states = go(params, rover, Goal.along(points))
    assert {state.phase for state in states} == {FollowerPhase.DRIVE, FollowerPhase.SETTLE}
    # distance to the polyline, by the nearest of many points on it
    line = [(0.0, 0.0), *points]
    fine = [
        (a[0] + (b[0] - a[0]) * k / 200, a[1] + (b[1] - a[1]) * k / 200)
        for a, b in zip(line, points, strict=False)
        for k in range(201)
    ]
    errors = [min(math.dist(place[:2], point) for point in fine) for place in track[::20]]
    assert math.sqrt(sum(error * error for error in errors) / len(errors)) < 0.15


def test_sideways_drift_is_steered_out(params: GoalFollowerParams) -> None:
    rover = Slipping(drift=0.1)
    _, track, states = go(params, rover, Goal.at(10.0, 0.0))
    assert max(abs(y) for _, y, _ in track) < 0.15
    assert states[400].lateral_error == pytest.approx(track[399][1], abs=1e-3)


def test_a_rover_that_slides_downhill_as_it_turns_comes_to_its_goal(params: GoalFollowerParams) -> None:
    """It went along the path of before the turn, arrived beside its goal, turned again, and gave up in 13 of 72."""
    directions = [k * math.pi / 12.0 for k in range(24)]
    goals = [(d * math.cos(angle), d * math.sin(angle)) for d in (0.2, 0.35, 0.6) for angle in directions]
    reached = 0
    for goal in goals:
        outcome, track, _ = go(params, Slipping(turn_slide=0.4), Goal((goal,)))
        reached += outcome.kind == "reached" and math.dist(track[-1][:2], goal) <= params.position_tolerance
    assert reached >= len(goals) - 2


def test_distance_to_go_is_the_way_along_the_path(params: GoalFollowerParams) -> None:
    assert path_lengths((0.0, 0.0), [(3.0, 4.0), (3.0, 10.0)]) == (11.0, 6.0, 0.0)
    state = accept(params, Goal.along([(3.0, 4.0), (3.0, 10.0)]), (0.0, 0.0))
    assert isinstance(state, FollowerState)
    assert 10.8 < state.distance_to_go < 11.0  # the corner is rounded
    assert state.distance_to_go == state.path.length
    result = follow(params, state, (0.0, 0.0, 0.0), False, LIMITS, DT)
    assert result.state.distance_to_go == pytest.approx(state.path.length)


def test_it_slows_down_before_the_goal(params: GoalFollowerParams) -> None:
    state = accept(params, Goal.at(3.0, 0.0), (0.0, 0.0))
    assert isinstance(state, FollowerState)
    speeds = []
    for x in (0.0, 1.0, 2.0, 2.85, 2.93, 2.9615, 2.96999):
        state, speed, _, _ = follow(params, state, (x, 0.0, 0.0), True, LIMITS, DT)
        speeds.append(speed)
    braking = params.approach_speed / params.stop_time  # to rest 0.03 m before the goal, at one rate
    assert speeds == pytest.approx([
        0.1, 0.1, 0.1, math.sqrt(2.0 * braking * 0.12), 0.07 * params.distance_gain, math.sqrt(2.0 * braking * 0.0085),
        0.1 * params.approach_speed,
    ])  # fmt: skip


@pytest.mark.parametrize(
    ("goal", "reason"),
    [
        (Goal.at(math.nan, 0.0), r"point 0 is \(nan, 0.0\)"),
        (Goal.along([(1.0, 0.0), (2.0, math.inf)]), "point 1"),
        (Goal.at(1.0, 0.0, math.nan), "heading is nan"),
        (Goal.along([]), "no points"),
        (Goal.at(200.5, 0.0), "200.5 m long, allowed are 200.0 m"),
        (Goal.along([(150.0, 0.0), (0.0, 0.0)]), "300.0 m long"),
        (Goal.along([(0.0, 0.0)] * 1001), "1001 points"),
    ],
)
def test_bad_goals_are_refused_with_the_reason(params: GoalFollowerParams, goal: Goal, reason: str) -> None:
    outcome = accept(params, goal, (0.0, 0.0))
    assert isinstance(outcome, GoalOutcome)
    assert outcome.kind == "refused"
    with pytest.raises(ValueError, match=reason):
        raise ValueError(outcome.reason)


@pytest.mark.parametrize(("slip", "turn_slip"), [(1.0, 0.0), (0.0, 1.0)])
def test_a_rover_that_gets_nowhere_gives_up(params: GoalFollowerParams, slip: float, turn_slip: float) -> None:
    outcome, _, states = go(params, Slipping(slip=slip, turn_slip=turn_slip), Goal.at(2.0, 2.0))
    assert outcome.kind == "stopped"
    assert "no progress" in outcome.reason
    assert outcome.distance_to_go == pytest.approx(math.hypot(2.0, 2.0), abs=0.2)
    assert states[-1].elapsed >= params.progress_timeout


def test_a_heading_that_cannot_be_held_ends_after_some_attempts(params: GoalFollowerParams) -> None:
    state = accept(params, Goal.at(0.0, 0.0, 0.0), (0.0, 0.0))
    assert isinstance(state, FollowerState)
    outcome, settles = None, 0
    for _ in range(200):
        # something turns the rover away whenever it stands
        yaw = 0.5 if state.phase is FollowerPhase.SETTLE else 0.0
        settles += state.phase is FollowerPhase.SETTLE
        result = follow(params, state, (0.0, 0.0, yaw), False, LIMITS, DT)
        state, outcome = result.state, result.outcome
        if outcome is not None:
            break
    assert outcome is not None
    assert outcome.kind == "stopped"
    assert "approaches" in outcome.reason
    assert settles == params.settle_attempts
