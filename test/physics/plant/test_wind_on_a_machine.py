"""A machine in the wind: energy goes where the account says, and a calm changes nothing."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

Machines = Callable[..., Any]
WIND = "wind={speed: 30, towards_deg: 90, drag_area: 2}"


def test_the_ground_holds_a_parked_machine_against_the_wind(machine: Machines) -> None:
    one = machine("flat_drive", "body=venus", "soil=rigid_rock", "wind={speed: 1, towards_deg: 90, drag_area: 2}")
    seen: list[Any] = []
    end = one.run(2.0, watch=lambda _, output: seen.append(output.contacts[:, 6:9].sum(axis=0)))
    height = one.model.centre_of_mass(end.configuration)[2]
    force = one.model.air.force(height, np.zeros(3))
    assert force[0] > 30.0 and abs(force[1]) < 1e-9
    assert seen[-1][0] == pytest.approx(-force[0], rel=0.02)
    assert np.abs(end.velocity).max() < 1e-3


def test_a_falling_machine_is_slowed_and_the_account_closes(machine: Machines) -> None:
    one = machine("flat_drive", "body=mars", "soil=rigid_rock", WIND)
    first = one.run(0.02, state=one.thrown("z", 0.3, 60.0))
    end = one.run(4.0, state=first)
    fallen = one.weight * float(first.configuration[2] - end.configuration[2])
    lost = first.energy.mechanical - end.energy.mechanical
    # the integrator's own error in free fall, m g^2 t dt / 2, is 5 J of the 20 kJ set free; the air takes 157
    assert lost - end.energy.air_work == pytest.approx(0.0, abs=3e-4 * fallen)
    assert end.energy.air_work > 5e-3 * fallen
    centre = one.model.centre_of_mass(end.configuration) - one.model.centre_of_mass(first.configuration)
    density = one.model.air.density
    assert density == pytest.approx(0.01503, rel=1e-3)
    drift = 0.5 * (0.5 * density * 2.0 * 45.0**2 / one.model.mass) * 4.0**2
    assert 0.3 * drift < centre[0] < 1.5 * drift  # the wind is some 45 m/s there, and less near the ground


def test_a_calm_changes_no_bit(machine: Machines, numbers_of: Any) -> None:
    one, calm = machine("flat_drive", "body=mars"), machine("flat_drive", "body=mars", "battery_soc=0.8")
    assert one.model.air is None
    np.testing.assert_array_equal(numbers_of(one.run(0.4)), numbers_of(calm.run(0.4)))
