"""The machines of the bench: the energies of a drive over rough ground balance; platforms have the wheels asked for."""

import pytest

from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import read_machine
from sojourn_physics.plant.state import EnergyAccount
from sojourn_studies.bench_machine import long_drive
from sojourn_studies.wheeled_platform import Chassis, wheeled_platform


def test_energies_of_a_drive_over_rough_ground_balance() -> None:
    """Asked: 1 % over 100 m, which `scripts/bench --only energy` drives; here 2 m, craters, rocks and ruts included."""
    used, seconds = long_drive(2.0)
    assert used.balance_error(EnergyAccount()) < 1e-3
    assert used.electrical > used.friction_heat > used.soil_work > 0.0
    assert used.winding_heat > 0.0
    assert seconds < 60.0


@pytest.mark.parametrize("axles", [2, 3, 4, 10])
def test_platforms_carry_their_weight_on_all_wheels(axles: int) -> None:
    rover = read_machine("explorer", "moon", "lunar_nominal").machine
    places = [0.7 * (0.5 * (axles - 1) - number) for number in range(axles)]
    platform = wheeled_platform(places, rover.wheels[0], rover.drives[:1], chassis=Chassis(56.0 * axles))
    machine = StandingMachine(platform.urdf_xml, platform.machine, 1.6)
    loads = machine.loads(machine.stand(lambda x, y: 0.0)).normal
    assert machine.mass == pytest.approx(axles * (56.0 + 4.0))
    assert loads == pytest.approx([0.5 * 60.0 * 1.6] * (2 * axles))
