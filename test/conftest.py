"""Settings of every test, made before anything of ROS is imported."""

import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # `domains`, for the fixtures of several folders

# rclpy looks at it once, when the first message class is imported: without it wrong types corrupt in silence.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(Path(__file__).parents[1] / "config" / "nodes" / "fastdds.xml")
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SYSTEM_DEFAULT"
