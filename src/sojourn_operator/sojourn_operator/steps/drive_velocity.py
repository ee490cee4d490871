"""Drive with a velocity for a while, then stop sending it: the drive's own time-out brings the machine to rest."""

from typing import ClassVar

import numpy as np
from pydantic import Field

from sojourn_config.steps import LONGEST
from sojourn_contract.values import Message, TwistStamped
from sojourn_machine.params import Params
from sojourn_operator.steps.step import JOGGED, LEAD_NS, OperatorStep, View

FASTEST = 10.0
TO_REST_S = 2.0
"""After its last word [s]: time-out of the drive, braking, and a status, which comes once a second."""


class DriveVelocityStep(Params, OperatorStep):
    """A velocity that the operator keeps sending for a while: /cmd_vel."""

    role: ClassVar[str] = "drive"
    topic: ClassVar[str] = "/cmd_vel"
    forward: float = Field(default=0.0, ge=-FASTEST, le=FASTEST, description="of base_link, to the front [m/s]")
    left: float = Field(default=0.0, ge=-FASTEST, le=FASTEST, description="of base_link, to the left [m/s]")
    turn: float = Field(default=0.0, ge=-FASTEST, le=FASTEST, description="about the vertical, to the left [rad/s]")
    seconds: float = Field(gt=0.0, le=LONGEST, description="how long [s]")

    def describe(self) -> str:
        """See OperatorStep."""
        return f"drive at {self.forward:g}, {self.left:g} m/s, {self.turn:g} rad/s for {self.seconds:g} s"

    @property
    def stream_s(self) -> float:
        """For how long it has to be said again and again [s]."""
        return self.seconds

    def say(self, view: View) -> Message | None:
        """See OperatorStep."""
        if view.is_over(self.seconds):
            return None
        linear, angular = np.array([self.forward, self.left, 0.0]), np.array([0.0, 0.0, self.turn])
        return TwistStamped(view.stamp, "base_link", linear, angular)

    def end(self, view: View) -> tuple[str, str] | None:
        """When the machine has had the time to stop; at once where the drive refuses it."""
        report = view.reports.get(self.role)
        if report is not None and report.state == "refused" and report.goal_stamp >= view.since + LEAD_NS:
            return report.state, report.reason
        return (JOGGED, "") if view.is_over(self.seconds + TO_REST_S) else None
