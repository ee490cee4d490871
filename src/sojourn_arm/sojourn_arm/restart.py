"""An arm whose process was started again: it knows which joints do not do as they are told, and which goal was lost."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from sojourn_arm.goals import LastGoal
from sojourn_contract.kept_goal import GOAL, KeptGoal, kept_goal
from sojourn_flight.arm.dead_joints import DeadJoint
from sojourn_flight.arm.model import ArmModel
from sojourn_machine.errors import InvalidValueError

RESTARTED = "the arm was restarted"


def kept_values(dead: Sequence[DeadJoint], goal: LastGoal) -> dict[str, Any]:
    """What the next process is to know, as JSON has it."""
    joints = [{"name": one.name, "position": one.position, "holds": one.holds} for one in dead]
    goal = goal.under_way or goal
    return {"dead": joints, GOAL: KeptGoal(goal.state, goal.reason, goal.stamp)._asdict()}


def dead_of(kept: Mapping[str, Any], model: ArmModel) -> tuple[DeadJoint, ...]:
    """The joints that were kept.

    Raises:
        InvalidValueError: no list of joints of this arm with a finite position each.
    """
    try:
        found = []
        for values in kept["dead"]:
            joint, position = model.joint_names.index(values["name"]), float(values["position"])
            if not math.isfinite(position):
                raise ValueError(position)
            found.append(DeadJoint(joint, values["name"], position, model.unit(joint), bool(values["holds"])))
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidValueError(
            "dead", kept.get("dead"), "joints of this arm, each with name, position, holds"
        ) from error
    return tuple(sorted(found, key=lambda one: one.joint))


def goal_of(kept: Mapping[str, Any]) -> LastGoal:
    """What became of the last goal. Raises InvalidValueError."""
    return LastGoal(*kept_goal(kept).after(RESTARTED), abandoned=True)
