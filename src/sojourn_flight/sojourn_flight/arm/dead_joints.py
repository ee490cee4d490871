"""Joints of the arm that do not do as they are told, and the arm that is left: planned with them where they are.

A joint does not move where it alone is behind its reference by `following_error_limit`, stands still there, and
nothing touches the arm: what blocks the way of a link is felt as a torque from outside (contact_guard.py). So this is
found only where the joints' torques are told. It is then rigid for the arm's kinematics, whose Jacobian has nothing
of it, and has no range but where it is: inverse kinematics, paths, jogs and detours do with the others what they can.

A joint moves by itself where it alone is off its reference at rest by that much, or, once it is known not to move, by
HELD_WITHIN: gear and brake do not hold it, and no motion of the others is allowed.

Assumptions: the drives have power, as `allowed` says; the encoder of the joint sees it (one on the motor does not see
a gear that is broken). A joint goal that names the joint alone is another try of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from sojourn_flight.arm.goals import HELD_WITHIN, ArmGoal, JointGoal
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import FollowingParams
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

_STILL = 0.1
"""A joint stands still below this share of its largest speed [-]."""
_FOLLOWS = 0.5
"""A joint follows below this share of the largest following error [-]."""


@dataclass(frozen=True, slots=True)
class DeadJoint:
    """One joint, by its place in the arm."""

    joint: int
    name: str
    position: float
    """Where it was found [rad or m]."""
    unit: str
    holds: bool = True
    """It stays where it is; else it moves by itself."""

    def text(self) -> str:
        """What is wrong with it, in words."""
        if self.holds:
            return f"{self.name} does not move: held at {self.position:.3f} {self.unit}"
        return f"{self.name} moves by itself: nothing holds it"


def words(dead: Sequence[DeadJoint]) -> str:
    """Of all of them, in words; empty where there are none."""
    return "; ".join(one.text() for one in dead)


def with_words(text: str, dead: Sequence[DeadJoint]) -> str:
    """A reason or a note, and what is wrong with joints."""
    return "; ".join(filter(None, (text, words(dead))))


def refuse_run_away(dead: Sequence[DeadJoint]) -> None:
    """Raises GoalRefusedError where a joint moves by itself: the others may not move it."""
    if any(not one.holds for one in dead):
        raise GoalRefusedError("no motion is planned with a joint that nothing holds")


def stands_still(params: FollowingParams, model: ArmModel, behind: FloatArray, velocities: FloatArray) -> bool:
    """Whether the joint that is furthest behind its reference does not move while all others follow.

    Args:
        behind: sizes of the following errors (n,) [rad or m]. velocities: measured (n,) [rad/s or m/s].
    """
    worst = int(np.argmax(behind))
    others = np.delete(behind, worst)
    follow = bool(np.all(others <= _FOLLOWS * params.following_error_limit))
    return follow and abs(float(velocities[worst])) < _STILL * float(model.max_velocity[worst])


def known_dead(
    dead: tuple[DeadJoint, ...], model: ArmModel, joint: int, at: float, holds: bool
) -> tuple[DeadJoint, ...]:
    """With one more, or with what is now known of one: it is at `at` [rad or m]."""
    found = DeadJoint(joint, model.joint_names[joint], at, model.unit(joint), holds)
    return tuple(sorted((*(one for one in dead if one.joint != joint), found), key=lambda one: one.joint))


def run_away(
    params: FollowingParams, model: ArmModel, dead: tuple[DeadJoint, ...], off: FloatArray, positions: FloatArray
) -> tuple[DeadJoint, ...]:
    """The dead joints after a period at rest, in which one may move by itself.

    Args:
        off: sizes of the joints' errors (n,). positions: measured (n,) [rad or m].
    """
    for one in dead:
        if one.holds and abs(float(positions[one.joint]) - one.position) > HELD_WITHIN:
            dead = known_dead(dead, model, one.joint, float(positions[one.joint]), False)
    worst = int(np.argmax(off))
    alone = bool(np.all(np.delete(off, worst) <= _FOLLOWS * params.following_error_limit))
    if off[worst] > params.following_error_limit and alone and all(one.joint != worst for one in dead):
        dead = known_dead(dead, model, worst, float(positions[worst]), False)
    return dead


def tried_again(dead: tuple[DeadJoint, ...], goal: ArmGoal | None) -> tuple[DeadJoint, ...]:
    """Those that are left when a goal comes: one that names a dead joint alone tries it again."""
    if not isinstance(goal, JointGoal) or len(goal.names) != 1:
        return dead
    return tuple(one for one in dead if one.name != goal.names[0])


def arm_without(model: ArmModel, dead: Sequence[DeadJoint]) -> ArmModel:
    """The arm that is left: dead joints are rigid where they were found. The same model where there are none."""
    if not dead:
        return model
    lower, upper, chain = model.lower.copy(), model.upper.copy(), model.chain
    rotation, translation = chain.rotation.copy(), chain.translation.copy()
    axis, revolute = chain.axis.copy(), chain.revolute.copy()
    for one in dead:
        i, q = one.joint, one.position
        lower[i] = upper[i] = q
        if chain.revolute[i] > 0.5:
            rotation[i] = rotation[i] @ Rotation.from_rotvec(q * axis[i]).as_matrix()
        else:
            translation[i] += rotation[i] @ axis[i] * q
        axis[i], revolute[i] = 0.0, 0.0  # slides along nothing
    rigid = chain._replace(rotation=rotation, translation=translation, axis=axis, revolute=revolute)
    return replace(model, chain=rigid, lower=lower, upper=upper, held=tuple(one.joint for one in dead))
