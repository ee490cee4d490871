"""Who commands the rover in a period: nobody, a goal, or an operator's twist; and how goals begin and end.

A goal ends the older goal; a twist command that came after the goal ends the goal; a stop request ends both. What a
goal will take of the battery, and the obstacles that are known, may refuse it (`energy_forecast`, `avoidance`). A twist
that the machine does not allow is refused as a whole (`allowed_motion`): the rover stands, and says what it can do.
"""

from dataclasses import dataclass, replace

from sojourn_flight.mobility.twist import NO_MOTION, PlanarTwist
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.planning.energy_forecast import EnergyLeft, EnergyUse, account_step, shortage
from sojourn_flight.planning.follower_state import FollowerState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.goal_follower import stop
from sojourn_flight.supervision.avoidance import guarded
from sojourn_flight.supervision.avoidance_types import AvoidanceState
from sojourn_flight.supervision.drive_types import Mode, TwistCommand
from sojourn_flight.supervision.driven_machine import DrivenMachine
from sojourn_flight.supervision.foresight import foresee

WORTH_TELLING = 1e-3
"""Sideways speed by which a twist that is driven differs from the one asked for, and the status says so [m/s]."""


def why_pre_empted(twist: PlanarTwist) -> str:
    """Why a goal ends with an operator's twist, in words: one without motion is a stop."""
    return "stopped by operator" if twist == NO_MOTION else "pre-empted by /cmd_vel"


@dataclass(slots=True)
class Arbiter:
    """What commands the rover in this period; lives within one step only."""

    mode: Mode
    follower: FollowerState | None
    since_override: float
    text: str
    outcomes: list[GoalOutcome]
    energy: EnergyUse
    avoidance: AvoidanceState | None
    twist_refused: bool = False
    """Whether an operator's twist is not driven because the machine does not allow it."""
    waits: bool = False
    """Whether `text` says why a goal on its way does not get on."""

    def end_goal(self, outcome: GoalOutcome, mode: Mode = "idle") -> None:
        """Notes how a goal ended."""
        self.outcomes.append(outcome)
        self.follower = None
        self.mode = mode
        self.text = f"{outcome.kind}: {outcome.reason}"

    def take_stop(self, reason: str) -> None:
        """A stop request ends goal and twist."""
        if self.follower is not None:
            self.end_goal(stop(self.follower, reason))
        self.mode, self.text, self.since_override = "idle", f"stopped: {reason}", 0.0

    def take_goal(self, model: DrivenMachine, goal: Goal, here: OdometryState, supply: EnergyLeft | None) -> None:
        """A new goal ends the older one, unless it is refused."""
        found = foresee(model, self.avoidance, goal, here, supply)
        answer, self.avoidance = found.answer, found.avoidance
        if isinstance(answer, GoalOutcome):
            self.outcomes.append(answer)
            if self.follower is None and self.mode == "idle":
                self.text = f"refused: {answer.reason}"
            return
        if self.follower is not None:
            self.end_goal(stop(self.follower, "pre-empted by a newer goal"))
        judged = found.forecast is None or supply is not None
        self.follower, self.mode, self.since_override = answer, goal.kind, 0.0
        self.energy = EnergyUse(found.forecast, judged=judged)

    def watch_energy(self, model: DrivenMachine, supply: EnergyLeft | None, dt: float) -> None:
        """Count what the goal takes; a goal that came before the first reading of the battery is judged by it."""
        self.energy = account_step(self.energy, supply, self.follower is not None, dt)
        costs, forecast = model.params.energy, self.energy.forecast
        if self.energy.judged or self.follower is None or supply is None or costs is None or forecast is None:
            return
        self.energy = replace(self.energy, judged=True)
        short = shortage(costs, forecast, supply)
        if short is not None:
            way = self.follower
            self.end_goal(GoalOutcome("refused", short, way.goal, way.distance_to_go))

    def take_twist(self, model: DrivenMachine, command: TwistCommand | None, dt: float) -> PlanarTwist:
        """The operator's twist, if it is fresh and newer than the last goal or stop."""
        timeout = model.params.cmd_vel_timeout
        newer = command is not None and command.age < self.since_override - 0.5 * dt
        if command is not None and newer and command.age <= timeout:
            if self.follower is not None:
                self.end_goal(stop(self.follower, why_pre_empted(command.twist)))
            self.mode, self.text = "cmd_vel", "driving by /cmd_vel"
            twist, reason = model.mobility.fit(command.twist)
            self.twist_refused = reason != ""
            if self.twist_refused:
                self.text = f"/cmd_vel: {reason}"
            elif abs(twist.v_y - command.twist.v_y) > WORTH_TELLING:
                self.text += f" at v_y = {twist.v_y:.3f} m/s, as the fixed wheels roll"
            return twist
        if self.mode == "cmd_vel":
            self.mode, self.text = "idle", f"stopped: /cmd_vel is older than {timeout:.2f} s"
        return NO_MOTION

    def keep_clear(self, model: DrivenMachine, wanted: PlanarTwist, here: OdometryState) -> PlanarTwist:
        """The motion wanted, or none where it would lead into an obstacle."""
        if model.avoidance is None or self.avoidance is None or wanted == NO_MOTION:
            return wanted
        self.avoidance, free = guarded(model.avoidance, self.avoidance, wanted, here, by_hand=self.mode == "cmd_vel")
        if free:
            return wanted
        self.text = f"stopped before {self.avoidance.obstacle}"
        return NO_MOTION
