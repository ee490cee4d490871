"""scripts/new_machine: a folder that is valid, whose numbers are right, and whose machine drives."""

from pathlib import Path

import numpy as np
import pytest

from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.new_machine import KINDS, main
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_config.starter.solids import Box, Cylinder

GRID = np.linspace(-0.5, 0.5, 101)[:-1] + 0.005
"""Middles of a hundred cells of a length of one."""


def made(folder: Path, *options: str, name: str = "mine") -> LoadedScenario:
    assert main([name, "--folder", str(folder), *options]) == 0
    return load_scenario(str(folder / name / "flat.yaml"))


@pytest.mark.parametrize("steer", KINDS)
def test_each_kind_weighs_what_was_asked_for_and_has_strong_enough_drives(steer: str, tmp_path: Path) -> None:
    scenario = made(tmp_path, "--steer", steer, "--mass", "75")
    assert sum(inertial.mass for inertial in scenario.urdf.inertials.values()) == pytest.approx(75.0, rel=1e-6)
    supports = scenario.machine.rolling
    assert len(supports) == (2 if steer == "tracks" else 4)
    load = 75.0 * scenario.gravity / len(supports)
    for drive in scenario.machine.drives:
        if drive.load == "drive":
            stall = drive.motor.max_current * drive.motor.torque_constant * drive.gear.ratio * drive.gear.efficiency
            assert stall > 1.5 * load * supports[0].radius  # it climbs a wall that it leans on with its weight
    wanted = scenario.drive.limits.max_speed / supports[0].radius
    assert all(scenario.urdf.joints[support.joint].velocity > 1.2 * wanted for support in supports)


def test_inertias_are_those_of_the_solids() -> None:
    x, y, z = np.meshgrid(0.3 * GRID, 0.5 * GRID, 0.7 * GRID)
    box = ((y**2 + z**2).mean(), (x**2 + z**2).mean(), (x**2 + y**2).mean())
    assert Box((0.3, 0.5, 0.7)).inertia_per_mass == pytest.approx(box, rel=1e-3)
    x, y, z = np.meshgrid(0.8 * GRID, 0.2 * GRID, 0.8 * GRID)
    inside = x**2 + z**2 <= 0.4**2
    disc = tuple(squares[inside].mean() for squares in (y**2 + z**2, x**2 + z**2, x**2 + y**2))
    assert Cylinder(0.4, 0.2).inertia_per_mass == pytest.approx(disc, rel=5e-3)


def test_springs_carry_what_hangs_on_them_at_zero_pose(tmp_path: Path) -> None:
    scenario = made(tmp_path, "--wheels", "6", "--body", "mars")
    (springs,) = scenario.machine.suspensions
    hanging = sum(scenario.urdf.inertials[link].mass for joint in springs.joints
                  for link in scenario.urdf.below(scenario.urdf.joints[joint].child)
                  if link in scenario.urdf.inertials)  # fmt: skip
    carried = (scenario.machine.mass - hanging) * scenario.gravity
    assert -len(springs.joints) * springs.stiffness * springs.rest == pytest.approx(carried, rel=1e-3)


def test_lengths_that_are_asked_for_are_there_and_sensors_too(tmp_path: Path) -> None:
    sizes = ("--wheelbase", "1.1", "--track", "0.9", "--wheel-radius", "0.2", "--wheel-width", "0.1")
    scenario = made(tmp_path, "--steer", "all", *sizes, "--cameras")
    x, y = np.array([(wheel.x, wheel.y) for wheel in scenario.steering.wheels]).T
    assert (np.ptp(x), np.ptp(y)) == pytest.approx((1.1, 0.9))
    assert {(wheel.radius, wheel.width) for wheel in scenario.machine.wheels} == {(0.2, 0.1)}
    assert {"hazcam", "sun"} <= set(scenario.sensors.sensors)
    assert scenario.drive.obstacles is not None


def test_a_machine_that_does_not_turn_on_the_spot_has_room_for_its_corners(tmp_path: Path) -> None:
    scenario = made(tmp_path, "--steer", "ackermann", "--wheels", "6")
    wheels = scenario.steering.wheels
    inner = min(wheel.y for wheel in wheels), max(abs(wheel.steer_max) for wheel in wheels if wheel.steered)
    radius = np.ptp([wheel.x for wheel in wheels]) / np.tan(inner[1]) - inner[0]
    assert scenario.drive.follower.max_curvature == pytest.approx(0.9 / radius, rel=0.01)
    side = scenario.config.steps[0].action.points[0].x
    assert side > 2.0 / (scenario.drive.follower.planned_curvature * scenario.drive.follower.max_curvature)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["Mine"], "lower-case"),
        (["skid"], "config/machines has one"),
        (["mine", "--wheels", "5"], "allowed with --steer skid is 4, 6, 8, 10"),
        (["mine", "--steer", "tracks", "--wheels", "4"], "has none"),
        (["mine", "--mass", "0.5"], "allowed is 3 to 5000 kg"),
        (["mine", "--wheelbase", "0.2"], "neighbouring wheels would touch, allowed is at least 0.396 m"),
        (["mine", "--track", "0.1"], "no room for a body"),
        (["mine", "--wheel-radius", "0.4", "--track", "0.8", "--wheelbase", "2"], "it would tip over"),
    ],
)
def test_what_no_machine_can_have_is_said_in_words(options: list[str], said: str, tmp_path: Path) -> None:
    with pytest.raises(UsageError) as refusal:
        main([*options, "--folder", str(tmp_path)])
    assert said in str(refusal.value)
    assert not list(tmp_path.iterdir())


def test_nothing_is_overwritten_and_an_unknown_body_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="moon"):
        main(["mine", "--body", "mooon", "--folder", str(tmp_path)])
    made(tmp_path)
    with pytest.raises(UsageError, match="nothing is overwritten"):
        main(["mine", "--folder", str(tmp_path)])
