"""The plane on which a machine stands, by the joints of its suspension; lines of the tip, checked against it."""

from typing import Any

import numpy as np
import pinocchio
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.collision import refined
from sojourn_flight.arm.ground import GroundUnderWheels, plane_through
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.kinematics import forward_kinematics, inverse_kinematics
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.tasks.start import check_line
from sojourn_machine.errors import InvalidValueError

SCENARIO = load_scenario("flat_drive")
WHEELS = [(wheel.joint, wheel.radius) for wheel in SCENARIO.machine.wheels]
SEED = 7


def test_a_plane_through_points_of_a_known_plane() -> None:
    generator = np.random.default_rng(SEED)
    normal = np.array([0.2, -0.1, 1.0]) / np.linalg.norm([0.2, -0.1, 1.0])
    across = np.linalg.svd(normal[None, :])[2][1:]
    points = -0.4 * normal + generator.normal(size=(6, 2)) @ across
    plane = plane_through(points)
    assert plane is not None
    assert plane.normal == pytest.approx(normal, abs=1e-12) and plane.height == pytest.approx(-0.4, abs=1e-12)
    assert plane_through(points[:2]) is None
    assert plane_through(np.outer(np.arange(4.0), [1.0, 2.0, 0.0])) is None


def test_wheels_on_a_plane_give_it_whatever_the_suspension_does() -> None:
    """Against Pinocchio on a machine that is set down: the points that it gives must be the plane's own."""
    under = GroundUnderWheels(SCENARIO.urdf_xml, WHEELS)
    level = under.plane({})
    assert level is not None
    assert level.normal == pytest.approx((0.0, 0.0, 1.0)) and level.height == pytest.approx(-0.47, abs=1e-3)
    joints = {"rocker_left_joint": 0.1, "rocker_right_joint": 0.1, "bogie_left_joint": 0.05, "bogie_right_joint": 0.05}
    model = pinocchio.buildModelFromXML(SCENARIO.urdf_xml)
    q = pinocchio.neutral(model)
    for name, value in joints.items():
        q[model.joints[model.getJointId(name)].idx_q] = value
    data = model.createData()
    pinocchio.forwardKinematics(model, data, q)
    lowest = np.array([data.oMi[model.getJointId(name)].translation - [0, 0, radius] for name, radius in WHEELS])
    slope, _, _, _ = np.linalg.lstsq(np.c_[lowest[:, :2], np.ones(6)], lowest[:, 2], rcond=None)
    tilted = under.plane(joints)
    assert tilted is not None
    wanted = np.array([-slope[0], -slope[1], 1.0])
    assert tilted.normal == pytest.approx(wanted / np.linalg.norm(wanted), abs=1e-3)
    assert abs(tilted.normal[0]) > 0.01, "the machine pitches on its suspension"


def test_a_wheel_that_is_none_is_named() -> None:
    with pytest.raises(InvalidValueError, match="no_such_joint"):
        GroundUnderWheels(SCENARIO.urdf_xml, [("no_such_joint", 0.1)])


def test_refined_postures_are_near_each_other_and_keep_the_given_ones() -> None:
    given = np.array([[0.0, 0.0], [0.1, -0.25], [0.1, -0.25], [0.0, 0.0]])
    found = refined(given, 0.02)
    assert np.max(np.abs(np.diff(found, axis=0))) <= 0.02 + 1e-12
    for row in given:
        assert np.min(np.max(np.abs(found - row), axis=1)) < 1e-12


def test_a_line_may_bring_the_tool_to_the_ground_but_no_other_link(explorer: Any) -> None:
    """Lowered straight down with the tool level, the wrist and forearm come to the ground: refused with the pair."""
    start = np.array(explorer.params.named_poses["unfold"])
    down = np.array([0.0, 0.0, -1.0])
    tip = forward_kinematics(explorer.model, start)
    ground = GroundPlane(float(tip.position[2]) - 0.02)
    postures = check_line(explorer.params, explorer.model, start, down, 0.06, ground)
    assert forward_kinematics(explorer.model, postures[-1]).position[2] < ground.height

    forward = np.array([1.0, 0.0, 0.0])
    level = inverse_kinematics(explorer.params, explorer.model, np.array([1.3, -0.14, -0.1]), forward, start)
    assert level.status == "solved"
    ground = GroundPlane(-0.2)
    check_line(explorer.params, explorer.model, level.solutions[0], down, 0.12)
    with pytest.raises(GoalRefusedError, match=r"collision of arm_\w+ and ground: .* % of the path"):
        check_line(explorer.params, explorer.model, level.solutions[0], down, 0.12, ground)


def test_a_line_is_checked_between_its_places(explorer: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the joints run far for a short way of the tip, postures in between are looked at as well."""
    seen: list[Any] = []

    def watch(params: Any, model: Any, samples: Any, ground: Any, allow_start: bool) -> None:
        seen.append(samples)

    monkeypatch.setattr("sojourn_flight.arm.tasks.start.check_samples", watch)
    start = np.array(explorer.params.named_poses["unfold"])
    check_line(explorer.params, explorer.model, start, np.array([0.0, 0.0, -1.0]), 0.3)
    assert np.max(np.abs(np.diff(seen[0], axis=0))) <= explorer.params.collision_step + 1e-12
