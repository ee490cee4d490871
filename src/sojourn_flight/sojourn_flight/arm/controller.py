"""The laws of the arm node: goals in, joint references, feed-forward efforts and a status out.

One call of `step` a control period (20 ms). The joint servo (PD) is the plant's or the real drive's: it
follows the position and velocity given here and adds the effort.

- A new goal is planned (limits, collisions) within the call and pre-empts the present motion from its
  present position, velocity and acceleration. A refused goal changes nothing but the reason; a motion under
  way goes on.
- At the end of the motion the state stays 'moving' (progress 1) until the measured joints have been within
  tolerance for `settle_time`: 'reached'. After `settle_timeout` without that: 'holding', reason "not
  settled" and the error.
- A joint that falls behind by more than `following_error_limit` ends the motion: the reference goes back to
  where the arm is, so that it does not push against what holds it.
- `allowed` false (load shed, drive moving) ends a motion with a jerk-limited stop; goals are refused
  meanwhile. When it is true again and the arm has sagged by more than `resync_error`, the reference starts
  anew from the measured position.
- A pause brings the motion to rest on its path, and resuming goes on from there (pace.py). Where less power is granted
  than the motion would draw, it is planned slower, or run slower from where it is.
- A task may give the reference itself (`guide`): the arm then follows it and plans nothing.
- A joint that does not move is found as dead_joints.py says; what follows is planned with it where it is.
- Trim: at rest the position sent is reference + trim, with  d trim/dt = rate (reference - measured),
  limited in rate and size, and left alone within the deadband. It takes out what gravity model errors and
  friction leave to a PD servo. It is frozen in motion. The first step holds the measured position.

The state is a value: copy it, save it, go on from it; nothing is kept elsewhere.
"""

import math
from contextlib import suppress

import numpy as np

from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.dead_joints import (
    arm_without,
    known_dead,
    refuse_run_away,
    run_away,
    stands_still,
    tried_again,
    with_words,
    words,
)
from sojourn_flight.arm.deflection import joint_positions, motor_positions
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.feedforward import feedforward_effort
from sojourn_flight.arm.goal_events import ACCEPTED, GoalEvent, Outcome
from sojourn_flight.arm.goals import ArmGoal, PauseGoal, PoseGoal, ResumeGoal, StopGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.pace import (
    follow_granted_power,
    go_on_at_rate,
    pause,
    resume,
    runs_as_planned,
    with_granted_power,
)
from sojourn_flight.arm.param_groups import FollowingParams, SettlingParams
from sojourn_flight.arm.params import ArmParams, TrimParams
from sojourn_flight.arm.path_clock import PathClock
from sojourn_flight.arm.phases import (
    ArmStatus,
    Guided,
    Holding,
    Moving,
    Paused,
    RestStatus,
    Settling,
    Stopping,
    Waiting,
    is_busy,
)
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import flat_relief
from sojourn_flight.arm.state import ArmInput, ArmOutput, ArmState, Target, initial_state
from sojourn_flight.arm.tasks.tip_motion import TipMotion
from sojourn_flight.arm.trajectory import JointReference, TrajectoryError, at_rest, point_to_point, stop
from sojourn_flight.arm.ways import Departure, Plan
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

__all__ = ["ArmInput", "ArmOutput", "ArmState", "ArmStatus", "initial_state", "step", "warm_up"]

_OUTCOMES: dict[RestStatus, Outcome] = {"reached": "reached", "stopped": "stopped", "holding": "failed"}
"""What has become of a motion under way, by the status in which the arm then holds."""


def warm_up(params: ArmParams, model: ArmModel) -> None:
    """Have every compiled kernel ready, so that no later step waits for the compiler (seconds)."""
    start = np.array(params.named_poses["unfold"])
    tip = forward_kinematics(model, start)
    goal = PoseGoal((float(tip.position[0]), float(tip.position[1]), float(tip.position[2])))
    rest, level = np.zeros(model.joint_count), np.array([0.0, 0.0, -1.0])
    state = initial_state(params)
    for request in (goal, StopGoal(), None):
        state, _ = step(params, model, state, ArmInput(start, rest, level, goal=request), 0.02)
        if isinstance(state.phase, Moving):
            state.phase.plan.path.states(np.zeros(1))  # that a pause asks
    check_posture(params, model, start, flat_relief(GroundPlane(-100.0)))


def step(
    params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, dt: float
) -> tuple[ArmState, ArmOutput]:
    """One control period of `dt` [s].

    Raises:
        InvalidValueError: a measurement or the gravity vector of wrong length or not finite.
    """
    _check_input(model, inputs, dt)
    if state.dead:
        state = _with_another_try(model, state, inputs)
        model = arm_without(model, state.dead)
    positions = joint_positions(params, model, inputs.positions, inputs.gravity_in_base)
    if positions is not inputs.positions:
        inputs = replace(inputs, positions=positions)
    if isinstance(state.phase, Waiting):
        state = _hold(model, state, inputs.positions, "idle", "")
    before, state = state, _follow_permission(params, model, state, inputs)
    events = _ended(before, state)
    if inputs.goal is not None:
        state, event = _take_goal(params, model, state, inputs, inputs.goal)
        events = (*events, event)
    if inputs.granted != state.granted:
        state = follow_granted_power(params, model, state, inputs)
    before = state
    if inputs.guide is not None and (inputs.goal is None or not isinstance(state.phase, Moving | Stopping)):
        state = _follow(model, state, inputs.guide)
    else:
        state = _advance(params, model, state, inputs, dt)
        events = (*events, *_ended(before, state))
    if inputs.feels and inputs.allowed and isinstance(state.phase, Holding | Settling):
        off = np.abs(state.reference.position + state.trim - inputs.positions)
        dead = run_away(params, model, state.dead, off, inputs.positions)
        state = state if dead is state.dead else replace(state, dead=dead)
    return state, _output(params, model, state, inputs, events)


def _with_another_try(model: ArmModel, state: ArmState, inputs: ArmInput) -> ArmState:
    """Without the dead joint that a goal tries again: the arm, at rest, begins where it is."""
    dead = tried_again(state.dead, inputs.goal)
    if len(dead) == len(state.dead) or not inputs.allowed or is_busy(state.phase):
        return state
    return _hold(model, replace(state, dead=dead), inputs.positions, "stopped", "")


def _ended(before: ArmState, after: ArmState) -> tuple[GoalEvent, ...]:
    """What it means for a goal that one phase has given way to the next one."""
    old, new = before.phase, after.phase
    if isinstance(new, Paused) and not isinstance(old, Paused):
        return (GoalEvent("paused", after.reason),)
    if isinstance(new, Holding) and is_busy(old):
        return (GoalEvent(_OUTCOMES[new.status], after.reason),)
    return ()


def _check_input(model: ArmModel, inputs: ArmInput, dt: float) -> None:
    n = model.joint_count
    for name, array, length in (
        ("measured positions", inputs.positions, n),
        ("measured velocities", inputs.velocities, n),
        ("gravity_in_base", inputs.gravity_in_base, 3),
    ):
        if array.shape != (length,) or not all(map(math.isfinite, array.tolist())):
            raise InvalidValueError(name, array.tolist(), f"{length} finite numbers")
    if not 0.0 < dt <= 1.0:
        raise InvalidValueError("dt", dt, "above 0, at most 1 s")


def _hold(model: ArmModel, state: ArmState, positions: FloatArray, status: RestStatus, reason: str) -> ArmState:
    """Stand still at `positions`, without trim."""
    target = Target(positions.copy(), forward_kinematics(model, positions).position)
    trim = np.zeros(positions.shape[0])
    return replace(state, phase=Holding(status), reference=at_rest(positions), target=target, trim=trim, reason=reason)


def _follow(model: ArmModel, state: ArmState, guide: TipMotion) -> ArmState:
    """Take the reference that a task gives. The trim stays as it is: against a contact it would not come to an end."""
    joints = guide.joints.position
    target = Target(joints.copy(), forward_kinematics(model, joints).position, guide.origin)
    return replace(state, phase=Guided(), reference=guide.joints, target=target, reason="")


def _follow_permission(params: FollowingParams, model: ArmModel, state: ArmState, inputs: ArmInput) -> ArmState:
    if not inputs.allowed:
        reason = f"not allowed to move: {inputs.not_allowed_reason or 'no reason given'}"
        if isinstance(state.phase, Moving):
            state, _ = _begin_stop(model, state, reason)
        elif isinstance(state.phase, Settling):
            state = replace(state, phase=Holding("stopped"), reason=reason)
        return replace(state, was_allowed=False) if state.was_allowed else state
    if not state.was_allowed:
        state = replace(state, was_allowed=True)
        off = np.abs(inputs.positions - state.reference.position)
        worst = int(np.argmax(off))
        if not isinstance(state.phase, Moving | Stopping) and off[worst] > params.resync_error:
            text = f"allowed again: holds where it is, {off[worst]:.3f} {model.unit(worst)} from where it stopped"
            state = _hold(model, state, inputs.positions, "stopped", text)
    return state


def _begin_stop(model: ArmModel, state: ArmState, reason: str) -> tuple[ArmState, Stopping]:
    """The state, and its phase."""
    stopping = Stopping(stop(model, state.reference))
    end = stopping.path.sample(stopping.path.duration)[0]
    target = Target(end, forward_kinematics(model, end).position, state.way_out)
    return replace(state, phase=stopping, target=target, part_done=state.progress, reason=reason), stopping


def _take_goal(
    params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, goal: ArmGoal
) -> tuple[ArmState, GoalEvent]:
    if isinstance(goal, StopGoal):
        return _begin_stop(model, state, "stop asked for")[0], ACCEPTED
    try:
        if not inputs.allowed:
            raise GoalRefusedError(f"not allowed to move: {inputs.not_allowed_reason or 'no reason given'}")
        if isinstance(goal, PauseGoal):
            return pause(state), ACCEPTED
        if isinstance(goal, ResumeGoal):
            return resume(state), ACCEPTED
        refuse_run_away(state.dead)
        departure = Departure(state.reference, state.target.joints, state.way_out)
        granted = with_granted_power(params, inputs.granted)
        plan = plan_goal(granted, model, goal, departure, inputs.ground, inputs.gravity_in_base)
    except GoalRefusedError as error:
        why = with_words(str(error), state.dead)
        if is_busy(state.phase):
            state = replace(state, reason=f"new goal refused: {why}")
        else:
            state = replace(state, phase=Holding("refused"), part_done=0.0, reason=why)
        return state, GoalEvent("refused", state.reason)
    plan = replace(plan, note=with_words(plan.note, state.dead))
    return _start(replace(state, granted=inputs.granted), plan), ACCEPTED


def _start(state: ArmState, plan: Plan) -> ArmState:
    target = Target(plan.target, plan.tip_target, plan.retreat)
    phase = Moving(plan, PathClock(rate=1.0))
    return replace(state, phase=phase, target=target, part_done=1.0, reason=plan.note)


def _advance(params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, dt: float) -> ArmState:
    phase = state.phase
    if isinstance(phase, Moving):
        return _go_on(params, model, state, phase, inputs, dt)
    if isinstance(phase, Stopping):
        return _go_on_stopping(state, phase, dt)
    error = state.reference.position - inputs.positions
    if inputs.allowed and params.trim.rate > 0.0:
        trim = _trimmed(params.trim, state.trim, error, dt)
        state = state if trim is state.trim else replace(state, trim=trim)
    return _settle(params, model, state, phase, inputs, error, dt) if isinstance(phase, Settling) else state


def _go_on(
    params: ArmParams, model: ArmModel, state: ArmState, moving: Moving, inputs: ArmInput, dt: float
) -> ArmState:
    behind = np.abs(state.reference.position + state.trim - inputs.positions)
    if float(np.max(behind)) > params.following_error_limit:
        state, stopping = give_way(params, model, state, inputs, behind)
        return _go_on_stopping(state, stopping, dt)
    path = moving.plan.path
    if not runs_as_planned(moving):
        state, moving = go_on_at_rate(model, state, moving, dt)
        if moving.clock.time < path.duration:
            return state
    time = moving.clock.time + dt
    if time < path.duration:
        reference = JointReference(*path.sample(time))
        return replace(state, phase=replace(moving, clock=replace(moving.clock, time=time)), reference=reference)
    return replace(state, phase=Settling(), reference=at_rest(state.target.joints))


def _go_on_stopping(state: ArmState, stopping: Stopping, dt: float) -> ArmState:
    time = stopping.time + dt
    if time < stopping.path.duration:
        reference = JointReference(*stopping.path.sample(time))
        return replace(state, phase=Stopping(stopping.path, time), reference=reference)
    return replace(state, phase=Holding("stopped"), reference=at_rest(state.target.joints))


def give_way(
    params: FollowingParams, model: ArmModel, state: ArmState, inputs: ArmInput, behind: FloatArray
) -> tuple[ArmState, Stopping]:
    """Bring the reference back to the measured position, as a joint is too far from it. The state, and its phase.

    Args:
        behind: sizes of the following errors (n,) [rad or m]. Where contacts are felt, as `inputs` say, a joint that
            alone stands still does not move any more, and is known by that from now on.
    """
    joint = int(np.argmax(behind))
    reason = (
        f"stopped: {model.joint_names[joint]} is {behind[joint]:.3f} {model.unit(joint)} from its reference "
        f"(limit {params.following_error_limit:.3f}): something holds it"
    )
    given_way, stopping = _begin_stop(model, state, reason)
    here = np.clip(inputs.positions, model.lower, model.upper)
    with suppress(TrajectoryError):
        stopping = Stopping(point_to_point(model, state.reference, here))
        target = replace(given_way.target, joints=here, tip=forward_kinematics(model, here).position)
        given_way = replace(given_way, phase=stopping, target=target)
    if inputs.feels and stands_still(params, model, behind, inputs.velocities):
        dead = known_dead(state.dead, model, joint, float(given_way.target.joints[joint]), True)
        given_way = replace(given_way, dead=dead, reason=f"{reason}; {words(dead)}")
    return given_way, stopping


def _trimmed(settings: TrimParams, trim: FloatArray, error: FloatArray, dt: float) -> FloatArray:
    active = np.abs(error) > settings.deadband
    if not active.any():
        return trim
    rate = np.minimum(np.maximum(settings.rate * error, -settings.max_rate), settings.max_rate)
    moved = trim + np.where(active, rate, 0.0) * dt
    return np.asarray(np.minimum(np.maximum(moved, -settings.limit), settings.limit), dtype=np.float64)


def _settle(
    params: SettlingParams,
    model: ArmModel,
    state: ArmState,
    settling: Settling,
    inputs: ArmInput,
    error: FloatArray,
    dt: float,
) -> ArmState:
    off = np.abs(error)
    still = float(np.max(np.abs(inputs.velocities))) <= params.settle_velocity
    worst = int(np.argmax(off))
    within = still and float(off[worst]) <= params.joint_tolerance
    settling = Settling(settling.within_for + dt if within else 0.0, settling.elapsed + dt)
    if settling.within_for >= params.settle_time - 1e-9:
        return replace(state, phase=Holding("reached"))
    if settling.elapsed >= params.settle_timeout:
        speeds = np.abs(inputs.velocities)
        fastest = int(np.argmax(speeds))
        reason = (
            f"not settled {params.settle_timeout:.1f} s after the motion: {model.joint_names[worst]} is "
            f"{float(off[worst]):.4f} {model.unit(worst)} off (tolerance {params.joint_tolerance:.4f}), "
            f"fastest joint {speeds[fastest]:.3f} {model.unit(fastest)}/s"
        )
        return replace(state, phase=Holding("holding"), reason=reason)
    return replace(state, phase=settling)


def _within_limits(model: ArmModel, position: FloatArray, trim: FloatArray) -> FloatArray:
    """Reference with its trim, which is not to push the command out of the joint limits."""
    lower, upper = np.minimum(model.lower, position), np.maximum(model.upper, position)
    return np.asarray(np.minimum(np.maximum(position + trim, lower), upper), dtype=np.float64)


def _time_to_go(state: ArmState) -> float:
    """Of the path under way [s]."""
    phase = state.phase
    if isinstance(phase, Moving):
        return max(phase.plan.path.duration - phase.clock.time, 0.0) / max(phase.pace, 1e-3)
    return max(phase.path.duration - phase.time, 0.0) if isinstance(phase, Stopping) else 0.0


def _output(
    params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, events: tuple[GoalEvent, ...]
) -> ArmOutput:
    reference, gravity = state.reference, inputs.gravity_in_base
    rigid = rigid_effort(model, reference.position, reference.velocity, reference.acceleration, gravity)
    tip = forward_kinematics(model, inputs.positions)
    offset = tip.position - state.target.tip
    return ArmOutput(
        positions=_within_limits(model, motor_positions(params, reference.position, rigid), state.trim),
        velocities=reference.velocity.copy(),
        efforts=feedforward_effort(params, model, reference.velocity, rigid),
        status=state.status,
        progress=state.progress,
        time_to_go=_time_to_go(state),
        reason=state.reason,
        tip_in_base=tip.position,
        tool_direction_in_base=tip.tool_direction,
        goal_error=float(np.sqrt(offset @ offset)),
        joint_error=float(np.max(np.abs(inputs.positions - state.target.joints))),
        events=events,
        failed_joints=words(state.dead),
    )
