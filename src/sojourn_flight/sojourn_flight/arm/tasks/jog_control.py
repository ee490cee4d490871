"""A jog in the place of a task: taken or refused, and carried on a period at a time."""

from sojourn_flight.arm.dead_joints import refuse_run_away, with_words
from sojourn_flight.arm.goal_events import ACCEPTED, GoalEvent
from sojourn_flight.arm.jogging import JogCommand, Surroundings, begin_jog, jog_on
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.pace import with_granted_power
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.phases import Holding
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmState, Target
from sojourn_flight.arm.tasks.activity import Jog, RunningTask, motion_of
from sojourn_flight.arm.tasks.joint_watch import held_back
from sojourn_flight.arm.tasks.relaxed import Relaxed
from sojourn_flight.arm.tasks.task import Doing
from sojourn_flight.arm.tasks.task_state import TaskInput, TaskState
from sojourn_flight.arm.tasks.tip_motion import begin, begin_at
from sojourn_flight.arm.trajectory import JointReference
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray


def take_jog(
    params: ArmParams, model: ArmModel, state: TaskState, inputs: TaskInput, command: JogCommand
) -> tuple[TaskState, GoalEvent]:
    """Begin a jog, or go on with it by a new command, in place of whatever is under way, if it is not refused.

    A command that is refused stops the jog. Where the tool has met something, commands are refused until they pause.
    """
    paused = state.since_jog >= params.jog.pause
    before = state.activity
    task = before.task if isinstance(before, RunningTask) else None
    state = replace(state, since_jog=0.0)
    try:
        if not inputs.arm.allowed:
            raise GoalRefusedError(f"not allowed to move: {inputs.arm.not_allowed_reason or 'no reason given'}")
        if isinstance(task, Relaxed) and not paused:
            raise GoalRefusedError(f"{task.reason}: no jog until the commands pause for {params.jog.pause:g} s")
        refuse_run_away(state.arm.dead)
        posture = state.arm.reference.position if state.arm.started else inputs.arm.positions
        jogging = begin_jog(params, model, command, posture, inputs.arm.ground)
    except GoalRefusedError as error:
        if isinstance(before, Jog):
            still = replace(before.jogging, command=JogCommand((0.0,) * 3, (0.0,) * 3))
            state = replace(state, activity=replace(before, jogging=still))
        return state, GoalEvent("refused", with_words(str(error), state.arm.dead))
    if isinstance(before, Jog):
        jogging = replace(jogging, share=before.jogging.share, near=jogging.near and before.jogging.near)
    motion = motion_of(before)
    if motion is None:
        motion = begin(model, state.arm.reference) if state.arm.started else begin_at(model, inputs.arm.positions)
    return replace(state, activity=Jog(jogging, Doing(), motion)), ACCEPTED


def go_on_with_jog(
    params: ArmParams, model: ArmModel, state: TaskState, jog: Jog, inputs: TaskInput, dt: float
) -> TaskState:
    """A period of a jog; at its end the arm holds where it rests."""
    if jog.motion is None:
        return state
    hindrance = held_back(params, model, state, inputs)
    if not inputs.arm.allowed:
        hindrance = f"not allowed to move: {inputs.arm.not_allowed_reason}"
    granted, limited = params, inputs.arm.granted.power is not None
    if limited:
        granted = with_granted_power(params, inputs.arm.granted)
    around = Surroundings(inputs.arm.ground, inputs.arm.gravity_in_base, hindrance, limited)
    jogging, joints = jog_on(granted, model, jog.jogging, jog.motion.joints, around, dt)
    doing = Doing(state="moving" if jogging.moving else "failed" if hindrance else "stopped", reason=jogging.reason)
    motion = replace(begin(model, joints), origin=None)
    if jogging.moving:
        return replace(state, activity=Jog(jogging, doing, motion))
    return replace(state, activity=Jog(jogging, doing, None), arm=_rested(state.arm, joints, motion.place))


def _rested(arm: ArmState, joints: JointReference, tip: FloatArray) -> ArmState:
    """Not guided any more: the arm holds at `joints`, with its tip (3,) there [m]."""
    if not arm.started:
        return arm
    return replace(arm, phase=Holding("stopped"), reference=joints, target=Target(joints.position, tip))
