"""Paths of the tip in space: straight line, arc, turning at an even rate; and the joints that follow them.

Place: on a line, or on the circle through three points. Turn: from the first orientation to the last about one axis
(spherical linear interpolation; Shoemake, SIGGRAPH 1985), in step with the place. The path parameter s runs from 0 to 1
in even steps of length.

Joints: the inverse kinematics at even steps of s, each from the last posture, so that the arm stays on one branch; then
a cubic spline through the postures, whose distance from the path is measured between them and refined until it is
within the tolerance. Where a posture cannot be found, or a joint would have to jump (a singularity that the path leads
through), the path is refused with the place. Near a singularity the joints run far for a short way: the timing
(time_optimal.py) then slows the tip down.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from sojourn_mechanics.arm.inverse_search import POINTING, POSE, POSITION, search
from sojourn_mechanics.arm.kinematics import forward_kinematics
from sojourn_mechanics.arm.serial_arm import SerialArm
from sojourn_mechanics.arm.spline_path import SplinePath, spline_through
from sojourn_mechanics.errors import InvalidValueError, MechanicsError
from sojourn_mechanics.params import FloatArray

_STEPS = (32, 64, 128, 256, 512)
_LARGEST_JUMP = 0.6
"""More than this between two steps of the finest division is a jump [rad, or reaches]."""


class CartesianPathError(MechanicsError):
    """The arm cannot follow the path; the message says where and why."""


@dataclass(frozen=True, slots=True, eq=False)
class TipPath:
    """A path of the tip. `centre` is None on a line."""

    start: FloatArray  # (3,) [m]
    end: FloatArray  # (3,) [m]
    start_rotation: FloatArray  # (3, 3)
    turn: FloatArray  # rotation vector (3,) in the base, start to end [rad]
    centre: FloatArray | None = None  # (3,) [m]
    sweep: FloatArray | None = None  # rotation vector (3,) of the arc [rad]

    @property
    def length(self) -> float:
        """Of the way of the tip's place [m]."""
        if self.centre is None or self.sweep is None:
            return float(np.linalg.norm(self.end - self.start))
        return float(np.linalg.norm(self.sweep) * np.linalg.norm(self.start - self.centre))

    def pose(self, s: float) -> tuple[FloatArray, FloatArray]:
        """Place (3,) [m] and rotation (3, 3) at s from 0 to 1."""
        rotation = Rotation.from_rotvec(s * self.turn).as_matrix() @ self.start_rotation
        if self.centre is None or self.sweep is None:
            return self.start + s * (self.end - self.start), rotation
        return self.centre + Rotation.from_rotvec(s * self.sweep).apply(self.start - self.centre), rotation


def line(start: FloatArray, end: FloatArray, start_rotation: FloatArray, end_rotation: FloatArray) -> TipPath:
    """Straight from one pose to another: places (3,) [m], rotations (3, 3)."""
    _check(start, end, start_rotation, end_rotation)
    return TipPath(start, end, start_rotation, _turn(start_rotation, end_rotation))


def arc(
    start: FloatArray, through: FloatArray, end: FloatArray, start_rotation: FloatArray, end_rotation: FloatArray
) -> TipPath:
    """On the circle from `start` by way of `through` to `end`, (3,) [m] each.

    Raises:
        InvalidValueError: the three points lie on a line.
    """
    _check(start, through, end, start_rotation, end_rotation)
    a, b = through - start, end - start
    normal = np.cross(a, b)
    area = float(normal @ normal)
    if area < (1e-6 * float(a @ a + b @ b)) ** 2 or area == 0.0:
        raise InvalidValueError("arc", [p.tolist() for p in (start, through, end)], "three points that are no line")
    centre = start + (np.cross(normal, a) * float(b @ b) + np.cross(b, normal) * float(a @ a)) / (2.0 * area)
    axis = normal / math.sqrt(area)
    out, last = start - centre, end - centre
    angle = math.atan2(float(np.cross(out, last) @ axis), float(out @ last)) % (2.0 * math.pi)
    return TipPath(start, end, start_rotation, _turn(start_rotation, end_rotation), centre, angle * axis)


def joints_along(
    arm: SerialArm, path: TipPath, start: FloatArray, task: int | None = None, tolerance: float = 1.0e-4
) -> SplinePath:
    """The joints that follow a path of the tip.

    Args:
        start: joint positions (n,) near those at its beginning: they choose the branch.
        task: POSE, POINTING or POSITION; if left out, POINTING for five joints, else POSE.
        tolerance: allowed distance of the tip from the path between the postures [m], and angle [rad].

    Raises:
        CartesianPathError: a place of the path cannot be reached from the one before it.
    """
    task = (POINTING if arm.joint_count == 5 else POSE) if task is None else task
    reason = ""
    for steps in _STEPS:
        try:
            postures = _postures(arm, path, start, task, np.linspace(0.0, 1.0, steps + 1), steps == _STEPS[-1])
        except CartesianPathError as error:
            reason = str(error)
            if steps == _STEPS[-1]:
                raise
            continue
        spline = spline_through(postures, np.linspace(0.0, 1.0, steps + 1))
        worst = _deviation(arm, path, task, spline, (np.arange(steps) + 0.5) / steps)
        if worst <= tolerance:
            return spline
        reason = f"the joints' spline leaves the path by {worst:.2g} m or rad"
    raise CartesianPathError(f"no spline of {_STEPS[-1]} pieces is near enough: {reason}")


def _postures(
    arm: SerialArm, path: TipPath, start: FloatArray, task: int, places: FloatArray, finest: bool
) -> FloatArray:
    reach = arm.reach
    settings = np.array([1e-8 * reach, 1e-8, 1e-12 * reach**2, 0.5, 60.0])
    q = start
    rows: list[FloatArray] = []
    for s in places:
        position, wanted = path.pose(float(s))
        wanted = _wanted(arm, task, wanted)
        found, distance, angle = search(
            arm.chain, q, arm.lower, arm.upper, task, position, wanted, 0.25 * reach, settings
        )
        if distance > 1e-6 * reach or angle > 1e-6:
            off = f"{distance:.2g} m and {angle:.2g} rad off"
            held = np.flatnonzero((found <= arm.lower) | (found >= arm.upper))
            at_limit = ", ".join(arm.joint_names[i] for i in held)
            why = f" with {at_limit} at the limit" if at_limit else ""
            raise CartesianPathError(f"at {100.0 * s:.0f} % of the path the arm stays {off}{why}")
        jump = np.abs(found - q) / np.where(arm.chain.revolute > 0.5, 1.0, reach)
        if rows and finest and float(np.max(jump)) > _LARGEST_JUMP:
            joint = arm.joint_names[int(np.argmax(jump))]
            raise CartesianPathError(f"at {100.0 * s:.0f} % of the path {joint} would have to jump: a singularity")
        q = found
        rows.append(found)
    return np.array(rows)


def _wanted(arm: SerialArm, task: int, rotation: FloatArray) -> FloatArray:
    """What the search takes for a rotation of the tip: for POINTING its last column is the tool direction."""
    wanted = np.array(rotation)
    if task == POINTING:
        wanted[:, 2] = rotation @ arm.chain.tool_axis
    return wanted


def _deviation(arm: SerialArm, path: TipPath, task: int, spline: SplinePath, places: FloatArray) -> float:
    worst = 0.0
    for s in places:
        position, rotation = path.pose(float(s))
        tip = forward_kinematics(arm, spline.at(float(s))[0])
        worst = max(worst, float(np.linalg.norm(tip.position - position)))
        if task == POSE:
            worst = max(worst, float(Rotation.from_matrix(tip.rotation @ rotation.T).magnitude()))
        elif task != POSITION:
            worst = max(worst, float(np.linalg.norm(tip.tool_direction - rotation @ arm.chain.tool_axis)))
    return worst


def _turn(start: FloatArray, end: FloatArray) -> FloatArray:
    return np.asarray(Rotation.from_matrix(end @ start.T).as_rotvec())


def _check(*values: FloatArray) -> None:
    for value in values:
        if not np.all(np.isfinite(value)):
            raise InvalidValueError("path of the tip", value.tolist(), "finite numbers")
