"""The machine's own shapes, as its URDF has them for the eye, wherever its joints are.

Each is a box, a cylinder or a ball in a frame of its own; a mesh is the box about it.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

BOX, CYLINDER, BALL = 0.0, 1.0, 2.0
KIND, HALF_X, HALF_Y, HALF_Z, ROUND, ALBEDO = 0, 1, 2, 3, 4, 5
"""Columns of `sizes`: kind; half sides, or radius, radius and half length; radius of the ball about it [m]; albedo [-].
"""


class Shapes(NamedTuple):
    """Shapes where they are, for the kernels; there may be none."""

    sizes: FloatArray
    """(shapes, 6)."""
    turns: FloatArray
    """From map into each shape's frame, (shapes, 3, 3)."""
    places: FloatArray
    """Of their middles in map, (shapes, 3) [m]."""
    around: FloatArray
    """Middle of a ball about all of them in map, and its radius, (4,) [m]."""

    def none(self) -> "Shapes":
        """No shape."""
        return Shapes(self.sizes[:0], self.turns[:0], self.places[:0], np.zeros(4))


class MachineShapes:
    """The shapes of a machine, which its joints move.

    Args:
        urdf_xml: of the machine. link: of a sensor, or of what else they are seen from.

    Raises:
        InvalidValueError: the URDF has not the link.
    """

    def __init__(self, urdf_xml: str, link: str) -> None:
        self._model = pin.buildModelFromXML(urdf_xml)
        if not self._model.existFrame(link):
            raise InvalidValueError("link of a sensor", link, "a link of the URDF")
        self._data = self._model.createData()
        self._frame = self._model.getFrameId(link)
        self._shapes = pin.buildGeomFromUrdfString(self._model, urdf_xml, pin.GeometryType.VISUAL)
        self._placed = self._shapes.createData()
        rows = [_row(shape) for shape in self._shapes.geometryObjects]
        self._sizes = np.array(rows).reshape(len(rows), 6)

    def at(self, names: tuple[str, ...], angles: FloatArray) -> tuple[FloatArray, FloatArray, Shapes]:
        """The link, rotation (3, 3) and place (3,) [m], and the shapes, all in base_link.

        Args:
            names: of joints. angles: theirs, shape (n,) [rad, m]; a joint that is not named stands at zero.
        """
        model, data = self._model, self._data
        q = pin.neutral(model)
        for name, angle in zip(names, angles, strict=True):
            joint = model.getJointId(name)
            if joint < model.njoints:
                at = model.joints[joint].idx_q
                if model.joints[joint].nq == 2:  # a joint without limits is kept as cosine and sine
                    q[at : at + 2] = math.cos(angle), math.sin(angle)
                elif model.joints[joint].nq == 1:
                    q[at] = angle
        pin.framesForwardKinematics(model, data, q)
        pin.updateGeometryPlacements(model, data, self._shapes, self._placed)
        camera = data.oMf[self._frame]
        turns = np.array([place.rotation.T for place in self._placed.oMg]).reshape(-1, 3, 3)
        places = np.array([place.translation for place in self._placed.oMg]).reshape(-1, 3)
        shapes = Shapes(self._sizes, np.ascontiguousarray(turns), places, _about(places, self._sizes))
        return np.array(camera.rotation), np.array(camera.translation), shapes


def moved(body: Shapes, rotation: FloatArray, place: FloatArray) -> Shapes:
    """Shapes from base_link into map, by the base's rotation, shape (3, 3), and place, shape (3,) [m]."""
    around = body.around.copy()
    around[:3] = rotation @ around[:3] + place
    return Shapes(body.sizes, np.ascontiguousarray(body.turns @ rotation.T), body.places @ rotation.T + place, around)


def _row(shape: Any) -> tuple[float, ...]:
    albedo = float(np.dot((0.2126, 0.7152, 0.0722), np.asarray(shape.meshColor)[:3]))
    kind = type(shape.geometry).__name__
    if kind == "Cylinder":
        radius, half = shape.geometry.radius, shape.geometry.halfLength
        return CYLINDER, radius, radius, half, math.hypot(radius, half), albedo
    if kind == "Sphere":
        radius = shape.geometry.radius
        return BALL, radius, radius, radius, radius, albedo
    if kind == "Box":
        half_sides = np.asarray(shape.geometry.halfSide)
    else:
        shape.geometry.computeLocalAABB()
        half_sides = np.full(3, shape.geometry.aabb_radius / math.sqrt(3.0))
    return BOX, *(float(side) for side in half_sides), float(np.linalg.norm(half_sides)), albedo


def _about(places: FloatArray, sizes: FloatArray) -> FloatArray:
    if not len(places):
        return np.zeros(4)
    reach = sizes[:, ROUND, np.newaxis]
    middle = 0.5 * ((places - reach).min(axis=0) + (places + reach).max(axis=0))
    return np.array([*middle, (np.linalg.norm(places - middle, axis=1) + sizes[:, ROUND]).max()])
