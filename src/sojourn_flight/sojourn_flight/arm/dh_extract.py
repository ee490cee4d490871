"""The Denavit-Hartenberg parameters of any serial chain: from the lines of its joint axes at zero.

Between axis i and axis i+1 lies their common normal: a_i is its length, alpha_i the angle that it turns axis i into
axis i+1, d_i+1 and theta_i+1 are the shift and the turn along axis i+1 from one normal to the next (Hartenberg &
Denavit, Kinematic Synthesis of Linkages, 1964, chapter 12). Where the normal is not unique it is chosen: parallel
axes, the one through the last foot, so that d = 0; axes that cross, the direction of their vector product; one and
the same axis, the direction of the last normal. A prismatic joint has a direction only: its axis is laid through
the joint's frame.
"""

import math

import numpy as np

from sojourn_flight.arm.chain import Chain
from sojourn_flight.arm.dh import Convention, DhGeometry, in_convention, screw, twist
from sojourn_machine.params import FloatArray

_PARALLEL = 1.0e-9  # sine of the angle below which axes are parallel [-]
_TOUCHING = 1.0e-9  # distance below which axes meet [m]


def dh_of_chain(chain: Chain, convention: Convention) -> DhGeometry:
    """Parameters of a chain; its base and its tool hold what the table has no columns for."""
    points, axes, tip = _axes_at_zero(chain)
    count = len(points)
    frame = _first_frame(points[0], axes[0])
    base = frame.copy()
    theta, d = np.zeros(count), np.zeros(count)
    a, alpha = np.zeros(count + 1), np.zeros(count + 1)
    for i in range(count - 1):
        foot, direction, length = _common_normal(frame, points[i + 1], axes[i + 1])
        theta[i] = _angle(frame[:3, 0], direction, frame[:3, 2])
        d[i] = float((foot - frame[:3, 3]) @ frame[:3, 2])
        a[i + 1] = length
        alpha[i + 1] = _angle(axes[i], axes[i + 1], direction)
        frame = frame @ screw(theta[i], d[i]) @ twist(length, alpha[i + 1])
    tool = np.linalg.inv(frame) @ tip
    revolute = tuple(bool(flag > 0.5) for flag in chain.revolute)
    return in_convention(DhGeometry(revolute, theta, d, a, alpha, base, tool), convention)


def _axes_at_zero(chain: Chain) -> tuple[list[FloatArray], list[FloatArray], FloatArray]:
    """A point on each joint axis and its direction, and the tip (4, 4), all in the base."""
    rotation, position = np.eye(3), np.zeros(3)
    points, axes = [], []
    for i in range(chain.axis.shape[0]):
        position = position + rotation @ chain.translation[i]
        rotation = rotation @ chain.rotation[i]
        points.append(position)
        axes.append(rotation @ chain.axis[i])
    tip = np.eye(4)
    tip[:3, :3], tip[:3, 3] = rotation @ chain.tip_rotation, position + rotation @ chain.tip_translation
    return points, axes, tip


def _first_frame(point: FloatArray, axis: FloatArray) -> FloatArray:
    """A frame at `point` with z along `axis`, its x as near to the base's x as can be."""
    helper = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = helper - (helper @ axis) * axis
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = x, np.cross(axis, x), axis, point
    return frame


def _common_normal(frame: FloatArray, point: FloatArray, axis: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Foot of the normal on the frame's z axis, its direction to the next axis, its length."""
    origin, z, x = frame[:3, 3], frame[:3, 2], frame[:3, 0]
    cross, between = np.cross(z, axis), point - origin
    sine = float(np.linalg.norm(cross))
    if sine < _PARALLEL:
        across = between - (between @ z) * z
        distance = float(np.linalg.norm(across))
        # parallel: straight over from here
        return origin, (across / distance if distance > _TOUCHING else x), distance if distance > _TOUCHING else 0.0
    direction = cross / sine
    along = float(np.cross(between, axis) @ cross) / sine**2
    distance = float(between @ direction)
    if abs(distance) < _TOUCHING:
        return origin + along * z, direction, 0.0
    return origin + along * z, math.copysign(1.0, distance) * direction, abs(distance)


def _angle(start: FloatArray, end: FloatArray, axis: FloatArray) -> float:
    """Turn about `axis` from one unit vector to another, both square to it [rad]."""
    return math.atan2(float(np.cross(start, end) @ axis), float(start @ end))
