"""Parts of a machine where its joints put them."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

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
    still, turned = (shape.placements({"wheel_front_left_joint": angle}) for angle in (0.0, 0.7))
    (moved,) = np.flatnonzero(np.abs(still - turned).max(axis=1) > 1e-6)
    assert shape.bodies[moved] == "wheel_front_left_joint"
    half = math.acos(min(abs(float(still[moved, 3:] @ turned[moved, 3:])), 1.0))
    assert 2.0 * half == pytest.approx(0.7, abs=1e-6)


def test_each_part_is_where_the_urdf_puts_it(world: World, shape: MachineShape) -> None:
    """By the way over the link's own frame: another one than over the body to which the part belongs."""
    joints = {"rocker_left_joint": 0.1, "wheel_front_left_joint": 0.7, "arm_elbow_joint": -0.4}
    bodies = shape.placements(joints)
    origins = origins_of_visuals(world.scenario.urdf_xml)
    assert len({part.body for part in shape.parts}) > 6
    for part in shape.parts:
        link, number = part.name.rsplit("_", 1)
        where = shape.link(link, joints)
        assert where is not None
        turn, way = origins[link][int(number)]
        body = bodies[part.body]
        within = Rotation.from_quat(body[[4, 5, 6, 3]])
        assert body[:3] + within.apply(part.place[:3]) == pytest.approx(where[0] + where[1] @ way, abs=1e-9)
        found = (within * Rotation.from_quat(part.place[[4, 5, 6, 3]])).as_matrix()
        assert found == pytest.approx(where[1] @ turn.as_matrix(), abs=1e-9)


def origins_of_visuals(urdf: str) -> dict[str, list[tuple[Rotation, np.ndarray]]]:
    """Of each link where its shapes are in its frame."""
    found: dict[str, list[tuple[Rotation, np.ndarray]]] = {}
    for link in ElementTree.fromstring(urdf).findall("link"):
        for visual in link.findall("visual"):
            origin = visual.find("origin")
            given = {} if origin is None else origin.attrib
            way, turn = (np.array(given.get(name, "0 0 0").split(), dtype=float) for name in ("xyz", "rpy"))
            found.setdefault(link.attrib["name"], []).append((Rotation.from_euler("xyz", turn), way))
    return found


def test_an_unknown_joint_moves_nothing(shape: MachineShape) -> None:
    assert (shape.placements({"no_such_joint": 1.0}) == shape.placements({})).all()


def test_the_ellipse_is_that_of_two_deviations() -> None:
    """Every point of it is two deviations away, by the covariance's own measure."""
    covariance = np.array([[0.09, 0.02], [0.02, 0.04]])
    away = ellipse(np.array([3.0, -1.0]), covariance)[:, :2] - [3.0, -1.0]
    measured = np.einsum("ni,ij,nj->n", away, np.linalg.inv(covariance), away)
    assert measured == pytest.approx(4.0)
