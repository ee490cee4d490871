"""Closed-form inverse kinematics, all branches: arms with a spherical wrist, and planar arms that yaw.

Both kinds start with a joint axis 1 and parallel axes 2 and 3 square to it (Pieper 1968; Paul, Robot Manipulators,
1981, chapter 3). In the frames of dh.py, with s = sin alpha_1 = +-1 and the lateral offset h of the plane of the arm, a
point of that plane with coordinates (u, v) lies at
    Rz(theta_1) (a_1 + u, -s h, s v + ...)   so   theta_1 = atan2(Y, X) - atan2(-s h, a_1 + u),
    a_1 + u = +-sqrt(X^2 + Y^2 - h^2)        (two shoulders),
and two links of lengths a_2 and l_3 reach (u, v) with two elbows (law of cosines).

Spherical wrist (axes 4, 5, 6 meet, right angles between them): the wrist's centre W is where the tip's pose puts it; it
gives joints 1 to 3 in four ways, and the rotation that is left gives joints 4 to 6 in two, eight branches.

Planar with yaw and roll (axis 4 parallel to 2 and 3, axis 5 square to it; the tool axis square to axis 5 and the tip on
a line along the tool axis through axis 5): tip position and tool direction D are wanted. Axis 5 is square to D and in
the arm's plane, which leaves two senses of it: with two shoulders and two elbows, eight branches.

Branches are turned by whole turns into the joint limits where that is possible. Where a branch is singular (wrist
stretched, or the target on axis 1) one joint is free: it is left where the reference is, and the branch is marked.
"""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np

from sojourn_flight.arm.dh import DhGeometry, screw, twist
from sojourn_flight.arm.dh_extract import dh_of_chain
from sojourn_flight.arm.inverse_search import turn_into_limits
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray

_EXACT = 1.0e-7
"""A length [m] or sine that is so small counts as zero."""
_SINGULAR = 1.0e-9


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """One way to reach the target."""

    positions: FloatArray  # (n,) [rad]
    inside: bool  # within the joint limits
    singular: bool  # one joint is free here


def spherical_wrist_branches(
    arm: SerialArm, position: FloatArray, rotation: FloatArray, reference: FloatArray | None = None
) -> tuple[Branch, ...]:
    """Every way to put the tip at `position` (3,) [m] with `rotation` (3, 3); none where it is out of reach.

    Args:
        reference: joint positions (n,) that fix what a singular branch leaves free; zero if left out.
    """
    geometry = dh_of_chain(arm.chain, "modified")
    reference = np.zeros(6) if reference is None else reference
    target = np.eye(4)
    target[:3, :3], target[:3, 3] = rotation, position
    flange = np.linalg.inv(geometry.base) @ target @ np.linalg.inv(geometry.tool)
    centre = flange[:3, 3] - flange[:3, 2] * geometry.d[5]
    in_third = np.array([geometry.a[3], -math.sin(geometry.alpha[3]) * geometry.d[3]])
    lateral = math.cos(geometry.alpha[3]) * geometry.d[3]
    found = []
    for right, up in product((1.0, -1.0), repeat=2):
        shoulder = _first_joint(geometry, centre, _lateral(geometry, lateral), right, reference[0])
        if shoulder is None:
            continue
        theta_1, u, v, free = shoulder
        elbow = _two_links(geometry, u, v, in_third, up)
        if elbow is None:
            continue
        angles = [theta_1, *elbow]
        for bend in (1.0, -1.0):
            wrist, stretched = _wrist_angles(geometry, flange, angles, bend, reference[3])
            found.append(_branch(arm, geometry, [*angles, *wrist], free or stretched))
    return tuple(found)


def planar_yaw_branches(
    arm: SerialArm, position: FloatArray, direction: FloatArray, reference: FloatArray | None = None
) -> tuple[Branch, ...]:
    """Every way to put the tip at `position` (3,) [m] with the tool axis along the unit vector `direction` (3,).

    Args:
        reference: as for `spherical_wrist_branches`.
    """
    geometry = dh_of_chain(arm.chain, "modified")
    reference = np.zeros(5) if reference is None else reference
    turn = geometry.base[:3, :3].T
    tool = geometry.tool[:3, :3] @ arm.chain.tool_axis
    pointing = turn @ direction
    on_axis = turn @ (position - geometry.base[:3, 3]) - float(geometry.tool[:3, 3] @ tool) * pointing
    s1, s4 = math.sin(geometry.alpha[1]), math.sin(geometry.alpha[4])
    second, third = math.cos(geometry.alpha[2]), math.cos(geometry.alpha[3])
    beyond = geometry.d[4] + geometry.tool[2, 3]
    along = np.array([geometry.a[4], -second * third * s4 * beyond])  # from axis 4 to there
    lateral = third * geometry.d[3]
    found = []
    for right, sense, up in product((1.0, -1.0), repeat=3):
        shoulder = _first_joint(geometry, on_axis, _lateral(geometry, lateral), right, reference[0])
        if shoulder is None:
            continue
        theta_1, u, v, free = shoulder
        in_plane = np.array([math.cos(theta_1) * pointing[0] + math.sin(theta_1) * pointing[1], s1 * pointing[2]])
        square = float(np.hypot(*in_plane)) > _SINGULAR
        # axis 5 has the direction s4 (sin psi, -cos psi) in the plane: square to the tool
        psi = math.atan2(in_plane[1], in_plane[0]) if square else float(reference[1])
        psi += 0.0 if sense > 0.0 else math.pi
        c, s = math.cos(psi), math.sin(psi)
        wrist_u, wrist_v = u - (c * along[0] - s * along[1]), v - (s * along[0] + c * along[1])
        elbow = _two_links(geometry, wrist_u, wrist_v, np.array([geometry.a[3], 0.0]), up)
        if elbow is None:
            continue
        theta_4 = second * third * (psi - elbow[0] - second * elbow[1])
        transform = _chain_rotation(geometry, [theta_1, *elbow, theta_4]) @ twist(0.0, geometry.alpha[4])[:3, :3]
        seen = transform.T @ pointing
        theta_5 = math.atan2(seen[1], seen[0]) - math.atan2(tool[1], tool[0])
        found.append(_branch(arm, geometry, [theta_1, *elbow, theta_4, theta_5], free or not square))
    return tuple(found)


def has_spherical_wrist(arm: SerialArm) -> bool:
    """Whether `spherical_wrist_branches` is for this arm."""
    if arm.joint_count != 6 or not all(arm.revolute):
        return False
    g = dh_of_chain(arm.chain, "modified")
    meet = max(abs(g.a[4]), abs(g.a[5]), abs(g.d[4])) < _EXACT * arm.reach
    return _has_planar_shoulder(g) and meet and _right_angles(g.alpha[3], g.alpha[4], g.alpha[5])


def is_planar_with_yaw(arm: SerialArm) -> bool:
    """Whether `planar_yaw_branches` is for this arm."""
    if arm.joint_count != 5 or not all(arm.revolute):
        return False
    g = dh_of_chain(arm.chain, "modified")
    tool = g.tool[:3, :3] @ arm.chain.tool_axis
    offset = g.tool[:3, 3] - np.array([0.0, 0.0, g.tool[2, 3]])
    beside = float(np.linalg.norm(offset - (offset @ tool) * tool))
    parallel = abs(math.sin(g.alpha[3])) < _EXACT and _right_angles(g.alpha[4])
    return _has_planar_shoulder(g) and parallel and abs(tool[2]) < _EXACT and beside < _EXACT * arm.reach


def _has_planar_shoulder(g: DhGeometry) -> bool:
    return _right_angles(g.alpha[1]) and abs(math.sin(g.alpha[2])) < _EXACT


def _right_angles(*angles: float) -> bool:
    return all(abs(math.cos(angle)) < _EXACT for angle in angles)


def _lateral(g: DhGeometry, beyond: float) -> float:
    """Offset h of the plane of the arm along axis 2, `beyond` of it along axis 3."""
    return float(g.d[1] + math.cos(g.alpha[2]) * (g.d[2] + beyond))


def _first_joint(
    g: DhGeometry, point: FloatArray, h: float, right: float, reference: float
) -> tuple[float, float, float, bool] | None:
    """theta_1, (u, v) of a point given in frame 0, and whether joint 1 is free; None out of reach."""
    s = math.sin(g.alpha[1])
    square = point[0] ** 2 + point[1] ** 2 - h * h
    if square < -_EXACT * (h * h + _EXACT):
        return None
    across = right * math.sqrt(max(square, 0.0))
    free = point[0] ** 2 + point[1] ** 2 < _SINGULAR
    theta = reference + g.theta[0] if free else math.atan2(point[1], point[0]) - math.atan2(-s * h, across)
    return theta, across - g.a[1], s * (point[2] - g.d[0]), free


def _two_links(g: DhGeometry, u: float, v: float, end: FloatArray, up: float) -> tuple[float, float] | None:
    """theta_2, theta_3 that put the point `end` (2,) of frame 3 at (u, v) of the plane; None out of reach."""
    sense = math.cos(g.alpha[2])
    first, second = float(g.a[2]), float(np.hypot(*end))
    if first * second < _EXACT**2:
        return None
    cosine = (u * u + v * v - first**2 - second**2) / (2.0 * first * second)
    if abs(cosine) > 1.0 + _EXACT:
        return None
    bend = up * math.acos(min(max(cosine, -1.0), 1.0))
    theta_3 = sense * bend - math.atan2(end[1], end[0])
    x, y = first + second * math.cos(bend), second * math.sin(bend)
    return math.atan2(v, u) - math.atan2(y, x), theta_3


def _wrist_angles(
    g: DhGeometry, flange: FloatArray, angles: list[float], bend: float, reference: float
) -> tuple[list[float], bool]:
    """theta_4 to theta_6 from Rz(t4) Rx(alpha_4) Rz(t5) Rx(alpha_5) Rz(t6) = M, and whether the wrist is stretched."""
    m = (_chain_rotation(g, angles) @ twist(0.0, g.alpha[3])[:3, :3]).T @ flange[:3, :3]
    s4, s5 = math.sin(g.alpha[4]), math.sin(g.alpha[5])
    sine = math.hypot(m[0, 2], m[1, 2])
    theta_5 = math.atan2(bend * sine, -s4 * s5 * m[2, 2])
    if sine > _SINGULAR:
        theta_4 = math.atan2(bend * s5 * m[1, 2], bend * s5 * m[0, 2])
        return [theta_4, theta_5, math.atan2(-bend * s4 * m[2, 1], bend * s4 * m[2, 0])], False
    theta_4 = reference + float(g.theta[3])
    turned = screw(theta_4, 0.0) @ twist(0.0, g.alpha[4]) @ screw(theta_5, 0.0) @ twist(0.0, g.alpha[5])
    rest = turned[:3, :3].T @ m
    return [theta_4, theta_5, math.atan2(rest[1, 0], rest[0, 0])], True


def _chain_rotation(g: DhGeometry, angles: list[float]) -> FloatArray:
    """Rotation (3, 3) of the last of these joints' frames in frame 0."""
    rotation = np.eye(3)
    for i, angle in enumerate(angles):
        rotation = rotation @ twist(0.0, g.alpha[i])[:3, :3] @ screw(angle, 0.0)[:3, :3]
    return rotation


def _branch(arm: SerialArm, g: DhGeometry, angles: list[float], singular: bool) -> Branch:
    q = np.array(angles) - g.theta
    inside = bool(turn_into_limits(arm.chain, arm.lower, arm.upper, q))
    return Branch(q, inside, singular)
