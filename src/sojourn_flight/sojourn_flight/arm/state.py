"""What the arm node's laws take in, remember and give out: plain values, one of each per control period."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from sojourn_flight.arm.goals import ArmGoal
from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.relief import Ground
from sojourn_flight.arm.tasks.tip_motion import TipMotion
from sojourn_flight.arm.trajectory import JointReference, at_rest
from sojourn_machine.params import FloatArray

ArmStatus: TypeAlias = Literal["idle", "moving", "paused", "holding", "refused", "reached", "stopped"]


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
    granted_power: float | None = None  # what the arm may draw now [W], if that is less than its own limit
    granted_current: float = 1.0  # share of its largest current that each motor may draw, and so of its torque
    guide: TipMotion | None = None  # reference that a task gives for this period, in place of a planned motion


@dataclass(frozen=True, slots=True)
class ArmState:
    """All that the arm node remembers. Arrays are replaced, never written to."""

    started: bool
    reference: JointReference
    target: FloatArray  # joint positions of the present goal (n,) [rad or m]
    tip_target: FloatArray  # tip position of the present goal in base_link (3,) [m]
    path: JointPath | None
    path_time: float  # [s]
    stopping: bool  # the path is a stop
    settling: bool  # the path has ended, the joints have yet to arrive
    settled_for: float  # [s]
    settling_for: float  # [s]
    trim: FloatArray  # (n,) [rad or m]
    retreat: FloatArray | None  # joint positions (n,) by which the present target is left again
    retreat_time: float  # from this time on the path [s]
    leave: FloatArray | None  # joint positions (n,) that the path goes through first
    leave_time: float  # when it is there [s]
    part_done: float  # of the motion of the last goal when it was cut off, 0 to 1; 1 where it was not
    status: ArmStatus
    reason: str
    was_allowed: bool
    goals_accepted: int
    goals_refused: int
    rate: float = 1.0  # at which the path is run: 1 as planned, 0 at rest on it (path_clock.py)
    rate_change: float = 0.0  # [1/s]
    rate_fade: int = 0  # periods in which the change may fade (path_clock.py)
    pace: float = 1.0  # the rate that the granted power allows
    paused: bool = False  # the operator has asked for a pause
    granted_power: float | None = None  # of the last period [W]
    granted_current: float = 1.0  # of the last period [-]


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
    goals_accepted: int
    goals_refused: int


def initial_state(params: ArmParams) -> ArmState:
    """State before the first step."""
    zero = np.zeros(params.joint_count)
    return ArmState(
        started=False,
        reference=at_rest(zero),
        target=zero,
        tip_target=np.zeros(3),
        path=None,
        path_time=0.0,
        stopping=False,
        settling=False,
        settled_for=0.0,
        settling_for=0.0,
        trim=zero,
        retreat=None,
        retreat_time=0.0,
        leave=None,
        leave_time=0.0,
        part_done=0.0,
        status="idle",
        reason="",
        was_allowed=True,
        goals_accepted=0,
        goals_refused=0,
    )
