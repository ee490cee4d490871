"""A late viewer of a whole run in each layout: the machine it is shown, and where the images of its cameras stand."""

from collections.abc import Callable
from itertools import chain
from pathlib import Path
from typing import Any

import pinocchio as pin
import pytest
import rclpy
from programs import PATIENT, Program
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_msgs.msg import String

from sojourn_bags.definitions import typestore
from sojourn_bags.transform_message import transform_message_class
from sojourn_config.paths import config_folder
from sojourn_config.urdf import parse_urdf
from sojourn_contract.types import message_class

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SET = {
    "machine": "explorer_cameras",
    "duration_limit_s": "3600",
    "steps": "[{wait_s: 3600.0}]",
    "sensors.navcam.lens": "{columns: 32, rows: 24, horizontal_view_deg: 45.0}",
    "sensors.navcam.on_demand": "true",
    "drive.visual_odometry": "null",
    "sensors.front": "null",
    "sensors.rear": "null",
    "sensors.belly": "null",
    "sensors.powered_by": "{navcam: cameras, hazcam: cameras}",
}


def linked(message: bytes) -> dict[str, str]:
    """Parents by child."""
    told = typestore().deserialize_cdr(message, "tf2_msgs/msg/TFMessage")
    return {one.child_frame_id: one.header.frame_id for one in told.transforms}  # type: ignore[attr-defined]


@pytest.mark.parametrize("layout", ["--composed", "--processes", "--realtime"])
def test_each_frame_hangs_on_the_tree_and_is_a_link_or_named_in_the_manual(
    layout: str, start: Callable[..., Program], domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(config_folder() / "nodes" / "fastdds.xml"))
    settings = chain.from_iterable(("--set", f"{key}={value}") for key, value in SET.items())
    chosen = [] if layout == "--processes" else [layout]  # processes is what there is without an option
    running = start(
        "start", "flat_drive", *PATIENT, "--domain", domain, *chosen, *settings, "--run-dir", tmp_path / "run"
    )
    context, heard = Context(), dict[str, Any]()
    context.init(args=[], domain_id=domain)
    node = rclpy.create_node("viewer", context=context, enable_rosout=False)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def listen(name: str, kind: Any, quality: QoSProfile | int, raw: bool = False) -> None:
        node.create_subscription(kind, name, lambda said: heard.setdefault(name, said), quality, raw=raw)

    def spin_until(names: set[str]) -> None:
        while not names <= heard.keys():
            assert running.process.poll() is None, running.text
            executor.spin_once(timeout_sec=0.2)

    try:
        listen("navcam/left/image", message_class("sensor_msgs/Image"), qos_profile_sensor_data)
        spin_until({"navcam/left/image"})  # so it is late: the run has gone on for some time
        listen("robot_description", String, LATCHED)
        listen("tf_static", transform_message_class(), LATCHED, raw=True)
        links, moving = dict[str, str](), list[bytes]()
        node.create_subscription(transform_message_class(), "tf", moving.append, 100, raw=True)
        spin_until({"robot_description", "tf_static"})
        urdf = parse_urdf(heard["robot_description"].data, "heard")
        while not {*urdf.links, "odom"} <= links.keys():
            assert running.process.poll() is None, running.text
            executor.spin_once(timeout_sec=0.2)
            links = linked(heard["tf_static"])
            for message in moving:
                links |= linked(message)
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
    model = pin.buildModelFromXML(heard["robot_description"].data)
    assert {link for link in urdf.links if model.existFrame(link)} == set(urdf.links)
    image = heard["navcam/left/image"].header.frame_id
    assert set(links) - set(urdf.links) == {"odom", image}, "but for these all frames are links"
    for frame in (*urdf.links, image):
        above = [frame]
        while above[-1] in links and len(above) < len(links) + 2:
            above.append(links[above[-1]])
        assert above[-1] == "map", f"{frame} hangs on {above[-1]}"
