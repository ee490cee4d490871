"""Named tasks that an operator may ask of the arm, with their numbers, and how they are read from texts.

Every task has the key `preempt`: whether it replaces a goal that is under way (true) or is refused while there is one
(false). Directions are in base_link; a direction that is left out is that of the tool.

A task is a kind (`names.TASKS`): a request with its numbers, registered by an entry point of the group
`sojourn.arm_tasks`, which begins a `Task`. Those here are ours; what begins them (`start`) takes a while to load.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeAlias

from pydantic import BeforeValidator, Field, ValidationError

from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.tasks.names import TASKS
from sojourn_machine.errors import UnknownNameError
from sojourn_machine.params import Params

if TYPE_CHECKING:
    from sojourn_flight.arm.tasks.start import Beginning
    from sojourn_flight.arm.tasks.task import Task


def _numbers(value: object) -> object:
    """A text of numbers with spaces or commas between them as a tuple."""
    return tuple(value.replace(",", " ").split()) if isinstance(value, str) else value


def _unit(value: tuple[float, float, float]) -> tuple[float, float, float]:
    length = math.hypot(*value)
    if length < 1e-6:
        raise ValueError("allowed is a vector that has a length")
    return value[0] / length, value[1] / length, value[2] / length


Coordinate = Annotated[float, Field(ge=-100.0, le=100.0)]
Vector = Annotated[tuple[Coordinate, Coordinate, Coordinate], BeforeValidator(_numbers)]


class TaskRequest(Params):
    """What every task has."""

    task: ClassVar[str] = ""
    preempt: bool = Field(default=False, description="replace a goal that is under way, instead of being refused")

    def begin(self, beginning: "Beginning") -> "Task":
        """The task that is asked for.

        Raises:
            GoalRefusedError: it needs what this arm has not, or a line that it cannot follow.
        """
        raise GoalRefusedError(f"{self.task}: this arm has no law for it")


class Unfold(TaskRequest):
    """Go to the pose 'unfold'."""

    task: ClassVar[str] = "unfold"

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.named_pose(self, beginning)


class Stow(TaskRequest):
    """Go to the pose 'stow'."""

    task: ClassVar[str] = "stow"

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.named_pose(self, beginning)


class Place(TaskRequest):
    """Place the tip at a target, the tool coming along a direction."""

    task: ClassVar[str] = "place"
    position: Vector = Field(description="of the tip in base_link [m]")
    direction: Vector | None = Field(default=None, description="of the tool in base_link; free if left out")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.place(self, beginning)


class Tare(TaskRequest):
    """Take what the wrist's sensor reads, less the known weight of the tool, for its bias: the tool hanging free."""

    task: ClassVar[str] = "tare"
    seconds: float = Field(default=1.0, ge=0.1, le=60.0, description="over which the readings are averaged [s]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.tare(self, beginning)


class GuardedMove(TaskRequest):
    """Advance until the tool presses with a force, then stop and stay in touch."""

    task: ClassVar[str] = "guarded_move"
    direction: Vector | None = Field(
        default=None, description="of the advance in base_link; that of the tool if left out"
    )
    speed: float = Field(default=0.01, ge=0.001, le=0.05, description="of the tip [m/s]")
    force: float = Field(default=10.0, ge=2.0, le=60.0, description="contact force at which it stops [N]")
    distance: float = Field(default=0.1, ge=0.005, le=0.5, description="after which it gives up [m]")
    retract: float = Field(default=0.0, ge=0.0, le=0.5, description="distance to back off afterwards [m]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.guarded_move(self, beginning)


class HoldForce(TaskRequest):
    """Press with a force for a time; a tool that does not touch looks for the ground first."""

    task: ClassVar[str] = "hold_force"
    direction: Vector | None = Field(
        default=None, description="to press along, in base_link; that of the tool if left out"
    )
    force: float = Field(default=10.0, ge=2.0, le=60.0, description="to hold [N]")
    seconds: float = Field(default=5.0, ge=0.0, le=3600.0, description="for which it is held within the tolerance [s]")
    tolerance: float = Field(default=2.0, ge=0.5, le=20.0, description="of the force [N]")
    distance: float = Field(default=0.05, ge=0.0, le=0.5, description="the tip may move along the direction [m]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.hold_force(self, beginning)


class Dig(TaskRequest):
    """Touch the ground, push the tool in, drag it and lift it out."""

    task: ClassVar[str] = "dig"
    direction: Vector | None = Field(
        default=None, description="into the ground, in base_link; that of the tool if left out"
    )
    along: Vector | None = Field(default=None, description="of the furrow, in base_link; towards the rover if left out")
    depth: float = Field(default=0.02, gt=0.0, le=0.2, description="below the place where the ground is felt [m]")
    length: float = Field(default=0.08, gt=0.0, le=0.5, description="of the furrow [m]")
    speed: float = Field(default=0.01, ge=0.001, le=0.05, description="of the tip [m/s]")
    force: float = Field(default=40.0, ge=5.0, le=70.0, description="most that it may press with [N]")
    distance: float = Field(default=0.1, ge=0.005, le=0.5, description="within which the ground must be found [m]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.dig(self, beginning)


class Dump(TaskRequest):
    """Open the scoop where it is, let what is in it fall, and shut it."""

    task: ClassVar[str] = "dump"
    seconds: float = Field(default=1.0, ge=0.1, le=60.0, description="for which it stays open [s]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.dump(self, beginning)


class Weigh(TaskRequest):
    """Weigh what is carried at the tip, from the joint torques in several postures."""

    task: ClassVar[str] = "weigh"
    seconds: float = Field(default=2.0, ge=0.2, le=60.0, description="over which torques are averaged in a posture [s]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.weigh(self, beginning)


class Pause(TaskRequest):
    """Come to rest on the path of the motion that is under way."""

    task: ClassVar[str] = "pause"


class Resume(TaskRequest):
    """Go on with what was paused."""

    task: ClassVar[str] = "resume"


class Drill(TaskRequest):
    """Drill a hole: touch, spin up, press with a force down to a depth, come out."""

    task: ClassVar[str] = "drill"
    direction: Vector | None = Field(
        default=None, description="into the ground, in base_link; that of the tool if left out"
    )
    depth: float = Field(default=0.02, gt=0.0, le=0.5, description="of the hole below the place of the touch [m]")
    force: float = Field(default=30.0, ge=2.0, le=70.0, description="weight on the bit [N]")
    rate: float | None = Field(
        default=None, gt=0.0, le=500.0, description="of the spindle; the drill's own if left out"
    )
    speed: float = Field(default=0.01, ge=0.001, le=0.05, description="of the tip until it touches, and out [m/s]")
    patience: float = Field(default=20.0, ge=1.0, le=3600.0, description="without progress, after which it ends [s]")
    distance: float = Field(default=0.1, ge=0.005, le=0.5, description="within which the ground must be found [m]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.drill(self, beginning)


class Pick(TaskRequest):
    """Take an object with the gripper: open, come from above, close, lift."""

    task: ClassVar[str] = "pick"
    position: Vector = Field(description="of the object's middle in base_link [m]")
    direction: Vector = Field(default=(0.0, 0.0, -1.0), description="of the approach, in base_link")
    force: float = Field(default=10.0, gt=0.0, le=1e4, description="grasp force of a finger [N]")
    lift: float = Field(default=0.1, ge=0.01, le=0.5, description="height by which it is lifted [m]")
    speed: float = Field(default=0.02, ge=0.001, le=0.05, description="of the tip on the last way, and up [m/s]")
    mass: float | None = Field(
        default=None, gt=0.0, le=1000.0, description="of the object; with its friction the force is checked before [kg]"
    )
    friction: float | None = Field(default=None, gt=0.0, le=5.0, description="of the object against the fingers [-]")

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.pick(self, beginning)


class Release(TaskRequest):
    """Open the gripper where it is."""

    task: ClassVar[str] = "release"

    def begin(self, beginning: "Beginning") -> "Task":
        """See TaskRequest."""
        from sojourn_flight.arm.tasks import start

        return start.release(self, beginning)


Texts: TypeAlias = Mapping[str, Any]


def parse_task(name: str, values: Texts) -> TaskRequest:
    """Task of a name and of its numbers, which may be texts ("0.01", "0 0 -1", "true").

    Raises:
        GoalRefusedError: an unknown task or key, with those that there are; a number that is missing or not allowed.
    """
    try:
        kind = TASKS.get(name)
    except UnknownNameError:
        raise GoalRefusedError(f"unknown task {name!r}: there are {', '.join(TASKS.names())}") from None
    try:
        request = kind.model_validate(dict(values))
        direction = getattr(request, "direction", None)
        return request if direction is None else request.model_copy(update={"direction": _unit(direction)})
    except ValidationError as error:
        raise GoalRefusedError(_explain(kind, error)) from error
    except ValueError as error:
        raise GoalRefusedError(f"{name}: direction: {error}") from error


def _explain(kind: type[TaskRequest], error: ValidationError) -> str:
    """What is wrong with the numbers of a task, in one line."""
    found = []
    keys = ", ".join(kind.model_fields)
    for problem in error.errors():
        key = ".".join(str(part) for part in problem["loc"][:1])
        if problem["type"] == "extra_forbidden":
            found.append(f"unknown key {key!r} (there are {keys})")
        elif problem["type"] == "missing":
            found.append(f"{key} is missing")
        else:
            field = kind.model_fields[key]
            found.append(f"{key} = {problem['input']!r}: {problem['msg'].lower()} ({field.description})")
    return f"{kind.task}: " + "; ".join(found)
