"""Paths of the tip: geometry, and joints that follow it on one branch."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from sojourn_config.arms import load_arm
from sojourn_flight.arm.cartesian_path import arc, line
from sojourn_flight.arm.inverse import pointing_goal, pose_goal, position_goal
from sojourn_flight.arm.inverse_search import POSE, POSITION
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_flight.arm.time_optimal import JointLimits, fastest_timing
from sojourn_flight.arm.tip_following import CartesianPathError, joints_along
from sojourn_machine.errors import InvalidValueError

PUMA, EXPLORER = load_arm("puma560"), load_arm("explorer_arm")
ZERO = np.zeros(3)
BENT = np.array([0.1, 0.6, -2.6, 0.3, 0.9, 0.2])


def test_a_line_is_straight_and_turns_like_slerp() -> None:
    first, last = Rotation.from_rotvec([0.3, 0.2, -0.5]), Rotation.from_rotvec([-0.4, 1.0, 0.7])
    path = line(np.zeros(3), np.array([1.0, 2.0, 2.0]), first.as_matrix(), last.as_matrix())
    assert path.length == pytest.approx(3.0)
    slerp = Slerp([0, 1], Rotation.concatenate([first, last]))
    for s in (0.0, 0.3, 1.0):
        place, rotation = path.pose(s)
        np.testing.assert_allclose(place, [s, 2 * s, 2 * s], atol=1e-12)
        np.testing.assert_allclose(rotation, slerp(s).as_matrix(), atol=1e-12)


def test_an_arc_goes_through_its_three_points() -> None:
    centre, radius = np.array([0.2, -0.1, 0.5]), 0.4
    frame = Rotation.from_rotvec([0.4, -0.8, 0.3])

    def on_circle(angle: float) -> np.ndarray:
        return centre + radius * frame.apply([math.cos(angle), math.sin(angle), 0.0])

    path = arc(on_circle(0.2), on_circle(2.0), on_circle(4.4), np.eye(3), np.eye(3))  # more than half a turn
    assert path.length == pytest.approx(radius * 4.2)
    np.testing.assert_allclose(path.centre, centre, atol=1e-12)
    for s in (0.0, 0.25, 0.5, 1.0):
        np.testing.assert_allclose(path.pose(s)[0], on_circle(0.2 + 4.2 * s), atol=1e-9)
    back = arc(on_circle(4.4), on_circle(2.0), on_circle(0.2), np.eye(3), np.eye(3))
    np.testing.assert_allclose(back.pose(0.5)[0], path.pose(0.5)[0], atol=1e-9)
    with pytest.raises(InvalidValueError, match="no line"):
        arc(np.zeros(3), np.ones(3), 2 * np.ones(3), np.eye(3), np.eye(3))


def test_the_joints_keep_the_tip_on_the_path() -> None:
    tip = forward_kinematics(PUMA, BENT)
    turned = Rotation.from_rotvec([0.2, -0.3, 0.4]).as_matrix() @ tip.rotation
    path = line(tip.position, tip.position + np.array([-0.1, 0.3, 0.1]), tip.rotation, turned)
    joints = joints_along(PUMA, path, BENT)
    np.testing.assert_allclose(joints.joints.at(0.0)[0], BENT, atol=1e-6)
    for u in np.linspace(0.0, joints.joints.end, 57):
        place, rotation = path.pose(joints.share(float(u)))
        reached = forward_kinematics(PUMA, joints.joints.at(float(u))[0])
        np.testing.assert_allclose(reached.position, place, atol=1.2e-4)
        assert Rotation.from_matrix(reached.rotation @ rotation.T).magnitude() < 1.2e-4


def test_five_joints_follow_place_and_pointing() -> None:
    start = np.array([0.1, -0.8, 1.6, -0.8, 0.2])
    tip = forward_kinematics(EXPLORER, start)
    path = line(tip.position, tip.position + np.array([0.1, 0.15, -0.1]), tip.rotation, tip.rotation)
    joints = joints_along(EXPLORER, path, start)
    for u in np.linspace(0.0, joints.joints.end, 23):
        reached = forward_kinematics(EXPLORER, joints.joints.at(float(u))[0])
        np.testing.assert_allclose(reached.position, path.pose(joints.share(float(u)))[0], atol=1.2e-4)
        np.testing.assert_allclose(reached.tool_direction, tip.tool_direction, atol=1.2e-4)


def test_near_a_singularity_the_tip_is_slowed_down_and_the_limits_hold() -> None:
    """A line on which the wrist is nearly stretched in the middle: roll and flange turn far for a short way there."""
    middle = np.array([0.1, 0.6, -2.6, 1.0, 0.08, 0.1])
    tip = forward_kinematics(PUMA, middle)
    half = np.array([0.1, 0.0, 0.0])
    start, end = tip.position - half, tip.position + half
    posture = pose_goal(PUMA, start, tip.rotation, middle).positions
    joints = joints_along(PUMA, line(start, end, tip.rotation, tip.rotation), posture)
    acceleration = np.full(6, 20.0)
    limits = JointLimits(np.full(6, 0.4), acceleration, np.full(6, 1e4))
    motion = fastest_timing(PUMA, joints.joints, limits, np.array([0.0, 0.0, -9.81]), intervals=400)
    speeds, wrist = [], []
    for time in np.linspace(0.05, motion.duration - 0.05, 300):
        q, qd, qdd = motion.sample(float(time))
        assert np.all(np.abs(qd) <= 0.4 * 1.005) and np.all(np.abs(qdd) <= acceleration * 1.005)
        speeds.append(float(np.linalg.norm(forward_kinematics(PUMA, q).jacobian[:3] @ qd)))
        wrist.append(abs(q[4]))
    assert min(wrist) < 0.08
    assert speeds[int(np.argmin(wrist))] < 0.3 * max(speeds)


FREE = dataclasses.replace(PUMA, lower=np.full(6, -9.0), upper=np.full(6, 9.0))
"""A PUMA whose limits do not end the turn that the wrist has to make."""
SINGULAR = {
    "wrist stretched": (FREE, [0.1, 0.6, -2.6, 0.4, 0.0, 0.2]),
    "wrist at right angles": (load_arm("ssrms"), [0.3, 0.4, 0.2, 0.9, 0.5, 0.5 * math.pi, 0.2]),
    "nothing": (load_arm("cylindrical"), [0.3, 0.4, 0.3, 0.2]),
}


@pytest.mark.parametrize("beside", [0.0, 1e-4, 1e-2])
@pytest.mark.parametrize("arm,posture", SINGULAR.values(), ids=SINGULAR.keys())
def test_lines_through_and_beside_singular_postures(arm: SerialArm, posture: list[float], beside: float) -> None:
    """They were refused: a joint would have to jump. Now all are followed, and every sample keeps the joints' rates."""
    generator = np.random.default_rng(3)
    tip = forward_kinematics(arm, np.array(posture))
    task = POSE if arm.joint_count > 5 else POSITION
    for _ in range(2):
        along = generator.normal(size=3)
        along *= 0.1 * arm.reach / np.linalg.norm(along)
        aside = np.cross(along, generator.normal(size=3))
        middle = tip.position + beside * arm.reach * aside / np.linalg.norm(aside)
        turned = tip.rotation @ Rotation.from_rotvec(beside * generator.normal(size=3)).as_matrix()
        path = line(middle - along, middle + along, turned, turned)
        start = _solved(arm, task, middle - along, turned, np.array(posture))
        followed = joints_along(arm, path, start, task)
        speed = np.minimum(arm.max_velocity, 1.0)
        motion = fastest_timing(arm, followed.joints, JointLimits(speed, 2.0 * speed, np.full(len(posture), 1e6)), ZERO)
        positions, rates, _ = motion.states(np.linspace(0.0, motion.duration, 800))
        assert np.all(np.abs(rates) <= speed * 1.002)
        away = np.cross(np.array([forward_kinematics(arm, q).position for q in positions]) - path.start, along)
        assert np.max(np.linalg.norm(away, axis=1)) / np.linalg.norm(along) < 1.5e-4


def _solved(arm: SerialArm, task: int, place: np.ndarray, rotation: np.ndarray, near: np.ndarray) -> np.ndarray:
    answer = pose_goal(arm, place, rotation, near) if task == POSE else position_goal(arm, place, near)
    assert answer.reached
    return answer.positions


def test_a_line_just_inside_the_reach_stretches_the_elbow_and_goes_on() -> None:
    stretched = np.array([0.2, -0.4, 0.0, 0.6, 0.3])
    tip = forward_kinematics(EXPLORER, stretched)
    across = np.cross([math.cos(0.2), math.sin(0.2), 0.0], tip.tool_direction)
    across *= 0.15 / np.linalg.norm(across)
    middle = tip.position - 0.03 * np.array([math.cos(0.2), math.sin(0.2), 0.0])
    start = pointing_goal(EXPLORER, middle - across, tip.tool_direction, stretched)
    assert start.reached
    path = line(middle - across, middle + across, tip.rotation, tip.rotation)
    followed = joints_along(EXPLORER, path, start.positions)
    limits = JointLimits(EXPLORER.max_velocity, EXPLORER.max_velocity, EXPLORER.max_effort)
    motion = fastest_timing(EXPLORER, followed.joints, limits, np.array([0.0, 0.0, -1.62]))
    assert np.all(np.abs(motion.states(np.linspace(0, motion.duration, 800))[1]) <= EXPLORER.max_velocity * 1.002)


def test_a_path_out_of_reach_is_refused_with_the_place() -> None:
    tip = forward_kinematics(PUMA, BENT)
    path = line(tip.position, tip.position + np.array([2.0, 0.0, 0.0]), tip.rotation, tip.rotation)
    with pytest.raises(CartesianPathError, match=r"at \d+ % of the path the arm stays"):
        joints_along(PUMA, path, BENT)
