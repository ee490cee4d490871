"""The arm cut out of a rover's URDF."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio
import pytest

from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModelError, build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_machine.errors import InvalidValueError


def test_tip_and_efforts_agree_with_the_whole_rover(arm: Any) -> None:
    full = pinocchio.buildModelFromXML(arm.urdf)
    data = full.createData()
    generator = np.random.default_rng(3)
    for _ in range(20):
        posture = arm.random_posture(generator)
        q = pinocchio.neutral(full)
        for name, value in zip(arm.model.joint_names, posture, strict=True):
            q[full.joints[full.getJointId(name)].idx_q] = value
        pinocchio.framesForwardKinematics(full, data, q)
        base = data.oMf[full.getFrameId("base_link")]
        tip = base.actInv(data.oMf[full.getFrameId(arm.params.tip_link)])
        pose = forward_kinematics(arm.model, posture)
        np.testing.assert_allclose(pose.position, tip.translation, atol=1e-12)
        np.testing.assert_allclose(pose.rotation, tip.rotation, atol=1e-12)


def test_only_real_pairs_are_checked(small: Any) -> None:
    pairs = {frozenset(pair) for pair in small.model.pairs}
    assert frozenset(("upper_link", "mast_link")) in pairs
    assert frozenset(("tool_link", "wheel_link")) in pairs
    assert frozenset(("tool_link", "upper_link")) in pairs
    for neighbours in (
        ("shoulder_link", "base_link"),
        ("upper_link", "shoulder_link"),
        ("hand_link", "tool_link"),
    ):
        assert frozenset(neighbours) not in pairs
    assert not any("mast_link" in pair and "base_link" in pair for pair in pairs)


def test_ignored_pairs_are_left_out(small_urdf: str, small_values: dict[str, Any]) -> None:
    params = ArmParams(**{**small_values, "ignored_link_pairs": (("mast_link", "upper_link"),)})
    model = build_arm_model(small_urdf, params)
    assert frozenset(("upper_link", "mast_link")) not in {frozenset(pair) for pair in model.pairs}


def test_locked_positions_move_the_obstacles(small_urdf: str, small_values: dict[str, Any]) -> None:
    level = build_arm_model(small_urdf, ArmParams(**small_values))
    raised = build_arm_model(small_urdf, ArmParams(**{**small_values, "locked_positions": {"rocker_joint": -0.5}}))
    heights = []
    for model in (level, raised):
        shapes = model.geometry_model.geometryObjects
        heights.append(next(s.placement.translation[2] for s in shapes if s.name.startswith("wheel_link")))
    # The wheel is 0.45 ahead of and 0.2 below the rocker's axis; negative about y lifts what is ahead.
    assert heights[0] == pytest.approx(-0.25)
    assert heights[1] == pytest.approx(-0.05 + 0.45 * np.sin(0.5) - 0.2 * np.cos(0.5))


@pytest.mark.parametrize(
    ("spoil", "change", "text"),
    [
        (
            lambda xml: xml,
            {"joint_names": ("nobody", *(f"j{k}" for k in range(4)))},
            "'nobody' is not a joint",
        ),
        (lambda xml: xml, {"tip_link": "finger_link"}, "'finger_link' is not a link"),
        (lambda xml: xml, {"tip_link": "upper_link"}, "not carried by 'tool_joint'"),
        (lambda xml: xml, {"base_link": "hand_link"}, "moves with the arm"),
        (lambda xml: xml, {"ground_contact_links": ("shoe_link",)}, "'shoe_link' is not a link"),
        (
            lambda xml: xml,
            {"locked_positions": {"wheel_joint": 0.1}},
            "'wheel_joint' is not a joint with limits",
        ),
        (lambda xml: xml[:400], {}, "could not be read"),
        (
            lambda xml: xml.replace('<sphere radius="0.12"/>', '<mesh filename="wheel.stl"/>'),
            {},
            "could not be read",
        ),
        (
            lambda xml: xml.replace('"tool_joint" type="revolute"', '"tool_joint" type="continuous"'),
            {},
            "'tool_joint' is continuous",
        ),
    ],
)
def test_what_does_not_fit_the_urdf_is_refused(
    small_urdf: str,
    small_values: dict[str, Any],
    spoil: Callable[[str], str],
    change: dict[str, Any],
    text: str,
) -> None:
    with pytest.raises(ArmModelError, match=text):
        build_arm_model(spoil(small_urdf), ArmParams(**{**small_values, **change}))


def test_joints_out_of_chain_order_are_refused(small_urdf: str, small_values: dict[str, Any]) -> None:
    names = small_values["joint_names"]
    swapped = (names[1], names[0], *names[2:])
    with pytest.raises(ArmModelError, match="order along the chain"):
        build_arm_model(small_urdf, ArmParams(**{**small_values, "joint_names": swapped}))


def test_pose_and_speed_beyond_the_urdf_are_refused(small_urdf: str, small_values: dict[str, Any]) -> None:
    poses = {**small_values["named_poses"], "far": (2.6, 0.0, 0.0, 0.0, 0.0)}
    with pytest.raises(InvalidValueError, match=r"named_poses.far of shoulder_joint = 2.6.*-2.5000 to 2.5000"):
        build_arm_model(small_urdf, ArmParams(**{**small_values, "named_poses": poses}))
    with pytest.raises(InvalidValueError, match="max_velocity of shoulder_joint"):
        build_arm_model(small_urdf, ArmParams(**{**small_values, "max_velocity": (2.1, 0.5, 0.6, 0.8, 0.8)}))
