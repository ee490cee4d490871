"""The machine's own shapes: what a camera sees of them, and which ground lies in their shadow.

Each shape is a box, a cylinder or a ball in a frame of its own, as the URDF has them; a mesh is the box about it. A ray
is met in closed form (Glassner 1989, An Introduction to Ray Tracing, ch. 2). A ball about each shape says which rays
cannot meet it.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import kernel, small_kernel
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
        urdf_xml: of the machine. link: of the camera.

    Raises:
        InvalidValueError: the URDF has not the camera's link.
    """

    def __init__(self, urdf_xml: str, link: str) -> None:
        self._model = pin.buildModelFromXML(urdf_xml)
        if not self._model.existFrame(link):
            raise InvalidValueError("link of a camera", link, "a link of the URDF")
        self._data = self._model.createData()
        self._frame = self._model.getFrameId(link)
        self._shapes = pin.buildGeomFromUrdfString(self._model, urdf_xml, pin.GeometryType.VISUAL)
        self._placed = self._shapes.createData()
        rows = [_row(shape) for shape in self._shapes.geometryObjects]
        self._sizes = np.array(rows).reshape(len(rows), 6)

    def at(self, names: tuple[str, ...], angles: FloatArray) -> tuple[FloatArray, FloatArray, Shapes]:
        """The camera's link, rotation (3, 3) and place (3,) [m], and the shapes, all in base_link.

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


@small_kernel
def near_ray(body: Shapes, shape: int, origin: FloatArray, ray: tuple[float, float, float]) -> bool:
    """Whether a ray passes through the ball about a shape."""
    dx = body.places[shape, 0] - origin[0]
    dy = body.places[shape, 1] - origin[1]
    dz = body.places[shape, 2] - origin[2]
    along = dx * ray[0] + dy * ray[1] + dz * ray[2]
    square = dx * dx + dy * dy + dz * dz
    radius = body.sizes[shape, ROUND]
    return bool((square - along * along if along > 0.0 else square) <= radius * radius)


@kernel
def meet_shape(
    body: Shapes, shape: int, origin: FloatArray, ray: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    """Distance along a unit ray in map to where it enters a shape, infinite where it does not or begins inside, and the
    normal there in map.
    """
    turn = body.turns[shape]
    px, py, pz = (
        origin[0] - body.places[shape, 0],
        origin[1] - body.places[shape, 1],
        origin[2] - body.places[shape, 2],
    )
    x = turn[0, 0] * px + turn[0, 1] * py + turn[0, 2] * pz
    y = turn[1, 0] * px + turn[1, 1] * py + turn[1, 2] * pz
    z = turn[2, 0] * px + turn[2, 1] * py + turn[2, 2] * pz
    dx = turn[0, 0] * ray[0] + turn[0, 1] * ray[1] + turn[0, 2] * ray[2]
    dy = turn[1, 0] * ray[0] + turn[1, 1] * ray[1] + turn[1, 2] * ray[2]
    dz = turn[2, 0] * ray[0] + turn[2, 1] * ray[1] + turn[2, 2] * ray[2]
    size = body.sizes[shape]
    found = math.inf
    nx, ny, nz = 0.0, 0.0, 0.0
    if size[KIND] == BOX:
        found, nx, ny, nz = _meet_box((x, y, z), (dx, dy, dz), (size[HALF_X], size[HALF_Y], size[HALF_Z]))
    elif size[KIND] == CYLINDER:
        found, nx, ny, nz = _meet_cylinder((x, y, z), (dx, dy, dz), size[HALF_X], size[HALF_Z])
    else:
        found, nx, ny, nz = _meet_ball((x, y, z), (dx, dy, dz), size[HALF_X])
    return (
        found,
        turn[0, 0] * nx + turn[1, 0] * ny + turn[2, 0] * nz,
        turn[0, 1] * nx + turn[1, 1] * ny + turn[2, 1] * nz,
        turn[0, 2] * nx + turn[1, 2] * ny + turn[2, 2] * nz,
    )


@small_kernel
def _meet_box(
    p: tuple[float, float, float], d: tuple[float, float, float], half: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    enter, leave, axis = -math.inf, math.inf, 0
    for k in range(3):
        if abs(d[k]) < 1e-12:
            if abs(p[k]) > half[k]:
                return math.inf, 0.0, 0.0, 0.0
            continue
        a, b = (-half[k] - p[k]) / d[k], (half[k] - p[k]) / d[k]
        if min(a, b) > enter:
            enter, axis = min(a, b), k
        leave = min(leave, max(a, b))
    if enter > leave or enter <= 0.0:
        return math.inf, 0.0, 0.0, 0.0
    sign = -1.0 if d[axis] > 0.0 else 1.0
    return enter, sign if axis == 0 else 0.0, sign if axis == 1 else 0.0, sign if axis == 2 else 0.0


@small_kernel
def _meet_cylinder(
    p: tuple[float, float, float], d: tuple[float, float, float], radius: float, half: float
) -> tuple[float, float, float, float]:
    """About z."""
    a = d[0] * d[0] + d[1] * d[1]
    b = p[0] * d[0] + p[1] * d[1]
    c = p[0] * p[0] + p[1] * p[1] - radius * radius
    if a > 1e-14:
        inside = b * b - a * c
        if inside >= 0.0:
            at = (-b - math.sqrt(inside)) / a
            z = p[2] + at * d[2]
            if at > 0.0 and abs(z) <= half:
                return at, (p[0] + at * d[0]) / radius, (p[1] + at * d[1]) / radius, 0.0
    if abs(d[2]) > 1e-14:
        side = -1.0 if d[2] > 0.0 else 1.0
        at = (side * half - p[2]) / d[2]
        x, y = p[0] + at * d[0], p[1] + at * d[1]
        if at > 0.0 and x * x + y * y <= radius * radius:
            return at, 0.0, 0.0, side
    return math.inf, 0.0, 0.0, 0.0


@small_kernel
def _meet_ball(
    p: tuple[float, float, float], d: tuple[float, float, float], radius: float
) -> tuple[float, float, float, float]:
    b = p[0] * d[0] + p[1] * d[1] + p[2] * d[2]
    inside = b * b - (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - radius * radius)
    at = -b - math.sqrt(max(inside, 0.0))
    if inside < 0.0 or at <= 0.0:
        return math.inf, 0.0, 0.0, 0.0
    return at, (p[0] + at * d[0]) / radius, (p[1] + at * d[1]) / radius, (p[2] + at * d[2]) / radius


@small_kernel
def hides_sun(body: Shapes, sun: FloatArray, x: float, y: float, z: float, point: FloatArray) -> bool:
    """Whether a shape stands between a point in map and the Sun. `point`: working room, shape (3,)."""
    dx, dy, dz = body.around[0] - x, body.around[1] - y, body.around[2] - z
    along = dx * sun[0] + dy * sun[1] + dz * sun[2]
    radius = body.around[3]
    if along < -radius or dx * dx + dy * dy + dz * dz - along * along > radius * radius:
        return False
    point[0], point[1], point[2] = x, y, z
    ray = (sun[0], sun[1], sun[2])
    for shape in range(body.sizes.shape[0]):
        if near_ray(body, shape, point, ray):
            found, _, _, _ = meet_shape(body, shape, point, ray)
            if found < math.inf:
                return True
    return False
