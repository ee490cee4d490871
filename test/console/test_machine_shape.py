"""Parts of a machine where its joints put them."""

import math

import numpy as np
import pytest

from sojourn_console.machine_shape import MachineShape
from sojourn_console.views.way_view import ellipse
from sojourn_console.world import World
from sojourn_machine.mounting import mounting


@pytest.fixture(scope="module")
def shape(world: World) -> MachineShape:
    return MachineShape(world.scenario.urdf_xml)


def test_links_are_where_the_urdf_mounts_them(world: World, shape: MachineShape) -> None:
    for link in ("hazcam_link", "imu_link"):
        rotation, position = mounting(world.scenario.urdf_xml, link)
        found = shape.link(link, {})
        assert found is not None
        assert found[0] == pytest.approx(position) and found[1] == pytest.approx(rotation)
    assert shape.link("no_such_link", {}) is None


def test_a_wheel_turns_by_the_angle_of_its_joint(shape: MachineShape) -> None:
    still, turned = (shape.placements({"wheel_front_left_joint": angle})[1] for angle in (0.0, 0.7))
    moved = np.flatnonzero(np.abs(still - turned).max(axis=1) > 1e-6)
    assert len(moved) and all(shape.parts[number].name.startswith("wheel_front_left") for number in moved)
    for number in moved:
        half = math.acos(min(abs(float(still[number] @ turned[number])), 1.0))
        assert 2.0 * half == pytest.approx(0.7, abs=1e-6)


def test_an_unknown_joint_moves_nothing(shape: MachineShape) -> None:
    assert (shape.placements({"no_such_joint": 1.0})[0] == shape.placements({})[0]).all()


def test_the_ellipse_is_that_of_two_deviations() -> None:
    """Every point of it is two deviations away, by the covariance's own measure."""
    covariance = np.array([[0.09, 0.02], [0.02, 0.04]])
    away = ellipse(np.array([3.0, -1.0]), covariance)[:, :2] - [3.0, -1.0]
    measured = np.einsum("ni,ij,nj->n", away, np.linalg.inv(covariance), away)
    assert measured == pytest.approx(4.0)
