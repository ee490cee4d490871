"""Paths of the tip as goals: shape with rounded corners, timing, what is refused, and the arm on its way."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm import controller
from sojourn_flight.arm.cartesian_path import TipPath, arc, line
from sojourn_flight.arm.goal_events import was
from sojourn_flight.arm.goals import JointGoal, PathGoal, PathPoint, PauseGoal, PoseGoal, ResumeGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.motion_load import peak
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmInput, initial_state
from sojourn_flight.arm.tip_route import routes_along
from sojourn_flight.arm.trajectory import at_rest
from sojourn_flight.arm.ways import Departure, Plan
from sojourn_machine.params import FloatArray

DT = 0.02
SCENARIO = load_scenario("flat_drive")
PARAMS = SCENARIO.carried_arm().model_copy(update={"gear_compliance": (), "gear_backlash": (), "bearing_friction": ()})
MODEL = build_arm_model(SCENARIO.urdf_xml, PARAMS)
UNFOLD = np.array(PARAMS.named_poses["unfold"])
TIP = forward_kinematics(MODEL, UNFOLD)
MOON = np.array([0.0, 0.0, -1.62])
EYE = np.eye(3)
number = st.floats(-0.5, 0.5)
place = st.tuples(number, number, number).map(np.array)


def point(offset: Any, on_arc: bool = False, direction: Any = None) -> PathPoint:
    """A point of a path, from where the tip is in the pose 'unfold'."""
    x, y, z = (float(value) for value in TIP.position + np.array(offset))
    return PathPoint(PoseGoal((x, y, z), direction), on_arc)


def plan(*points: PathPoint, ground: Any = None, **changes: Any) -> Plan:
    params = PARAMS.model_copy(update={"tip_path": PARAMS.tip_path.model_copy(update=changes)})
    return plan_goal(params, MODEL, PathGoal(points), Departure(at_rest(UNFOLD), UNFOLD), ground, MOON)


def off_the(shape: FloatArray, path: JointPath) -> float:
    """Largest distance of the tip from points (k, 3) of the wanted shape, between the points: [m]."""
    tips = [forward_kinematics(MODEL, q).position for q in path.samples(np.linspace(0.0, path.duration, 300))]
    return float(cKDTree(shape).query(np.array(tips))[0].max())


def polygon(*offsets: Any) -> FloatArray:
    """Points 0.2 mm apart, or less, on straight lines from the tip over offsets."""
    corners = TIP.position + np.array([(0.0, 0.0, 0.0), *offsets])
    share = np.linspace(0.0, 1.0, 2000)[:, None]
    return np.vstack([a + share * (b - a) for a, b in pairwise(corners)])


@given(places=st.lists(place, min_size=3, max_size=6), corner=st.floats(1e-3, 0.05))
@settings(max_examples=25, deadline=None)
def test_a_rounded_corner_is_passed_by_so_much_at_most_and_nothing_jumps(places: Any, corner: float) -> None:
    legs = [line(a, b, EYE, EYE) for a, b in pairwise(places) if np.linalg.norm(b - a) > 0.02]
    joined: list[TipPath] = []
    for leg in legs:  # a leg that was left out leaves a gap: go on from where the last one ended
        joined.append(leg if not joined else line(joined[-1].end, leg.end, EYE, EYE))
    joined = [leg for leg in joined if leg.length > 0.02]
    routes = routes_along(joined, corner)
    assert sum(len(route.legs) for route in routes) == len(joined)
    for route in routes:
        shares = np.linspace(0.0, 1.0, 801)
        run = np.array([route.pose(s)[0] for s in shares])
        np.testing.assert_allclose(run[[0, -1]], [route.legs[0].start, route.legs[-1].end], rtol=0.0, atol=1e-12)
        steps = np.linalg.norm(np.diff(run, axis=0), axis=1)
        assert steps.max() <= route.length / 800 * (1.0 + 1e-6)  # nowhere faster than on the legs
        for k, leg in enumerate(route.legs[:-1]):
            assert np.linalg.norm(run - leg.end, axis=1).min() <= corner + steps.max()
            assert route.rounded[k] <= 0.5 * min(leg.length, route.legs[k + 1].length) + 1e-12


def test_a_rounding_is_smooth_to_the_second_derivative() -> None:
    straight = line(np.zeros(3), np.array([0.4, 0.0, 0.0]), EYE, EYE)
    bow = arc(straight.end, np.array([0.5, 0.1, 0.0]), np.array([0.4, 0.2, 0.0]), EYE, EYE)
    up = line(bow.end, np.array([0.4, 0.2, 0.3]), EYE, Rotation.from_rotvec([0.0, 0.0, 0.8]).as_matrix())
    route = routes_along([straight, bow, up], 0.01)[0]
    assert len(route.rounded) == 2
    for s in route.breaks:  # a jump would be left however near one looks
        jumps = []
        for h in (1e-3, 1e-4):
            places = np.array([route.pose(s + k * h)[0] for k in (-2, -1, 0, 1, 2)])
            second = np.diff(places, 2, axis=0) / h**2
            jumps.append(float(np.linalg.norm(second[-1] - second[0])))
        assert jumps[1] < 0.15 * jumps[0] + 1e-4
    turned = [Rotation.from_matrix(route.pose(s)[1]) for s in np.linspace(0.0, 1.0, 400)]
    steps = [(b * a.inv()).magnitude() for a, b in pairwise(turned)]
    assert sum(steps) == pytest.approx(0.8, abs=1e-6) and max(steps) < 0.02


def test_the_tip_keeps_to_a_line_within_a_tenth_of_a_millimetre() -> None:
    made = plan(point((0.1, 0.15, 0.0)))
    assert off_the(polygon((0.1, 0.15, 0.0)), made.path) < 1.5e-4  # 0.1 mm of it: the points of the line
    np.testing.assert_allclose(made.tip_target, TIP.position + np.array([0.1, 0.15, 0.0]), atol=1e-6)
    for time in np.linspace(0.0, made.path.duration, 60):
        tool = forward_kinematics(MODEL, made.path.sample(time)[0]).tool_direction
        np.testing.assert_allclose(tool, TIP.tool_direction, atol=2e-4)


def test_lines_and_arcs_in_one_go_and_the_tool_turns_on_the_way() -> None:
    slanted = (0.3, 0.0, -math.sqrt(1.0 - 0.09))
    goal = (
        point((0.0, 0.1, 0.0)),
        point((0.1, 0.2, 0.0), True),
        point((0.2, 0.1, 0.0)),
        point((0.2, 0.0, 0.05), False, slanted),
    )
    made = plan(*goal)
    assert made.note == ""
    angle = np.linspace(0.0, math.pi, 4000)
    bow = TIP.position + np.array([0.1, 0.1, 0.0]) + 0.1 * np.column_stack([-np.cos(angle), np.sin(angle), 0.0 * angle])
    last = bow[-1] + np.linspace(0.0, 1.0, 2000)[:, None] * [0.0, -0.1, 0.05]
    assert off_the(np.vstack([polygon((0.0, 0.1, 0.0)), bow, last]), made.path) < PARAMS.tip_path.corner
    end = forward_kinematics(MODEL, made.target)
    np.testing.assert_allclose(end.tool_direction, slanted, atol=1e-5)
    exact = plan(*goal, corner=0.0)
    assert exact.note == "stops at 2 of its corners"
    assert off_the(np.vstack([polygon((0.0, 0.1, 0.0)), bow, last]), exact.path) < 1.5e-4


@given(
    offsets=st.lists(
        st.tuples(st.floats(-0.25, 0.05), st.floats(-0.2, 0.2), st.floats(-0.1, 0.15)), min_size=1, max_size=3
    ),
    speed=st.floats(0.005, 1.0),
)
@settings(max_examples=15, deadline=None)
def test_speed_acceleration_and_jerk_of_the_commands_are_within_the_limits(offsets: Any, speed: float) -> None:
    try:
        made = plan(*(point(offset) for offset in offsets), speed=speed)
    except GoalRefusedError as refusal:
        assert any(word in str(refusal) for word in ("collision", "stays", "no length"))
        return
    rest = np.tile(made.path.sample(0.0)[0], (4, 1))
    commands = np.vstack([rest, made.path.samples(np.arange(0.0, made.path.duration + 5 * DT, DT))])
    for order, limit in ((1, MODEL.max_velocity), (2, MODEL.max_acceleration), (3, MODEL.max_jerk)):
        assert np.all(np.abs(np.diff(commands, order, axis=0)) / DT**order <= limit * (1.0 + 1e-5))
    tips = np.array([forward_kinematics(MODEL, q).position for q in commands])
    assert np.max(np.linalg.norm(np.diff(tips, axis=0), axis=1)) / DT <= speed * 1.02
    assert np.all(commands >= MODEL.lower - 1e-5) and np.all(commands <= MODEL.upper + 1e-5)
    ends = made.path.sample(made.path.duration)
    np.testing.assert_allclose(ends[1:], 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ((), "at least one"),
        ((point((0.0, 0.0, 0.0)),), "no length"),
        ((point((0.0, 0.1, 0.0)), point((1.0, 0.1, 0.0))), r"at \d+ % of the path the arm stays behind"),
        ((point((0.1, 0.1, 0.0), True),), "its end is to follow"),
        ((point((0.1, 0.1, 0.0), True), point((0.2, 0.1, 0.0), True)), "points 0 and 1 are both on an arc"),
        ((point((0.1, 0.0, 0.0), True), point((0.2, 0.0, 0.0))), "three points that are no line"),
        ((point((0.0, 0.0, -0.8)),), "below the plane on which the machine stands"),
        ((point((-0.5, 0.7, -0.1)),), "collision of arm_turret_link and rocker_left_link"),
        ((point((math.nan, 0.0, 0.0)),), "finite"),
    ],
)
def test_a_path_that_cannot_be_is_refused_with_the_reason(points: tuple[PathPoint, ...], words: str) -> None:
    with pytest.raises(GoalRefusedError, match=words):
        plan(*points, ground=GroundPlane(-0.55))


def test_a_path_is_paused_resumed_and_replaced_like_any_motion() -> None:
    state, joints = initial_state(PARAMS), UNFOLD
    periods: dict[int, Any] = {
        0: JointGoal(("arm_azimuth_joint",), (0.2,)),
        60: PathGoal((point((0.0, 0.1, 0.0)), point((0.05, 0.0, 0.05)))),  # the arm moves: it comes to rest first
        200: PauseGoal(),
        330: ResumeGoal(),
    }
    seen = []
    for period in range(1200):
        inputs = ArmInput(joints, np.zeros(5), MOON, periods.get(period))
        state, out = controller.step(PARAMS, MODEL, state, inputs, DT)
        joints = state.reference.position
        seen.append(out.status)
        assert not was("refused", out.events), out.reason
    assert "paused" in seen and seen[-1] == "reached"
    np.testing.assert_allclose(
        forward_kinematics(MODEL, joints).position, TIP.position + np.array([0.05, 0.0, 0.05]), atol=1e-6
    )


def test_less_power_makes_it_slower_on_the_same_way() -> None:
    goal = PathGoal((point((0.1, 0.15, 0.0)),))
    heavy = 4.0 * MOON
    free = plan_goal(PARAMS, MODEL, goal, Departure(at_rest(UNFOLD), UNFOLD), None, heavy)
    weak = PARAMS.model_copy(update={"power_limit": 1.5})
    slow = plan_goal(weak, MODEL, goal, Departure(at_rest(UNFOLD), UNFOLD), None, heavy)
    assert "slower, or the arm would draw" in slow.note
    assert slow.path.duration > 1.1 * free.path.duration
    assert peak(weak, MODEL, slow.path, heavy).share <= 1.0 < peak(weak, MODEL, free.path, heavy).share
    assert off_the(polygon((0.1, 0.15, 0.0)), slow.path) < 1.5e-4


@pytest.mark.parametrize("name", ["cylindrical_course", "scara_course", "puma560_course"])
def test_arms_of_four_and_six_joints_follow_a_line(name: str) -> None:
    """Four joints keep to the place alone: they were asked for the orientation, too, and refused at once."""
    scenario = load_scenario(name)
    params = scenario.carried_arm()
    model = build_arm_model(scenario.urdf_xml, params)
    start = np.array(params.named_poses["unfold"])
    tip = forward_kinematics(model, start).position
    end = tip + np.array([-0.03, 0.08, 0.02])
    goal = PathGoal((PathPoint(PoseGoal((float(end[0]), float(end[1]), float(end[2])))),))
    made = plan_goal(
        params, model, goal, Departure(at_rest(start), start), None, np.array([0.0, 0.0, -scenario.gravity])
    )
    shape = tip + np.linspace(0.0, 1.0, 2000)[:, None] * (end - tip)
    places = [
        forward_kinematics(model, q).position for q in made.path.samples(np.linspace(0.0, made.path.duration, 99))
    ]
    assert float(cKDTree(shape).query(np.array(places))[0].max()) < 1.5e-4
    np.testing.assert_allclose(places[-1], end, atol=1e-6)
