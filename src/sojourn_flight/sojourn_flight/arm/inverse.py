"""Joint positions for a wanted tip pose, for any serial arm, with the reason where there are none.

The compiled search of inverse_search.py runs from a given posture and then from points spread over the limits, always
the same ones: the same question has the same answer.

    solved        the pose is reached
    singular      it is reached, but in every posture found the arm has lost a direction of motion there
    collision     it is reached, but every posture found makes the arm run into itself (only if that is looked at)
    limits        it would be reached with joints beyond their limits, which are named
    unreachable   it is not reached; the nearest approach is given
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sojourn_flight.arm.chain import ChainArm
from sojourn_flight.arm.inverse_search import (
    POINTING,
    POSE,
    POSITION,
    SearchSettings,
    TipTarget,
    search_from_many,
    spread,
    turn_into_limits,
)
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.manipulability import SINGULAR, scaled_jacobian
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

Status = Literal["solved", "singular", "collision", "limits", "unreachable"]
Obstruction = Callable[[FloatArray], str]
"""Of joint positions (n,): what is in the way, in words; empty where nothing is."""

STARTS = 100
"""Most starts of one search."""
MORE_WHEN_SINGULAR = 10
"""Answers that are tried after a singular one, or one that collides."""
TOLERANCE = 1.0e-6
"""Accepted error: of position in reaches of the arm, of angle in radians."""
ANGLE_WEIGHT = 0.25
"""Length that one radian counts for, in reaches of the arm."""
_DAMPING, _LARGEST_STEP, _ITERATIONS = 1.0e-9, 0.7, 60
_ANY_TURN = 1.0e6
"""Stands for no limit [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class InverseAnswer:
    """Answer of the inverse kinematics."""

    status: Status
    positions: FloatArray  # (n,) [rad or m]: the solution, or the nearest approach within the limits
    position_error: float  # [m]
    angle_error: float  # [rad]
    smallest_singular_value: float  # of the task's scaled Jacobian at `positions` [-]
    message: str  # empty when solved

    @property
    def reached(self) -> bool:
        """Whether `positions` put the tip where it is wanted."""
        return self.status in ("solved", "singular", "collision")


def pose_goal(
    arm: SerialArm,
    position: FloatArray,
    rotation: FloatArray,
    start: FloatArray | None = None,
    in_the_way: Obstruction | None = None,
) -> InverseAnswer:
    """Tip at `position` (3,) [m] with `rotation` (3, 3), both in the base; `start` (n,) is searched from first."""
    return _solve(arm, POSE, position, rotation, start, in_the_way)


def pointing_goal(
    arm: SerialArm,
    position: FloatArray,
    direction: FloatArray,
    start: FloatArray | None = None,
    in_the_way: Obstruction | None = None,
) -> InverseAnswer:
    """Tip at `position` (3,) [m], tool axis along the unit vector `direction` (3,): roll about it is free."""
    wanted = np.eye(3)
    wanted[:, 2] = direction
    return _solve(arm, POINTING, position, wanted, start, in_the_way)


def position_goal(
    arm: SerialArm, position: FloatArray, start: FloatArray | None = None, in_the_way: Obstruction | None = None
) -> InverseAnswer:
    """Tip at `position` (3,) [m], turned any way."""
    return _solve(arm, POSITION, position, np.eye(3), start, in_the_way)


def task_jacobian(arm: ChainArm, task: int, jacobian: FloatArray, tool_direction: FloatArray) -> FloatArray:
    """Rows of the scaled Jacobian (6, n) that a task asks for."""
    scaled = scaled_jacobian(arm, jacobian)
    if task == POSITION:
        return scaled[:3]
    if task == POSE:
        return scaled
    across = np.linalg.svd(tool_direction[None, :])[2][1:]  # two directions square to the tool
    return np.vstack([scaled[:3], across @ scaled[3:]])


def _solve(
    arm: SerialArm,
    task: int,
    position: FloatArray,
    wanted: FloatArray,
    start: FloatArray | None,
    in_the_way: Obstruction | None,
) -> InverseAnswer:
    if not (np.all(np.isfinite(position)) and np.all(np.isfinite(wanted))):
        raise InvalidValueError("target", (position.tolist(), wanted.tolist()), "finite numbers")
    # copies: the compiled search is there for arrays that may be written to, and would be compiled again for others
    question = _Question(arm, task, np.array(position, dtype=np.float64), np.array(wanted, dtype=np.float64, order="C"))
    starts = spread(arm.joint_count, STARTS) * (arm.upper - arm.lower) + arm.lower
    if start is not None:
        starts = np.vstack([start, starts])
    q, distance, angle, index = question.search(starts, arm.lower, arm.upper)
    if index < 0:
        return _explain(question, starts, (q, distance, angle))
    best, best_value, seen = (q, distance, angle), _smallest(arm, task, q), index
    blocked = in_the_way(q) if in_the_way is not None else ""
    for _ in range(MORE_WHEN_SINGULAR):
        if (best_value >= SINGULAR and not blocked) or seen + 1 >= len(starts):
            break
        q, distance, angle, index = question.search(starts[seen + 1 :], arm.lower, arm.upper)
        if index < 0:
            break
        seen, value = seen + 1 + index, _smallest(arm, task, q)
        why_not = in_the_way(q) if in_the_way is not None else ""
        if (not why_not, value) > (not blocked, best_value):
            best, best_value, blocked = (q, distance, angle), value, why_not
    if blocked:
        return InverseAnswer("collision", *best, best_value, f"reached only where the arm collides: {blocked}")
    if best_value < SINGULAR:
        message = f"reached in a singular posture only (smallest singular value {best_value:.1e})"
        return InverseAnswer("singular", *best, best_value, message)
    return InverseAnswer("solved", *best, best_value, "")


@dataclass(frozen=True, slots=True, eq=False)
class _Question:
    arm: SerialArm
    task: int
    target: FloatArray
    wanted: FloatArray

    def search(self, starts: FloatArray, lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, float, float, int]:
        """Joint positions, position error, angle error, and the start that arrived or -1."""
        reach = self.arm.reach
        settings = SearchSettings(TOLERANCE * reach, TOLERANCE, _DAMPING * reach**2, _LARGEST_STEP, _ITERATIONS)
        target = TipTarget(self.task, self.target, self.wanted, ANGLE_WEIGHT * reach)
        found: tuple[FloatArray, float, float, int] = search_from_many(
            self.arm.chain, starts, lower, upper, target, settings
        )
        return found


def _explain(question: _Question, starts: FloatArray, nearest: tuple[FloatArray, float, float]) -> InverseAnswer:
    """Why there is no solution: the limits, or the reach."""
    arm, task = question.arm, question.task
    travel = arm.upper - arm.lower
    turning = arm.chain.revolute > 0.5
    lower = np.where(turning, -_ANY_TURN, arm.lower - 2.0 * travel)
    upper = np.where(turning, _ANY_TURN, arm.upper + 2.0 * travel)
    value = _smallest(arm, task, nearest[0])
    off = f"the nearest approach is {nearest[1]:.4g} m" + ("" if task == POSITION else f" and {nearest[2]:.3g} rad off")
    q, _, _, index = question.search(starts[: STARTS // 2], lower, upper)
    if index < 0:
        return InverseAnswer("unreachable", *nearest, value, f"unreachable: {off}")
    turn_into_limits(arm.chain, arm.lower, arm.upper, q)
    beyond = [
        f"{arm.joint_names[i]} would be {q[i]:.4g} (limits {arm.lower[i]:.4g} to {arm.upper[i]:.4g})"
        for i in range(arm.joint_count)
        if not arm.lower[i] <= q[i] <= arm.upper[i]
    ]
    if not beyond:
        return InverseAnswer("unreachable", *nearest, value, f"not found within {len(starts)} starts: {off}")
    return InverseAnswer("limits", *nearest, value, f"beyond the joint limits: {', '.join(beyond)}; {off}")


def _smallest(arm: SerialArm, task: int, positions: FloatArray) -> float:
    """Smallest singular value of the task's Jacobian [-]."""
    tip = forward_kinematics(arm, positions)
    rows = task_jacobian(arm, task, tip.jacobian, tip.tool_direction)
    return float(np.linalg.svd(rows, compute_uv=False)[-1])
