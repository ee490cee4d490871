"""scripts/lib/environment.sh: which rclpy our processes take, and what they leave as it was for others."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHOW = '. scripts/lib/environment.sh; printf "ros=%s\\nvenv=%s\\n" "$sojourn_ros" "${sojourn_venv##*/}"; env'


def environment_after(tmp_path: Path, rclpy: bool = False, **variables: str) -> tuple[dict[str, str], str]:
    """The environment once the file was sourced, and what it told the user.

    `rclpy`: whether the python3 of the system can import it.
    """
    python = tmp_path / "bin" / "python3"
    python.parent.mkdir()
    python.write_text(f"#!/bin/sh\nexit {0 if rclpy else 1}\n", encoding="utf-8")
    python.chmod(0o755)
    start = {"PATH": f"{python.parent}:{os.environ['PATH']}", "HOME": str(tmp_path)} | variables
    done = subprocess.run(["bash", "-c", SHOW], cwd=ROOT, env=start, capture_output=True, text=True, check=True)
    return dict(line.split("=", 1) for line in done.stdout.splitlines() if "=" in line), done.stderr


def test_wheels_where_no_ros_is_sourced(tmp_path: Path) -> None:
    after, told = environment_after(tmp_path, PYTHONPATH="/elsewhere", RMW_IMPLEMENTATION="rmw_cyclonedds_cpp")
    assert (after["ros"], after["venv"]) == ("wheels", ".venv")
    assert "PYTHONPATH" not in after
    assert after["RMW_IMPLEMENTATION"] == "rmw_fastrtps_cpp"
    assert told == ""


def test_sourced_jazzy_is_left_alone(tmp_path: Path) -> None:
    sourced = {
        "ROS_DISTRO": "jazzy",
        "AMENT_PREFIX_PATH": "/opt/ros/jazzy",
        "PYTHONPATH": "/opt/ros/jazzy/lib/python3.12/site-packages",
        "LD_LIBRARY_PATH": "/opt/ros/jazzy/lib",
        "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp",
    }
    after, told = environment_after(tmp_path, rclpy=True, **sourced)
    assert after["venv"] == ".venv-ros"
    assert sourced.items() <= after.items()
    assert told == ""


def test_jazzy_that_python_cannot_import(tmp_path: Path) -> None:
    after, told = environment_after(tmp_path, ROS_DISTRO="jazzy", AMENT_PREFIX_PATH="/opt/ros/jazzy")
    assert after["ros"] == "wheels"
    assert "cannot import its rclpy" in told


def test_another_distribution_stays_out_and_is_kept_for_others(tmp_path: Path) -> None:
    wheels_elsewhere = "/a/lib/python3.12/site-packages/ros_rcl.libs"
    sourced = {
        "ROS_DISTRO": "humble",
        "AMENT_PREFIX_PATH": "/ws/install/mine:/opt/ros/humble",
        "PYTHONPATH": "/opt/ros/humble/lib/python3.10/site-packages",
        "LD_LIBRARY_PATH": f"/ws/install/mine/lib:/opt/ros/humble/lib/x86:{wheels_elsewhere}:/opt/cuda/lib",
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
    }
    after, told = environment_after(tmp_path, rclpy=True, **sourced)
    assert after["ros"] == "wheels"
    assert "humble is sourced" in told
    assert not after.keys() & {
        "ROS_DISTRO",
        "AMENT_PREFIX_PATH",
        "PYTHONPATH",
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE",
    }
    assert after["LD_LIBRARY_PATH"] == "/opt/cuda/lib"
    outer = {name: after[f"SOJOURN_OUTER_{name}"] for name in after["SOJOURN_OUTER"].split() if name in sourced}
    assert outer == sourced


def test_inner_call_keeps_what_was_outside(tmp_path: Path) -> None:
    inside = {
        "SOJOURN_OUTER": "LD_LIBRARY_PATH ROS_DISTRO",
        "SOJOURN_OUTER_ROS_DISTRO": "humble",
        "LD_LIBRARY_PATH": "/opt/cuda/lib",
    }
    after, told = environment_after(tmp_path, **inside)
    assert after["SOJOURN_OUTER_ROS_DISTRO"] == "humble"
    assert "SOJOURN_OUTER_LD_LIBRARY_PATH" not in after
    assert told == ""


@pytest.mark.parametrize("ros", ["wheels", "jazzy"])
def test_a_container_that_keeps_no_compiled_modules_is_overruled_and_others_get_it_back(
    tmp_path: Path, ros: str
) -> None:
    """Every process of a run would compile all our modules again, which takes a tenth of its start."""
    sourced = {"ROS_DISTRO": "jazzy", "AMENT_PREFIX_PATH": "/opt/ros/jazzy"} if ros == "jazzy" else {}
    after, _ = environment_after(tmp_path, rclpy=ros == "jazzy", PYTHONDONTWRITEBYTECODE="1", **sourced)
    assert after["venv"] == (".venv-ros" if ros == "jazzy" else ".venv")
    assert "PYTHONDONTWRITEBYTECODE" not in after
    assert "PYTHONDONTWRITEBYTECODE" in after["SOJOURN_OUTER"].split()
    assert after["SOJOURN_OUTER_PYTHONDONTWRITEBYTECODE"] == "1"
