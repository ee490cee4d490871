"""Arms that are not ours, against closed forms worked by hand: planar, Stanford, seven joints; and odd URDFs."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from sojourn_analysis.arm.control_loop import ControlTestError, settings_for
from sojourn_config.arms import load_arm
from sojourn_config.errors import ConfigError
from sojourn_flight.arm.dynamics import coriolis_effort, gravity_effort, mass_matrix
from sojourn_flight.arm.inverse import pose_goal, position_goal
from sojourn_flight.arm.inverse_search import POSITION
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.manipulability import manipulability, partial_manipulability
from sojourn_flight.arm.redundancy import better_posture, joint_centring, manipulability_measure
from sojourn_flight.arm.self_collision import SelfCollision
from sojourn_flight.arm.serial_arm import SerialArm

A1, A2, M1, M2, I1, I2, C1, C2 = 1.0, 0.8, 2.0, 1.0, 0.1, 0.05, 0.5, 0.4
"""Planar arm: lengths, masses, inertias about the centres, which lie so far from the joints."""
PLANAR = f"""
name: planar
convention: standard
joints:
  - {{a: {A1}, link: {{mass: {M1}, com: [{C1 - A1}, 0, 0], inertia: [0, 0, {I1}, 0, 0, 0]}}}}
  - {{a: {A2}, link: {{mass: {M2}, com: [{C2 - A2}, 0, 0], inertia: [0, 0, {I2}, 0, 0, 0]}}}}
"""
STANFORD = """
name: stanford
convention: standard
joints:
  - {alpha_deg: -90}
  - {d: 0.154, alpha_deg: 90}
  - {kind: prismatic, lower: 0.2, upper: 1.0, effort: 100}
  - {alpha_deg: -90}
  - {alpha_deg: 90}
  - {d: 0.263}
"""
PANDA = """
name: panda
convention: modified
tool_xyz: [0, 0, 0.107]
joints:
  - {d: 0.333}
  - {alpha_deg: -90}
  - {alpha_deg: 90, d: 0.316}
  - {alpha_deg: 90, a: 0.0825}
  - {alpha_deg: -90, a: -0.0825, d: 0.384}
  - {alpha_deg: 90}
  - {alpha_deg: 90, a: 0.088}
"""


def _table(folder: Path, text: str) -> SerialArm:
    path = folder / "arm.yaml"
    path.write_text(text, encoding="utf-8")
    return load_arm(str(path))


@pytest.mark.parametrize("q", [(0.3, 0.5), (-1.2, 2.0), (2.5, -0.7)])
def test_a_planar_arm_is_that_of_the_textbook(tmp_path: Path, q: tuple[float, float]) -> None:
    """Spong, Hutchinson & Vidyasagar, Robot Modeling and Control, 2006, section 6.4; weight along -y."""
    arm, g, rates = _table(tmp_path, PLANAR), 9.81, np.array([0.7, -1.1])
    (t1, t2), posture = q, np.array(q)
    h = M2 * A1 * C2 * math.sin(t2)
    coupled = M2 * (C2**2 + A1 * C2 * math.cos(t2)) + I2
    first = M1 * C1**2 + M2 * (A1**2 + C2**2 + 2 * A1 * C2 * math.cos(t2)) + I1 + I2
    np.testing.assert_allclose(mass_matrix(arm, posture), [[first, coupled], [coupled, M2 * C2**2 + I2]], atol=1e-12)
    np.testing.assert_allclose(
        coriolis_effort(arm, posture, rates),
        [-h * (2 * rates[0] * rates[1] + rates[1] ** 2), h * rates[0] ** 2],
        atol=1e-12,
    )
    outer = M2 * C2 * g * math.cos(t1 + t2)
    held = gravity_effort(arm, posture, np.array([0.0, -g, 0.0]))
    np.testing.assert_allclose(held, [(M1 * C1 + M2 * A1) * g * math.cos(t1) + outer, outer], atol=1e-12)
    jacobian = forward_kinematics(arm, posture).jacobian
    assert partial_manipulability(arm, jacobian, slice(0, 3)) == pytest.approx(A1 * A2 * abs(math.sin(t2)), abs=1e-12)


def test_stretched_out_a_planar_arm_cannot_translate_everywhere(tmp_path: Path) -> None:
    """Its whole Jacobian keeps rank, for the sum of the joints still turns: the measure of the translation says it."""
    arm = _table(tmp_path, PLANAR)
    jacobian = forward_kinematics(arm, np.zeros(2)).jacobian
    assert manipulability(jacobian) > 0.5
    assert partial_manipulability(arm, jacobian, slice(0, 3)) == pytest.approx(0.0, abs=1e-12)


def test_the_stanford_arm_is_solved_by_its_closed_form(tmp_path: Path) -> None:
    """Paul, Robot Manipulators, 1981, section 2.9: place of the tip less d6 along its axis is (r, z) of d2 and d3."""
    arm = _table(tmp_path, STANFORD)
    generator = np.random.default_rng(5)
    for _ in range(50):
        q = generator.uniform(0.8 * arm.lower, 0.8 * arm.upper)
        q[2] = generator.uniform(0.25, 0.95)
        tip = forward_kinematics(arm, q)
        wrist = tip.position - 0.263 * tip.rotation[:, 2]
        s1, c1, s2, c2 = math.sin(q[0]), math.cos(q[0]), math.sin(q[1]), math.cos(q[1])
        wanted = [c1 * s2 * q[2] - s1 * 0.154, s1 * s2 * q[2] + c1 * 0.154, c2 * q[2]]
        np.testing.assert_allclose(wrist, wanted, atol=1e-12)
        found = pose_goal(arm, tip.position, tip.rotation)
        assert found.reached
        assert found.positions[2] == pytest.approx(math.sqrt(max(wrist @ wrist - 0.154**2, 0.0)), abs=1e-5)


def test_seven_joints_by_the_modified_table(tmp_path: Path) -> None:
    """The ready pose of Franka Emika's arm has its flange at (0.307, 0, 0.59) with this flange's offset."""
    arm = _table(tmp_path, PANDA)
    ready = np.array([0.0, -0.25 * math.pi, 0.0, -0.75 * math.pi, 0.0, 0.5 * math.pi, 0.25 * math.pi])
    tip = forward_kinematics(arm, ready)
    np.testing.assert_allclose(tip.position, [0.3069, 0.0, 0.5903], atol=1e-4)
    centred = better_posture(arm, ready, joint_centring(arm))
    assert joint_centring(arm)(centred) > joint_centring(arm)(ready) + 1e-3
    np.testing.assert_allclose(forward_kinematics(arm, centred).position, tip.position, atol=1e-7)


def test_six_joints_have_some_to_spare_where_only_a_place_is_asked_for() -> None:
    arm = load_arm("puma560")
    found = position_goal(arm, np.array([0.5, 0.2, 0.6]))
    measure = manipulability_measure(arm)
    better = better_posture(arm, found.positions, measure, task=POSITION)
    assert measure(better) > measure(found.positions) + 0.02
    np.testing.assert_allclose(forward_kinematics(arm, better).position, [0.5, 0.2, 0.6], atol=1e-6)


INERTIA = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
TUBE = '<collision><origin xyz="0.25 0 0"/><geometry><box size="0.4 0.05 0.05"/></geometry></collision>'
MESH = '<visual><geometry><mesh filename="package://x/y.stl"/></geometry></visual>'


def _urdf(folder: Path, *joints: str) -> Path:
    path = folder / "arm.urdf"
    body = f'<inertial><mass value="1"/>{INERTIA}</inertial>{MESH}{TUBE}{MESH.replace("visual", "collision")}'
    links = ["base", *(child for text in joints for child in re.findall('child link="([a-z]+)"', text))]
    bodies = "".join(f'<link name="{name}">{body}</link>' for name in links)
    path.write_text(f'<robot name="odd">{bodies}{"".join(joints)}</robot>', encoding="utf-8")
    return path


def _joint(name: str, kind: str, parent: str, child: str, rest: str = "", axis: str = "0 0 1") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="0.5 0 0"/><axis xyz="{axis}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{rest}</joint>'


LIMIT = '<limit lower="-3" upper="3" effort="10" velocity="1"/>'
CHAIN = (
    _joint("a", "continuous", "base", "one"),
    _joint("b", "revolute", "one", "two", LIMIT),
    _joint("c", "revolute", "two", "three", LIMIT.replace("effort", "unknown")),
)


def test_a_gripper_does_not_belong_to_the_arm(tmp_path: Path) -> None:
    """Fingers that mimic each other used to be refused, and without mimic counted as a joint of the arm."""
    slide = '<limit lower="0" upper="0.05" effort="1" velocity="1"/>'
    left = _joint("left", "prismatic", "three", "tip", slide)
    right = _joint("right", "prismatic", "three", "other", '<mimic joint="left"/>' + slide)
    path = _urdf(tmp_path, *CHAIN, left, right)
    arm = load_arm(str(path))
    assert arm.joint_names == ("a", "b", "c") and arm.tip_link == "three"
    assert load_arm(str(path), tip_link="tip").joint_names == ("a", "b", "c", "left")
    assert load_arm(str(path), base_link="one").joint_names == ("b", "c")
    with pytest.raises(ConfigError, match="'right' mimics another"):
        load_arm(str(path), tip_link="other")


def test_limits_that_are_not_given_do_not_limit(tmp_path: Path) -> None:
    """They counted as 0: every effort was too much, and no speed allowed."""
    arm = load_arm(str(_urdf(tmp_path, *CHAIN)))
    assert arm.max_effort.tolist() == [math.inf, 10.0, math.inf]
    assert arm.max_velocity.tolist() == [math.inf, 1.0, 1.0]
    assert arm.upper[0] == pytest.approx(2 * math.pi)
    assert 0.0 < settings_for(arm, np.zeros(3)).bandwidth <= 25.0


def test_an_arm_runs_into_itself(tmp_path: Path) -> None:
    arm = load_arm(str(_urdf(tmp_path, *CHAIN)))
    collisions = SelfCollision(arm)
    assert collisions.pairs == 3 and collisions.at(np.zeros(3)) is None
    folded = np.array([0.0, 2.9, 2.9])
    found = collisions.at(folded)
    assert found is not None and set(found[:2]) == {"one", "three"}
    tip = forward_kinematics(arm, folded)
    free = pose_goal(arm, tip.position, tip.rotation, folded, collisions.text)
    assert free.status == "solved" and collisions.at(free.positions) is None, "folded the other way it is free"
    np.testing.assert_allclose(pose_goal(arm, tip.position, tip.rotation, folded).positions, folded, atol=1e-9)


ODD: dict[str, tuple[tuple[str, ...], str]] = {
    "no axis": ((_joint("a", "revolute", "base", "one", LIMIT, "0 0 0"),), "axis = '0 0 0'"),
    "floating": ((_joint("a", "floating", "base", "one"), *CHAIN[1:]), "'a' is floating: allowed are revolute"),
    "no range": ((_joint("a", "prismatic", "base", "one", LIMIT.replace("-3", "3")),), "limits 3 to 3: allowed"),
    "backward": ((_joint("a", "revolute", "base", "one", LIMIT.replace('-3"', '4"')),), "limits 4 to 3: allowed"),
    "no number": ((_joint("a", "revolute", "base", "one", LIMIT.replace("10", "much")),), "effort = 'much'"),
    "below 0": ((_joint("a", "revolute", "base", "one", LIMIT.replace("10", "-10")),), "effort = -10"),
}


@pytest.mark.parametrize("joints,words", ODD.values(), ids=ODD.keys())
def test_what_is_wrong_in_a_urdf_is_named(tmp_path: Path, joints: tuple[str, ...], words: str) -> None:
    with pytest.raises(ConfigError, match=words.replace("(", r"\(")):
        load_arm(str(_urdf(tmp_path, *joints)))


def test_without_masses_there_is_no_motion_to_compare_laws_on(tmp_path: Path) -> None:
    """The mass matrix could not be inverted, and the program ended with a traceback."""
    with pytest.raises(ControlTestError, match=r"no inertia is moved by joint_1, .* a motion needs masses"):
        settings_for(_table(tmp_path, PANDA), np.zeros(7))


def test_a_sliding_joint_needs_its_range(tmp_path: Path) -> None:
    broken = STANFORD.replace("lower: 0.2, upper: 1.0, ", "")
    with pytest.raises(ConfigError, match="a joint that slides needs both"):
        _table(tmp_path, broken)
