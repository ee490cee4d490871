"""What the arm node's laws take in, remember and give out: plain values, one of each per control period."""

from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.dead_joints import DeadJoint
from sojourn_flight.arm.goal_events import GoalEvent
from sojourn_flight.arm.goals import ArmGoal
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.phases import ArmStatus, Moving, Phase, Waiting, status_of
from sojourn_flight.arm.relief import Ground
from sojourn_flight.arm.tasks.tip_motion import TipMotion
from sojourn_flight.arm.trajectory import JointReference, at_rest
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class Granted:
    """What the power manager lets the arm draw."""

    power: float | None = None
    """[W], if that is less than its own limit."""
    current: float = 1.0
    """Share of its largest current that each motor may draw, and so of its torque."""


EVERYTHING = Granted()


@dataclass(frozen=True, slots=True)
class ArmInput:
    """What the arm node knows at one period. Arrays in the order of `ArmParams.joint_names`."""

    positions: FloatArray  # measured (n,) [rad or m]
    velocities: FloatArray  # measured (n,) [rad/s or m/s]
    gravity_in_base: FloatArray  # (3,) [m/s2], pointing down
    goal: ArmGoal | None = None  # a new goal, in the period in which it arrives
    allowed: bool = True
    not_allowed_reason: str = ""
    ground: Ground | None = None
    granted: Granted = EVERYTHING
    feels: bool = False  # what touches a link is felt, and ends a motion: a joint that stays behind is not blocked
    guide: TipMotion | None = None  # reference that a task gives for this period, in place of a planned motion


@dataclass(frozen=True, slots=True)
class Target:
    """Where the present goal ends."""

    joints: FloatArray
    """Positions (n,) [rad or m]."""
    tip: FloatArray
    """Position in base_link (3,) [m]."""
    retreat: FloatArray | None = None
    """Joint positions (n,) by which it is left again."""


@dataclass(frozen=True, slots=True)
class ArmState:
    """All that the arm node remembers. Arrays are replaced, never written to."""

    phase: Phase
    reference: JointReference
    target: Target
    trim: FloatArray
    """(n,) [rad or m]"""
    part_done: float = 0.0
    """Of the motion of the last goal when it was cut off, 0 to 1; 1 where it was not."""
    reason: str = ""
    was_allowed: bool = True
    """In the last period."""
    granted: Granted = EVERYTHING
    """In the last period."""
    dead: tuple[DeadJoint, ...] = ()
    """Joints that do not do as they are told."""

    @property
    def started(self) -> bool:
        """Whether it is known where the arm is."""
        return not isinstance(self.phase, Waiting)

    @property
    def status(self) -> ArmStatus:
        """In the words of the operator's status."""
        return status_of(self.phase)

    @property
    def progress(self) -> float:
        """Part of the motion of the last goal that is done, 0 to 1; a stop does not add to it."""
        if not isinstance(self.phase, Moving):
            return self.part_done
        return min(self.phase.clock.time / max(self.phase.plan.path.duration, 1e-9), 1.0)

    @property
    def way_out(self) -> FloatArray | None:
        """The posture (n,) by which it must leave: at its target, on its last stretch to it, or just leaving one."""
        if isinstance(self.phase, Moving):
            plan, time = self.phase.plan, self.phase.clock.time
            if time < plan.leave_time:
                return plan.leave
            if time < plan.retreat_time:
                return None
        return self.target.retreat


@dataclass(frozen=True, slots=True)
class ArmOutput:
    """Command of one period, and the status. Arrays in the order of `ArmParams.joint_names`."""

    positions: FloatArray  # (n,) [rad or m], reference and trim
    velocities: FloatArray  # (n,) [rad/s or m/s]
    efforts: FloatArray  # feed-forward (n,) [N m or N]
    status: ArmStatus
    progress: float  # 0 to 1, of the time of the motion; of one that was stopped what had been done by then
    time_to_go: float  # [s]
    reason: str
    tip_in_base: FloatArray  # measured tip position (3,) [m]
    tool_direction_in_base: FloatArray  # measured (3,)
    goal_error: float  # measured tip to the goal's tip position [m]
    joint_error: float  # largest difference of a measured joint from its target [rad or m]
    events: tuple[GoalEvent, ...] = ()
    """What became of goals in this period."""
    failed_joints: str = ""
    """Those that do not do as they are told, in words."""


def initial_state(params: ArmParams) -> ArmState:
    """State before the first step."""
    zero = np.zeros(params.joint_count)
    return ArmState(Waiting(), at_rest(zero), Target(zero, np.zeros(3)), zero)
