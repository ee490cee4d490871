"""Omni-directional and Mecanum wheels: free direction, kinematic matrix, forces."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from mecanum import kinematic_matrix
from sojourn_analysis.wheels.examples import ROVER_SIZE, example_row
from sojourn_machine.params import FloatArray
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.contact_law import ContactModel
from sojourn_physics.contact.roller_wheel import RollerColumn
from sojourn_physics.contact.rows import kernel_rows
from sojourn_physics.soil.params import SoilColumn

Maker = Callable[..., Any]
RADIUS = 0.125
DEPTH = 5e-4
# x ahead, y left; the rollers of the four wheels, seen from above, form an X
PLACES = [(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)]
ANGLES = [math.radians(angle) for angle in (-45.0, 45.0, 45.0, -45.0)]


def roller(angle_deg: float, friction: float = 0.01) -> FloatArray:
    contact = {"model": "roller_wheel", "roller_angle_deg": angle_deg, "roller_friction": friction}
    wheel = WheelParams.model_validate({"name": "a", "joint": "b", **ROVER_SIZE, "contact": contact})
    return kernel_rows([wheel], [], 1.62)[0]


def test_the_matrix_of_four_mecanum_wheels_is_the_known_one() -> None:
    """r omega = v_x -+ v_y -+ (l_x + l_y) yaw rate (Muir & Neuman 1987)."""
    reach = 0.4 + 0.3
    expected = np.array([[1, -1, -reach], [1, 1, reach], [1, 1, -reach], [1, -1, reach]]) / RADIUS
    assert np.allclose(kinematic_matrix(PLACES, ANGLES, RADIUS), expected)


@pytest.mark.parametrize("twist", [(0.2, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.5), (0.15, -0.1, 0.3)])
def test_wheels_at_the_rates_of_the_matrix_push_with_nothing_but_their_bearings(
    law: Maker, twist: tuple[float, float, float]
) -> None:
    rates = kinematic_matrix(PLACES, ANGLES, RADIUS) @ np.array(twist)
    for (x, y), angle, rate in zip(PLACES, ANGLES, rates, strict=True):
        one = law(roller(math.degrees(angle)), "rigid_rock")
        fresh = one.step(penetration=DEPTH)
        one.state[:] = 0.0
        rim = rate * RADIUS * RADIUS / (RADIUS - fresh["deflection"] / 3.0)
        found = one.step(
            3000, penetration=DEPTH, v_along=twist[0] - twist[2] * y, v_side=twist[1] + twist[2] * x, rim_speed=rim
        )
        assert math.hypot(found["force_x"], found["force_y"]) <= 0.0101 * found["force_z"]


def test_an_omni_wheel_is_free_to_the_side_and_grips_along(law: Maker) -> None:
    one = law(roller(90.0), "rigid_rock")
    aside = one.step(3000, penetration=DEPTH, v_side=0.2)
    assert aside["force_y"] == pytest.approx(-0.01 * aside["force_z"], rel=1e-3)
    one.state[:] = 0.0
    locked = one.step(3000, penetration=DEPTH, v_along=0.2)
    assert locked["force_x"] == pytest.approx(-one.soil[SoilColumn.TAN_PHI] * locked["force_z"], rel=1e-3)


def test_a_mecanum_wheel_pushes_along_its_rollers_axis(law: Maker) -> None:
    one = law(roller(45.0, 0.0), "rigid_rock")
    spinning = one.step(3000, penetration=DEPTH, rim_speed=0.5)
    friction = one.soil[SoilColumn.TAN_PHI] * spinning["force_z"]
    assert spinning["force_x"] == pytest.approx(friction * math.sqrt(0.5), rel=1e-3)
    assert spinning["force_y"] == pytest.approx(friction * math.sqrt(0.5), rel=1e-3)


def test_rollers_along_the_axle_are_refused() -> None:
    with pytest.raises(ValidationError, match=r"roller_angle_deg.*5 to 90 degrees"):
        roller(2.0)


def test_the_row_holds_the_direction_of_the_axis() -> None:
    row = example_row(ContactModel.ROLLER_WHEEL)
    assert row[RollerColumn.SIN_ANGLE] == pytest.approx(math.sqrt(0.5))
    assert row[RollerColumn.COS_ANGLE] == pytest.approx(math.sqrt(0.5))
