"""The arm's laws with named tasks over them: one call of `step` a control period, in place of `controller.step`.

A task is started by a TaskRequest. It either gives goals to the arm, which plans and checks them as those of an
operator, or guides the reference of the tip by what the wrist's sensor feels. One goal at a time: a task that comes
while another goal is under way is refused, or replaces it if it asks to; any other goal that is taken, and a stop,
replaces a task. A task that has ended goes on holding what it has reached (a contact force) until the next goal.

A guided motion is given up when the contact force exceeds `max_force` (the tool then gives way until it presses no
more), when the joints are further than `following_error_limit` from their reference, when the tip cannot follow, and
when the arm may not move (it then stops).

A pause brings a planned motion to rest on its path, and the tip of a guided one; the task stands still meanwhile.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from sojourn_mechanics.arm import controller
from sojourn_mechanics.arm.goals import ArmGoal, GoalRefusedError, PauseGoal, PoseGoal, ResumeGoal, StopGoal
from sojourn_mechanics.arm.kinematics import forward_kinematics
from sojourn_mechanics.arm.model import ArmModel
from sojourn_mechanics.arm.params import ArmParams
from sojourn_mechanics.arm.state import ArmInput, ArmOutput, ArmState
from sojourn_mechanics.arm.tasks.contact_sense import ContactSense, check_wrench, contact_sense
from sojourn_mechanics.arm.tasks.ended import Ended, Released
from sojourn_mechanics.arm.tasks.requests import Pause, Resume, TaskRequest
from sojourn_mechanics.arm.tasks.start import start_task
from sojourn_mechanics.arm.tasks.task import Doing, Look, Task, ToolCommand, ToolReading
from sojourn_mechanics.arm.tasks.tip_motion import CannotFollowError, TipMotion, begin, move
from sojourn_mechanics.arm.tool_params import ToolParams
from sojourn_mechanics.params import FloatArray

_PAUSED = "paused; the task resume goes on"


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


@dataclass(frozen=True, slots=True)
class TaskState:
    """All that the laws remember: those of the arm, and the task."""

    arm: ArmState
    sense: ContactSense
    tool: ToolParams | None = None
    """At the arm's end."""
    tool_command: ToolCommand = field(default_factory=ToolCommand)
    """For its actuator."""
    name: str = ""
    task: Task | None = None
    doing: Doing = field(default_factory=Doing)
    motion: TipMotion | None = None
    accepted: int = 0
    """Tasks taken, less the goals that tasks have given to the arm."""
    refused: int = 0
    paused: bool = False
    """Of a guided motion; that of a planned one is in `arm`."""


@dataclass(frozen=True, slots=True)
class TaskReport:
    """How the present task stands."""

    name: str
    doing: Doing


def initial_state(params: ArmParams, model: ArmModel, tool: ToolParams | None = None) -> TaskState:
    """State before the first step, of an arm with a tool or without."""
    return TaskState(controller.initial_state(params), contact_sense(model), tool)


def warm_up(params: ArmParams, model: ArmModel) -> None:
    """Have every compiled kernel ready, so that no later step waits for the compiler (seconds)."""
    start = np.array(params.named_poses["unfold"])
    tip = forward_kinematics(model, start).position
    goal = PoseGoal((float(tip[0]), float(tip[1]), float(tip[2])))
    rest, level = np.zeros(model.joint_count), np.array([0.0, 0.0, -1.0])
    state = initial_state(params, model)
    for request in (goal, StopGoal(), None):
        state, _, _ = step(params, model, state, TaskInput(ArmInput(start, rest, level, goal=request)), 0.02)


def step(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, dt: float
) -> tuple[TaskState, ArmOutput, TaskReport | None]:
    """One control period of `dt` [s]. The report is None where the last goal was no task.

    Raises:
        InvalidValueError: a measurement of wrong length or not finite.
    """
    check_wrench(inputs.wrench)
    goal, refusal = inputs.arm.goal, ""
    if goal is None and isinstance(inputs.task, Pause | Resume):
        state, goal, refusal = _pause(state, isinstance(inputs.task, Pause))
    elif goal is None:
        state, refusal = _take_task(params, model, state, inputs)
    if goal is None:
        state, goal = _work(params, model, state, inputs, dt)
    asked = replace(inputs.arm, goal=goal, guide=state.motion)
    arm, output = controller.step(params, model, state.arm, asked, dt)
    taken = arm.goals_accepted - state.arm.goals_accepted
    refused = arm.goals_refused - state.arm.goals_refused
    state = replace(state, arm=arm)
    if inputs.arm.goal is not None:
        if taken:
            state = replace(state, name="", task=None, motion=None, paused=False)
    elif goal is not None and not isinstance(goal, PauseGoal | ResumeGoal):  # of the task
        state = replace(state, accepted=state.accepted - taken, refused=state.refused - refused)
        if refused:
            state = _give_up(state, Ended(arm.reason))
    output = replace(
        output,
        goals_accepted=output.goals_accepted + state.accepted,
        goals_refused=output.goals_refused + state.refused,
        reason=refusal or output.reason,
    )
    if state.paused:
        resting = not np.any(output.velocities)
        output = replace(output, status="paused" if resting else "moving", reason=refusal or _PAUSED)
    told = state.task is not None and not (state.paused or arm.paused)
    return state, output, TaskReport(state.name, state.doing) if told else None


def _pause(state: TaskState, begin: bool) -> tuple[TaskState, ArmGoal | None, str]:
    """Pause or go on: a guided motion here, a planned one by a goal for the arm; else why not."""
    if state.motion is None:
        return state, PauseGoal() if begin else ResumeGoal(), ""
    if begin == state.paused:
        why = "pause: the motion is paused already" if begin else "resume: no motion is paused"
        return replace(state, refused=state.refused + 1), None, why
    return replace(state, paused=begin, accepted=state.accepted + 1), None, ""


def _take_task(params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput) -> tuple[TaskState, str]:
    """Start the task that has come, if one has; else why it is refused."""
    request = inputs.task
    if request is None:
        return state, ""
    try:
        if not inputs.arm.allowed:
            raise GoalRefusedError(f"not allowed to move: {inputs.arm.not_allowed_reason or 'no reason given'}")
        under_way = _under_way(state)
        if under_way and not request.preempt:
            raise GoalRefusedError(f"{request.task}: {under_way} is under way (preempt: true would replace it)")
        posture = state.arm.reference.position if state.arm.started else inputs.arm.positions
        feels, ground = inputs.wrench is not None, inputs.arm.ground
        gravity = float(np.linalg.norm(inputs.arm.gravity_in_base))
        task = start_task(params, model, request, posture, feels, ground, state.tool, gravity)
    except GoalRefusedError as error:
        return replace(state, refused=state.refused + 1), str(error)
    return replace(state, name=request.task, task=task, doing=Doing(), accepted=state.accepted + 1, paused=False), ""


def _under_way(state: TaskState) -> str:
    """What the arm is at, in words; empty where it is at nothing."""
    if state.task is not None and not state.arm.paused:
        return state.name if state.doing.state == "moving" else ""
    return "another goal" if state.arm.path is not None or state.arm.settling else ""


def _work(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, dt: float
) -> tuple[TaskState, ArmGoal | None]:
    """Let the task look; the reference of the tip that it guides, or the goal that it gives to the arm."""
    if state.task is None or not state.arm.started:
        return state, None
    look = _look(params, model, state, inputs)
    if state.doing.state == "moving":
        state = _guard(params, model, state, inputs, look)
    if state.paused and state.motion is not None and not isinstance(state.task, Ended | Released):
        still = move(model, state.motion, np.zeros(3), params.force_control.tip_acceleration, dt)
        return replace(state, motion=still), None
    if state.arm.paused:
        return state, None
    task, doing = state.task.advance(look, dt) if state.task is not None else (None, Doing())
    sense = state.sense if doing.bias is None else replace(state.sense, bias=state.sense.bias + doing.bias)
    state = replace(state, task=task, sense=sense, doing=doing, tool_command=doing.tool or state.tool_command)
    if doing.velocity is None:
        stop = StopGoal() if state.motion is not None and doing.goal is None else None
        return replace(state, motion=None), doing.goal or stop
    motion = state.motion or begin(model, state.arm.reference)
    try:
        moved = move(model, motion, doing.velocity, params.force_control.tip_acceleration, dt)
    except CannotFollowError as error:
        return _give_up(state, Ended(str(error))), StopGoal()
    return replace(state, motion=moved), None


def _guard(params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, look: Look) -> TaskState:
    """Give up a task under way where the arm may not go on."""
    if not inputs.arm.allowed:
        return replace(state, task=Ended(f"not allowed to move: {inputs.arm.not_allowed_reason}"))
    if state.motion is None:
        return state
    force = float(np.linalg.norm(look.force))
    if force > params.force_control.max_force:
        reason = f"contact force {force:.0f} N: at most {params.force_control.max_force:g} N is allowed"
        return replace(state, task=Released(reason, -look.force / force))
    behind = np.abs(state.arm.reference.position + state.arm.trim - inputs.arm.positions)
    worst = int(np.argmax(behind))
    if behind[worst] > params.following_error_limit:
        name = params.joint_names[worst]
        off = f"{behind[worst]:.3f} {model.unit(worst)}"
        return replace(state, task=Ended(f"{name} is {off} from its reference: something holds it"))
    return state


def _give_up(state: TaskState, ended: Ended) -> TaskState:
    return replace(state, task=ended, motion=None, paused=False, doing=Doing(state="failed", reason=ended.reason))


def _look(params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput) -> Look:
    arm = inputs.arm
    tip = forward_kinematics(model, arm.positions)
    force, rest = np.zeros(3), np.zeros(6)
    if inputs.wrench is not None:
        force = state.sense.contact(model, tip, inputs.wrench, arm.gravity_in_base)
        rest = inputs.wrench - state.sense.bias - state.sense.tool_load(model, tip, arm.gravity_in_base)
    return Look(
        tip=tip,
        feels=inputs.wrench is not None,
        force=force,
        wrench=rest,
        efforts=inputs.efforts,
        positions=arm.positions,
        gravity=arm.gravity_in_base,
        status=state.arm.status,
        reason=state.arm.reason,
        control=params.force_control,
        tool=inputs.tool,
    )
