"""scripts/actions beside a running stack, with a client of rclpy's: the two packages of interfaces, which are not among
the wheels, are built for the test.
"""

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import PATIENT, SHORT_RUN, Program, environment

from sojourn_config.ros_environment import ros_variables

HERE = Path(__file__).parent
LONGEST_S = 600.0
can_build = shutil.which("g++") and all(
    header.exists()
    for header in (Path(sysconfig.get_paths()["include"], "Python.h"), Path(sys.prefix, "include/action_msgs"))
)


@pytest.mark.skipif(not can_build, reason="no C++ compiler, or no headers of Python and of the ROS wheels")
def test_goals_of_front_ends_reach_the_machine(
    tmp_path: Path, domain: int, start: Callable[..., Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    types = tmp_path / "types"
    built = subprocess.run(
        [sys.executable, HERE / "interfaces" / "build.py", types], capture_output=True, text=True, check=False
    )
    assert built.returncode == 0, built.stdout + built.stderr
    endless = ("steps=[]", "duration_limit_s=100000.0", "terrain.size_x=80.0")
    values = [word for value in endless for word in ("--set", value)]
    start("start", SHORT_RUN, "--composed", *values, "--domain", domain, "--run-dir", tmp_path / "run", *PATIENT)
    for variable, folder in (("LD_LIBRARY_PATH", "lib"), ("PYTHONPATH", "python")):
        monkeypatch.setenv(variable, str(types / folder), prepend=os.pathsep)
    adapter = start("action_command", "--domain", domain)
    log = tmp_path / "client.log"
    variables = environment(dict(ros_variables(domain)))
    with log.open("wb") as output:
        client = subprocess.Popen(
            [sys.executable, HERE / "action_client.py"], env=variables, stdout=output, stderr=output
        )
    try:
        end = time.monotonic() + LONGEST_S
        while "left alone: accepted" not in log.read_text("utf-8"):
            assert client.poll() is None and time.monotonic() < end, log.read_text("utf-8") + adapter.text
            time.sleep(0.1)
        while adapter.text.count("sent on /goal_pose") < 3:
            assert time.monotonic() < end, adapter.text
            time.sleep(0.1)
        os.kill(adapter.process.pid, signal.SIGINT)
        assert client.wait(LONGEST_S) == 0
    finally:
        client.kill()
        client.wait()
    assert adapter.process.wait(LONGEST_S) == 0
    said = log.read_text("utf-8").splitlines()
    assert [line for line in said if "accepted" not in line] == [
        "elsewhere: rejected",
        "there: status 4, error 0, fed back True",
        "taken back: status 5, error 0, fed back True",
        "moved: status 4, error 0, fed back True",
        "too far: status 6, error -1, fed back False",
        *[line for line in said[-1:] if line.startswith("left alone: status 6, error 9000")],
    ]
    for words in (
        "rejected: /goal_pose.header.frame_id = 'moon'",
        "canceled: stopped by operator",
        "aborted: point 0: arm_azimuth_joint = 9.0000 is out of its limits",
        "aborted: the adapter has ended; the machine goes on",
    ):
        assert words in adapter.text
