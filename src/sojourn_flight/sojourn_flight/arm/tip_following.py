"""The joints that keep the tip on a path in space, through singular postures too.

From the beginning the path is gone along in steps, each answered by the inverse kinematics from the last posture, so
that the arm stays on one branch; a step after which a joint would have run further than `_JOINT_STEP`, or come to
another branch, is made shorter. Where no step is short enough the arm has come to a singular posture in which joints
must turn while the tip rests (a wrist that is stretched out: roll and flange turn against each other): they do, on a
straight line in joint space, if the tip stays within the tolerance meanwhile. If it would not, or the path leaves the
reach, it is refused with the place.

Through the postures goes a cubic spline of a parameter u that grows with the way of the tip and that of the joints, so
that a grid over u is fine where the joints are fast. How far its tip is from the path is measured between the postures,
and more are put in until that is within the tolerance. Timed by time_optimal.py it slows the tip down where the joints
would be too fast, down to a rest: no speed limit is broken, and no path refused, for being near a singularity.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from sojourn_flight.arm.chain import ChainArm
from sojourn_flight.arm.inverse_search import POINTING, POSE, POSITION, SearchSettings, TipTarget, search
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.spline_path import SplinePath, spline_through
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray

_FIRST_STEP = 1.0 / 32.0
_SHORTEST_STEP = 1.0e-6
_JOINT_STEP = 0.15
"""Most that a joint runs from one posture to the next [rad, or reaches]."""
_BEND = 0.1
"""Most that the middle one of three postures may be off the middle, in shares of the way between the others."""
_AS_GOOD = 0.3
"""Share of the tolerance within which a posture halfway between two others is as good as that of the inverse
kinematics, which is not smooth next to a singular one: there, far postures differ by less than its tolerance."""
_ROUNDS = 8
"""Times that postures are put in between."""


class JointedArm(ChainArm, Protocol):
    """An arm whose joints can be named: SerialArm, ArmModel."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """In the order of the chain."""


class PathOfTip(Protocol):
    """A path of the tip: TipPath, TipRoute."""

    @property
    def breaks(self) -> tuple[float, ...]:
        """Values of s at which its shape changes, rising."""

    def pose(self, s: float) -> tuple[FloatArray, FloatArray]:
        """Place (3,) [m] and rotation (3, 3) at s from 0 to 1."""


class CartesianPathError(MachineError):
    """The arm cannot follow the path; the message says where and why."""


@dataclass(frozen=True, slots=True, eq=False)
class FollowedPath:
    """Joints as a function of u, and the share of the tip's path that is done there."""

    joints: SplinePath
    shares: SplinePath  # one column, 0 to 1

    def share(self, u: float) -> float:
        """Of the tip's path at u [-]."""
        return float(np.clip(self.shares.at(u)[0][0], 0.0, 1.0))


def joints_along(
    arm: JointedArm, path: PathOfTip, start: FloatArray, task: int | None = None, tolerance: float = 1.0e-4
) -> FollowedPath:
    """The joints that follow a path of the tip.

    Args:
        start: joint positions (n,) near those at its beginning: they choose the branch.
        task: POSE, POINTING or POSITION; if left out, POINTING for five joints, else POSE.
        tolerance: allowed distance of the tip from the path between the postures [m], and angle [rad].

    Raises:
        CartesianPathError: a place of the path cannot be reached from the one before it.
    """
    follower = _Follower(arm, path, (POINTING if arm.joint_count == 5 else POSE) if task is None else task, tolerance)
    places, postures = follower.along(start)
    for _ in range(_ROUNDS):
        followed = _spline(arm, places, postures)
        beside, worst = follower.beside(followed, places, postures)
        if not np.any(beside):
            return followed
        places, postures = follower.finer(places, postures, beside)
    raise CartesianPathError(
        f"no spline of {len(places)} pieces is near enough: it leaves the path by {worst:.2g} m or rad"
    )


def _spline(arm: JointedArm, places: FloatArray, postures: FloatArray) -> FollowedPath:
    u = _ways(arm, places, postures)
    return FollowedPath(spline_through(postures, u), spline_through(places[:, None], u))


def _ways(arm: JointedArm, places: FloatArray, postures: FloatArray) -> FloatArray:
    """u of each posture (m,): way of the tip in shares of its path, and of the joints [rad, reaches]."""
    steps = np.linalg.norm(np.diff(postures, axis=0) / _scale(arm), axis=1) + np.diff(places)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _scale(arm: JointedArm) -> FloatArray:
    return np.where(arm.chain.revolute > 0.5, 1.0, arm.reach)


@dataclass(frozen=True, slots=True, eq=False)
class _Follower:
    arm: JointedArm
    path: PathOfTip
    task: int
    tolerance: float

    def along(self, start: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places (m,) and postures (m, n) from one end to the other."""
        q, missed = self._posture(0.0, start)
        if missed:
            raise CartesianPathError(self._why(0.0, q, missed))
        places, postures, step = [0.0], [q], _FIRST_STEP
        ends = [*self.path.breaks, 1.0]
        while places[-1] < 1.0:
            here, last = places[-1], postures[-1]
            there = min(here + step, next(end for end in ends if end > here))
            between = 0.5 * (here + there)
            middle, missed = self._posture(between, last)
            q, missed_then = self._posture(there, middle)
            missed = missed or missed_then
            if not missed and self._is_smooth(last, middle, q, between):
                step = min(2.0 * step, _FIRST_STEP)
                places += [between, there]
                postures += [middle, q]
            elif step > _SHORTEST_STEP:
                step *= 0.25
            elif missed:
                raise CartesianPathError(self._why(there, q, missed))
            else:
                self._turn_at_rest(there, q, places, postures)
        return np.array(places), np.array(postures)

    def beside(self, followed: FollowedPath, places: FloatArray, postures: FloatArray) -> tuple[FloatArray, float]:
        """After which postures (m - 1,) the spline leaves the path, and by how much at most."""
        u = _ways(self.arm, places, postures)
        middles = 0.5 * (u[1:] + u[:-1])
        off = np.array([self._off(followed.joints.at(v)[0], followed.share(float(v))) for v in middles])
        return np.asarray(off > self.tolerance), float(off.max())

    def finer(self, places: FloatArray, postures: FloatArray, after: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same with postures put in `after` those marked."""
        new_places, new_postures = [places[0]], [postures[0]]
        for k in range(1, len(places)):
            if after[k - 1]:
                middle = 0.5 * (places[k - 1] + places[k])
                q, missed = 0.5 * (postures[k - 1] + postures[k]), ""
                if self._off(q, middle) > _AS_GOOD * self.tolerance:
                    q, missed = self._posture(middle, q)
                if not missed:
                    new_places.append(middle)
                    new_postures.append(q)
            new_places.append(places[k])
            new_postures.append(postures[k])
        return np.array(new_places), np.array(new_postures)

    def _is_smooth(self, first: FloatArray, middle: FloatArray, last: FloatArray, between: float) -> bool:
        """Whether three postures lie on one branch: no joint runs far, and the middle one is in the middle.

        Close to a singular posture a step may lead across it to another branch without running far. That is as good if
        the way between keeps to the path.
        """
        scale = _scale(self.arm)
        run = float(np.max(np.abs(last - first) / scale))
        bend = float(np.max(np.abs(middle - 0.5 * (first + last)) / scale))
        if run <= 2.0 * _JOINT_STEP and bend <= _BEND * run + 1e-6:
            return True
        return run <= 2.0 * _JOINT_STEP and self._off(0.5 * (first + last), between) <= _AS_GOOD * self.tolerance

    def _turn_at_rest(self, there: float, q: FloatArray, places: list[float], postures: list[FloatArray]) -> None:
        """Go from the last posture to q while the tip is as good as at rest."""
        last, here = postures[-1], places[-1]
        run = np.abs(q - last) / _scale(self.arm)
        count = int(np.ceil(np.max(run) / _JOINT_STEP))
        rows = [last + share * (q - last) for share in np.arange(1, count + 1) / count]
        worst = max(self._off(row, there) for row in rows)
        if worst > self.tolerance:
            joint = self.arm.joint_names[int(np.argmax(run))]
            raise CartesianPathError(
                f"at {100.0 * there:.0f} % of the path {joint} would have to jump by {np.max(run):.2g}, and the tip "
                f"would leave the path by {worst:.2g} m or rad meanwhile"
            )
        places += [here + share * (there - here) for share in np.arange(1, count + 1) / count]
        postures += rows

    def _posture(self, place: float, near: FloatArray) -> tuple[FloatArray, str]:
        """The posture at a place of the path, and by how much it is missed, in words; empty where it is reached."""
        arm, reach = self.arm, self.arm.reach
        settings = SearchSettings(1e-8 * reach, 1e-8, 1e-12 * reach**2, 0.5, 60)
        position, rotation = self.path.pose(place)
        wanted = np.array(rotation)
        if self.task == POINTING:
            wanted[:, 2] = rotation @ arm.chain.tool_axis
        target = TipTarget(self.task, position, wanted, 0.25 * reach)
        q, distance, angle = search(arm.chain, near, arm.lower, arm.upper, target, settings)
        missed = distance > 1e-6 * reach or angle > 1e-6
        return q, f"{distance:.2g} m and {angle:.2g} rad off" if missed else ""

    def _why(self, place: float, q: FloatArray, missed: str) -> str:
        held = np.flatnonzero((q <= self.arm.lower) | (q >= self.arm.upper))
        at_limit = ", ".join(self.arm.joint_names[i] for i in held)
        why = (
            f"{at_limit} at the limit" if at_limit else "it is stretched out, or in a posture that it must turn out of"
        )
        off = f" {missed}" if place == 0.0 else ""
        return f"at {100.0 * place:.0f} % of the path the arm stays behind{off}: {why}"

    def _off(self, q: FloatArray, place: float) -> float:
        """Distance of the tip from a place of the path [m], or angle [rad] where that is larger."""
        position, rotation = self.path.pose(place)
        tip = forward_kinematics(self.arm, q)
        off = float(np.linalg.norm(tip.position - position))
        if self.task == POSE:
            return max(off, float(Rotation.from_matrix(tip.rotation @ rotation.T).magnitude()))
        if self.task == POSITION:
            return off
        return max(off, float(np.linalg.norm(tip.tool_direction - rotation @ self.arm.chain.tool_axis)))
