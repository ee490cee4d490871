"""Ground, motors, bus and computer act on one another in one run: what a bag shows of it.

Soft soil takes torque, torque takes current, current pulls down the bus, the low bus limits the drive, and the rover is
slower. The arm keeps within the power that it is given: it moves slower, or says that it cannot.
"""

from pathlib import Path

import numpy as np
import pytest

from sojourn_bags.reading import Bag, read_bag
from sojourn_machine.params import FloatArray
from sojourn_stack import run as direct
from sojourn_stack.run import Result

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
ROCK_TO_SAND = (
    "body=mars",
    "terrain={kind: flat, size_x: 20.0, size_y: 20.0, resolution: 0.1, "
    "soil_patches: [{soil: rigid_rock, x: -1.5, y: 0.0, length: 4.0, width: 4.0}]}",
    "soil=dry_sand",
    "soil.k_phi=3e5",  # looser than the file's: the wheels stand deep in it, and not so deep that they do not turn
    "steps=[{drive_to: {x: 3.0, y: 0.0}, timeout_s: 200.0}]",
)
WEAK = ("battery_soc=0.19", "battery.temperature_surroundings=238.15")
WHEELS = tuple(f"wheel_{where}_{side}_joint" for where in ("front", "middle", "rear") for side in ("left", "right"))


def run(folder: Path, *overrides: str) -> tuple[Bag, Result]:
    result = direct.run(direct.RunSpec("flat_drive", ROLES, overrides, bag=folder))
    return read_bag(folder), result


def mean_over(bag: Bag, topic: str, values: FloatArray, spans: tuple[tuple[float, float], ...]) -> list[float]:
    """Of values on a topic, while base_link is in each of these spans of x [m]."""
    odometry = bag["/truth/odom"]
    x = np.interp(bag[topic].times, odometry.times, odometry.column("pose.pose.position.x"))
    return [float(values[(x > low) & (x < high)].mean()) for low, high in spans]


@pytest.fixture(scope="module")
def weak(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    bag, result = run(tmp_path_factory.mktemp("weak") / "bag", *ROCK_TO_SAND, *WEAK)
    assert [step.good for step in result.steps] == [True]
    return bag


@pytest.fixture(scope="module")
def strong(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    bag, result = run(tmp_path_factory.mktemp("strong") / "bag", *ROCK_TO_SAND, "battery_soc=0.9")
    assert [step.good for step in result.steps] == [True]
    return bag


ON_ROCK, IN_SAND = (-0.8, -0.4), (1.8, 2.6)


def test_soft_soil_pulls_down_the_bus_and_the_drive_is_limited_and_slower(weak: Bag, strong: Bag) -> None:
    spans = (ON_ROCK, IN_SAND)
    joints = weak["/truth/joint_states"].joints()
    efforts = np.abs(joints.effort[:, [joints.index(wheel) for wheel in WHEELS]]).sum(axis=1)
    rock, sand = mean_over(weak, "/truth/joint_states", efforts, spans)
    assert sand > 1.3 * rock, "torque"
    rock, sand = mean_over(weak, "/truth/electrical", -weak["/truth/electrical"].column("current"), spans)
    assert sand > 1.1 * rock, "current"
    rock, sand = mean_over(weak, "/truth/electrical", weak["/truth/electrical"].column("voltage"), spans)
    assert sand < rock - 0.2, "bus"
    limits = np.array([float(status["drive_fraction"]) for status in weak["/power/status"].statuses()])
    rock, sand = mean_over(weak, "/power/status", limits, spans)
    assert sand < 0.95 < rock + 0.05, "limit"
    speeds = [
        mean_over(bag, "/truth/odom", bag["/truth/odom"].column("twist.twist.linear.x"), spans)
        for bag in (weak, strong)
    ]
    assert speeds[0][0] == pytest.approx(speeds[1][0], rel=0.01), "on rock both are as fast as they are told to be"
    assert speeds[0][1] < 0.97 * speeds[1][1], "in sand the weak battery makes the rover slower"


def test_a_strong_battery_limits_nothing_in_the_same_sand(strong: Bag) -> None:
    assert {status["drive_fraction"] for status in strong["/power/status"].statuses()} == {"1.000"}


def test_the_arm_keeps_within_its_power_slower_or_says_that_it_cannot(tmp_path: Path) -> None:
    unfold = "steps=[{arm_task: {name: unfold}, timeout_s: 300.0}]"
    took, most = {}, {}
    for watts in (40.0, 14.0):
        bag, result = run(tmp_path / f"{watts:.0f}", unfold, f"power_manager.load_limits.arm={watts}")
        assert [step.good for step in result.steps] == [True]
        took[watts] = float(bag["/clock"].times[-1])
        most[watts] = max(float(status["power arm"]) for status in bag["/truth/loads"].statuses())
    assert took[14.0] > 1.08 * took[40.0]
    assert most[14.0] <= 14.0 + 1e-6 and most[40.0] <= 40.0 + 1e-6
    _, result = run(tmp_path / "12", unfold, "power_manager.load_limits.arm=12")
    assert [step.good for step in result.steps] == [False]
    assert "however slowly it moves" in result.steps[0].reason
