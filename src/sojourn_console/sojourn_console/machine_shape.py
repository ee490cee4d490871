"""The shapes of a machine's links from its URDF, and where they are for given joint angles: by Pinocchio.

What joints connect are bodies: the shapes of links that are fixed to each other are parts of one body. They are boxes,
cylinders, spheres and meshes as Pinocchio reads them; a link without a visual shape is not drawn.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio
import trimesh

from sojourn_machine.params import FloatArray

_GREY = (0.6, 0.6, 0.6, 1.0)
_W_FIRST = [0, 1, 2, 6, 3, 4, 5]
"""Where Pinocchio's x, y, z and quaternion x y z w has x, y, z and quaternion w x y z."""
_ROUND = 28
"""Sides of what is drawn for a round thing."""


@dataclass(frozen=True, eq=False)
class Part:
    """One shape.

    Args:
        body: number of the body to which it belongs. place: in its frame, (7,) x, y, z [m] and quaternion w x y z.
        vertices, faces: its triangles in its own frame. color: 0 to 255.
    """

    name: str
    body: int
    place: FloatArray
    vertices: FloatArray
    faces: FloatArray
    color: tuple[int, int, int]


class MachineShape:
    """Of one machine.

    Args:
        urdf: text of its URDF.

    Attributes:
        bodies: names of the joints that move them; the first is that of what is fixed to base_link.
    """

    def __init__(self, urdf: str) -> None:
        self._model = pinocchio.buildModelFromXML(urdf)
        self._data = self._model.createData()
        self._shapes = pinocchio.buildGeomFromUrdfString(self._model, urdf, pinocchio.GeometryType.VISUAL)
        self._neutral = pinocchio.neutral(self._model)
        self.bodies = tuple(self._model.names)
        self.parts = tuple(_part(shape) for shape in self._shapes.geometryObjects)
        self._columns = {name: self._model.joints[number] for number, name in enumerate(self._model.names) if number}

    def placements(self, joints: Mapping[str, float]) -> FloatArray:
        """Where the bodies are in base_link: (n, 7) x, y, z [m] and quaternion w x y z.

        joints: angles [rad], ways [m]; a joint that is not named stands where it is zero.
        """
        self._place(joints)
        return np.array([pinocchio.SE3ToXYZQUAT(place) for place in self._data.oMi])[:, _W_FIRST]

    def link(self, name: str, joints: Mapping[str, float]) -> tuple[FloatArray, FloatArray] | None:
        """Where a link's frame is in base_link: position (3,) [m], rotation (3, 3); None without such a link."""
        if not self._model.existFrame(name):
            return None
        self._place(joints)
        pinocchio.updateFramePlacements(self._model, self._data)
        place = self._data.oMf[self._model.getFrameId(name)]
        return np.array(place.translation), np.array(place.rotation)

    def _place(self, joints: Mapping[str, float]) -> None:
        configuration = self._neutral.copy()
        for name, angle in joints.items():
            joint = self._columns.get(name)
            if joint is None:
                continue
            if joint.nq == 1:
                configuration[joint.idx_q] = angle
            else:  # a continuous joint is kept as cosine and sine
                configuration[joint.idx_q : joint.idx_q + 2] = np.cos(angle), np.sin(angle)
        pinocchio.forwardKinematics(self._model, self._data, configuration)


def _part(shape: Any) -> Part:
    mesh = _mesh(shape.geometry)
    vertices = mesh.vertices * np.array(shape.meshScale)
    color = np.array(shape.meshColor) if shape.meshColor is not None else np.array(_GREY)
    red, green, blue = (round(255.0 * float(np.clip(part, 0.0, 1.0))) for part in color[:3])
    return Part(shape.name, shape.parentJoint, _row(shape.placement), vertices, mesh.faces, (red, green, blue))


def _row(place: pinocchio.SE3) -> FloatArray:
    """A placement as x, y, z and quaternion w x y z."""
    return np.asarray(pinocchio.SE3ToXYZQUAT(place)[_W_FIRST])


def _mesh(shape: Any) -> trimesh.Trimesh:
    kind = type(shape).__name__
    if kind == "Box":
        return trimesh.creation.box(2.0 * np.array(shape.halfSide))
    if kind == "Cylinder":
        return trimesh.creation.cylinder(shape.radius, 2.0 * shape.halfLength, sections=_ROUND)
    if kind == "Capsule":
        return trimesh.creation.capsule(2.0 * shape.halfLength, shape.radius, count=(_ROUND, _ROUND))
    if kind == "Sphere":
        return trimesh.creation.icosphere(3, shape.radius)
    points = np.array([shape.vertex(number) for number in range(shape.num_vertices)])
    triangles = [shape.tri_indices(number) for number in range(shape.num_tris)]
    return trimesh.Trimesh(points, [[one[0], one[1], one[2]] for one in triangles], process=False)
