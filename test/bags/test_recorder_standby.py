"""A recorder that waits has read what it will need, so that its beginning waits for no library."""

import os
import subprocess
import sys
from pathlib import Path

CODE = """
import sys
import rclpy
from sojourn_bags import standby
from sojourn_bags.recorder_node import RecorderNode
from sojourn_config.scenario import load_scenario

loaded = load_scenario("flat_drive", [])
standby.read_ahead(loaded)
before = set(sys.modules)
rclpy.init(args=[])
given = {"participants": ["plant", "recorder"], "scenario": "flat_drive", "bag": sys.argv[1], "lockstep": False}
node = RecorderNode(loaded=loaded, overrides=given)
new = [name for name in sys.modules if name not in before]
print(*(name for name in new if name.startswith(("rosbags.typesys", "rosidl", "sojourn"))))
node.destroy_node()
"""


def test_it_begins_without_reading_a_library(tmp_path: Path, domain: int) -> None:
    told = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    command = [sys.executable, "-c", CODE, f"{tmp_path}/bag"]
    said = subprocess.run(command, env=told, capture_output=True, text=True, check=True, timeout=300)
    assert said.stdout.split() == []
