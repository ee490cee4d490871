"""Tip of the arm with a velocity, for a while. It is said again at each look, and zero from the end on until the arm
says that it rests.
"""

import math
from typing import ClassVar

import numpy as np
from pydantic import Field

from sojourn_config.steps import LONGEST
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import Message, TwistStamped
from sojourn_machine.params import Params
from sojourn_operator.steps.step import FINAL_STATES, JOGGED, LEAD_NS, STOPPED, OperatorStep, View

REST = (0.0, 0.0, 0.0)


class ArmJogStep(Params, OperatorStep):
    """A velocity that the operator keeps sending for a while, then zero: /arm/cmd_vel."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/cmd_vel"
    linear: tuple[float, float, float] = Field(default=REST, description="velocity of the tip [m/s]")
    angular: tuple[float, float, float] = Field(default=REST, description="rate of its turn [rad/s]")
    frame: str = Field(
        default="base_link", description="frame of the numbers: base_link, map, odom or the link of the arm's tip"
    )
    seconds: float = Field(gt=0.0, le=LONGEST, description="how long [s]")

    def describe(self) -> str:
        """See OperatorStep."""
        speed, turning = math.hypot(*self.linear), math.hypot(*self.angular)
        return f"jog the arm at {speed:g} m/s, {turning:g} rad/s for {self.seconds:g} s"

    @property
    def stream_s(self) -> float:
        """For how long it has to be said again and again [s]; a zero that is late does no harm."""
        return self.seconds

    def say(self, view: View) -> Message:
        """See OperatorStep."""
        linear, angular = (REST, REST) if view.is_over(self.seconds) else (self.linear, self.angular)
        return TwistStamped(view.stamp, self.frame, np.array(linear), np.array(angular))

    def end(self, view: View) -> tuple[str, str] | None:
        """At rest after its time, or when it is refused."""
        report = view.reports.get(self.role)
        if report is None or report.goal_stamp < view.since + LEAD_NS or report.state not in FINAL_STATES:
            return None
        if report.state != STOPPED:
            return report.state, report.reason
        over = report.goal_stamp >= view.since + round(self.seconds * NANOSECONDS) + LEAD_NS
        return (JOGGED, report.reason) if over else None
