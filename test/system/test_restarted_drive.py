"""A drive that dies on its way, in real time: its goal is lost in words, and the next one ends where it should."""

import math
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path

from programs import PATIENT, SHORT_RUN, Program

from sojourn_bags.reading import read_bag

GOAL, BEYOND = (0.9, 0.2), (1.2, 0.25)
"""[m], map"""
NEAR = 0.1
"""Goal tolerance of the drive and what it cannot have seen of its way meanwhile [m]."""


def to_go(text: str) -> float:
    """What the goal client said last [m]."""
    found = re.findall(r"([\d.]+) m to go", text)
    return float(found[-1]) if found else math.inf


def lose(process: int, kept: Path) -> None:
    """Kill a drive, and spoil what it has kept."""
    os.kill(process, signal.SIGSTOP)
    kept.write_text(kept.read_text(encoding="utf-8").replace("0", "1"), encoding="utf-8")
    os.kill(process, signal.SIGKILL)


def truth_now(run_dir: Path) -> tuple[float, float, float]:
    """Where the rover is, as far as it is in the bag: x, y [m], yaw [rad]."""
    x, y, z, w = read_bag(run_dir / "bag")["/truth/odom"].columns(
        "pose.pose.position.x", "pose.pose.position.y", "pose.pose.orientation.z", "pose.pose.orientation.w"
    )[-1]
    return x, y, 2.0 * math.atan2(z, w)


def test_a_restarted_drive_knows_where_it_is_and_says_what_happened(
    start: Callable[..., Program], tmp_path: Path, domain: int
) -> None:
    run_dir = tmp_path / "run"
    stack = start(
        "start", SHORT_RUN, *PATIENT, "--realtime", "--set", "steps=[]", "--domain", domain, "--run-dir", run_dir
    )
    goal = start("goal_client", "drive", *GOAL, "--domain", domain)
    goal.wait_until(lambda text: to_go(text) < 0.5, "half of the way")
    os.kill(stack.process_of("drive"), signal.SIGKILL)
    assert goal.wait() == 1
    assert "goal lost: the drive was restarted" in goal.text.splitlines()[-1], goal.text
    again = start("goal_client", "drive", *GOAL, "--domain", domain)
    assert again.wait() == 0, again.text
    assert math.dist(truth_now(run_dir)[:2], GOAL) < NEAR
    lose(stack.process_of("drive"), run_dir / "kept" / "drive.json")
    stack.wait_until(lambda text: len(re.findall(r"^drive .*: running", text, re.MULTILINE)) == 3, "it runs again")
    refused = start("goal_client", "drive", *BEYOND, "--domain", domain)
    assert refused.wait() == 1 and "does not know where it is" in refused.text, refused.text
    here = truth_now(run_dir)
    told = start("goal_client", "here", *here, "--within", 0.02, "--domain", domain)
    assert told.wait() == 0 and told.text.splitlines()[-1] == "done", told.text
    beyond = start("goal_client", "drive", *BEYOND, "--domain", domain)
    assert beyond.wait() == 0, beyond.text
    stack.send(signal.SIGINT)
    stack.wait()
    bag = read_bag(run_dir / "bag")
    x, y = bag["/truth/odom"].columns("pose.pose.position.x", "pose.pose.position.y")[-1]
    assert math.dist((x, y), BEYOND) < NEAR
    alarms = {values.get("alarm", "") for values in bag["/diagnostics"].statuses()}
    assert any(alarm.startswith("the drive was restarted: it goes on from") for alarm in alarms)
