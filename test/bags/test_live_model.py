"""The machine as viewers hear of it while it runs: its URDF, its links, where it stands."""

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import rclpy
from fake_stack import PERIOD, FakePlant, build, run
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from sojourn_bags import transform_message
from sojourn_bags.definitions import type_hash, typestore
from sojourn_bags.errors import TransformTypeError
from sojourn_bags.link_frames import LinkFrames
from sojourn_bags.live_model import EVERY
from sojourn_bags.transform_message import transform_message_class
from sojourn_config.scenario import load_scenario
from sojourn_config.urdf import parse_urdf
from sojourn_physics.imaging.camera import LINK_TO_OPTICAL

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SLIDER = """<robot name="slider"><link name="base_link"/><link name="rail"/><link name="tool"/><link name="tip"/>
<joint name="turn" type="continuous"><parent link="base_link"/><child link="rail"/>
  <origin xyz="0.1 -0.2 0.3" rpy="0.3 -1.2 2.9"/><axis xyz="0.6 0 0.8"/></joint>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="tool"/>
  <origin xyz="0 0 1" rpy="-0.4 0 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
<joint name="held" type="fixed"><parent link="tool"/><child link="tip"/><origin xyz="1 2 3" rpy="3.1 0 0.5"/></joint>
</robot>"""


def frames(data: bytes) -> dict[str, tuple[str, int, np.ndarray]]:
    """By child: parent, stamp [ns] and homogeneous transform."""
    found = {}
    for link in typestore().deserialize_cdr(data, "tf2_msgs/msg/TFMessage").transforms:  # type: ignore[attr-defined]
        move, turn = link.transform.translation, link.transform.rotation
        place = pin.XYZQUATToSE3(np.array([move.x, move.y, move.z, turn.x, turn.y, turn.z, turn.w])).homogeneous
        stamp = link.header.stamp.sec * 10**9 + link.header.stamp.nanosec
        found[link.child_frame_id] = link.header.frame_id, stamp, place
    return found


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(["slider", "lunar_sample", "flat_drive"]), st.integers(0, 1000))
def test_links_stand_where_pinocchio_has_them(name: str, seed: int) -> None:
    urdf = parse_urdf(SLIDER, name) if name == "slider" else load_scenario(name).urdf
    model = pin.buildModelFromXML(urdf.text)
    data, random = model.createData(), np.random.default_rng(seed)
    positions = {joint: random.uniform(-1.0, 1.0) for joint in urdf.moving_joints}
    q = pin.neutral(model)
    for joint, position in positions.items():
        entry = model.joints[model.getJointId(joint)]
        at = slice(entry.idx_q, entry.idx_q + entry.nq)
        q[at] = position if entry.nq == 1 else (np.cos(position), np.sin(position))
    pin.framesForwardKinematics(model, data, q)
    links = LinkFrames(urdf)
    told = frames(links.fixed()) | frames(links.moving(20, positions))
    assert {urdf.root, *told} == set(urdf.links)
    for child, (parent, _, place) in told.items():
        above, below = (data.oMf[model.getFrameId(link)].homogeneous for link in (parent, child))
        np.testing.assert_allclose(above @ place, below, atol=1e-12)


def test_an_image_lies_as_rep_103_has_it_on_the_link_of_its_camera() -> None:
    """Its z along the link's x, its x to the right, its y down; one frame however many cameras there are on a link."""
    told = frames(LinkFrames(parse_urdf(SLIDER, "slider"), [("tool", "tool_optical")] * 2).fixed())
    parent, _, place = told["tool_optical"]
    assert parent == "tool" and len(told) == 2
    np.testing.assert_allclose(place[:3, :3], LINK_TO_OPTICAL, atol=1e-12)
    assert not place[:3, 3].any()


def test_a_joint_that_is_not_told_stands_at_zero() -> None:
    links = LinkFrames(parse_urdf(SLIDER, "slider"))
    assert links.moving(20, {}) == links.moving(20, {"turn": 0.0, "slide": 0.0, "other": 3.0})


def test_the_type_is_that_of_the_package_for_everybody_else(ros: None) -> None:
    node, kind = rclpy.create_node("speaker"), transform_message_class()
    publisher, heard = node.create_publisher(kind, "tf", LATCHED), list[bytes]()
    node.create_subscription(kind, "tf", heard.append, LATCHED, raw=True)
    said = LinkFrames(parse_urdf(SLIDER, "slider")).fixed()
    publisher.publish(said)
    while not heard:
        rclpy.spin_once(node, timeout_sec=1.0)
    assert frames(heard[0]).keys() == {"tip"}
    (told,) = node.get_publishers_info_by_topic("/tf")
    assert told.topic_type == "tf2_msgs/msg/TFMessage"
    assert str(told.topic_type_hash) == type_hash("tf2_msgs/msg/TFMessage")
    node.destroy_node()


def test_a_library_of_another_layout_is_told_and_nothing_is_made_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    class Odd:
        _support = transform_message._support_of("std_msgs/Header")

    monkeypatch.setattr(transform_message, "_support_of", lambda _: Odd._support)
    with pytest.raises(TransformTypeError, match="cannot be made here: callbacks of another layout"):
        transform_message._made()


def test_who_listens_hears_the_machine_and_the_run_is_the_same(tmp_path: Path, ros: None) -> None:
    nodes = build(tmp_path / "run", 60)
    plant: Any = nodes[0]
    assert isinstance(plant, FakePlant)
    moving, fixed, described = list[bytes](), list[bytes](), list[String]()
    plant.create_subscription(transform_message_class(), "tf", moving.append, 100, raw=True)

    def come_late(period: int) -> None:
        if period == 30:
            plant.create_subscription(transform_message_class(), "tf_static", fixed.append, LATCHED, raw=True)
            plant.create_subscription(String, "robot_description", described.append, LATCHED)

    plant.before_period = come_late
    assert run(nodes) == 0
    (robot,), (still,) = described, fixed
    urdf = parse_urdf(robot.data, "heard")
    assert set(frames(still)) == {joint.child for joint in urdf.joints.values() if joint.kind == "fixed"}
    said = [frames(data) for data in moving]
    poses = [told for told in said if "base_link" in told]
    links = [told for told in said if "base_link" not in told]
    assert len(poses) == len(links) and len(links) > 15
    stamps = [told["base_link"][1] for told in poses]
    assert stamps == sorted(stamps) and all(stamp % (EVERY * PERIOD) == 0 for stamp in stamps)
    last = poses[-1]
    assert (last["odom"][0], last["base_link"][0]) == ("map", "odom")
    place = last["odom"][2] @ last["base_link"][2]
    assert place[0, 3] == pytest.approx(0.1 * stamps[-1] * 1e-9), "where the truth has it"


def test_without_tf2_the_urdf_is_told_all_the_same(
    tmp_path: Path, ros: None, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def missing() -> Any:
        raise TransformTypeError("members of another layout")

    monkeypatch.setattr("sojourn_bags.live_model.transform_message_class", missing)
    nodes = build(tmp_path / "run", 10)
    described = list[String]()
    nodes[0].create_subscription(String, "robot_description", described.append, LATCHED)
    assert run(nodes) == 0 and described[0].data.startswith("<")
    assert "no /tf and /tf_static: tf2_msgs is not installed" in capfd.readouterr().err
