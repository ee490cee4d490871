"""A goal of an action that has gone out as one of the contract: whether it is over, by what its role tells of it."""

from dataclasses import dataclass, replace

from sojourn_contract.stamps import NANOSECONDS
from sojourn_operator.steps.step import FINAL_STATES, REACHED, REFUSED, GoalReport

SUCCEEDED, ABORTED, CANCELED = "succeeded", "aborted", "canceled"
"""Words of action_msgs/GoalStatus for a goal that is over."""
REPLACED, SILENT, BREACH, UNSENT = "replaced", "silent", "breach", "unsent"
"""Causes of an end besides the states of a status."""
SILENT_S = 10.0
"""Simulation time within which a role has told of a goal for certain: statuses come once a second."""


@dataclass(frozen=True)
class Ending:
    """How a goal ended.

    Args:
        word: of the action: SUCCEEDED, ABORTED or CANCELED. cause: state of the status that said so, or one of the
            causes above. reason: in words.
    """

    word: str
    cause: str
    reason: str


@dataclass(frozen=True)
class GoalWatch:
    """Of one goal.

    Args:
        role: that carries it out. stamp: with which it has gone out [ns]. is_known: whether the role has told of it.
        stop: simulation time at which its sender has taken it back by a stop [ns]; None: nobody has.
        heard: simulation time at which the role has told of it last [ns].
    """

    role: str
    stamp: int
    is_known: bool = False
    stop: int | None = None
    heard: int = 0

    def step(self, report: GoalReport | None, now: int, told: int) -> tuple["GoalWatch", Ending | None]:
        """After a look.

        Args:
            report: the last word of the role, None before the first. now: simulation time [ns].
        """
        if report is not None and report.goal_stamp == self.stamp:
            return replace(self, is_known=True, heard=now), _ending_of(report, self.stop is not None)
        # An arm tells of a stop as of a goal, and a stop has no stamp.
        if report is not None and report.goal_stamp == 0 and self.stop is not None and told > self.stop:
            return self, None if report.state == "moving" else Ending(CANCELED, report.state, report.reason)
        # Others' goals may be stamped zero: once this one is known, any other stamp is that of a later one.
        # One that was refused has not taken the place of this one.
        if report is not None and report.state != REFUSED and (self.is_known or report.goal_stamp > self.stamp):
            return self, Ending(ABORTED, REPLACED, f"the {self.role} has been given something else to do")
        if now > max(self.stamp, self.heard) + round(SILENT_S * NANOSECONDS):
            reason = f"the {self.role} has told nothing of it within {SILENT_S:g} s of simulation time"
            return self, Ending(ABORTED, SILENT, reason)
        return self, None


def _ending_of(report: GoalReport, cancelled: bool) -> Ending | None:
    """What a report of the goal itself comes to."""
    if report.state not in FINAL_STATES:
        return None
    if report.state == REACHED:
        return Ending(SUCCEEDED, report.state, report.reason)
    return Ending(CANCELED if cancelled and report.state == "stopped" else ABORTED, report.state, report.reason)
