"""Wheel loads by the work of lifting each wheel, by springs under a plate, and by the balance on slopes."""

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml

from sojourn_analysis.vehicle.differential import bar_right_angle, chassis_error
from sojourn_analysis.vehicle.wheel_loads import StandingMachine, least_energy_forces
from sojourn_config.machine_reader import joined_machine
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import DifferentialBarParams

ROOT = Path(__file__).resolve().parents[3]
WEIGHT = 180.0 * 3.73


@pytest.fixture(scope="module")
def explorer() -> StandingMachine:
    machine = joined_machine("explorer")
    return StandingMachine(machine.urdf.text, machine.config, 3.73)


def energy(machine: StandingMachine, ground: object) -> float:
    stance = machine.stand(ground)
    return float(pin.computePotentialEnergy(machine.model, machine.data, stance.configuration))


def test_a_rocker_bogie_loads_its_wheels_alike(explorer: StandingMachine) -> None:
    arm = yaml.safe_load((ROOT / "config/arms/explorer_arm.yaml").read_text("utf-8"))
    stowed = dict(zip(arm["joint_names"], arm["named_poses"]["stow"], strict=True))
    stance = explorer.stand(lambda x, y: 0.0, angles=stowed)
    loads = explorer.loads(stance)
    assert np.abs(stance.gaps).max() < 1e-9
    assert loads.normal.sum() == pytest.approx(explorer.mass * 3.73)
    assert loads.normal == pytest.approx(np.full(6, WEIGHT / 6.0), rel=0.03)
    assert loads.tangential == pytest.approx(np.zeros(6), abs=1e-4)


@pytest.mark.parametrize("wheel", [0, 2, 5])
def test_a_load_is_the_work_of_lifting_the_ground(explorer: StandingMachine, wheel: int) -> None:
    """dV/dh of the potential energy of the whole machine, the ground rising under one wheel alone."""
    stance = explorer.stand(lambda x, y: 0.0)
    load = explorer.loads(stance).normal[wheel]
    x, y, _ = stance.contacts[wheel]

    def block(height: float):  # a block under this wheel
        return lambda u, v: height if math.hypot(u - x, v - y) < 0.1 else 0.0

    rise = 1e-3
    work = (energy(explorer, block(rise)) - energy(explorer, block(-rise))) / (2.0 * rise)
    assert work == pytest.approx(load, rel=1e-4)


def test_a_block_changes_the_loads_little(explorer: StandingMachine) -> None:
    flat = explorer.stand(lambda x, y: 0.0)
    x, y, _ = flat.contacts[0]
    stance = explorer.stand(lambda u, v: 0.10 if math.hypot(u - x, v - y) < 0.12 else 0.0)
    assert np.abs(stance.gaps).max() < 1e-6
    assert np.abs(explorer.loads(stance).normal / (WEIGHT / 6.0) - 1.0).max() < 0.35
    # the differential holds: the rockers turn against one another
    rockers = [explorer.model.getJointId(f"rocker_{side}_joint") for side in ("left", "right")]
    left, right = (stance.configuration[explorer.model.joints[joint].idx_q] for joint in rockers)
    assert left == pytest.approx(-right) and abs(left) > 0.02


@pytest.mark.parametrize("slope", [(0.3, 0.0), (0.0, 0.4), (-0.2, 0.25)])
def test_forces_on_a_slope_hold_the_weight(explorer: StandingMachine, slope: tuple[float, float]) -> None:
    stance = explorer.stand(lambda x, y: slope[0] * x + slope[1] * y)
    loads = explorer.loads(stance)
    assert loads.forces.sum(axis=0) == pytest.approx([0.0, 0.0, explorer.mass * 3.73], abs=1e-6)
    arms = stance.contacts - explorer.centre_of_mass(stance.configuration)
    assert np.cross(arms, loads.forces).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-6)
    uphill = stance.contacts @ np.array([*slope, 0.0])
    assert loads.normal[uphill.argmin()] > loads.normal[uphill.argmax()]


def test_it_falls_over_where_it_must(explorer: StandingMachine) -> None:
    with pytest.raises(InvalidValueError, match="hold the machine"):
        explorer.loads(explorer.stand(lambda x, y: 1.6 * y))


def plate(places: np.ndarray) -> np.ndarray:
    """Equilibrium of a rigid body: rows force and moment, columns three forces a contact."""
    columns = []
    for x, y in places:
        for axis in np.eye(3):
            columns.append(np.concatenate([axis, np.cross([x, y, 0.0], axis)]))
    return np.array(columns).T


def test_four_legs_are_a_plate_on_springs() -> None:
    places = np.array([[1.0, 0.5], [1.0, -0.5], [-1.2, 0.5], [-1.2, -0.5]])
    matrix = plate(places)
    rates = np.array([1e4, 2e4, 1.5e4, 1e4])
    gap = np.array([0.002, 0.0, 0.0, 0.001])
    right = np.array([0.0, 0.0, 900.0, 0.0, 0.0, 0.0])
    stiffness = np.repeat(rates, 3)
    gaps = np.zeros(12)
    gaps[2::3] = gap
    found = least_energy_forces(matrix, right, stiffness, gaps).reshape(4, 3)
    # the plate sinks by p + q x + r y; every spring is pressed by that less its gap
    pressed = found[:, 2] / rates + gap
    plane, *_ = np.linalg.lstsq(np.column_stack([np.ones(4), places]), pressed, rcond=None)
    assert np.column_stack([np.ones(4), places]) @ plane == pytest.approx(pressed, abs=1e-12)
    assert found[:, 2].sum() == pytest.approx(900.0)
    assert found[:, 2] @ places == pytest.approx([0.0, 0.0], abs=1e-8)


def test_a_short_leg_hangs() -> None:
    places = np.array([[1.0, 0.5], [1.0, -0.5], [-1.0, 0.5], [-1.0, -0.5]])
    gaps = np.zeros(12)
    gaps[2] = 1.0
    found = least_energy_forces(plate(places), np.array([0, 0, 900.0, 0, 90.0, 0.0]), np.full(12, 1e4), gaps)
    assert found[2] == 0.0
    assert found[[5, 8, 11]].min() >= 0.0 and found[2::3].sum() == pytest.approx(900.0)


def test_differential_bar() -> None:
    bar = DifferentialBarParams(half_length=0.25, arm=0.2, bar_height=0.2, link=0.3)
    angle = 0.01
    assert bar_right_angle(bar, angle) == pytest.approx(-angle, rel=2e-2)
    assert bar_right_angle(bar, bar_right_angle(bar, 0.3)) == pytest.approx(0.3)
    assert abs(chassis_error(bar, 0.3)) < 0.05 * 0.3
    assert chassis_error(bar, 0.3) == pytest.approx(chassis_error(bar, bar_right_angle(bar, 0.3)))
    # links that are level at rest: the error begins with the fourth power of the angle, without that with the second
    assert chassis_error(bar, 0.2) / chassis_error(bar, 0.1) == pytest.approx(16.0, rel=0.1)
    tilted = bar.model_copy(update={"bar_height": 0.1})
    assert chassis_error(tilted, 0.04) / chassis_error(tilted, 0.02) == pytest.approx(4.0, rel=0.1)
    with pytest.raises(InvalidValueError, match="reaches"):
        bar_right_angle(bar, 1.5)
    with pytest.raises(ValueError, match=r"link = 0\.1"):
        DifferentialBarParams(half_length=0.25, arm=0.2, bar_height=0.05, link=0.1)
