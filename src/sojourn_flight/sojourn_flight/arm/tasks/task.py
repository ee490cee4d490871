"""What a task is: a value that looks at the arm at every period, and says what is to be done and how it stands."""

from dataclasses import dataclass, field
from typing import Literal, NamedTuple, Protocol, TypeAlias

from sojourn_flight.arm.force_control import ForceControlParams
from sojourn_flight.arm.goals import ArmGoal
from sojourn_flight.arm.kinematics import TipPose
from sojourn_flight.arm.phases import ArmStatus
from sojourn_machine.params import FloatArray

DoingState: TypeAlias = Literal["moving", "reached", "failed", "stopped"]
"""How a task stands."""


class ToolReading(NamedTuple):
    """The tool's actuator as measured."""

    position: float
    """[rad or m]"""
    rate: float
    effort: float
    """[N m or N]"""


class ToolCommand(NamedTuple):
    """What the tool's actuator is told: by position or by rate, as it is made, with the effort that it may use."""

    position: float = 0.0
    rate: float = 0.0
    effort: float = 0.0


@dataclass(frozen=True, slots=True)
class TaskView:
    """What a task sees at one period."""

    tip: TipPose
    """Measured, in base_link."""
    feels: bool
    """Whether the wrist's sensor has told its wrench; if not, force and wrench are zero."""
    force: FloatArray
    """Of the ground on the tool in base_link, (3,) [N]."""
    wrench: FloatArray
    """As measured, less bias and weight of the tool, in the sensor's frame (6,) [N], [N m]."""
    efforts: FloatArray | None
    """Of the joints as measured, (n,) [N m]; None where nobody tells them."""
    positions: FloatArray
    """Of the joints as measured, (n,) [rad or m]."""
    gravity: FloatArray
    """In base_link, (3,) [m/s2]."""
    status: ArmStatus
    """What has become of the last goal that was given to the arm."""
    reason: str
    control: ForceControlParams
    tool: ToolReading | None = None
    """None where there is no tool, or nobody tells it."""


@dataclass(frozen=True, slots=True)
class Doing:
    """What is to be done in this period, and how the task stands."""

    goal: ArmGoal | None = None
    """To be given to the arm now."""
    velocity: FloatArray | None = None
    """Of the tip's reference in base_link (3,) [m/s]; None: the arm is not guided."""
    state: DoingState = "moving"
    reason: str = ""
    progress: float = 0.0
    """0 to 1."""
    time_to_go: float = 0.0
    """[s]"""
    figures: dict[str, float] = field(default_factory=dict)
    """What the operator is told besides, by name with its unit."""
    bias: FloatArray | None = None
    """New bias of the wrist's sensor (6,), where the task has found one."""
    gives_way: bool = False
    """The arm is to give way to whatever it feels."""
    tool: ToolCommand | None = None
    """For the tool's actuator; None: it goes on with what it was told last."""


class Task(Protocol):
    """A task under way. It is called on after it has ended, to hold what it has reached."""

    def advance(self, view: TaskView, dt: float) -> tuple["Task", Doing]:
        """One period of `dt` [s]: the task that goes on, as a rule itself, and what is to be done."""
