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
- Trim: at rest the position sent is reference + trim, with  d trim/dt = rate (reference - measured),
  limited in rate and size, and left alone within the deadband. It takes out what gravity model errors and
  friction leave to a PD servo. It is frozen in motion. The first step holds the measured position.

The state is a value: copy it, save it, go on from it; nothing is kept elsewhere.
"""

import numpy as np

from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.deflection import joint_positions, motor_positions
from sojourn_flight.arm.feedforward import feedforward_effort
from sojourn_flight.arm.goals import PauseGoal, PoseGoal, ResumeGoal, StopGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.pace import (
    follow_granted_power,
    go_on_at_rate,
    is_granted_as_before,
    pause,
    resume,
    with_granted_power,
)
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import flat_relief
from sojourn_flight.arm.state import ArmInput, ArmOutput, ArmState, ArmStatus, initial_state
from sojourn_flight.arm.tasks.tip_motion import TipMotion
from sojourn_flight.arm.trajectory import JointReference, TrajectoryError, at_rest, point_to_point, stop
from sojourn_flight.arm.ways import Plan
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

__all__ = ["ArmInput", "ArmOutput", "ArmState", "ArmStatus", "initial_state", "step", "warm_up"]


def warm_up(params: ArmParams, model: ArmModel) -> None:
    """Have every compiled kernel ready, so that no later step waits for the compiler (seconds)."""
    start = np.array(params.named_poses["unfold"])
    tip = forward_kinematics(model, start)
    goal = PoseGoal((float(tip.position[0]), float(tip.position[1]), float(tip.position[2])))
    rest, level = np.zeros(model.joint_count), np.array([0.0, 0.0, -1.0])
    state = initial_state(params)
    for request in (goal, StopGoal(), None):
        state, _ = step(params, model, state, ArmInput(start, rest, level, goal=request), 0.02)
    check_posture(params, model, start, flat_relief(GroundPlane(-100.0)))


def step(
    params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, dt: float
) -> tuple[ArmState, ArmOutput]:
    """One control period of `dt` [s].

    Raises:
        InvalidValueError: a measurement or the gravity vector of wrong length or not finite.
    """
    _check_input(model, inputs, dt)
    inputs = replace(inputs, positions=joint_positions(params, model, inputs.positions, inputs.gravity_in_base))
    if not state.started:
        state = _hold(model, replace(state, started=True), inputs.positions, "idle", "")
    state = _follow_permission(params, model, state, inputs)
    if inputs.goal is not None:
        state = _take_goal(params, model, state, inputs)
    if not is_granted_as_before(state, inputs):
        state = follow_granted_power(params, model, state, inputs)
    if inputs.guide is not None and (inputs.goal is None or state.path is None):
        state = _follow(model, state, inputs.guide)
    else:
        state = _advance(params, model, state, inputs, dt)
    return state, _output(params, model, state, inputs)


def _check_input(model: ArmModel, inputs: ArmInput, dt: float) -> None:
    n = model.joint_count
    for name, array, length in (
        ("measured positions", inputs.positions, n),
        ("measured velocities", inputs.velocities, n),
        ("gravity_in_base", inputs.gravity_in_base, 3),
    ):
        if array.shape != (length,) or not np.isfinite(array).all():
            raise InvalidValueError(name, array.tolist(), f"{length} finite numbers")
    if not 0.0 < dt <= 1.0:
        raise InvalidValueError("dt", dt, "above 0, at most 1 s")


def _hold(model: ArmModel, state: ArmState, positions: FloatArray, status: ArmStatus, reason: str) -> ArmState:
    """Stand still at `positions`, without trim."""
    return replace(
        state,
        reference=at_rest(positions),
        target=positions.copy(),
        tip_target=forward_kinematics(model, positions).position,
        path=None,
        settling=False,
        stopping=False,
        trim=np.zeros(positions.shape[0]),
        retreat=None,
        leave=None,
        leave_time=0.0,
        status=status,
        reason=reason,
        rate=1.0,
        rate_change=0.0,
        rate_fade=0,
        paused=False,
    )


def _follow(model: ArmModel, state: ArmState, guide: TipMotion) -> ArmState:
    """Take the reference that a task gives. The trim stays as it is: against a contact it would not come to an end."""
    held = _hold(model, state, guide.joints.position, "moving", "")
    return replace(held, reference=guide.joints, trim=state.trim, retreat=guide.origin)


def _follow_permission(params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput) -> ArmState:
    if not inputs.allowed:
        reason = f"not allowed to move: {inputs.not_allowed_reason or 'no reason given'}"
        if state.path is not None and not state.stopping:
            state = _begin_stop(model, state, reason)
        elif state.settling:
            state = replace(state, settling=False, status="stopped", reason=reason)
        return replace(state, was_allowed=False) if state.was_allowed else state
    if not state.was_allowed:
        state = replace(state, was_allowed=True)
        off = np.abs(inputs.positions - state.reference.position)
        worst = int(np.argmax(off))
        if state.path is None and off[worst] > params.resync_error:
            text = f"allowed again: holds where it is, {off[worst]:.3f} {model.unit(worst)} from where it stopped"
            state = _hold(model, state, inputs.positions, "stopped", text)
    return state


def _begin_stop(model: ArmModel, state: ArmState, reason: str) -> ArmState:
    path = stop(model, state.reference)
    end = path.sample(path.duration)[0]
    return replace(
        state,
        part_done=_progress(state),
        path=path,
        path_time=0.0,
        stopping=True,
        settling=False,
        target=end,
        tip_target=forward_kinematics(model, end).position,
        retreat=_present_retreat(state),
        retreat_time=0.0,
        leave=None,
        leave_time=0.0,
        status="moving",
        reason=reason,
        rate=1.0,
        rate_change=0.0,
        rate_fade=0,
        paused=False,
    )


def _present_retreat(state: ArmState) -> FloatArray | None:
    """The posture by which the arm must leave: on its last stretch, at its target, or just leaving one."""
    if state.path is not None and state.path_time < state.leave_time:
        return state.leave
    if state.path is not None and state.path_time < state.retreat_time:
        return None
    return state.retreat


def _take_goal(params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput) -> ArmState:
    if inputs.goal is None:
        return state
    if isinstance(inputs.goal, StopGoal):
        state = _begin_stop(model, state, "stop asked for")
        return replace(state, goals_accepted=state.goals_accepted + 1)
    try:
        if not inputs.allowed:
            raise GoalRefusedError(f"not allowed to move: {inputs.not_allowed_reason or 'no reason given'}")
        if isinstance(inputs.goal, PauseGoal):
            return pause(state)
        if isinstance(inputs.goal, ResumeGoal):
            return resume(state)
        retreat, gravity = _present_retreat(state), inputs.gravity_in_base
        granted = with_granted_power(params, inputs)
        plan = plan_goal(granted, model, inputs.goal, state.reference, state.target, retreat, inputs.ground, gravity)
    except GoalRefusedError as error:
        busy = state.path is not None or state.settling
        return replace(
            state,
            status=state.status if busy else "refused",
            part_done=state.part_done if busy else 0.0,
            reason=f"new goal refused: {error}" if busy else str(error),
            goals_refused=state.goals_refused + 1,
        )
    return _start(replace(state, granted_power=inputs.granted_power, granted_current=inputs.granted_current), plan)


def _start(state: ArmState, plan: Plan) -> ArmState:
    return replace(
        state,
        path=plan.path,
        path_time=0.0,
        stopping=False,
        settling=False,
        target=plan.target,
        tip_target=plan.tip_target,
        retreat=plan.retreat,
        retreat_time=plan.retreat_time,
        leave=plan.leave,
        leave_time=plan.leave_time,
        part_done=1.0,
        status="moving",
        reason=plan.note,
        rate=1.0,
        rate_change=0.0,
        rate_fade=0,
        pace=1.0,
        paused=False,
        goals_accepted=state.goals_accepted + 1,
    )


def _advance(params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, dt: float) -> ArmState:
    if state.path is not None:
        return _advance_motion(params, model, state, state.path, inputs, dt)
    error = state.reference.position - inputs.positions
    trim = state.trim
    if inputs.allowed and params.trim.rate > 0.0:
        trim = _trimmed(params, trim, error, dt)
    if not state.settling:
        return state if trim is state.trim else replace(state, trim=trim)
    return _settle(params, model, replace(state, trim=trim), inputs, error, dt)


def _advance_motion(
    params: ArmParams, model: ArmModel, state: ArmState, path: JointPath, inputs: ArmInput, dt: float
) -> ArmState:
    behind = np.abs(state.reference.position + state.trim - inputs.positions)
    worst = int(np.argmax(behind))
    if behind[worst] > params.following_error_limit and not state.stopping:
        state = _yield(params, model, state, inputs, worst, float(behind[worst]))
        path = state.path if state.path is not None else path
    if state.rate < 1.0 or state.pace < 1.0 or state.paused:
        slowed = go_on_at_rate(model, state, path, dt)
        if slowed.path_time < path.duration:
            return slowed
        state = replace(slowed, rate=1.0, rate_change=0.0, rate_fade=0, paused=False)
    time = state.path_time + dt
    if time < path.duration:
        return replace(state, path_time=time, reference=JointReference(*path.sample(time)))
    reference = at_rest(state.target)
    if state.stopping:
        return replace(state, path=None, reference=reference, stopping=False, status="stopped")
    return replace(state, path=None, reference=reference, settling=True, settled_for=0.0, settling_for=0.0)


def _yield(
    params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, joint: int, behind: float
) -> ArmState:
    """Give way: bring the reference back to the measured position."""
    reason = (
        f"stopped: {model.joint_names[joint]} is {behind:.3f} {model.unit(joint)} from its reference "
        f"(limit {params.following_error_limit:.3f}): something holds it"
    )
    stopped = _begin_stop(model, state, reason)
    here = np.clip(inputs.positions, model.lower, model.upper)
    try:
        path = point_to_point(model, state.reference, here)
    except TrajectoryError:
        return stopped
    return replace(stopped, path=path, target=here, tip_target=forward_kinematics(model, here).position)


def _trimmed(params: ArmParams, trim: FloatArray, error: FloatArray, dt: float) -> FloatArray:
    settings = params.trim
    active = np.abs(error) > settings.deadband
    if not active.any():
        return trim
    rate = np.minimum(np.maximum(settings.rate * error, -settings.max_rate), settings.max_rate)
    moved = trim + np.where(active, rate, 0.0) * dt
    return np.asarray(np.minimum(np.maximum(moved, -settings.limit), settings.limit), dtype=np.float64)


def _settle(
    params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput, error: FloatArray, dt: float
) -> ArmState:
    off = np.abs(error)
    still = float(np.max(np.abs(inputs.velocities))) <= params.settle_velocity
    worst = int(np.argmax(off))
    within = still and float(off[worst]) <= params.joint_tolerance
    settled_for = state.settled_for + dt if within else 0.0
    settling_for = state.settling_for + dt
    if settled_for >= params.settle_time - 1e-9:
        return replace(state, settling=False, settled_for=settled_for, settling_for=settling_for, status="reached")
    if settling_for >= params.settle_timeout:
        speeds = np.abs(inputs.velocities)
        fastest = int(np.argmax(speeds))
        reason = (
            f"not settled {params.settle_timeout:.1f} s after the motion: {model.joint_names[worst]} is "
            f"{float(off[worst]):.4f} {model.unit(worst)} off (tolerance {params.joint_tolerance:.4f}), "
            f"fastest joint {speeds[fastest]:.3f} {model.unit(fastest)}/s"
        )
        return replace(state, settling=False, settling_for=settling_for, status="holding", reason=reason)
    return replace(state, settled_for=settled_for, settling_for=settling_for)


def _within_limits(model: ArmModel, position: FloatArray, trim: FloatArray) -> FloatArray:
    """Reference with its trim, which is not to push the command out of the joint limits."""
    lower, upper = np.minimum(model.lower, position), np.maximum(model.upper, position)
    return np.asarray(np.minimum(np.maximum(position + trim, lower), upper), dtype=np.float64)


def _progress(state: ArmState) -> float:
    """Part of the motion of the last goal that is done, 0 to 1; a stop does not add to it."""
    if state.path is None or state.stopping:
        return state.part_done
    return min(state.path_time / max(state.path.duration, 1e-9), 1.0)


def _output(params: ArmParams, model: ArmModel, state: ArmState, inputs: ArmInput) -> ArmOutput:
    reference = state.reference
    tip = forward_kinematics(model, inputs.positions)
    offset = tip.position - state.tip_target
    time_to_go = 0.0 if state.path is None else max(state.path.duration - state.path_time, 0.0) / max(state.pace, 1e-3)
    return ArmOutput(
        positions=_within_limits(model, motor_positions(params, model, reference, inputs.gravity_in_base), state.trim),
        velocities=reference.velocity.copy(),
        efforts=feedforward_effort(
            params,
            model,
            reference.position,
            reference.velocity,
            reference.acceleration,
            inputs.gravity_in_base,
        ),
        status=state.status,
        progress=_progress(state),
        time_to_go=time_to_go,
        reason=state.reason,
        tip_in_base=tip.position,
        tool_direction_in_base=tip.tool_direction,
        goal_error=float(np.sqrt(offset @ offset)),
        joint_error=float(np.max(np.abs(inputs.positions - state.target))),
        goals_accepted=state.goals_accepted,
        goals_refused=state.goals_refused,
    )
