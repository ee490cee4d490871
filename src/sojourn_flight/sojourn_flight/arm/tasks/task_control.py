"""The arm's laws with named tasks over them: one call of `step` a control period, in place of `controller.step`.

A task is started by a TaskRequest. It either gives goals to the arm, which plans and checks them as those of an
operator, or guides the reference of the tip by what the wrist's sensor feels. One goal at a time: a task that comes
while another goal is under way is refused, or replaces it if it asks to; any other goal that is taken, and a stop,
replaces a task. A task that has ended goes on holding what it has reached (a contact force) until the next goal.

A guided motion is given up when the contact force exceeds `max_force` (the tool then gives way until it presses no
more), when the joints are further than `following_error_limit` from their reference, when the tip cannot follow, and
when the arm may not move (it then stops).

A planned motion is given up when it meets something (contact_guard.py), and any motion that presses when a wheel of the
rover is all but lifted. The arm then gives way to what it feels, until the next goal.

A jog (jogging.py) takes the place of whatever is under way, and is watched for contacts as a planned motion is.

A pause brings a planned motion to rest on its path, and the tip of a guided one; the task stands still meanwhile. Where
less power is granted than it draws, a guided motion is slower, but for giving way.
"""

import numpy as np

from sojourn_flight.arm import controller
from sojourn_flight.arm.contact_guard import (
    JointReading,
    MomentumObserver,
    before,
    faded,
    lifted,
    observe,
    touched,
    yielding_rates,
)
from sojourn_flight.arm.dead_joints import arm_without, refuse_run_away, with_words
from sojourn_flight.arm.deflection import joint_positions
from sojourn_flight.arm.goal_events import ACCEPTED, GoalEvent, was
from sojourn_flight.arm.goals import ArmGoal, PauseGoal, PoseGoal, ResumeGoal, StopGoal
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.pace import granted_velocity
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.phases import Moving, Paused, Pausing, Settling, is_busy
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmInput, ArmOutput
from sojourn_flight.arm.tasks.activity import GuidedTask, Jog, NoTask, PausedTask, RunningTask, motion_of, name_of
from sojourn_flight.arm.tasks.at_rest import moves, posture_at_rest
from sojourn_flight.arm.tasks.contact_sense import check_wrench
from sojourn_flight.arm.tasks.ended import Ended, Released, given_up
from sojourn_flight.arm.tasks.guided_pace import GuidedPace, next_pace, pace_limits
from sojourn_flight.arm.tasks.jog_control import go_on_with_jog, take_jog
from sojourn_flight.arm.tasks.joint_watch import feel, held_back, without_dead
from sojourn_flight.arm.tasks.outcome import report_of, with_outcome
from sojourn_flight.arm.tasks.relaxed import Relaxed
from sojourn_flight.arm.tasks.requests import Pause, Resume, TaskRequest
from sojourn_flight.arm.tasks.start import Beginning
from sojourn_flight.arm.tasks.task import Doing, Task, TaskView
from sojourn_flight.arm.tasks.task_state import TaskInput, TaskReport, TaskState, initial_state
from sojourn_flight.arm.tasks.tip_motion import (
    CannotFollowError,
    TipMotion,
    begin,
    begin_at,
    move,
    rates_of,
    turn_joints,
)
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

__all__ = ["TaskInput", "TaskReport", "TaskState", "initial_state", "step", "warm_up"]


def warm_up(params: ArmParams, model: ArmModel) -> None:
    """Have every compiled kernel ready, so that no later step waits for the compiler (seconds)."""
    start = np.array(params.named_poses["unfold"])
    tip = forward_kinematics(model, start).position
    goal = PoseGoal((float(tip[0]), float(tip[1]), float(tip[2])))
    rest, level = np.zeros(model.joint_count), np.array([0.0, 0.0, -1.0])
    state = initial_state(params, model)
    for request in (goal, StopGoal(), None):
        known = ArmInput(start, rest, level, goal=request)
        state, _, _ = step(params, model, state, TaskInput(known, wrench=np.zeros(6), efforts=rest), 0.02)
    controller.warm_up(params, model)


def step(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, dt: float
) -> tuple[TaskState, ArmOutput, TaskReport | None]:
    """One control period of `dt` [s]. The report is None where the last goal was no task.

    Raises:
        InvalidValueError: a measurement of wrong length or not finite.
    """
    check_wrench(inputs.wrench)
    whole, model = model, arm_without(model, state.arm.dead)
    observer = _observe(params, model, state.observer, inputs, dt)
    state = replace(state, observer=observer, since_jog=state.since_jog + dt)
    if state.motion is not None:
        known, state = state.arm.dead, without_dead(params, model, state, inputs)
        model = model if state.arm.dead is known else arm_without(whole, state.arm.dead)
    if _is_watched(state):
        state = _watch(params, model, state, inputs)
    elif state.known is not None:
        state = replace(state, known=None)
    state, goal, answer = _take(params, model, state, inputs)
    if isinstance(state.activity, Jog):
        state = go_on_with_jog(params, model, state, state.activity, inputs, dt)
    elif goal is None:
        state, goal = _work(params, model, state, inputs, dt)
        if answer is ACCEPTED and goal is None and state.motion is None and isinstance(state.arm.phase, Moving):
            goal = StopGoal()  # a task that moves nothing has replaced what was under way
    is_of_task = goal is not None and inputs.arm.goal is None and not isinstance(goal, PauseGoal | ResumeGoal)
    asked = inputs.arm
    feels = inputs.efforts is not None
    if goal is not asked.goal or state.motion is not asked.guide or feels != asked.feels:
        asked = replace(asked, goal=goal, guide=state.motion, feels=feels)
    arm, output = controller.step(params, whole, state.arm, asked, dt)
    state = state if arm is state.arm else replace(state, arm=arm)
    if is_of_task and was("refused", output.events):
        state = replace(state, activity=given_up(name_of(state.activity), arm.reason))
    elif inputs.arm.goal is not None and was("accepted", output.events):
        state = replace(state, activity=NoTask())
    state, output = with_outcome(state, output, answer, is_of_task)
    return state, output, report_of(state)


def _take(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput
) -> tuple[TaskState, ArmGoal | None, GoalEvent | None]:
    """Take what is asked for: a goal for the arm, which will answer it, or a task or a jog, with the answer."""
    if inputs.arm.goal is not None:
        return state, inputs.arm.goal, None
    if inputs.jog is not None:
        state, answer = take_jog(params, model, state, inputs, inputs.jog)
        return state, None, answer
    if inputs.task is None:
        return state, None, None
    if isinstance(inputs.task, Pause | Resume):
        return _pause(state, isinstance(inputs.task, Pause))
    state, answer = _take_task(params, model, state, inputs, inputs.task)
    return state, None, answer


def _pause(state: TaskState, begin: bool) -> tuple[TaskState, ArmGoal | None, GoalEvent | None]:
    """Pause or go on: a guided motion here, a planned one by a goal for the arm."""
    activity = state.activity
    if isinstance(activity, Jog) and activity.motion is not None:
        why = f"{'pause' if begin else 'resume'}: the arm is jogged, and rests where the commands stop"
        return state, None, GoalEvent("refused", why)
    if not isinstance(activity, GuidedTask) or isinstance(activity.task, Released):
        return state, PauseGoal() if begin else ResumeGoal(), None
    if begin == isinstance(activity, PausedTask):
        why = "pause: the motion is paused already" if begin else "resume: no motion is paused"
        return state, None, GoalEvent("refused", why)
    kind = PausedTask if begin else GuidedTask
    known = (activity.name, activity.task, activity.doing, activity.motion, activity.pace)
    return replace(state, activity=kind(*known)), None, ACCEPTED


def _take_task(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, request: TaskRequest
) -> tuple[TaskState, GoalEvent]:
    """Start a task, if it is not refused."""
    try:
        if not inputs.arm.allowed:
            raise GoalRefusedError(f"not allowed to move: {inputs.arm.not_allowed_reason or 'no reason given'}")
        under_way = _under_way(state)
        if under_way and not request.preempt:
            raise GoalRefusedError(f"{request.task}: {under_way} is under way (preempt: true would replace it)")
        refuse_run_away(state.arm.dead)
        posture = posture_at_rest(model, state.arm) if state.arm.started else inputs.arm.positions
        gravity = float(np.linalg.norm(inputs.arm.gravity_in_base))
        feels, ground = inputs.wrench is not None, inputs.arm.ground
        task = request.begin(Beginning(params, model, posture, moves(state.arm), feels, ground, state.tool, gravity))
    except GoalRefusedError as error:
        return state, GoalEvent("refused", with_words(str(error), state.arm.dead))
    return replace(state, activity=_doing(request.task, task, Doing(), state.motion)), ACCEPTED


def _doing(name: str, task: Task, doing: Doing, motion: TipMotion | None) -> RunningTask:
    """A task that goes on with the motion of the tip, if there is one."""
    return RunningTask(name, task, doing) if motion is None else GuidedTask(name, task, doing, motion)


def _under_way(state: TaskState) -> str:
    """What the arm is at, in words; empty where it is at nothing."""
    activity = state.activity
    if isinstance(activity, Jog) and activity.motion is not None:
        return name_of(activity)
    if isinstance(activity, RunningTask) and not isinstance(state.arm.phase, Pausing | Paused):
        return activity.name if activity.doing.state == "moving" else ""
    return "another goal" if is_busy(state.arm.phase) else ""


def _observe(
    params: ArmParams, model: ArmModel, observer: MomentumObserver, inputs: TaskInput, dt: float
) -> MomentumObserver:
    """The observer of torques from outside; anew where nobody tells those of the joints."""
    arm = inputs.arm
    if inputs.efforts is None:
        return MomentumObserver()
    reading = JointReading(arm.positions, arm.velocities, inputs.efforts)
    rotors, rate = not params.gear_compliance, params.contact.observer_rate
    return observe(model, observer, rotors, reading, arm.gravity_in_base, rate, dt)


def _is_watched(state: TaskState) -> bool:
    """Whether a motion is under way that is to touch nothing."""
    if state.motion is None:
        return isinstance(state.arm.phase, Moving | Settling)
    return isinstance(state.activity, Jog)


def _watch(params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput) -> TaskState:
    """Give up a motion that meets something."""
    tip = forward_kinematics(model, inputs.arm.positions)
    felt = feel(model, state, inputs, tip)
    known = faded(state.known or before(felt, model.joint_count), felt)
    reason = touched(params.contact, model, tip, known, felt)
    if not reason and inputs.loads is not None and felt.force is not None:
        reason = lifted(params.contact, inputs.loads, felt.force)
    if not reason:
        return replace(state, known=known)
    reason = f"stopped: {reason}, and gives way"
    here = joint_positions(params, model, inputs.arm.positions, inputs.arm.gravity_in_base) - state.arm.trim
    doing = Doing(gives_way=True, state="failed", reason=reason)
    name, motion = name_of(state.activity) or "relax", begin_at(model, np.clip(here, model.lower, model.upper))
    return replace(state, activity=GuidedTask(name, Relaxed(reason), doing, motion), known=None)


def _work(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, dt: float
) -> tuple[TaskState, ArmGoal | None]:
    """Let the task look; the reference of the tip that it guides, or the goal that it gives to the arm."""
    activity = state.activity
    if not isinstance(activity, RunningTask) or not state.arm.started:
        return state, None
    view = _view(params, model, state, inputs)
    if activity.doing.state == "moving":
        activity = _guarded(params, model, state, activity, inputs, view)
    if isinstance(activity, PausedTask):
        velocity = np.zeros(3) if activity.doing.velocity is None else activity.doing.velocity
        pace, velocity = _at_pace(params, model, activity, velocity, 0.0, dt)
        motion = move(model, activity.motion, velocity, params.force_control.tip_acceleration, dt)
        return replace(state, activity=replace(activity, motion=motion, pace=pace)), None
    if isinstance(state.arm.phase, Pausing | Paused):
        return replace(state, activity=activity), None
    task, doing = activity.task.advance(view, dt)
    sense = state.sense if doing.bias is None else replace(state.sense, bias=state.sense.bias + doing.bias)
    state = replace(state, sense=sense, tool_command=doing.tool or state.tool_command)
    guided = motion_of(activity)
    if doing.gives_way and guided is not None:
        rates = yielding_rates(params.contact, model, view.tip, feel(model, state, inputs, view.tip))
        yielding = turn_joints(model, guided, rates, dt)
        return replace(state, activity=GuidedTask(activity.name, task, doing, yielding)), None
    if doing.velocity is None:
        stop = StopGoal() if guided is not None and doing.goal is None else None
        return replace(state, activity=RunningTask(activity.name, task, doing)), doing.goal or stop
    pace = activity.pace if isinstance(activity, GuidedTask) else GuidedPace()
    following = GuidedTask(activity.name, task, doing, guided or begin(model, state.arm.reference), pace)
    try:
        following = _led(params, model, following, doing.velocity, inputs, view, dt)
    except CannotFollowError as error:
        return replace(state, activity=given_up(activity.name, str(error))), StopGoal()
    return replace(state, activity=following), None


def _led(
    params: ArmParams,
    model: ArmModel,
    task: GuidedTask,
    velocity: FloatArray,
    inputs: TaskInput,
    view: TaskView,
    dt: float,
) -> GuidedTask:
    """The tip led on by a period with a task's velocity (3,) [m/s], as fast as the power granted allows.

    Raises:
        CannotFollowError: the joints cannot.
    """
    doing, pace = task.doing, GuidedPace()
    if doing.state == "moving":
        share, slowed = granted_velocity(params, model, inputs.arm, task.motion, velocity, view.force)
        if slowed:
            doing = replace(doing, reason=slowed, time_to_go=doing.time_to_go / max(share, 1e-3))
        pace, velocity = _at_pace(params, model, task, velocity, share, dt)
    motion = move(model, task.motion, velocity, params.force_control.tip_acceleration, dt)
    return replace(task, doing=doing, motion=motion, pace=pace)


def _at_pace(
    params: ArmParams, model: ArmModel, task: GuidedTask, velocity: FloatArray, share: float, dt: float
) -> tuple[GuidedPace, FloatArray]:
    """A task's velocity of the tip (3,) [m/s] at the pace of this period, which is on its way to a share of it."""
    if task.pace == GuidedPace() and share == 1.0:
        return task.pace, velocity
    speed, most = float(np.linalg.norm(velocity)), params.force_control.tip_acceleration
    limits = pace_limits(model, rates_of(model, task.motion, velocity), speed, most)
    pace = next_pace(task.pace, share, limits, dt)
    return pace, pace.share * velocity


def _guarded(
    params: ArmParams, model: ArmModel, state: TaskState, activity: RunningTask, inputs: TaskInput, view: TaskView
) -> RunningTask:
    """The task under way, or what is left of it where the arm may not go on."""
    motion = motion_of(activity)
    ended = _why_ended(params, model, state, inputs, view)
    return activity if ended is None else _doing(activity.name, ended, activity.doing, motion)


def _why_ended(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, view: TaskView
) -> Ended | Released | None:
    if not inputs.arm.allowed:
        return Ended(f"not allowed to move: {inputs.arm.not_allowed_reason}")
    if state.motion is None:
        return None
    force = float(np.linalg.norm(view.force))
    if force > params.force_control.max_force:
        reason = f"contact force {force:.0f} N: at most {params.force_control.max_force:g} N is allowed"
        return Released(reason, -view.force / force)
    tips = "" if inputs.loads is None else lifted(params.contact, inputs.loads, view.force)
    if tips:
        return Released(tips, -view.force / force)
    held = held_back(params, model, state, inputs)
    return Ended(held) if held else None


def _view(params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput) -> TaskView:
    arm = inputs.arm
    tip = forward_kinematics(model, arm.positions)
    force, rest = np.zeros(3), np.zeros(6)
    if inputs.wrench is not None:
        force = state.sense.contact(model, tip, inputs.wrench, arm.gravity_in_base)
        rest = inputs.wrench - state.sense.bias - state.sense.tool_load(model, tip, arm.gravity_in_base)
    return TaskView(
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
