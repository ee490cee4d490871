"""What a role must not lose of its last goal when its process ends."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from sojourn_contract.kept_data import KEEP_EVERY_NS, Kept
from sojourn_machine.errors import InvalidValueError

GOAL = "goal"
"""Its key in what is kept."""
MOVING = "moving"


class KeptGoal(NamedTuple):
    """State and reason of a goal as a status has them, and its stamp [ns]."""

    state: str
    reason: str
    stamp: int

    def after(self, alarm: str) -> "KeptGoal":
        """As a role has it that was started again: one that was under way is lost. alarm: why, in words."""
        if self.state == MOVING:
            return KeptGoal("failed", f"goal lost: {alarm}", self.stamp)
        return self._replace(reason=self.reason or alarm)


def kept_goal(values: Mapping[str, Any]) -> KeptGoal:
    """That of what was kept. Raises InvalidValueError."""
    try:
        goal = values[GOAL]
        return KeptGoal(str(goal["state"]), str(goal["reason"]), int(goal["stamp"]))
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidValueError(GOAL, values.get(GOAL), "a state, a reason and a stamp") from error


def newly_kept(last: Kept | None, stamp: int, to_keep: Callable[[], Mapping[str, Any] | None]) -> Kept | None:
    """What is to be kept at a stamp [ns] in place of the last, None where that stays: every KEEP_EVERY_NS, and at once
    where the goal is another. A role tells of it once a second alone: whoever sent it would not hear what became of it.
    """
    is_time = last is None or abs(stamp - last.stamp) >= KEEP_EVERY_NS
    before = None if last is None else last.values.get(GOAL)
    if not is_time and before is None:
        return None
    values = to_keep()
    if values is None or not (is_time or values.get(GOAL) != before):
        return None
    return Kept(stamp, dict(values))
