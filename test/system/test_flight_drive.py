"""The example flight node in the place of our drive: in lock-step and in real time."""

import ast
import math
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from flight_drive import PERIOD, STEER_RATE, STEERED, Controller
from programs import PATIENT, SHORT_RUN, Program
from verdicts import faults_of_nodes

from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import read_bag

FLIGHT_DRIVE = Path(__file__).parent / "flight_drive.py"
COMMAND = f"{sys.executable} {FLIGHT_DRIVE}"
NEAR_M, NEAR_RAD = 0.1, 0.12


def test_it_knows_nothing_of_our_packages() -> None:
    tree = ast.parse(FLIGHT_DRIVE.read_text(encoding="utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert "rclpy" in imported
    assert not [name for name in imported if name.startswith("sojourn")]


def test_it_steers_on_from_where_it_was_after_a_silence() -> None:
    """A host that gave it no core for a second would make the joints leap after what it did not say."""
    drive = Controller(0.0, 0.0, 0.0)
    drive.command((0.0, 0.0, 0.1), dict.fromkeys(STEERED, 0.0), 0.5)
    assert all(0.0 < abs(drive.steer[name]) <= STEER_RATE * PERIOD * 1e-9 for name in STEERED)


@pytest.mark.parametrize(
    ("mode", "x", "y", "yaw"),
    [([], 0.3, 0.15, 0.9), (["--realtime"], 0.15, 0.03, 0.3)],
    ids=["lock-step", "real time"],
)
def test_it_drives_the_rover(
    mode: list[str], x: float, y: float, yaw: float, tmp_path: Path, start: Callable[..., Program], domain: int
) -> None:
    """It turns on the spot, drives an arc, and turns to the heading that the goal asks for."""
    run = tmp_path / "run"
    steps = f"steps=[{{drive_to: {{x: {x}, y: {y}, yaw: {yaw}}}, timeout_s: 60}}]"
    options = [*PATIENT, *mode, "--set", steps, "--replace", f"drive={COMMAND}", "--domain", domain]
    replaced = start("start", SHORT_RUN, *options, "--run-dir", run)
    assert replaced.wait() == 0, replaced.text
    assert not replaced.processes()
    assert "does not stop" not in replaced.text
    bag = read_bag(run)
    report, _ = judge_bag(bag)
    # when a message comes in real time is a matter of the host, which may be busy
    assert not (faults_of_nodes(report.as_data()) if mode else report.violations), list(report.lines())
    paths = ("position.x", "position.y", "orientation.z", "orientation.w")
    x_end, y_end, qz, qw = bag["/truth/odom"].columns(*(f"pose.pose.{path}" for path in paths))[-1]
    assert math.dist((x_end, y_end), (x, y)) < NEAR_M
    assert abs(2.0 * math.atan2(qz, qw) - yaw) < NEAR_RAD
    assert bag["/drive/status"].statuses()[-1]["state"] == "reached"
