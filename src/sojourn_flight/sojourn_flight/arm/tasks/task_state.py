"""What the arm's laws with tasks over them take in, remember and give out: plain values."""

import math
from dataclasses import dataclass, field

from sojourn_flight.arm import state as arm_state
from sojourn_flight.arm.contact_guard import Before, MomentumObserver
from sojourn_flight.arm.footing import FootingLoads
from sojourn_flight.arm.jogging import JogCommand
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.phases import Holding, Waiting
from sojourn_flight.arm.state import ArmInput, ArmState
from sojourn_flight.arm.tasks.activity import Activity, NoTask, motion_of
from sojourn_flight.arm.tasks.contact_sense import ContactSense, contact_sense
from sojourn_flight.arm.tasks.requests import TaskRequest
from sojourn_flight.arm.tasks.task import Doing, ToolCommand, ToolReading
from sojourn_flight.arm.tasks.tip_motion import TipMotion
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import ToolParams


@dataclass(frozen=True, slots=True)
class TaskInput:
    """The arm's measurements, those of its tools, and a goal (in `arm`) or a task."""

    arm: ArmInput
    task: TaskRequest | None = None
    wrench: FloatArray | None = None
    """On the wrist's sensor in its frame (6,) [N], [N m]; None where it is not measured."""
    efforts: FloatArray | None = None
    """Of the joints as measured (n,) [N m]; None where nobody tells them."""
    tool: ToolReading | None = None
    """Of the tool's actuator; None where there is no tool, or nobody tells it."""
    loads: FootingLoads | None = None
    """Of the rover's wheels; None where it stands fast, or nobody knows."""
    jog: JogCommand | None = None
    """In the period in which it takes effect."""


@dataclass(frozen=True, slots=True)
class TaskState:
    """All that the laws remember: those of the arm, and the task."""

    arm: ArmState
    sense: ContactSense
    tool: ToolParams | None = None
    """At the arm's end."""
    tool_command: ToolCommand = field(default_factory=ToolCommand)
    """For its actuator."""
    activity: Activity = field(default_factory=NoTask)
    under_way: bool = False
    """The operator's last goal, be it a task or one of the arm: its end has not been told yet."""
    observer: MomentumObserver = field(default_factory=MomentumObserver)
    """Of torques from outside."""
    known: Before | None = None
    """What was felt when the planned motion under way began; None where none is."""
    since_jog: float = math.inf
    """Since the last jog's command [s]."""

    @property
    def moves(self) -> bool:
        """Whether the arm is told to move, or a task may tell it so at any time."""
        return not isinstance(self.arm.phase, Waiting | Holding) or not isinstance(self.activity, NoTask)

    @property
    def motion(self) -> TipMotion | None:
        """Of the tip's reference; None where none is given to the arm."""
        return motion_of(self.activity)


@dataclass(frozen=True, slots=True)
class TaskReport:
    """How the present task stands."""

    name: str
    doing: Doing


def initial_state(params: ArmParams, model: ArmModel, tool: ToolParams | None = None) -> TaskState:
    """State before the first step, of an arm with a tool or without."""
    return TaskState(arm_state.initial_state(params), contact_sense(model), tool)
