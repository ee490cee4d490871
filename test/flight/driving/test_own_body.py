"""Points on the machine itself are no ground: by boxes, cylinders and balls, and by the joints as they are measured."""

import numpy as np
import pinocchio as pin
import pytest

from sojourn_config.machine_reader import joined_machine
from sojourn_flight.hazards.own_body import OwnBody, on_shapes
from sojourn_machine.shapes import BALL, BOX, CYLINDER, Shapes

TURN = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Into a shape's frame, which is turned by a quarter about z: its x is y."""


@pytest.mark.parametrize(
    ("size", "on", "off"),
    [
        ([BOX, 0.3, 0.1, 0.2], [[1.0, 2.34, 3.0], [1.14, 2.0, 3.0]], [[1.34, 2.0, 3.0], [1.0, 2.36, 3.0]]),
        ([CYLINDER, 0.1, 0.1, 0.3], [[1.1, 2.1, 3.34], [0.86, 2.0, 2.7]], [[1.12, 2.12, 3.0], [1.0, 2.0, 3.36]]),
        ([BALL, 0.2, 0.2, 0.2], [[1.0, 2.24, 3.0]], [[1.15, 2.15, 3.15]]),
    ],
)
def test_what_is_within_the_margin_of_a_shape(size: list[float], on: list[list[float]], off: list[list[float]]) -> None:
    shapes = Shapes(np.array([[*size, 0.4, 0.5]]), TURN[np.newaxis], np.array([[1.0, 2.0, 3.0]]), np.zeros(4))
    assert on_shapes(shapes, np.array(on), 0.05).all()
    assert not on_shapes(shapes, np.array(off), 0.05).any()


def test_points_go_with_the_joints_as_they_are_measured() -> None:
    """Points on the explorer's forearm, its arm folded and stretched out: each set is on it in its own pose only."""
    urdf = joined_machine("explorer").urdf.text
    body, arm = OwnBody(urdf), joined_machine("explorer").arm
    assert arm is not None
    poses = [np.array(arm.named_poses[name]) for name in ("stow", "unfold")]
    points = [_along_link(urdf, dict(zip(arm.joint_names, pose, strict=True)), "arm_turret_link") for pose in poses]
    for mine, other in ((0, 1), (1, 0)):
        assert len(body.left_out(points[mine], arm.joint_names, poses[mine])) == 0
        assert len(body.left_out(points[other], arm.joint_names, poses[mine])) == len(points[other])


def _along_link(urdf_xml: str, angles: dict[str, float], link: str) -> np.ndarray:
    """The middle of the last shape of a link, in base_link, (1, 3)."""
    model = pin.buildModelFromXML(urdf_xml)
    geometry, data = pin.buildGeomFromUrdfString(model, urdf_xml, pin.GeometryType.VISUAL), model.createData()
    placed, q = geometry.createData(), pin.neutral(model)
    for name, angle in angles.items():
        q[model.joints[model.getJointId(name)].idx_q] = angle
    pin.updateGeometryPlacements(model, data, geometry, placed, q)
    (place,) = [
        placed.oMg[number].translation
        for number, shape in enumerate(geometry.geometryObjects)
        if shape.name == f"{link}_0"
    ]
    return np.array([place])
