"""Steps: the linear programme against a search over the one free force, and a rocker-bogie against four fixed
wheels.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from sojourn_analysis.vehicle.side_view import side_view
from sojourn_analysis.vehicle.step_climbing import (
    SideView,
    SideWheel,
    climbs,
    failing_wheel,
    highest_step,
    least_friction,
)
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.machine_reader import joined_machine
from sojourn_machine.errors import InvalidValueError

R, BASE, AHEAD, UP = 0.1, 1.0, 0.45, 0.25
CART = SideView(10.0, (AHEAD, UP), (SideWheel(BASE, R, R, False), SideWheel(0.0, R, R, False)))


def friction_by_search(height: float) -> float:
    """Two wheels: three equations, four forces. The friction needed at each position, by a grid over the free one."""
    worst = 0.0
    start = math.asin((R - height) / R)
    for climber in (0, 1):
        for angle in np.linspace(start, math.pi / 2 - 1e-6, 8):
            centre = np.array([-R * math.cos(angle), height + R * math.sin(angle)])
            pitch = math.asin((centre[1] - R) / BASE) if climber == 0 else math.asin((height + R - centre[1]) / BASE)
            along = np.array([math.cos(pitch), math.sin(pitch)])
            front = centre if climber == 0 else centre + BASE * along
            rear = front - BASE * along
            com = rear + AHEAD * along + (UP - R) * np.array([-along[1], along[0]])
            normals = [np.array([0.0, 1.0]), np.array([0.0, 1.0])]
            normals[climber] = np.array([-math.cos(angle), math.sin(angle)])
            columns = []
            for place, n in zip((front, rear), normals, strict=True):
                contact = place - R * n - com
                for direction in (n, np.array([n[1], -n[0]])):
                    columns.append([*direction, contact[0] * direction[1] - contact[1] * direction[0]])
            matrix = np.array(columns).T
            right = np.array([0.0, 10.0, 0.0])
            particular = np.linalg.lstsq(matrix, right, rcond=None)[0]
            free = np.linalg.svd(matrix)[2][-1]
            amounts = np.linspace(-60.0, 60.0, 60001)
            forces = particular[:, None] + free[:, None] * amounts
            good = (forces[0] > 0.0) & (forces[2] > 0.0)
            if angle == start and not good.any():
                continue
            need = np.maximum(np.abs(forces[1] / forces[0]), np.abs(forces[3] / forces[2]))[good].min()
            if angle == start:
                continue  # it may stand on the ground there as well: easier
            worst = max(worst, float(need))
    return worst


@pytest.mark.parametrize("height", [0.03, 0.06])
def test_programme_and_search_agree(height: float) -> None:
    assert least_friction(CART, height, 1.0) == pytest.approx(friction_by_search(height), rel=3e-3)


def test_pushing_up_a_face() -> None:
    """Front wheel on the vertical face, just off the ground: the closed form of a cart with two driven axles."""
    mu = 0.9
    for ahead, expected in ((0.30, True), (0.62, False)):
        # N1 = W a/(mu (l + r) + r) from the moment about the rear contact; the rear has to push with N1 <= mu (W - mu
        # N1)
        push = ahead / (mu * (BASE + R) + R)
        assert (push * (1.0 + mu**2) <= mu) == expected
        cart = replace(CART, centre=(ahead, 0.1))
        assert (failing_wheel(cart, 0.101, mu, 1.0) != 0) == expected


def test_more_friction_climbs_higher() -> None:
    heights = [highest_step(CART, mu, 1.0, highest=0.3) for mu in (0.2, 0.5, 0.8)]
    assert heights[0] < heights[1] < heights[2]
    assert climbs(CART, heights[1] - 0.002, 0.5, 1.0)
    assert not climbs(CART, heights[1] + 0.002, 0.5, 1.0)
    # gravity divides out
    assert highest_step(CART, 0.5, 9.81, highest=0.3) == pytest.approx(heights[1], abs=2e-3)


def test_weak_motors_climb_less() -> None:
    assert highest_step(replace(CART, max_torque=0.2), 0.8, 1.0, 0.3) < highest_step(CART, 0.8, 1.0, 0.3)


def test_explorer_climbs_more_than_its_wheels_radius() -> None:
    rover = joined_machine("explorer")
    machine = StandingMachine(rover.urdf.text, rover.config, 3.73)
    side = side_view(machine)
    assert [wheel.on_bogie for wheel in side.wheels] == [False, True, True]
    assert 2.0 * (side.mass + side.bogie_mass) == pytest.approx(machine.mass)
    step = highest_step(side, 0.8, 3.73, highest=0.5)
    # the same machine with its bogie welded, front and rear wheel alone, is worse
    welded = SideView(
        side.mass + side.bogie_mass, side.centre, (side.wheels[0], replace_bogie(side.wheels[2])), max_torque=math.inf
    )
    assert step > side.wheels[0].radius
    assert step > highest_step(welded, 0.8, 3.73, highest=0.5)


def replace_bogie(wheel: SideWheel) -> SideWheel:
    return wheel._replace(on_bogie=False)


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="height"):
        climbs(CART, 0.0, 0.5, 1.0)
    with pytest.raises(InvalidValueError, match="wheels"):
        climbs(replace(CART, wheels=CART.wheels[:1]), 0.1, 0.5, 1.0)
